//! Lines of text and the palette.

use super::*;
use crate::measure::corruption::Damage;
use crate::measure::failure::Order;
use crate::modality::Modality;
use crate::session::snapshot::table::Column;

#[test]
fn a_line_can_be_typed() {
    assert_eq!(press(":12<enter>").0.cursor, 11);
    assert_eq!(press(":12<esc>l").0.cursor, 1);
    assert_eq!(
        press(":alpha<space>haptic<space>0.25<enter>").0.experts[1].alpha,
        0.25
    );
    assert_eq!(press(":episode<space>3<enter>").0.episode_index, 2);
    let paper = press(":preset<space>mit<enter>").0;
    assert_eq!(
        (paper.context, paper.state.contains("horizon=37")),
        (5, true)
    );
    assert_eq!(press(":q<enter>").1, [Action::Face(FaceCommand::Quit)]);
    let (snapshot, others, input) = press(":nonsense<enter>:4");
    assert!(matches!(&others[..], [Action::Explain { error: true, .. }]));
    assert_eq!(input.hint(&snapshot).as_deref(), Some(":4"));
    assert_eq!(press(":x<backspace><backspace>l").0.cursor, 1);
}

/// The keys that type a line.
fn typed(line: &str) -> String {
    line.replace(' ', "<space>")
}

fn command(line: &str, snapshot: &Snapshot) -> Command {
    let found = commands(&format!(":{}<enter>", typed(line)), snapshot);
    assert_eq!(found.len(), 1, "{line}: {found:?}");
    found.into_iter().next().unwrap()
}

fn palette(script: &str, snapshot: &Snapshot) -> PaletteView {
    let mut input = Input::default();
    asked(&mut input, script, snapshot);
    input.palette(snapshot).unwrap()
}

fn chosen(script: &str, snapshot: &Snapshot) -> String {
    let view = palette(script, snapshot);
    view.chosen
        .map_or(String::new(), |at| view.entries[at].name.clone())
}

#[test]
fn every_word_of_the_bench_reads() {
    let mut at = snapshot("llll");
    at.sampling.seed = 9;
    let Command::Corrupt {
        modality,
        corruption: Some(corruption),
    } = command("corrupt vision occlude 0.3", &at)
    else {
        panic!()
    };
    assert_eq!(
        (modality, corruption.damage, corruption.severity),
        (Modality::Vision, Damage::Occlude, 0.3)
    );
    assert_eq!(
        (corruption.from, corruption.until, corruption.seed),
        (0, None, 9)
    );
    let mended = Command::Corrupt {
        modality: Modality::Haptic,
        corruption: None,
    };
    assert_eq!(command("corrupt haptic none", &at), mended);
    let Command::EditControls(Some(edit)) = command("controls turn -30", &at) else {
        panic!()
    };
    assert_eq!((edit.from, edit.rotate_deg), (4, -30.0));
    assert_eq!(
        command("controls recorded", &at),
        Command::EditControls(None)
    );
    assert_eq!(
        command("set dv", &at),
        Command::UseSet(vec![true, false, false, true])
    );
    assert_eq!(command("samples 64", &at), Command::SetSamples(64));
    assert_eq!(command("seed 5", &at), Command::SetSeed(5));
    assert_eq!(
        command("rank conflict", &at),
        Command::RankBy(Order::Conflict)
    );
    assert_eq!(command("sort nees", &at), Command::SortBy(Column::Nees));
    assert_eq!(
        command("filter test set", &at),
        Command::Filter("test set".to_owned())
    );
    assert_eq!(command("model v-h-p", &at), Command::SelectModel(0));
    assert_eq!(command("compare 2", &at), Command::CompareWith(1));
    assert_eq!(command("step 3", &at), Command::SeekTo(3));
    assert_eq!(command("redo", &at), Command::Redo);
    assert_eq!(
        commands("/push<enter>/<enter>", &at),
        [
            Command::Filter("push".to_owned()),
            Command::Filter(String::new())
        ]
    );
    let mut input = Input::default();
    let view = asked(&mut input, ":view<space>fuse<enter>:help<enter>", &at);
    assert_eq!(view[0], Action::Face(FaceCommand::View("fuse")));
    assert!(matches!(view[1], Action::Explain { error: false, .. }));
}

#[test]
fn a_line_that_makes_no_sense_says_what_its_word_wants() {
    let at = snapshot("");
    for (line, says) in [
        ("samples 1", "samples N"),
        ("corrupt haptic occlude", "MODALITY KIND"),
        ("alpha vision x", "alpha EXPERT"),
        ("alpha smell 1", "alpha EXPERT"),
        ("controls turn nan", "turn DEGREES"),
        ("zzz", "one of step, view"),
    ] {
        let found = asked(
            &mut Input::default(),
            &format!(":{}<enter>", typed(line)),
            &at,
        );
        let [Action::Explain { error: true, text }] = &found[..] else {
            panic!("{line}: {found:?}");
        };
        assert!(text.contains(says), "{line}: {text}");
    }
}

#[test]
fn what_fits_best_is_chosen_and_enter_does_it() {
    let at = snapshot("");
    assert_eq!(chosen(":fuse", &at), "view fuse");
    assert_eq!(chosen(":corvisnoi", &at), "corrupt vision noise");
    assert_eq!(chosen(":swhap", &at), "switch haptic off or on");
    assert_eq!(commands(":swhap<enter>", &at), [Command::ToggleExpert(1)]);
    assert_eq!(commands(":twicespeed<enter>", &at), [Command::Speed(1)]);
    let mut input = Input::default();
    assert_eq!(
        asked(&mut input, ":vfuse<enter>", &at),
        [Action::Face(FaceCommand::View("fuse"))]
    );
    // A mode is begun by its name as by its key.
    asked(&mut input, ":otherctrls<enter>", &at);
    assert_eq!(input.mode(), Some(Mode::Controls));
}

#[test]
fn a_line_that_makes_sense_wins_until_another_is_picked() {
    let at = snapshot("");
    assert_eq!(chosen(":3", &at), "");
    assert_eq!(chosen(":", &at), "");
    assert_eq!(commands(":3<enter>", &at), [Command::SeekTo(3)]);
    assert_eq!(chosen(":<down>", &at), "play, pause");
    assert_eq!(commands(":<down><down><enter>", &at), [Command::Step(-1)]);
    assert_eq!(chosen(":undo", &at), "");
    let last = palette(":<up>", &at);
    assert_eq!(last.chosen, Some(last.entries.len() - 1));
    assert_eq!(chosen(":<up><down>", &at), "play, pause");
    assert_eq!(
        chosen(":vi<down>e", &at),
        chosen(":vie", &at),
        "typing chooses anew"
    );
}

#[test]
fn what_needs_more_is_begun_and_tab_completes() {
    let at = snapshot("");
    let mut input = Input::default();
    assert!(asked(&mut input, ":conte<enter>", &at).is_empty());
    assert_eq!(input.hint(&at).as_deref(), Some(":context "));
    assert_eq!(
        asked(&mut input, "9<enter>", &at),
        [Action::Session(Command::SetContext(9))]
    );
    assert_eq!(palette(":rankn<tab>", &at).line, "rank nees");
    assert_eq!(palette(":alpha<space>ha<tab>", &at).line, "alpha haptic ");
    let words = palette(":alpha<space>haptic<space>0.", &at);
    assert_eq!(words.entries[0].name, "alpha haptic α");
}

#[test]
fn the_palette_lists_every_key_once_and_names_are_unique() {
    let at = snapshot("");
    let view = palette(":", &at);
    let mut names: Vec<&str> = view
        .entries
        .iter()
        .map(|entry| entry.name.as_str())
        .collect();
    for binding in crate::session::keymap::bindings() {
        let is_listed = names.contains(&binding.help)
            || matches!(
                binding.meaning,
                Meaning::Line(_) | Meaning::ExpertDigit | Meaning::Face(FaceCommand::Back)
            );
        assert!(is_listed, "{}", binding.help);
    }
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}
