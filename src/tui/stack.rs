//! Shares of a whole as one column of stacked fills, the first expert at the bottom.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::paint::{eighth, put};
use super::theme::Depth;
use crate::modality::Expert;

/// Draws one column. Shares of 1 in all fill the pane's height; NaN and none draw nothing.
///
/// With colours the borders between experts are exact to an eighth of a cell; without, each cell shows the fill
/// of the expert at its middle.
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
        let at_eighth = |i: u8| owner((floor + (f32::from(i) + 0.5) / 8.0) / height);
        if depth == Depth::Plain {
            if let Some(expert) = at_eighth(4) {
                put(buf, pane, at, row, expert.fill(), Style::new());
            }
            continue;
        }
        let Some(lower) = at_eighth(0) else { continue };
        let same = (0..8).take_while(|&i| at_eighth(i) == Some(lower)).count();
        let mut style = Style::new().fg(depth.color(lower.rgb()));
        if let Some(upper) = at_eighth(7).filter(|_| same < 8) {
            style = style.bg(depth.color(upper.rgb()));
        }
        put(buf, pane, at, row, eighth(same as f32 / 8.0), style);
    }
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
    }

    #[test]
    fn nothing_known_draws_nothing() {
        let buf = drawn(&[(Expert::Vision, f32::NAN)], Depth::True);
        assert_eq!(buf, Buffer::empty(buf.area));
    }
}
