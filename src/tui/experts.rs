//! One line an expert: its digit, letter and name, its switch, its Gaussian in two numbers, its share of precision;
//! where there is room, what is read of it.
//!
//! ```text
//! experts     α       |μ|    σ share   mean  pos NIS head   prop  nats w/o σ    cm
//! 1 V vision  ● on   2.10 0.31 █████    52%  61%    14.1    11.0  1.31  2.10  0.41
//! 2 H haptic  ○ off  1.82 0.95           0%   0%       –       –     –     –     –
//! 3 P proprio ● on  ~noise 0.5 ▒▒       24%  14%    31.9▲   20.2  0.71  0.62  0.12
//! 9 D prior   ◐ 0.50 1.91 0.60 ░░       24%  25%                  1.02  1.13  0.24
//! ```
//! `mean` is the mean share over the latent dimensions, `pos` weighs them by what moves the position (D1). An expert
//! that is removed (`○ off`) and one whose input is damaged (`~`) are different things: the damaged one is still heard.

mod readings;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::face::Face;
use super::layout::columns;
use super::paint::{bar, right, short, text};
use super::theme::{WARNING, dim, strong};
use super::view::Pane;
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::{Expert, Modality};
use crate::session::snapshot::{Badge, ExpertView, Snapshot};

/// Columns of the table without the readings, at least.
const BASE: u16 = 44;
/// Columns after which each column of the table ends, from the left.
const MARK: u16 = 12;
const MEAN_END: u16 = 23;
const SIGMA_END: u16 = 28;
const BAR: u16 = 29;
/// Columns from the right edge at which the mean share ends.
const SHARE_END: u16 = 5;

/// Draws the table.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let readings = match pane.width {
        _ if snapshot.badge == Badge::NoProduct => 0,
        width => readings::columns_of(width.saturating_sub(BASE + 1)),
    };
    let (table, right_part) = if readings > 0 {
        columns(pane, pane.width - readings - 1, 1)
    } else {
        (pane, Rect::default())
    };
    let focused = face.is_focused(Pane::Experts);
    header(buf, table, focused);
    for (i, view) in snapshot.experts.iter().enumerate() {
        let row = 1 + i as u16;
        let chosen = i == face.expert && (focused || face.is_zoomed(Pane::Experts));
        line(buf, table, row, (i, view), snapshot, face, chosen);
    }
    if readings > 0 {
        readings::draw(buf, right_part, snapshot, face);
        let below = 1 + snapshot.experts.len() as u16;
        let notes = super::layout::rows(pane, below).1;
        readings::notes(buf, notes, snapshot);
    }
}

/// The expert whose line is at this row of the pane.
pub fn expert_at(row: u16, experts: usize) -> Option<usize> {
    let expert = usize::from(row.checked_sub(1)?);
    (expert < experts).then_some(expert)
}

fn header(buf: &mut Buffer, pane: Rect, focused: bool) {
    let title = if focused { "▸ experts" } else { "experts" };
    text(buf, pane, 0, 0, title, strong());
    text(buf, pane, MARK, 0, "α", dim());
    right(buf, pane, MEAN_END, 0, "|μ|", dim());
    right(buf, pane, SIGMA_END, 0, "σ", dim());
    if pane.width >= BASE {
        text(buf, pane, BAR, 0, "share", dim());
    }
    let share_end = pane.width.saturating_sub(SHARE_END);
    right(buf, pane, share_end, 0, "mean", dim());
    right(buf, pane, pane.width, 0, "pos", dim());
}

fn line(
    buf: &mut Buffer,
    pane: Rect,
    row: u16,
    (i, view): (usize, &ExpertView),
    snapshot: &Snapshot,
    face: &Face,
    chosen: bool,
) {
    let expert = view.expert;
    let on = view.alpha > 0.0;
    let ink = if on {
        face.depth.ink(expert.rgb())
    } else {
        dim()
    };
    let plain = if on { Style::new() } else { dim() };
    let digit = if expert == Expert::Prior {
        "9".to_owned()
    } else {
        (i + 1).to_string()
    };
    text(buf, pane, 0, row, &digit, dim());
    let letter = expert.letter().to_string();
    text(buf, pane, 2, row, &letter, strong().patch(ink));
    let name = if chosen { strong().underlined() } else { plain };
    text(buf, pane, 4, row, expert.name(), name);
    let emphasis = if on { Style::new() } else { strong() };
    text(buf, pane, MARK, row, &switch(view.alpha), emphasis);

    if let Some(damage) = damage(expert, snapshot) {
        let warning = strong().patch(face.depth.ink(WARNING));
        right(buf, pane, SIGMA_END, row, &damage, warning);
    } else {
        let numbers = view.latent.as_ref().map_or([f32::NAN; 2], |latent| {
            [norm(&latent.mean), latent.mean_sigma()]
        });
        right(buf, pane, MEAN_END, row, &short(numbers[0]), plain);
        right(buf, pane, SIGMA_END, row, &short(numbers[1]), plain);
    }

    let share_end = pane.width.saturating_sub(SHARE_END);
    let room = share_end.saturating_sub(BAR + 5);
    let filled = bar(expert.fill(), view.share_mean, room);
    text(buf, pane, BAR, row, &filled, ink);
    if view.latent.is_some() {
        right(buf, pane, share_end, row, &percent(view.share_mean), plain);
        let position = view.share_position.map_or_else(|| "–".to_owned(), percent);
        right(buf, pane, pane.width, row, &position, plain);
    }
}

fn switch(alpha: f32) -> String {
    if alpha <= 0.0 {
        "○ off".to_owned()
    } else if (alpha - 1.0).abs() < 1e-6 {
        "● on".to_owned()
    } else {
        format!("◐ {alpha:.2}")
    }
}

/// What is wrong with an expert's input: `~noise 0.5`, with the modality's letter where it looks at several.
fn damage(expert: Expert, snapshot: &Snapshot) -> Option<String> {
    let (modality, corruption) = snapshot.damage_of(expert)?;
    let letter = match modality {
        _ if expert.modalities().len() == 1 => "",
        Modality::Vision => "V",
        Modality::Haptic => "H",
        Modality::Proprio => "P",
    };
    Some(format!("{letter}{}", damage_badge(&corruption)))
}

/// A corruption in a few columns: `~noise 0.5`.
pub fn damage_badge(corruption: &Corruption) -> String {
    let name = match corruption.damage {
        Damage::Occlude => "patch",
        damage => damage.name(),
    };
    format!("~{name} {:.1}", corruption.severity)
}

fn percent(share: f32) -> String {
    if share.is_finite() {
        format!("{:.0}%", share * 100.0)
    } else {
        "–".to_owned()
    }
}

fn norm(mean: &[f32]) -> f32 {
    mean.iter().map(|mean| mean * mean).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::fixture;

    #[test]
    fn a_switch_is_read_from_its_mark_and_its_word() {
        assert_eq!([0.0, 1.0, 0.5].map(switch), ["○ off", "● on", "◐ 0.50"]);
    }

    #[test]
    fn clicks_find_their_line() {
        assert_eq!(expert_at(0, 4), None);
        assert_eq!(expert_at(4, 4), Some(3));
        assert_eq!(expert_at(5, 4), None);
    }

    #[test]
    fn damage_is_named_at_its_steps_only() {
        let noise = Corruption {
            damage: Damage::Noise,
            severity: 0.5,
            from: 3,
            until: Some(6),
            patch: [0.5; 2],
            seed: 0,
        };
        let mut snapshot = fixture::snapshot(0, 16);
        snapshot.corruptions = vec![(Modality::Haptic, noise)];
        let mut at = |expert, step| {
            snapshot.cursor = step;
            damage(expert, &snapshot)
        };
        assert_eq!(at(Expert::Haptic, 3).as_deref(), Some("~noise 0.5"));
        assert_eq!(at(Expert::Joint, 5).as_deref(), Some("H~noise 0.5"));
        assert_eq!(at(Expert::Haptic, 6), None);
        assert_eq!(at(Expert::Vision, 4), None);
    }
}
