//! Every key, line by line.

use super::Meaning::{ExpertDigit, Face, Line, Mode as Begin, Model, Prior, Session};
use super::{Binding, FaceCommand, Meaning, Mode};
use crate::session::command::Command;

/// The views a face has, in the order of `v`; what `:view NAME` takes.
pub const VIEWS: [&str; 6] = [
    "overview",
    "fuse",
    "predict",
    "position",
    "consistency",
    "lattice",
];

const TIME: &str = "Time";
const FUSION: &str = "Fusion";
const PREDICTION: &str = "Prediction";
const FINDING: &str = "Compare and find";
const LISTS: &str = "Episodes and models";
const SCREEN: &str = "Screen";

const fn bind(
    keys: &'static [&'static str],
    meaning: Meaning,
    group: &'static str,
    help: &'static str,
) -> Binding {
    Binding {
        keys,
        meaning,
        group,
        help,
    }
}

/// The table, in the order of help.
pub(super) static BINDINGS: &[Binding] = &[
    bind(
        &["<space>"],
        Session(Command::TogglePlay),
        TIME,
        "play, pause",
    ),
    bind(
        &["<left>", ",", "h"],
        Session(Command::Step(-1)),
        TIME,
        "one step back",
    ),
    bind(
        &["<right>", ".", "l"],
        Session(Command::Step(1)),
        TIME,
        "one step on",
    ),
    bind(
        &["<s-left>", "<"],
        Session(Command::Step(-10)),
        TIME,
        "ten steps back",
    ),
    bind(
        &["<s-right>", ">"],
        Session(Command::Step(10)),
        TIME,
        "ten steps on",
    ),
    bind(
        &["<home>", "g"],
        Session(Command::First),
        TIME,
        "first step",
    ),
    bind(&["<end>", "G"], Session(Command::Last), TIME, "last step"),
    bind(&["-"], Session(Command::Speed(-1)), TIME, "half the speed"),
    bind(&["="], Session(Command::Speed(1)), TIME, "twice the speed"),
    bind(
        &["V"],
        Session(Command::Select),
        TIME,
        "begin a selection of steps, end it, forget it",
    ),
    bind(
        &["L"],
        Session(Command::CycleLoop),
        TIME,
        "loop: off, all, the selection",
    ),
    bind(
        &["1", "2", "3", "4", "5", "6", "7", "8"],
        ExpertDigit,
        FUSION,
        "switch a sensor expert off or on",
    ),
    bind(&["9"], Prior, FUSION, "switch the prior off or on"),
    bind(
        &["S"],
        Begin(Mode::Solo),
        FUSION,
        "then a digit: only this sensor",
    ),
    bind(
        &["0"],
        Session(Command::AllOn),
        FUSION,
        "every expert as trained",
    ),
    bind(
        &["s"],
        Session(Command::CycleScope),
        FUSION,
        "switches reach: episode, from here on, this step",
    ),
    bind(
        &["a"],
        Begin(Mode::Temper),
        FUSION,
        "then a digit, - and =: α of an expert",
    ),
    bind(
        &["x"],
        Begin(Mode::Corrupt),
        FUSION,
        "then x, - and =, arrows: damage an input",
    ),
    bind(&["u"], Session(Command::Undo), FUSION, "undo"),
    bind(&["<c-r>"], Session(Command::Redo), FUSION, "redo"),
    bind(
        &["p"],
        Session(Command::PredictHere),
        PREDICTION,
        "predict from this step",
    ),
    bind(
        &["c"],
        Begin(Mode::Context),
        PREDICTION,
        "then - and =: images seen before",
    ),
    bind(
        &["C"],
        Begin(Mode::Horizon),
        PREDICTION,
        "then - and =: images predicted",
    ),
    bind(
        &["r"],
        Begin(Mode::Controls),
        PREDICTION,
        "then - and =, ↑ ↓, m . r: other controls",
    ),
    bind(
        &["m"],
        Session(Command::ToggleSamples),
        PREDICTION,
        "the mean path, or a sample",
    ),
    bind(
        &["M"],
        Begin(Mode::Samples),
        PREDICTION,
        "then - and =: number of samples",
    ),
    bind(
        &["d"],
        Face(FaceCommand::Difference),
        FINDING,
        "difference: two models, or to the truth",
    ),
    bind(
        &["b"],
        Face(FaceCommand::Blink),
        FINDING,
        "blink between the two",
    ),
    bind(
        &["w"],
        Face(FaceCommand::Wipe),
        FINDING,
        "wipe between the two",
    ),
    bind(
        &["{"],
        Session(Command::Event(-1)),
        FINDING,
        "previous event: a contact or a mark",
    ),
    bind(&["}"], Session(Command::Event(1)), FINDING, "next event"),
    bind(
        &["*"],
        Session(Command::ToggleMark),
        FINDING,
        "mark this step, or take its mark away",
    ),
    bind(
        &["n"],
        Session(Command::Failure(1)),
        FINDING,
        "next failure, the worst first",
    ),
    bind(
        &["N"],
        Session(Command::Failure(-1)),
        FINDING,
        "previous failure",
    ),
    bind(
        &["o"],
        Session(Command::CycleFailureOrder),
        FINDING,
        "what makes a failure: error, distance, NEES …",
    ),
    bind(
        &["/"],
        Line("filter "),
        FINDING,
        "list only episodes whose name or split has this",
    ),
    bind(
        &["["],
        Session(Command::Episode(-1)),
        LISTS,
        "previous episode",
    ),
    bind(&["]"], Session(Command::Episode(1)), LISTS, "next episode"),
    bind(&["("], Model(-1), LISTS, "previous model"),
    bind(&[")"], Model(1), LISTS, "next model"),
    bind(
        &["E"],
        Face(FaceCommand::Episodes),
        LISTS,
        "list of episodes",
    ),
    bind(&["v"], Face(FaceCommand::NextView), SCREEN, "next view"),
    bind(
        &["<tab>"],
        Face(FaceCommand::FocusNext),
        SCREEN,
        "next pane",
    ),
    bind(
        &["<s-tab>"],
        Face(FaceCommand::FocusPrevious),
        SCREEN,
        "previous pane",
    ),
    bind(
        &["<enter>"],
        Face(FaceCommand::Zoom),
        SCREEN,
        "this pane alone, or all",
    ),
    bind(
        &["<esc>"],
        Face(FaceCommand::Back),
        SCREEN,
        "back, or the end of a mode",
    ),
    bind(
        &[":", "<c-k>", "<c-p>"],
        Line(""),
        SCREEN,
        "every command by name, or a step: `:42`",
    ),
    bind(
        &["y"],
        Face(FaceCommand::CopyState),
        SCREEN,
        "copy the state string",
    ),
    bind(
        &["e"],
        Face(FaceCommand::Export),
        SCREEN,
        "export what is shown, as a file to take along",
    ),
    bind(&["?", "<f1>"], Face(FaceCommand::Help), SCREEN, "keys"),
    bind(&["q", "<c-c>"], Face(FaceCommand::Quit), SCREEN, "quit"),
];
