//! Figures for papers: a few kinds of marks, as SVG and as PNG.

mod axis;
mod panel;
mod raster;
mod svg;

use std::io::Write;
use std::path::Path;

pub use self::panel::{Panel, Series, Style, legend};
use super::ExportError;
use super::output::Output;
use super::png;

/// A colour as sRGB bytes.
pub type Rgb = [u8; 3];

/// Letters, axes.
pub const INK: Rgb = [32; 3];
/// Grids, and what stands back.
pub const FAINT: Rgb = [200; 3];

/// Where a text stands to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// Something drawn; lengths in pixels of the SVG, y down.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A filled polygon.
    Area {
        /// Its corners.
        points: Vec<[f32; 2]>,
        /// Its colour.
        color: Rgb,
        /// 0 to 1.
        opacity: f32,
    },
    /// A line through points.
    Line {
        /// The points.
        points: Vec<[f32; 2]>,
        /// Its colour.
        color: Rgb,
        /// Its width.
        width: f32,
        /// Lengths of dash and gap; empty for an unbroken one.
        dash: Vec<f32>,
    },
    /// A line of letters on its base line.
    Text {
        /// Its point.
        at: [f32; 2],
        /// The letters.
        text: String,
        /// Height of the letters.
        size: f32,
        /// How it stands to its point.
        anchor: Anchor,
        /// Whether it runs upwards.
        upwards: bool,
    },
    /// A grey image, its pixels never smoothed.
    Image {
        /// Its upper left corner.
        at: [f32; 2],
        /// Width and height as drawn.
        size: [f32; 2],
        /// Its columns.
        columns: usize,
        /// Grey values, row major.
        pixels: Vec<u8>,
    },
}

/// A figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Width and height.
    pub size: [f32; 2],
    /// What it shows, for those who cannot see it.
    pub title: String,
    /// In drawing order.
    pub marks: Vec<Mark>,
}

impl Plot {
    /// A text of the usual size.
    pub fn text(&mut self, at: [f32; 2], text: impl Into<String>, anchor: Anchor) {
        self.marks.push(Mark::Text {
            at,
            text: text.into(),
            size: 12.0,
            anchor,
            upwards: false,
        });
    }

    /// An unbroken line.
    pub fn line(&mut self, points: Vec<[f32; 2]>, color: Rgb, width: f32) {
        let dash = Vec::new();
        self.marks.push(Mark::Line {
            points,
            color,
            width,
            dash,
        });
    }

    /// Another plot's marks, moved.
    pub fn place(&mut self, plot: &Self, [dx, dy]: [f32; 2]) {
        let moved = |points: &[[f32; 2]]| points.iter().map(|[x, y]| [x + dx, y + dy]).collect();
        for mark in &plot.marks {
            let mut mark = mark.clone();
            match &mut mark {
                Mark::Area { points, .. } | Mark::Line { points, .. } => *points = moved(points),
                Mark::Text { at, .. } | Mark::Image { at, .. } => *at = [at[0] + dx, at[1] + dy],
            }
            self.marks.push(mark);
        }
    }

    /// Writes it as `STEM.svg` and `STEM.png` in a folder, replacing what is there.
    ///
    /// # Errors
    /// If one of them cannot be written.
    pub fn save(&self, folder: &Path, stem: &str) -> Result<(), ExportError> {
        let mut output = Output::create(&folder.join(format!("{stem}.svg")), true)?;
        let failed = output.failed();
        output
            .write_all(svg::text(self).as_bytes())
            .map_err(failed)?;
        output.commit()?;
        let path = folder.join(format!("{stem}.png"));
        let Some((size, pixels)) = raster::pixels(self) else {
            let what = "a figure of this size cannot be drawn".to_owned();
            return Err(ExportError::Format { path, what });
        };
        let facts = [("title".to_owned(), self.title.clone())].into();
        png::save(Output::create(&path, true)?, size, &pixels, &facts)
    }
}
