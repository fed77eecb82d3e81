//! A window on the table from above: metres to braille dots, equal aspect, axes in centimetres.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::paint::{put, right, text, width};
use super::scale::Scale;
use super::theme::dim;
use crate::measure::ellipse::{Ellipse, SIGMAS_OF_95_PERCENT};
use crate::session::snapshot::{Estimate, PositionView};

/// Columns of the numbers on the y axis.
pub const GUTTER: u16 = 4;
/// Free room around everything, in centimetres.
const BORDER_CM: f32 = 1.0;

/// The rectangle of the table that has to be seen, in centimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    low: (f32, f32),
    high: (f32, f32),
}

impl Extent {
    /// Holds every path of the episode and the ellipses along them, so that nothing moves while the cursor does.
    /// None without a single point.
    ///
    /// An ellipse counts no further than the paths themselves reach: one that is wider would shrink them to a spot.
    pub fn of(position: &PositionView) -> Option<Self> {
        let truth = position.truth.iter().map(|pose| (pose.x, pose.y));
        let tip = position.tip.iter().map(|&[x, y]| (x, y));
        let estimates = [
            &position.belief,
            &position.prediction,
            &position.recorded_controls,
        ];
        let estimates = estimates.into_iter().flat_map(|path| path.iter().flatten());
        let mut extent = Self::of_points(
            truth
                .chain(tip)
                .chain(estimates.map(|estimate| (estimate.x, estimate.y))),
        )?;
        let paths = extent;
        let size = |low: f32, high: f32| high - low;
        let limit = size(paths.low.0, paths.high.0)
            .max(size(paths.low.1, paths.high.1))
            .max(2.0);
        let believed = position
            .belief
            .iter()
            .flatten()
            .map(|e| (e, SIGMAS_OF_95_PERCENT));
        let predicted = position.prediction.iter().flatten().map(|e| (e, 1.0));
        for (estimate, sigmas) in believed.chain(predicted) {
            let [xx, _, yy] = estimate.covariance;
            // The box around an ellipse is as wide as the marginal deviations.
            let reach = |variance: f32| (sigmas * variance.max(0.0).sqrt() * 100.0).min(limit);
            let (x, y) = (estimate.x * 100.0, estimate.y * 100.0);
            let (dx, dy) = (reach(xx), reach(yy));
            if [x, y, dx, dy].iter().all(|value| value.is_finite()) {
                extent.low = (extent.low.0.min(x - dx), extent.low.1.min(y - dy));
                extent.high = (extent.high.0.max(x + dx), extent.high.1.max(y + dy));
            }
        }
        Some(extent)
    }

    fn of_points(points: impl Iterator<Item = (f32, f32)>) -> Option<Self> {
        let mut cm = points
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .map(|(x, y)| (x * 100.0, y * 100.0));
        let first = cm.next()?;
        let start = Self {
            low: first,
            high: first,
        };
        Some(cm.fold(start, |extent, (x, y)| Self {
            low: (extent.low.0.min(x), extent.low.1.min(y)),
            high: (extent.high.0.max(x), extent.high.1.max(y)),
        }))
    }

    /// Holds both.
    #[must_use]
    pub fn and(self, other: Option<Self>) -> Self {
        other.map_or(self, |other| Self {
            low: (self.low.0.min(other.low.0), self.low.1.min(other.low.1)),
            high: (self.high.0.max(other.high.0), self.high.1.max(other.high.1)),
        })
    }
}

/// The window.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    left: f32,
    top: f32,
    cm_per_dot: f32,
    /// Its size in dots.
    pub dots: (f32, f32),
}

impl Plane {
    /// The window on an extent in a pane of cells, the extent in its middle.
    pub fn new(extent: Extent, pane: Rect) -> Self {
        let dots = (f32::from(pane.width) * 2.0, f32::from(pane.height) * 4.0);
        let ((x0, y0), (x1, y1)) = (extent.low, extent.high);
        let width = x1 - x0 + 2.0 * BORDER_CM;
        let height = y1 - y0 + 2.0 * BORDER_CM;
        let cm_per_dot = (width / dots.0).max(height / dots.1);
        Self {
            left: f32::midpoint(x0, x1) - cm_per_dot * dots.0 / 2.0,
            top: f32::midpoint(y0, y1) + cm_per_dot * dots.1 / 2.0,
            cm_per_dot,
            dots,
        }
    }

    /// Dots of a point in metres, y upwards.
    pub fn dot(&self, [x, y]: [f32; 2]) -> (f32, f32) {
        (
            (x * 100.0 - self.left) / self.cm_per_dot,
            (self.top - y * 100.0) / self.cm_per_dot,
        )
    }

    /// Dots that so many metres take.
    pub fn length(&self, metres: f32) -> f32 {
        metres * 100.0 / self.cm_per_dot
    }

    /// The cell of some dots; none outside.
    pub fn cell(&self, (x, y): (f32, f32)) -> Option<(u16, u16)> {
        let inside = x >= 0.0 && y >= 0.0 && x < self.dots.0 && y < self.dots.1;
        inside.then_some(((x / 2.0) as u16, (y / 4.0) as u16))
    }

    /// The outline of so many standard deviations, closed.
    pub fn ellipse(&self, estimate: &Estimate, sigmas: f32) -> Vec<(f32, f32)> {
        const POINTS: usize = 48;
        let ellipse = Ellipse::of_covariance(estimate.covariance);
        let outline = ellipse.outline([estimate.x, estimate.y], sigmas, POINTS);
        outline.into_iter().map(|point| self.dot(point)).collect()
    }

    /// Whether some of the dots lie outside.
    pub fn cuts(&self, dots: &[(f32, f32)]) -> bool {
        dots.iter().any(|&dot| self.cell(dot).is_none())
    }

    /// Numbers in whole centimetres beside and below the plane; `pane` begins a gutter before it and ends a row below.
    pub fn axes(&self, buf: &mut Buffer, pane: Rect) {
        let (across, down) = self.dots;
        let rows = (down / 4.0) as u16;
        for row in 0..rows {
            put(buf, pane, GUTTER - 1, row, '│', dim());
        }
        put(buf, pane, GUTTER - 1, rows, '└', dim());
        let bottom = self.top - down * self.cm_per_dot;
        let whole = |scale: Scale, most: u16| {
            let ticks = scale.ticks(usize::from(most).max(1)).into_iter();
            // Through whole numbers, so that nothing reads -0.
            ticks.filter(|(value, _)| (value - value.round()).abs() < 1e-3)
        };
        for (y, _) in whole(Scale::linear(bottom, self.top), rows / 3) {
            let row = ((self.top - y) / self.cm_per_dot / 4.0) as u16;
            if row < rows {
                right(
                    buf,
                    pane,
                    GUTTER - 1,
                    row,
                    &(y.round() as i32).to_string(),
                    dim(),
                );
            }
        }
        let end = self.left + across * self.cm_per_dot;
        let mut free = GUTTER;
        for (x, _) in whole(Scale::linear(self.left, end), (across / 10.0) as u16) {
            let label = (x.round() as i32).to_string();
            let centre = GUTTER + ((x - self.left) / self.cm_per_dot / 2.0) as u16;
            let at = centre.saturating_sub(width(&label) / 2);
            if at >= free && at + width(&label) <= pane.width {
                free = text(buf, pane, at, rows, &label, dim()) + 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tui::fixture;

    fn position() -> PositionView {
        fixture::snapshot(8, 16).position.unwrap_or_default()
    }

    #[test]
    fn an_ellipse_is_held_up_to_the_size_of_the_paths() {
        let narrow = position();
        let mut wide = narrow.clone();
        let widened = |variance: f32| {
            let estimate = |e: &Option<Estimate>| {
                e.map(|e| Estimate {
                    covariance: [variance, 0.0, variance],
                    ..e
                })
            };
            Arc::new(narrow.belief.iter().map(estimate).collect::<Vec<_>>())
        };
        // σ of 1 cm, seen whole at every step.
        wide.belief = widened(1e-4);
        let pane = Rect::new(0, 0, 40, 20);
        let extent = |position: &PositionView| Extent::of(position).map(|e| Plane::new(e, pane));
        let plane = extent(&wide);
        assert!(plane.is_some_and(|plane| {
            wide.belief
                .iter()
                .flatten()
                .all(|estimate| !plane.cuts(&plane.ellipse(estimate, SIGMAS_OF_95_PERCENT)))
        }));
        // σ of 10 m: the paths still take a third.
        wide.belief = widened(100.0);
        let scales =
            [extent(&narrow), extent(&wide)].map(|plane| plane.map_or(0.0, |p| p.cm_per_dot));
        assert!(
            scales[1] > scales[0] && scales[1] < 4.0 * scales[0],
            "{scales:?}"
        );
    }
}
