//! Where the sets stand: as large as all of them fit with their frames, else in lines, else only those around the
//! chosen one.

use ratatui::layout::Rect;

/// Columns of a cell beside its frame: mark, gap, numbers, gap.
const BESIDE: u16 = 7;
/// Rows of a cell besides its frame: the name.
const ABOVE: u16 = 1;
/// The smallest side of a frame that still shows something, in columns.
const SMALLEST: u16 = 6;
/// Columns of a set in a table, and between two.
const LINE: u16 = 19;
const GAP: u16 = 3;

/// A grid of cells of one size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    count: usize,
    across: u16,
    cell: (u16, u16),
    /// Side of a frame in columns; 0 for lines without frames.
    pub side: u16,
}

impl Grid {
    /// The grid of so many sets whose frames are as large as they can be.
    pub fn of(pane: Rect, count: usize) -> Self {
        let framed = |across: u16| {
            let down = count.div_ceil(usize::from(across)) as u16;
            let cell = (pane.width / across, pane.height / down.max(1));
            let side = cell
                .0
                .saturating_sub(BESIDE)
                .min(cell.1.saturating_sub(ABOVE) * 2);
            Self {
                count,
                across,
                cell,
                side,
            }
        };
        // Of equal sides the fewest columns win: their cells have more air.
        let best = (1..=count.clamp(1, 64) as u16)
            .map(framed)
            .rev()
            .max_by_key(|grid| grid.side);
        match best {
            Some(best) if best.side >= SMALLEST => best,
            _ => {
                let across = ((pane.width + GAP) / (LINE + GAP)).max(1);
                let needed = count.div_ceil(usize::from(pane.height.max(1))).max(1) as u16;
                let across = across.min(needed);
                Self {
                    count,
                    across,
                    cell: ((pane.width + GAP) / across, 1),
                    side: 0,
                }
            }
        }
    }

    /// The sets that are shown with their places; the chosen one is always among them.
    pub fn places(self, pane: Rect, chosen: usize) -> Vec<(usize, Rect)> {
        let (width, height) = self.cell;
        if width == 0 || height == 0 {
            return Vec::new();
        }
        let across = usize::from(self.across);
        let down = usize::from(pane.height / height);
        // Lines are read downwards, frames across.
        let (fits, from) = if self.side == 0 {
            let fits = across * down;
            (fits, chosen.saturating_sub(fits.saturating_sub(1)))
        } else {
            (across * down, 0)
        };
        let gap = if self.side == 0 { GAP } else { 1 };
        let place = |i: usize| {
            let at = i - from;
            let (column, row) = if self.side == 0 {
                (at / down.max(1), at % down.max(1))
            } else {
                (at % across, at / across)
            };
            Rect {
                x: pane.x + column as u16 * width,
                y: pane.y + row as u16 * height,
                width: width.saturating_sub(gap),
                height,
            }
        };
        (from..self.count.min(from + fits))
            .map(|i| (i, place(i)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fifteen_sets_have_frames_on_a_small_terminal() {
        let grid = Grid::of(Rect::new(1, 2, 78, 18), 15);
        assert_eq!((grid.across, grid.side), (5, 8));
    }

    #[test]
    fn sets_keep_to_the_pane_and_the_chosen_one_is_shown() {
        for (width, height) in (1..200)
            .step_by(7)
            .flat_map(|w| (1..60).map(move |h| (w, h)))
        {
            for count in [1, 3, 7, 15, 31, 63] {
                let pane = Rect::new(3, 2, width, height);
                for chosen in [0, count / 2, count - 1] {
                    let grid = Grid::of(pane, count);
                    let places = grid.places(pane, chosen);
                    assert!(places.iter().any(|(i, _)| *i == chosen), "{pane} {count}");
                    for (i, (_, place)) in places.iter().enumerate() {
                        assert_eq!(place.intersection(pane), *place, "{pane} {count} {grid:?}");
                        let after = &places[i + 1..];
                        assert!(after.iter().all(|(_, other)| !place.intersects(*other)));
                    }
                }
            }
        }
    }
}
