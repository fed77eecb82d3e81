//! Shares of a whole as one column of stacked fills, the first expert at the bottom.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::face::Face;
use super::paint::{eighth, put, text};
use super::theme::{Depth, dim, strong};
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;

/// Draws one column. Shares of 1 in all fill the pane's height; NaN and none draw nothing.
///
/// With enough colours the borders between experts are exact to an eighth of a cell, as long as no three meet in one;
/// without, each cell shows the fill of the expert that holds most of it.
pub fn stack(buf: &mut Buffer, pane: Rect, at: u16, shares: &[(Expert, f32)], depth: Depth) {
    let owner = |level: f32| {
        let mut top = 0.0;
        for &(expert, share) in shares {
            top += share;
            if level < top {
                return Some(expert);
            }
        }
        None
    };
    let height = f32::from(pane.height);
    for row in 0..pane.height {
        let floor = f32::from(pane.height - 1 - row);
        let eighths: [Option<Expert>; 8] =
            std::array::from_fn(|i| owner((floor + (i as f32 + 0.5) / 8.0) / height));
        let (lower, upper) = two_largest(eighths);
        if !depth.has_shades() {
            let count = |of: Option<Expert>| eighths.iter().filter(|&&owner| owner == of).count();
            let most = if count(upper) > count(lower) {
                upper
            } else {
                lower
            };
            if let Some(expert) = most {
                put(buf, pane, at, row, expert.fill(), depth.ink(expert.rgb()));
            }
            continue;
        }
        let Some(expert) = lower else { continue };
        let border = eighths
            .iter()
            .position(|&owner| owner == upper && upper != lower);
        let mut style = Style::new().fg(depth.color(expert.rgb()));
        if let Some(above) = upper.filter(|_| border.is_some()) {
            style = style.bg(depth.color(above.rgb()));
        }
        put(
            buf,
            pane,
            at,
            row,
            eighth(border.unwrap_or(8) as f32 / 8.0),
            style,
        );
    }
}

/// The experts' letters from the bottom of a stack upwards, at the pane's right end.
pub fn legend(buf: &mut Buffer, pane: Rect, row: u16, snapshot: &Snapshot, face: &Face) {
    let letters = snapshot.experts.len() as u16 + 2;
    let mut at = pane.width.saturating_sub(letters);
    for view in &snapshot.experts {
        let ink = strong().patch(face.depth.ink(view.expert.rgb()));
        at = text(buf, pane, at, row, &view.expert.letter().to_string(), ink);
    }
    text(buf, pane, at + 1, row, "↑", dim());
}

/// The two that hold most of a cell, the lower one first; a cell has no more than two colours.
fn two_largest(eighths: [Option<Expert>; 8]) -> (Option<Expert>, Option<Expert>) {
    let mut runs: Vec<(Option<Expert>, usize)> = Vec::new();
    for owner in eighths {
        match runs.last_mut() {
            Some((last, length)) if *last == owner => *length += 1,
            _ => runs.push((owner, 1)),
        }
    }
    while runs.len() > 2 {
        let shortest = (0..runs.len()).min_by_key(|&i| runs[i].1).unwrap_or(0);
        runs.remove(shortest);
    }
    let lower = runs.first().and_then(|run| run.0);
    (lower, runs.last().and_then(|run| run.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(shares: &[(Expert, f32)], depth: Depth) -> Buffer {
        let mut buf = Buffer::empty(Rect::new(0, 0, 1, 2));
        let pane = buf.area;
        stack(&mut buf, pane, 0, shares, depth);
        buf
    }

    #[test]
    fn colours_meet_within_a_cell() {
        let buf = drawn(
            &[(Expert::Vision, 0.75), (Expert::Haptic, 0.25)],
            Depth::True,
        );
        assert_eq!(buf[(0, 1)].symbol(), "█");
        assert_eq!(buf[(0, 0)].symbol(), "▄");
        assert_eq!(buf[(0, 0)].fg, Depth::True.color(Expert::Vision.rgb()));
        assert_eq!(buf[(0, 0)].bg, Depth::True.color(Expert::Haptic.rgb()));
    }

    #[test]
    fn fills_carry_the_same_without_colour() {
        let buf = drawn(&[(Expert::Vision, 0.5), (Expert::Prior, 0.5)], Depth::Plain);
        assert_eq!(buf, Buffer::with_lines(["░", "█"]));
        let shares = [(Expert::Vision, 0.5), (Expert::Prior, 0.5)];
        let buf = drawn(&shares, Depth::Sixteen);
        assert_eq!((buf[(0, 0)].symbol(), buf[(0, 1)].symbol()), ("░", "█"));
        assert_eq!(buf[(0, 1)].fg, Depth::Sixteen.color(Expert::Vision.rgb()));
    }

    #[test]
    fn where_three_meet_the_two_largest_are_shown() {
        let shares = [
            (Expert::Vision, 0.06),
            (Expert::Haptic, 0.2),
            (Expert::Proprio, 0.74),
        ];
        let buf = drawn(&shares, Depth::True);
        assert_eq!(buf[(0, 1)].symbol(), "▄");
        assert_eq!(buf[(0, 1)].fg, Depth::True.color(Expert::Haptic.rgb()));
        assert_eq!(buf[(0, 1)].bg, Depth::True.color(Expert::Proprio.rgb()));
    }

    #[test]
    fn nothing_known_draws_nothing() {
        let buf = drawn(&[(Expert::Vision, f32::NAN)], Depth::True);
        assert_eq!(buf, Buffer::empty(buf.area));
    }
}
