//! Which pane stands where: arithmetic on the size of the screen, nothing else. A file a view.
//!
//! Every screen has the status line at the top and the message line at the bottom, every view the timeline.

mod consistency;
mod fuse;
mod lattice;
mod overview;
mod position;
mod predict;

use ratatui::layout::{Position, Rect};

use super::border::{self, Placed, Split};
use super::view::{Pane, View};

/// The smallest screen that is drawn at all.
pub const SMALLEST: (u16, u16) = (40, 12);

/// Columns of the left half of a small screen.
pub const LEFT: u16 = 47;
/// Rows of the smallest timeline: header and track.
const LEAST_TIMELINE: u16 = 2;

/// What a layout depends on besides the size of the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// What is looked at.
    pub view: View,
    /// T, the steps of the episode.
    pub steps: usize,
    /// How many experts the model has, the prior among them.
    pub experts: usize,
    /// Whether the model multiplies them.
    pub product: bool,
    /// Whether an input is damaged.
    pub damaged: bool,
    /// The pane that is alone on the screen.
    pub zoom: Option<Pane>,
}

/// Where each pane is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// View, dataset, model, episode.
    pub status: Rect,
    /// Message, prompt or key hints.
    pub message: Rect,
    panes: Vec<(Pane, Rect)>,
}

impl Layout {
    /// Lays out a screen of at least [`SMALLEST`].
    pub fn of(screen: Rect, shape: Shape) -> Self {
        let margin = u16::from(screen.width >= 60);
        let inner = Rect {
            x: screen.x + margin,
            width: screen.width - 2 * margin,
            ..screen
        };
        let (status, rest) = rows(inner, 1);
        let (body, message) = rows(rest, rest.height - 1);
        let mut layout = Self {
            status,
            message,
            panes: Vec::new(),
        };
        match (shape.zoom, shape.view) {
            (Some(pane), _) => layout.zoom(body, pane, shape),
            (None, View::Overview) => layout.overview(body, screen, shape),
            (None, View::Fuse) => layout.fuse(body, shape),
            (None, View::Predict) => layout.predict(body, shape),
            (None, View::Position) => layout.position(body, shape),
            (None, View::Consistency) => layout.consistency(body, shape),
            (None, View::Lattice) => layout.lattice(body, shape),
        }
        layout
    }

    /// Where a pane is; empty if it is not shown.
    pub fn get(&self, pane: Pane) -> Rect {
        let found = self.panes.iter().find(|(shown, _)| *shown == pane);
        found.map(|&(_, rect)| rect).unwrap_or_default()
    }

    /// All of them at once.
    pub fn panes(&self) -> &[Placed] {
        &self.panes
    }

    /// The panes that are shown, none of them empty.
    pub fn shown(&self) -> impl Iterator<Item = (Pane, Rect)> {
        self.panes.iter().copied()
    }

    /// The pane at a cell of the screen.
    pub fn at(&self, cell: Position) -> Option<(Pane, Rect)> {
        self.shown().find(|(_, rect)| rect.contains(cell))
    }

    /// The same with some borders of a view moved.
    #[must_use]
    pub fn moved(mut self, splits: &[Split], view: View) -> Self {
        self.panes = border::apply(&self.panes, splits, view);
        self
    }

    /// Puts a pane somewhere; nowhere, if there is no room.
    fn put(&mut self, pane: Pane, rect: Rect) {
        if !rect.is_empty() {
            self.panes.push((pane, rect));
        }
    }

    /// Puts the timeline over the whole width below; returns what is left above it.
    fn put_timeline(&mut self, body: Rect, height: u16) -> Rect {
        let height = height.clamp(LEAST_TIMELINE, body.height.max(LEAST_TIMELINE));
        let (above, timeline) = rows(body, body.height.saturating_sub(height));
        self.put(Pane::Timeline, timeline);
        above
    }

    fn zoom(&mut self, body: Rect, pane: Pane, shape: Shape) {
        match pane {
            // The switches alone would leave the screen empty.
            Pane::Experts if shape.product => {
                let notes = if shape.view == View::Fuse { 3 } else { 0 };
                let (upper, lower) = rows(body, experts_rows(shape.experts) + notes);
                self.put(Pane::Experts, upper);
                self.put(Pane::Dims, rows(lower, 1).1);
            }
            // Curves over time need the steps they are of.
            Pane::Series => {
                let (upper, lower) = rows(body, 3);
                self.put(Pane::Timeline, upper);
                self.put(Pane::Series, lower);
            }
            pane => self.put(pane, body),
        }
    }
}

fn experts_rows(experts: usize) -> u16 {
    1 + experts.clamp(1, 8) as u16
}

/// The upper so many rows, and the rest.
pub fn rows(pane: Rect, upper: u16) -> (Rect, Rect) {
    let upper = upper.min(pane.height);
    let first = Rect {
        height: upper,
        ..pane
    };
    let rest = Rect {
        y: pane.y + upper,
        height: pane.height - upper,
        ..pane
    };
    (first, rest)
}

/// The left so many columns, a gap, and the rest.
pub fn columns(pane: Rect, left: u16, gap: u16) -> (Rect, Rect) {
    let left = left.min(pane.width);
    let from = (left + gap).min(pane.width);
    let first = Rect {
        width: left,
        ..pane
    };
    let rest = Rect {
        x: pane.x + from,
        width: pane.width - from,
        ..pane
    };
    (first, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(screen: Rect, shape: Shape) {
        let layout = Layout::of(screen, shape);
        let mut panes = vec![layout.status, layout.message];
        panes.extend(layout.shown().map(|(_, rect)| rect));
        for (i, pane) in panes.iter().enumerate() {
            assert_eq!(pane.intersection(screen), *pane, "{screen} {shape:?}");
            let after = &panes[i + 1..];
            assert!(
                after.iter().all(|other| !pane.intersects(*other)),
                "{screen} {shape:?}: {panes:?}"
            );
        }
        if shape.zoom.is_none() {
            let timeline = layout.get(Pane::Timeline);
            assert!(timeline.height >= LEAST_TIMELINE, "{screen} {shape:?}");
        }
    }

    #[test]
    fn panes_never_overlap_nor_leave_the_screen() {
        for view in View::ALL {
            for (width, height) in (SMALLEST.0..=210)
                .step_by(3)
                .flat_map(|width| (SMALLEST.1..=70).map(move |height| (width, height)))
            {
                let screen = Rect::new(0, 0, width, height);
                for (steps, experts) in [(0, 0), (16, 4), (48, 3), (500, 6)] {
                    let shape = Shape {
                        view,
                        steps,
                        experts,
                        product: experts != 3,
                        damaged: steps == 48,
                        zoom: None,
                    };
                    check(screen, shape);
                    let pane = view.panes()[usize::from(width + height) % view.panes().len()];
                    check(
                        screen,
                        Shape {
                            zoom: Some(pane),
                            ..shape
                        },
                    );
                }
            }
        }
    }

    #[test]
    fn borders_can_be_dragged_anywhere_and_nothing_overlaps() {
        let mut dragged = 0;
        for view in View::ALL {
            for (width, height) in [(40, 12), (80, 24), (120, 40), (200, 60)] {
                let screen = Rect::new(0, 0, width, height);
                let shape = Shape {
                    view,
                    steps: 16,
                    experts: 4,
                    product: true,
                    damaged: false,
                    zoom: None,
                };
                let own = Layout::of(screen, shape);
                let mut splits = Vec::new();
                for i in 0..400_u16 {
                    let layout = own.clone().moved(&splits, view);
                    let cell = Position::new(i * 7919 % width, i * 104 % height);
                    let Some(found) = border::at(layout.panes(), cell) else {
                        continue;
                    };
                    dragged += 1;
                    let by = (i * 31 % 61) as i16 - 30;
                    border::set(&mut splits, own.panes(), view, found, by);
                    let panes = own.clone().moved(&splits, view);
                    assert_eq!(panes.panes().len(), own.panes().len());
                    for (k, (_, pane)) in panes.shown().enumerate() {
                        assert!(!pane.is_empty() && pane.intersection(screen) == pane);
                        let mut others = panes.shown().skip(k + 1);
                        assert!(others.all(|(_, other)| !pane.intersects(other)));
                    }
                }
            }
        }
        assert!(dragged > 100, "{dragged}");
    }

    #[test]
    fn a_zoomed_pane_is_shown() {
        let screen = Rect::new(0, 0, 80, 24);
        for view in View::ALL {
            for &pane in view.panes() {
                let shape = Shape {
                    view,
                    steps: 16,
                    experts: 4,
                    product: true,
                    damaged: false,
                    zoom: Some(pane),
                };
                assert!(!Layout::of(screen, shape).get(pane).is_empty(), "{pane:?}");
            }
        }
    }
}
