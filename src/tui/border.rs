//! Borders between panes, and what dragging one does: arithmetic on where the panes are, whatever view they are of.
//!
//! A border is the gap to the right of a pane, or the title row (or the gap) below one. Moving it moves the edge of
//! every pane that meets it, so that nothing overlaps. What was moved is kept as offsets from the view's own layout,
//! which stay when the screen gets another size, as far as there is room.

use ratatui::layout::{Position, Rect};

use super::view::{Pane, View};

/// The widest gap between two panes that are neighbours.
const GAP: u16 = 3;
/// No border makes a pane narrower or lower than this, in columns and rows, unless it was before.
const LEAST: (u16, u16) = (16, 3);

/// A pane and where it is.
pub type Placed = (Pane, Rect);

/// Which side of a pane a border is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// To its right.
    Right,
    /// Below it.
    Bottom,
}

/// A border, by a pane that it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// The pane to the left of it or above it.
    pub pane: Pane,
    /// On which side of that pane it is.
    pub side: Side,
}

/// A border that has been moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// In which view.
    pub view: View,
    /// Which one.
    pub border: Border,
    /// By so many columns to the right, or rows down.
    pub by: i16,
}

/// Along the axis in which a border moves, and across it: first cell, and the one after the last.
#[derive(Clone, Copy)]
struct Spans {
    along: (u16, u16),
    across: (u16, u16),
}

impl Side {
    fn spans(self, rect: Rect) -> Spans {
        let (x, y) = ((rect.x, rect.right()), (rect.y, rect.bottom()));
        match self {
            Self::Right => Spans {
                along: x,
                across: y,
            },
            Self::Bottom => Spans {
                along: y,
                across: x,
            },
        }
    }

    fn least(self) -> u16 {
        match self {
            Self::Right => LEAST.0,
            Self::Bottom => LEAST.1,
        }
    }

    /// The rectangle with another extent along the axis.
    fn resized(self, rect: Rect, (start, end): (u16, u16)) -> Rect {
        match self {
            Self::Right => Rect {
                x: start,
                width: end - start,
                ..rect
            },
            Self::Bottom => Rect {
                y: start,
                height: end - start,
                ..rect
            },
        }
    }

    /// What a pointer's way moves the border by.
    pub fn way(self, from: Position, to: Position) -> i16 {
        match self {
            Self::Right => to.x as i16 - from.x as i16,
            Self::Bottom => to.y as i16 - from.y as i16,
        }
    }
}

/// The border at a cell of the screen.
pub fn at(panes: &[Placed], cell: Position) -> Option<Border> {
    let inside = panes.iter().find(|(_, rect)| rect.contains(cell));
    let meets = |side: Side, along: u16, across: u16| {
        let upper = panes.iter().find(|(_, rect)| {
            let spans = side.spans(*rect);
            let is_near = spans.along.1 <= along && along - spans.along.1 < GAP;
            is_near && (spans.across.0..spans.across.1).contains(&across)
        })?;
        let pane = upper.0;
        let border = Border { pane, side };
        let (_, after) = meeting(panes, border);
        (!after.is_empty()).then_some(border)
    };
    match inside {
        // The title of the lower pane.
        Some((_, rect)) if rect.y == cell.y => meets(Side::Bottom, cell.y, cell.x),
        Some(_) => None,
        None => meets(Side::Right, cell.x, cell.y).or_else(|| meets(Side::Bottom, cell.y, cell.x)),
    }
}

/// The panes with their borders moved, the first split first.
pub fn apply(panes: &[Placed], splits: &[Split], view: View) -> Vec<Placed> {
    let mut panes = panes.to_vec();
    for split in splits.iter().filter(|split| split.view == view) {
        panes = moved(&panes, split.border, split.by).0;
    }
    panes
}

/// How far a border has been moved.
pub fn offset(splits: &[Split], view: View, border: Border) -> i16 {
    let of = |split: &&Split| split.view == view && split.border == border;
    splits.iter().find(of).map_or(0, |split| split.by)
}

/// Moves a border of a view whose own layout is `panes` to another offset, as far as there is room.
pub fn set(splits: &mut Vec<Split>, panes: &[Placed], view: View, border: Border, by: i16) {
    let of = |split: &Split| split.view == view && split.border == border;
    let i = splits.iter().position(of).unwrap_or_else(|| {
        splits.push(Split {
            view,
            border,
            by: 0,
        });
        splits.len() - 1
    });
    let before = apply(panes, &splits[..i], view);
    splits[i].by = moved(&before, border, by).1;
}

/// The panes with a border moved by as much of `by` as there is room for, and how much that is.
fn moved(panes: &[Placed], border: Border, by: i16) -> (Vec<Placed>, i16) {
    let (before, after) = meeting(panes, border);
    let mut by = if after.is_empty() { 0 } else { by };
    while by != 0 {
        if let Some(moved) = tried(panes, border.side, (&before, &after), by) {
            return (moved, by);
        }
        by -= by.signum();
    }
    (panes.to_vec(), 0)
}

/// The panes that end at a border, and those that begin there, by their places in the list.
fn meeting(panes: &[Placed], border: Border) -> (Vec<usize>, Vec<usize>) {
    let spans: Vec<Spans> = panes
        .iter()
        .map(|(_, rect)| border.side.spans(*rect))
        .collect();
    let first = panes.iter().position(|(pane, _)| *pane == border.pane);
    let (mut before, mut after): (Vec<usize>, Vec<usize>) = (first.into_iter().collect(), vec![]);
    let follows = |a: usize, b: usize| {
        let (a, b) = (spans[a], spans[b]);
        let is_near = a.along.1 <= b.along.0 && b.along.0 - a.along.1 <= GAP;
        is_near && a.across.0 < b.across.1 && b.across.0 < a.across.1
    };
    loop {
        let count = before.len() + after.len();
        for i in 0..panes.len() {
            if !after.contains(&i) && before.iter().any(|&a| follows(a, i)) {
                after.push(i);
            }
            if !before.contains(&i) && after.iter().any(|&b| follows(i, b)) {
                before.push(i);
            }
        }
        if before.len() + after.len() == count {
            return (before, after);
        }
    }
}

/// The panes with the border moved, if each keeps its least size and none comes over another.
fn tried(
    panes: &[Placed],
    side: Side,
    (before, after): (&[usize], &[usize]),
    by: i16,
) -> Option<Vec<Placed>> {
    let mut moved = panes.to_vec();
    for (i, (_, rect)) in moved.iter_mut().enumerate() {
        let (start, end) = side.spans(*rect).along;
        let (mut new_start, mut new_end) = (start, end);
        if after.contains(&i) {
            new_start = start.checked_add_signed(by)?;
        }
        if before.contains(&i) {
            new_end = end.checked_add_signed(by)?;
        }
        let least = side.least().min(end - start);
        if new_end < new_start || new_end - new_start < least {
            return None;
        }
        *rect = side.resized(*rect, (new_start, new_end));
    }
    let is_clear = |i: usize| {
        let others = &moved[i + 1..];
        others
            .iter()
            .all(|(_, other)| !other.intersects(moved[i].1))
    };
    (0..moved.len()).all(is_clear).then_some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ```text
    /// frames  frames
    /// experts position
    /// experts timeline
    /// ```
    fn panes() -> Vec<Placed> {
        vec![
            (Pane::Frames, Rect::new(1, 1, 78, 10)),
            (Pane::Experts, Rect::new(1, 11, 40, 12)),
            (Pane::Position, Rect::new(43, 11, 36, 6)),
            (Pane::Timeline, Rect::new(43, 17, 36, 6)),
        ]
    }

    const fn border(pane: Pane, side: Side) -> Border {
        Border { pane, side }
    }

    #[test]
    fn borders_are_gaps_and_titles() {
        let at = |x, y| at(&panes(), Position::new(x, y));
        assert_eq!(at(41, 12), Some(border(Pane::Experts, Side::Right)));
        assert_eq!(at(42, 20), Some(border(Pane::Experts, Side::Right)));
        assert_eq!(at(40, 12), None);
        assert_eq!(at(43, 13), None);
        assert_eq!(at(20, 11), Some(border(Pane::Frames, Side::Bottom)));
        assert_eq!(at(50, 17), Some(border(Pane::Position, Side::Bottom)));
        assert_eq!(at(20, 1), None, "nothing is above the frames");
        assert_eq!(at(0, 12), None);
        assert_eq!(at(79, 23), None);
    }

    #[test]
    fn every_pane_that_meets_a_border_follows_it() {
        let find = |panes: &[Placed], pane| {
            let found = panes.iter().find(|(p, _)| *p == pane);
            found.map(|&(_, rect)| rect).unwrap_or_default()
        };
        let split = |pane, side, by| {
            let border = Border { pane, side };
            let mut splits = Vec::new();
            set(&mut splits, &panes(), View::Overview, border, by);
            assert_eq!(apply(&panes(), &splits, View::Fuse), panes());
            (apply(&panes(), &splits, View::Overview), splits[0].by)
        };
        let (wider, by) = split(Pane::Experts, Side::Right, 10);
        assert_eq!(by, 10);
        assert_eq!(find(&wider, Pane::Experts).width, 50);
        assert_eq!(find(&wider, Pane::Position), Rect::new(53, 11, 26, 6));
        assert_eq!(find(&wider, Pane::Timeline), Rect::new(53, 17, 26, 6));
        let (_, most) = split(Pane::Experts, Side::Right, 99);
        assert_eq!(most, 20, "the timeline keeps its least width");
        let (higher, by) = split(Pane::Frames, Side::Bottom, -4);
        assert_eq!((by, find(&higher, Pane::Frames).height), (-4, 6));
        assert_eq!(find(&higher, Pane::Experts), Rect::new(1, 7, 40, 16));
        assert_eq!(find(&higher, Pane::Position), Rect::new(43, 7, 36, 10));
        assert_eq!(find(&higher, Pane::Timeline), Rect::new(43, 17, 36, 6));
    }

    #[test]
    fn an_offset_is_told_and_set_again() {
        let border = Border {
            pane: Pane::Position,
            side: Side::Bottom,
        };
        let mut splits = Vec::new();
        set(&mut splits, &panes(), View::Overview, border, 2);
        set(&mut splits, &panes(), View::Overview, border, -1);
        assert_eq!(
            (splits.len(), offset(&splits, View::Overview, border)),
            (1, -1)
        );
        assert_eq!(offset(&splits, View::Fuse, border), 0);
    }
}
