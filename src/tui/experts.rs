//! One line an expert: its digit, letter and name, its switch, its Gaussian in two numbers, its share of precision.
//!
//! ```text
//! experts     α       |μ|    σ share       mean  pos
//! 1 V vision  ● on   2.10 0.31 ██████       52%  61%
//! 2 H haptic  ○ off  1.82 0.95               0%   0%
//! 9 D prior   ◐ 0.50 1.91 0.60 ░░           21%  18%
//! ```
//! `mean` is the mean share over the latent dimensions, `pos` weighs them by what moves the position (D1).

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::face::Face;
use super::layout::LEFT;
use super::paint::{bar, right, text};
use super::theme::{dim, strong};
use super::view::Pane;
use crate::modality::Expert;
use crate::session::snapshot::{ExpertView, LatentView, Snapshot};

/// Columns after which each column of the table ends, from the left.
const MARK: u16 = 12;
const MEAN_END: u16 = 23;
const SIGMA_END: u16 = 28;
const BAR: u16 = 29;
/// Columns from the right edge at which the mean share ends.
const SHARE_END: u16 = 5;

/// Draws the table.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Experts);
    let title = if focused { "▸ experts" } else { "experts" };
    text(buf, pane, 0, 0, title, strong());
    text(buf, pane, MARK, 0, "α", dim());
    right(buf, pane, MEAN_END, 0, "|μ|", dim());
    right(buf, pane, SIGMA_END, 0, "σ", dim());
    if pane.width >= LEFT {
        text(buf, pane, BAR, 0, "share", dim());
    }
    right(
        buf,
        pane,
        pane.width.saturating_sub(SHARE_END),
        0,
        "mean",
        dim(),
    );
    right(buf, pane, pane.width, 0, "pos", dim());
    for (i, view) in snapshot.experts.iter().enumerate() {
        let row = 1 + i as u16;
        line(buf, pane, row, (i, view), face, focused && i == face.expert);
    }
}

/// The expert whose line is at this row of the pane.
pub fn expert_at(row: u16, experts: usize) -> Option<usize> {
    let expert = usize::from(row.checked_sub(1)?);
    (expert < experts).then_some(expert)
}

fn line(
    buf: &mut Buffer,
    pane: Rect,
    row: u16,
    (i, view): (usize, &ExpertView),
    face: &Face,
    focused: bool,
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
    text(
        buf,
        pane,
        2,
        row,
        &expert.letter().to_string(),
        strong().patch(ink),
    );
    let name = if focused {
        strong().underlined()
    } else {
        plain
    };
    text(buf, pane, 4, row, expert.name(), name);
    text(
        buf,
        pane,
        MARK,
        row,
        &switch(view.alpha),
        if on { Style::new() } else { strong() },
    );

    let (mean, sigma) = view.latent.as_ref().map_or_else(
        || ("–".to_owned(), "–".to_owned()),
        |latent| {
            (
                significant(norm(&latent.mean)),
                significant(mean_sigma(latent)),
            )
        },
    );
    right(buf, pane, MEAN_END, row, &mean, plain);
    right(buf, pane, SIGMA_END, row, &sigma, plain);

    let share_end = pane.width.saturating_sub(SHARE_END);
    let room = share_end.saturating_sub(BAR + 5);
    text(
        buf,
        pane,
        BAR,
        row,
        &bar(expert.fill(), view.share_mean, room),
        ink,
    );
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

fn percent(share: f32) -> String {
    if share.is_finite() {
        format!("{:.0}%", share * 100.0)
    } else {
        "–".to_owned()
    }
}

/// Four columns at most, whatever the size.
fn significant(value: f32) -> String {
    match value {
        value if value < 10.0 => format!("{value:.2}"),
        value if value < 100.0 => format!("{value:.1}"),
        value if value < 9999.5 => format!("{value:.0}"),
        value => format!("{value:.0e}"),
    }
}

fn norm(mean: &[f32]) -> f32 {
    mean.iter().map(|mean| mean * mean).sum::<f32>().sqrt()
}

fn mean_sigma(latent: &LatentView) -> f32 {
    latent.sigma.iter().sum::<f32>() / latent.sigma.len().max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_switch_is_read_from_its_mark_and_its_word() {
        assert_eq!([0.0, 1.0, 0.5].map(switch), ["○ off", "● on", "◐ 0.50"]);
    }

    #[test]
    fn numbers_keep_to_their_column() {
        for value in [0.0, 0.123, 9.99, 45.6, 1234.0, 1e8] {
            assert!(significant(value).len() <= 4, "{value}");
        }
    }

    #[test]
    fn clicks_find_their_line() {
        assert_eq!(expert_at(0, 4), None);
        assert_eq!(expert_at(4, 4), Some(3));
        assert_eq!(expert_at(5, 4), None);
    }
}
