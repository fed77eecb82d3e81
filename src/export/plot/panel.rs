//! A chart: curves with bands over an axis, ellipses, and the frame around them.

use super::axis::{label, ticks};
use super::{Anchor, FAINT, INK, Mark, Plot, Rgb};

/// How a series looks: never by colour alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Style {
    /// Its colour.
    pub color: Rgb,
    /// Lengths of dash and gap; empty for an unbroken line.
    pub dash: Vec<f32>,
}

/// A curve, with a band around it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// How it looks.
    pub style: Style,
    /// Its points; those that are not finite are left out.
    pub points: Vec<[f64; 2]>,
    /// Lower and upper edge over the same x; empty for none.
    pub band: Vec<[f64; 2]>,
}

/// A chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// Width and height of the whole, axes included.
    pub size: [f32; 2],
    /// Above it.
    pub title: String,
    /// Along the axes, with units.
    pub axes: [String; 2],
    /// The curves.
    pub series: Vec<Series>,
    /// Whether a unit is as long along x as along y.
    pub equal: bool,
    /// Whether y begins at zero.
    pub from_zero: bool,
    /// Least and largest y, where panels are to be compared; else as the curves have it.
    pub ends: Option<[f64; 2]>,
}

const LEFT: f32 = 54.0;
const RIGHT: f32 = 14.0;
const TOP: f32 = 28.0;
const BOTTOM: f32 = 42.0;

/// From numbers to pixels.
struct Scale {
    low: [f64; 2],
    per: [f64; 2],
    height: f32,
}

impl Scale {
    fn at(&self, [x, y]: [f64; 2]) -> [f32; 2] {
        let along = |k: usize, v: f64| ((v - self.low[k]) * self.per[k]) as f32;
        [LEFT + along(0, x), self.height - BOTTOM - along(1, y)]
    }
}

impl Panel {
    /// Least and largest number of an axis, with some room.
    pub fn range(&self, axis: usize) -> [f64; 2] {
        if let (1, Some(ends)) = (axis, self.ends) {
            return ends;
        }
        let points = self.series.iter().flat_map(|s| {
            let band = s
                .points
                .iter()
                .zip(&s.band)
                .flat_map(|(p, b)| b.map(|y| [p[0], y]));
            s.points.iter().copied().chain(band)
        });
        let numbers = points.map(|p| p[axis]).filter(|v| v.is_finite());
        let [low, high] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| {
            [a.min(v), b.max(v)]
        });
        if low > high {
            return [0.0, 1.0];
        }
        let room = if axis == 0 && !self.equal {
            0.0
        } else {
            0.05 * (high - low).max(1e-9)
        };
        let bottom = if axis == 1 && self.from_zero {
            low.min(0.0)
        } else {
            low - room
        };
        [bottom, high + room]
    }

    /// Draws it.
    pub fn draw(&self) -> Plot {
        let [width, height] = self.size;
        let inner = [
            f64::from(width - LEFT - RIGHT),
            f64::from(height - TOP - BOTTOM),
        ];
        let mut ranges = [self.range(0), self.range(1)];
        let mut per = [0, 1].map(|k| inner[k] / (ranges[k][1] - ranges[k][0]).max(1e-12));
        if self.equal {
            let both = per[0].min(per[1]);
            for k in 0..2 {
                let spare = inner[k] / both - (ranges[k][1] - ranges[k][0]);
                ranges[k] = [ranges[k][0] - spare / 2.0, ranges[k][1] + spare / 2.0];
            }
            per = [both; 2];
        }
        let scale = Scale {
            low: [ranges[0][0], ranges[1][0]],
            per,
            height,
        };
        let mut plot = Plot {
            size: self.size,
            title: self.title.clone(),
            marks: Vec::new(),
        };
        self.frame(&mut plot, &scale, ranges);
        for series in &self.series {
            band(&mut plot, &scale, series);
        }
        for series in &self.series {
            curve(&mut plot, &scale, series);
        }
        plot
    }

    fn frame(&self, plot: &mut Plot, scale: &Scale, ranges: [[f64; 2]; 2]) {
        let [[left, right], [low, high]] = ranges;
        let [width, height] = self.size;
        let steps = |range: [f64; 2], count| {
            let ticks = ticks(range, count);
            let step = ticks.get(1).zip(ticks.first()).map_or(1.0, |(b, a)| b - a);
            (ticks, step)
        };
        let (xs, step) = steps(ranges[0], 6);
        for x in xs {
            let [px, py] = scale.at([x, low]);
            plot.line(vec![[px, py], scale.at([x, high])], FAINT, 0.5);
            plot.text([px, py + 16.0], label(x, step), Anchor::Middle);
        }
        let (ys, step) = steps(ranges[1], 5);
        for y in ys {
            let [px, py] = scale.at([left, y]);
            plot.line(vec![[px, py], scale.at([right, y])], FAINT, 0.5);
            plot.text([px - 6.0, py + 4.0], label(y, step), Anchor::End);
        }
        let corners = [[left, high], [left, low], [right, low]];
        plot.line(corners.map(|c| scale.at(c)).to_vec(), INK, 1.0);
        let middle = LEFT + 0.5 * (width - LEFT - RIGHT);
        plot.text([middle, height - 8.0], self.axes[0].clone(), Anchor::Middle);
        plot.marks.push(Mark::Text {
            at: [14.0, TOP + 0.5 * (height - TOP - BOTTOM)],
            text: self.axes[1].clone(),
            size: 12.0,
            anchor: Anchor::Middle,
            upwards: true,
        });
        plot.text([middle, 16.0], self.title.clone(), Anchor::Middle);
    }
}

fn band(plot: &mut Plot, scale: &Scale, series: &Series) {
    let edges: Vec<[[f32; 2]; 2]> = series
        .points
        .iter()
        .zip(&series.band)
        .filter(|(p, b)| p.iter().chain(*b).all(|v| v.is_finite()))
        .map(|(p, b)| b.map(|y| scale.at([p[0], y])))
        .collect();
    if edges.len() < 2 {
        return;
    }
    let lower = edges.iter().map(|[low, _]| *low);
    let upper = edges.iter().rev().map(|[_, high]| *high);
    plot.marks.push(Mark::Area {
        points: lower.chain(upper).collect(),
        color: series.style.color,
        opacity: 0.12,
    });
}

fn curve(plot: &mut Plot, scale: &Scale, series: &Series) {
    let finite = series
        .points
        .iter()
        .filter(|p| p.iter().all(|v| v.is_finite()));
    plot.marks.push(Mark::Line {
        points: finite.map(|p| scale.at(*p)).collect(),
        color: series.style.color,
        width: 1.8,
        dash: series.style.dash.clone(),
    });
}

/// A row of names with a piece of their lines, broken into rows of `width`; its size says how high it is.
pub fn legend(series: &[(String, Style)], width: f32) -> Plot {
    let mut plot = Plot {
        size: [width, 20.0],
        ..Plot::default()
    };
    let mut at = [10.0, 12.0];
    for (label, style) in series {
        // Wide letters are about this wide.
        let needed = 44.0 + 7.0 * label.chars().count() as f32;
        if at[0] + needed > width && at[0] > 10.0 {
            at = [10.0, at[1] + 18.0];
        }
        plot.marks.push(Mark::Line {
            points: vec![[at[0], at[1] - 4.0], [at[0] + 30.0, at[1] - 4.0]],
            color: style.color,
            width: 2.0,
            dash: style.dash.clone(),
        });
        plot.text([at[0] + 36.0, at[1]], label.clone(), Anchor::Start);
        at[0] += needed;
    }
    plot.size[1] = at[1] + 8.0;
    plot
}
