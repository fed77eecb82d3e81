//! KL terms at the cursor in nats, mean and spread apart: who was overruled, who is merely vague, who claims what.
//!
//! ```text
//! KL nats       mean spread    █ mean ░ spread
//! belief‖V      1.23   0.43    █████░░
//! belief‖H      0.21   1.80    █░░░░░░░
//! V‖prior       3.10   0.20    █████████████░
//! belief‖prior  2.10   0.90    █████████░░░░       surprise
//! ```
//! The sum alone is never shown: a large mean part says that the expert was overruled, a large spread part that it is
//! vague (D3). `V‖prior` is what the expert alone would claim to know (D4), `belief‖prior` the surprise (D2).

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::empty;
use crate::measure::divergence::KlParts;
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::reading::FusionView;
use crate::tui::face::Face;
use crate::tui::layout::rows;
use crate::tui::paint::{below_title, right, short, text, title, width};
use crate::tui::theme::{dim, strong};
use crate::tui::view::Pane;
use crate::tui::words::{sentence, wrap};

/// Columns after which the numbers end, and at which the bars begin.
const MEAN_END: u16 = 18;
const SPREAD_END: u16 = 25;
const BAR: u16 = 27;
/// What the parts say, where there is room below the terms.
const WORDS_BELOW: [&str; 3] = [
    "A large mean part of belief‖V: the expert was overruled. A large spread part: it is merely vague.",
    "V‖prior: what the expert alone would claim to know beyond the prediction.",
    "belief‖prior, the surprise: how much all sensors changed what was predicted. Its size follows the weights of the \
     training loss.",
];
/// Columns of the words after the bars.
const WORDS: u16 = 9;
const LEGENDS: [&str; 2] = ["█ mean: overruled  ░ spread: vague", "█ mean ░ spread"];

/// One term: what is compared, the expert whose colour it has, its parts, and what they say.
struct Term {
    name: String,
    expert: Expert,
    parts: KlParts,
    word: &'static str,
}

/// Draws a row a term.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Divergence);
    let Some(fusion) = &snapshot.fusion else {
        title(buf, pane, "KL", "", focused);
        empty::draw(buf, below_title(pane), snapshot);
        return;
    };
    let name = if focused { "▸ KL nats" } else { "KL nats" };
    text(buf, pane, 0, 0, name, strong());
    right(buf, pane, MEAN_END, 0, "mean", dim());
    right(buf, pane, SPREAD_END, 0, "spread", dim());
    let fitting = LEGENDS
        .iter()
        .find(|legend| BAR + width(legend) <= pane.width);
    if let Some(legend) = fitting {
        text(buf, pane, BAR, 0, legend, dim());
    }
    let terms = terms(fusion, snapshot);
    let most = terms
        .iter()
        .map(|term| term.parts.mean.max(0.0) + term.parts.spread.max(0.0))
        .filter(|sum| sum.is_finite())
        .fold(1e-6, f32::max);
    let words = if pane.width >= BAR + 12 + WORDS {
        WORDS
    } else {
        0
    };
    let room = pane.width.saturating_sub(BAR + words).min(48);
    for (i, term) in terms.iter().enumerate() {
        let row = 1 + i as u16;
        let ink = face.depth.ink(term.expert.rgb());
        text(buf, pane, 0, row, &term.name, Style::new());
        right(
            buf,
            pane,
            MEAN_END,
            row,
            &short(term.parts.mean),
            Style::new(),
        );
        right(
            buf,
            pane,
            SPREAD_END,
            row,
            &short(term.parts.spread),
            Style::new(),
        );
        let columns = |nats: f32| (nats.max(0.0) / most * f32::from(room)).round() as usize;
        let mean = "█".repeat(columns(term.parts.mean).min(room.into()));
        let at = text(buf, pane, BAR, row, &mean, ink);
        let left = usize::from((BAR + room).saturating_sub(at));
        let spread = "░".repeat(columns(term.parts.spread).min(left));
        text(buf, pane, at, row, &spread, ink);
        if words > 0 {
            text(buf, pane, BAR + room + 1, row, term.word, dim());
        }
    }
    explain(buf, rows(pane, 2 + terms.len() as u16).1);
}

/// Says what the parts mean, if all of it fits.
fn explain(buf: &mut Buffer, pane: Rect) {
    let needed: usize = WORDS_BELOW
        .iter()
        .map(|line| wrap(line, pane.width).len())
        .sum();
    if needed > usize::from(pane.height) {
        return;
    }
    WORDS_BELOW
        .iter()
        .fold(0, |row, line| sentence(buf, pane, row, line, dim()));
}

fn terms(fusion: &FusionView, snapshot: &Snapshot) -> Vec<Term> {
    let experts = || snapshot.experts.iter().zip(&fusion.experts);
    let fused = experts().filter_map(|(view, reading)| {
        // Against the prior it is the surprise, which has a line of its own.
        let parts = reading.fused.filter(|_| view.expert != Expert::Prior)?;
        Some(Term {
            name: format!("belief‖{}", view.expert.letter()),
            expert: view.expert,
            parts,
            word: "",
        })
    });
    let claims = experts().filter_map(|(view, reading)| {
        Some(Term {
            name: format!("{}‖prior", view.expert.letter()),
            expert: view.expert,
            parts: reading.claim?,
            word: "claim",
        })
    });
    let surprise = fusion.surprise.map(|parts| Term {
        name: "belief‖prior".to_owned(),
        expert: Expert::Prior,
        parts,
        word: "surprise",
    });
    fused.chain(claims).chain(surprise).collect()
}
