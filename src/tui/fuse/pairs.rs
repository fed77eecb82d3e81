//! Who disagrees with whom (D9), and how much agreement the product forces (D10).
//!
//! ```text
//! pairs d²     H      P      D  6.9–28.8
//! V         12.9   14.7   20.0
//! H                 8.3   31.2▲
//! P                       10.5
//! Q 61.0  95 %: 26.0–61.8, 42 dof
//! within 95 % of agreeing experts σ 0.25
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::{empty, mark, range};
use crate::measure::innovation::{Conflict, Disagreement};
use crate::session::snapshot::{Badge, LatentView, Snapshot};
use crate::tui::face::Face;
use crate::tui::layout::rows;
use crate::tui::paint::{below_title, put, right, short, text, title, width};
use crate::tui::theme::{Depth, WARNING, dim, strong};
use crate::tui::view::Pane;
use crate::tui::words::sentence;

/// Columns of one distance with its mark.
const CELL: u16 = 7;
/// Column at which the first distance begins.
const FIRST: u16 = 7;

/// Draws the matrix and the conflict below it.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Pairs);
    let fusion = match &snapshot.fusion {
        Some(fusion) if snapshot.badge != Badge::NoProduct => fusion,
        _ => {
            title(buf, pane, name(snapshot), "", focused);
            empty::draw(buf, below_title(pane), snapshot);
            return;
        }
    };
    let name = if focused {
        "▸ pairs d²"
    } else {
        "pairs d²"
    };
    text(buf, pane, 0, 0, name, strong());
    let experts = snapshot.experts.len();
    for (i, view) in snapshot.experts.iter().enumerate() {
        let ink = strong().patch(face.depth.ink(view.expert.rgb()));
        let letter = view.expert.letter();
        if i > 0 {
            put(buf, pane, end(i) - 1, 0, letter, ink);
        }
        if i + 1 < experts {
            put(buf, pane, 0, 1 + i as u16, letter, ink);
        }
        if i + 1 < experts && view.alpha <= 0.0 {
            text(buf, pane, 2, 1 + i as u16, "off", dim());
        }
    }
    if let Some(bounds) = fusion.disagreements.iter().find_map(|pair| pair.bounds) {
        let stated = [
            format!("▲▼ outside 95 %: {}", range(bounds)),
            format!("95 %: {}", range(bounds)),
            range(bounds),
        ];
        let room = pane.width.saturating_sub(end(experts.max(1) - 1) + 1);
        if let Some(stated) = stated.iter().find(|stated| width(stated) <= room) {
            right(buf, pane, pane.width, 0, stated, dim());
        }
    }
    for pair in &fusion.disagreements {
        distance(buf, pane, *pair, face.depth);
    }
    let below = rows(pane, experts.max(1) as u16).1;
    let below = rows(below, u16::from(below.height > 6)).1;
    match fusion.conflict {
        Some(reading) => conflict(buf, below, reading, snapshot, face),
        None => {
            text(
                buf,
                below,
                0,
                0,
                "no conflict: only one expert is on",
                dim(),
            );
        }
    }
}

fn name(snapshot: &Snapshot) -> &'static str {
    match snapshot.badge {
        Badge::NoProduct => "no product",
        _ => "pairs",
    }
}

/// The column after an expert's distances, of its place in the list; the first has none.
fn end(expert: usize) -> u16 {
    FIRST + expert as u16 * CELL - 1
}

fn distance(buf: &mut Buffer, pane: Rect, pair: Disagreement, depth: Depth) {
    let (a, b) = (pair.a.min(pair.b), pair.a.max(pair.b));
    if a == b {
        return;
    }
    let (row, at) = (1 + a as u16, end(b));
    let sign = mark(pair.distance, pair.bounds);
    let style = if sign == ' ' { Style::new() } else { strong() };
    right(buf, pane, at, row, &short(pair.distance), style);
    if sign != ' ' {
        put(buf, pane, at, row, sign, style.patch(depth.ink(WARNING)));
    }
}

fn conflict(buf: &mut Buffer, pane: Rect, reading: Conflict, snapshot: &Snapshot, face: &Face) {
    let sign = mark(reading.energy, reading.bounds);
    let style = match sign {
        ' ' => strong(),
        _ => strong().patch(face.depth.ink(WARNING)),
    };
    let at = text(buf, pane, 0, 0, "Q ", strong());
    let at = text(
        buf,
        pane,
        at,
        0,
        &format!("{}{sign}", short(reading.energy)),
        style,
    );
    let bounds = match reading.bounds {
        Some(bounds) => format!("95 %: {}, {} dof", range(bounds), reading.dof),
        None => format!("{} dof", reading.dof),
    };
    text(buf, pane, at + 1, 0, &bounds, dim());
    let roomy = pane.height > 3;
    let row = sentence(buf, pane, 1, words(reading, roomy), Style::new());
    // The belief is sharpest just when it is wrong, so its σ stands beside Q.
    let belief = snapshot.belief.as_ref();
    let sigma = belief.map_or(f32::NAN, LatentView::mean_sigma);
    if roomy {
        let more = format!("σ of the belief {}", short(sigma));
        text(buf, pane, 0, row, &more, dim());
    } else {
        right(
            buf,
            pane,
            pane.width,
            1,
            &format!("σ {}", short(sigma)),
            dim(),
        );
    }
    if pane.height > row + 1 {
        let normaliser = format!(
            "ln C {}  the product's normaliser",
            short(reading.log_normaliser)
        );
        text(buf, pane, 0, row + 1, &normaliser, dim());
    }
}

/// What the conflict says, in plain words.
fn words(reading: Conflict, roomy: bool) -> &'static str {
    if reading.bounds.is_none() {
        return "no bounds: an α is neither 0 nor 1";
    }
    match (mark(reading.energy, reading.bounds), roomy) {
        ('▲', true) => "above what 95 % of agreeing experts show: the product forces agreement",
        ('▼', true) => "below what 95 % of agreeing experts show: they are too timid",
        (_, true) => "within what 95 % of agreeing experts show",
        ('▲', false) => "above 95 % of agreeing experts",
        ('▼', false) => "below 95 % of agreeing experts",
        (_, false) => "within 95 % of agreeing experts",
    }
}
