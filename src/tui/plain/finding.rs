//! What stands out: contacts and marks, the selection, how the episode was scored, the queue of failures.

use super::{Report, of};
use crate::measure::failure::Order;
use crate::session::snapshot::table::{EpisodeScore, TableView};
use crate::session::snapshot::{EventKind, Snapshot};

/// Tells it; scores and failures once they have been asked for.
pub(super) fn tell(report: &mut Report, snapshot: &Snapshot) {
    let steps = |kind: EventKind| {
        let events = snapshot.events.iter();
        events
            .filter(move |event| event.kind == kind)
            .map(|event| event.step + 1)
    };
    report.list("contact begins, steps", steps(EventKind::Contact));
    report.list("marked, steps", steps(EventKind::Mark));
    match snapshot.selection {
        Some((a, b)) => {
            let (first, last) = (a.min(b) + 1, a.max(b) + 1);
            report.fact("selection", format!("steps {first} to {last}"));
        }
        None => report.fact("selection", "none"),
    }
    let table = &*snapshot.table;
    if table.asked || table.scored > 0 {
        report.fact("episodes scored", of(table.scored, table.rows.len()));
        report.fact("episodes shown", of(table.shown.len(), table.rows.len()));
        if !table.filter.is_empty() {
            report.fact("episodes filter", &table.filter);
        }
        let row = table.rows.get(snapshot.episode_index);
        if let Some(score) = row.and_then(|row| row.score.as_deref()) {
            scores(report, score);
        }
        failures(report, table);
    }
}

fn scores(report: &mut Report, score: &EpisodeScore) {
    if let Some(fault) = &score.fault {
        report.fact("episode score", format!("none, {fault}"));
        return;
    }
    for order in Order::ALL {
        let value = score.scores.value(order).filter(|it| it.is_finite());
        let told = value.map_or_else(|| "none".to_owned(), |value| order.spelt(value));
        report.fact(&format!("episode by {}", order.name()), told);
    }
}

/// The queue, and the failure that was last gone to.
fn failures(report: &mut Report, table: &TableView) {
    let (count, order) = (table.queue.len(), table.order);
    let place = table.place.map_or_else(
        || format!("{count} in the queue"),
        |place| of(place + 1, count),
    );
    report.fact(&format!("failures by {}", order.name()), place);
    if let Some(failure) = table.place.and_then(|place| table.queue.get(place)) {
        report.fact("failure", order.spelt(failure.value));
        let row = table.rows.get(failure.episode);
        report.fact("failure episode", row.map_or("none", |row| row.id.as_str()));
        report.fact("failure step", failure.step + 1);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tui::{fixture, plain};

    #[test]
    fn steps_count_from_one_and_a_failure_is_said_with_its_episode() {
        let mut snapshot = fixture::snapshot(8, 16);
        snapshot.selection = Some((6, 2));
        let text = plain(&snapshot);
        for line in [
            "contact begins, steps: 5",
            "marked, steps: 8",
            "selection: steps 3 to 7",
            "episodes scored: 20 of 24",
            "episode by gain: none",
            "failures by error: 3 of 20",
            "failure: squared error 7.6",
            "failure episode: push-00014",
            "failure step: 9",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
    }

    #[test]
    fn what_was_not_asked_for_is_left_out_and_what_could_not_be_scored_says_why() {
        let mut snapshot = fixture::snapshot(8, 16);
        snapshot.events = Arc::default();
        let mut table = (*snapshot.table).clone();
        (table.asked, table.scored) = (false, 0);
        snapshot.table = Arc::new(table.clone());
        let text = plain(&snapshot);
        assert!(text.ends_with("\nmarked, steps: none\nselection: none\n"));
        let mut rows = (*table.rows).clone();
        rows[snapshot.episode_index].score = Some(Arc::new(EpisodeScore {
            fault: Some("no frames".to_owned()),
            ..EpisodeScore::default()
        }));
        (table.asked, table.place, table.rows) = (true, None, Arc::new(rows));
        snapshot.table = Arc::new(table);
        let text = plain(&snapshot);
        for line in [
            "episode score: none, no frames",
            "failures by error: 20 in the queue",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
    }
}
