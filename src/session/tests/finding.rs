//! Failures, events, marks, selections, and the board.

use std::collections::BTreeMap;
use std::sync::Mutex;

use super::*;
use crate::measure::failure::Order;
use crate::session::snapshot::EventKind;
use crate::session::snapshot::table::Column;
use crate::session::survey::Cache;
use crate::session::wants::Wants;

#[test]
fn failures_are_gone_through_from_the_worst_on() {
    let mut session = session();
    assert!(!session.snapshot().table.asked);
    let first = run(&mut session, [Failure(1)]);
    let table = Arc::clone(&first.table);
    assert_eq!(
        (table.scored, table.queue.len(), table.place),
        (4, 4, Some(0))
    );
    let worst = table.queue[0];
    assert_eq!(
        (first.episode_index, first.cursor),
        (worst.episode, worst.step)
    );
    for pair in table.queue.windows(2) {
        assert!(pair[0].value >= pair[1].value);
    }
    for failure in table.queue.iter() {
        let row = &table.rows[failure.episode];
        let by_step = &row.score.as_ref().unwrap().by_step;
        let most = by_step.iter().filter_map(|s| s.error).fold(0.0, f32::max);
        assert_eq!(failure.value, most);
    }
    let second = run(&mut session, [Failure(1)]);
    assert_eq!(second.episode_index, table.queue[1].episode);
    let back = run(&mut session, [Failure(-1)]);
    assert_eq!(back.cursor, worst.step);
    let text = text(&back).to_owned();
    assert!(
        text.starts_with("failure 1/4 by error: squared error"),
        "{text}"
    );
}

#[test]
fn gain_needs_a_model_of_vision_alone() {
    let mut session = session();
    let snapshot = run(&mut session, [RankBy(Order::Gain), Failure(1)]);
    assert!(is_refusal(&snapshot) && text(&snapshot).contains("--model"));
    let mut session = session_of(vec![
        Arc::new(FakePredictor::three()),
        Arc::new(FakePredictor::vision()),
    ]);
    run(&mut session, [RankBy(Order::Gain)]);
    let snapshot = run(&mut session, [Failure(1)]);
    assert_eq!(snapshot.table.queue.len(), 4, "{}", text(&snapshot));
    let values: Vec<f32> = snapshot.table.queue.iter().map(|f| f.value).collect();
    assert!(
        values.is_sorted(),
        "the smallest gain is the worst: {values:?}"
    );
}

/// A cache in memory.
#[derive(Default)]
struct Shelf(Mutex<BTreeMap<String, Vec<u8>>>);

impl Cache for Shelf {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        self.0.lock().unwrap().get(key).cloned()
    }

    fn store(&self, key: &str, bytes: &[u8]) {
        self.0
            .lock()
            .unwrap()
            .insert(key.to_owned(), bytes.to_vec());
    }
}

#[test]
fn scores_are_kept_by_model_and_data() {
    let shelf = Arc::new(Shelf::default());
    let scored = |hash: &str| {
        let model = FakePredictor::three().with_hash(hash);
        let calls = model.calls();
        let mut session = session_of(vec![Arc::new(model)]);
        session.keep_scores_in(Arc::clone(&shelf) as Arc<dyn Cache>);
        let snapshot = run(&mut session, [Failure(1)]);
        (snapshot.table.queue.clone(), calls.encoded())
    };
    let (queue, encoded) = scored("a");
    assert!(
        queue.len() == 4 && encoded >= 5,
        "each episode, and what is shown: {encoded}"
    );
    let (again, encoded) = scored("a");
    assert_eq!(*again, *queue);
    assert!(encoded <= 2, "only what is shown: {encoded}");
    let (_, encoded) = scored("b");
    assert!(encoded >= 5);
    let keys: Vec<String> = shelf.0.lock().unwrap().keys().cloned().collect();
    assert_eq!(keys, ["survey-a-squares-1.json", "survey-b-squares-1.json"]);
    shelf
        .0
        .lock()
        .unwrap()
        .values_mut()
        .for_each(|bytes| bytes.truncate(40));
    assert_eq!(*scored("a").0, *queue, "what cannot be read is made again");
}

#[test]
fn the_table_is_sorted_and_filtered() {
    let mut session = session();
    run(&mut session, [Failure(1)]);
    let sorted = run(&mut session, [SortBy(Column::Rmse), SortBy(Column::Rmse)]);
    let error = |i: usize| sorted.table.rows[i].score.as_ref().unwrap().scores.error;
    let shown: Vec<_> = sorted.table.shown.iter().map(|&i| error(i)).collect();
    assert!(shown.windows(2).all(|pair| pair[0] >= pair[1]));
    let filtered = run(&mut session, [Filter("_02".to_owned())]);
    assert_eq!(*filtered.table.shown, [2]);
}

#[test]
fn marks_and_contacts_are_events() {
    let mut session = session();
    let marked = run(
        &mut session,
        [SeekTo(6), ToggleMark, SeekTo(12), ToggleMark],
    );
    let marks = marked.events.iter().filter(|e| e.kind == EventKind::Mark);
    assert_eq!(marks.map(|e| e.step).collect::<Vec<_>>(), [5, 11]);
    assert_eq!(run(&mut session, [First, Event(i64::MAX)]).cursor, 11);
    assert_eq!(run(&mut session, [Event(1)]).cursor, 11);
    assert_eq!(run(&mut session, [Event(-1)]).cursor, 5);
    let other = run(&mut session, [Episode(1)]);
    assert!(other.events.iter().all(|e| e.kind == EventKind::Contact));
    let back = run(&mut session, [Episode(-1), SeekTo(6), ToggleMark]);
    assert_eq!(
        back.events
            .iter()
            .filter(|e| e.kind == EventKind::Mark)
            .count(),
        1
    );
}

#[test]
fn a_selection_is_begun_ended_and_forgotten() {
    let mut session = session();
    let begun = run(&mut session, [SeekTo(9), Select, SeekTo(4)]);
    assert_eq!(begun.selection, Some((3, 8)));
    let ended = run(&mut session, [Select, SeekTo(14), CycleLoop]);
    assert_eq!(
        (ended.selection, ended.looping),
        (Some((3, 8)), Looping::Selection)
    );
    let elsewhere = run(&mut session, [Episode(1)]);
    assert_eq!(
        (elsewhere.selection, elsewhere.looping),
        (None, Looping::All)
    );
    let forgotten = run(&mut session, [Select, SeekTo(9), Select, Select]);
    assert_eq!(forgotten.selection, None);
}

#[test]
fn the_board_measures_the_switches_over_the_split() {
    let mut session = session();
    session.want(Wants {
        board: true,
        ..Wants::default()
    });
    let board = run(&mut session, []).board.unwrap();
    assert_eq!(
        (board.split.as_str(), board.episodes, board.total),
        ("test", 4, 4)
    );
    assert!(board.why_not.is_none());
    assert_eq!(board.by_head.len(), board.by_propagation.len());
    // One belief where the prediction begins, two where the one goes on seeing and the other does not.
    assert_eq!(board.by_head.len(), board.by_filter.len());
    assert_eq!(board.by_head.first(), board.by_filter.first());
    assert_ne!(board.by_head.last(), board.by_filter.last());
    assert_eq!(
        (board.by_head[0].horizon, board.by_head[0].episodes),
        (0, 4)
    );
    assert_eq!(board.alphas.len(), 3);
    assert!(!board.sentences.is_empty());
    let without = run(&mut session, [ToggleExpert(0)]).board.unwrap();
    assert_ne!(without.by_head[0].mean, board.by_head[0].mean);
    assert_eq!(without.experts.len(), 2);
    let same = run(&mut session, [ToggleExpert(0), SeekTo(9)])
        .board
        .unwrap();
    assert_eq!(same.by_head, board.by_head);
}

#[test]
fn known_activity_comes_from_all_episodes() {
    let mut session = session();
    let before = run(&mut session, [SeekTo(5)]).fusion.unwrap();
    assert_eq!(before.active_from, "this episode");
    run(&mut session, [Failure(1)]);
    let after = run(&mut session, []).fusion.unwrap();
    assert_eq!(after.active_from, "4 episodes");
    assert_eq!(after.importance_m.len(), 4);
    assert!(after.importance_m[0] > 10.0 * after.importance_m[3].abs());
}

#[test]
fn a_filter_says_how_many_it_lets_through() {
    let mut session = session();
    let told = run(&mut session, [Filter("_02".to_owned())]);
    let total = told.table.rows.len();
    let words = format!("1 of {total} episodes have \"_02\" in name or split; E lists them");
    assert_eq!(text(&told), words);
    let all = run(&mut session, [Filter(String::new())]);
    assert_eq!(text(&all), format!("all {total} episodes are listed"));
}

#[test]
fn the_oddities_of_a_recording_are_told_one_after_the_other() {
    let mut session = session();
    let flags = run(&mut session, []).episode.unwrap().flags.clone();
    for told in 0..=flags.len() {
        let said = run(&mut session, [Oddity]);
        let expected = match told.checked_rem(flags.len()) {
            Some(at) => format!("recording ({} of {}): {}", at + 1, flags.len(), flags[at]),
            None => "nothing is odd about this recording".to_owned(),
        };
        assert_eq!(text(&said), expected);
    }
}
