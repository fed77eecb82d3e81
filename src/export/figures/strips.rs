//! Frames in rows: truth, and what models predict.

use crate::export::plot::{Anchor, Mark, Plot};

/// A row of frames.
pub struct Frames {
    /// Before it.
    pub label: String,
    /// Grey values, each of `columns * columns` pixels.
    pub frames: Vec<Vec<u8>>,
}

/// Rows of frames of one episode.
pub struct Strip {
    /// Above it.
    pub title: String,
    /// Its rows; the images they are of are the same.
    pub rows: Vec<Frames>,
    /// Number of the first image, from 1.
    pub first: usize,
}

/// Strips one under the other, `side` pixels of a frame along.
pub fn strips(title: &str, strips: &[Strip], side: usize) -> Plot {
    const CELL: f32 = 64.0;
    const GAP: f32 = 2.0;
    let labels = strips.iter().flat_map(|s| &s.rows);
    let widest = labels.map(|row| row.label.chars().count()).max();
    // Wide letters are about this wide.
    let label = 16.0 + 7.0 * widest.unwrap_or(0) as f32;
    let longest = strips
        .iter()
        .flat_map(|s| &s.rows)
        .map(|r| r.frames.len())
        .max();
    // No more frames in a row than a page is wide.
    let every = longest.unwrap_or(1).div_ceil(14).max(1);
    let columns = longest.unwrap_or(1).div_ceil(every);
    let mut plot = Plot {
        size: [label + columns as f32 * (CELL + GAP) + 10.0, 10.0],
        title: title.to_owned(),
        marks: Vec::new(),
    };
    for strip in strips {
        let top = plot.size[1];
        plot.text([10.0, top + 14.0], strip.title.clone(), Anchor::Start);
        for column in 0..columns {
            let x = label + column as f32 * (CELL + GAP) + CELL / 2.0;
            let number = (strip.first + column * every).to_string();
            plot.text([x, top + 34.0], number, Anchor::Middle);
        }
        let mut y = top + 40.0;
        for row in &strip.rows {
            plot.text(
                [label - 8.0, y + CELL / 2.0 + 4.0],
                row.label.clone(),
                Anchor::End,
            );
            for (column, pixels) in row.frames.iter().step_by(every).enumerate() {
                plot.marks.push(Mark::Image {
                    at: [label + column as f32 * (CELL + GAP), y],
                    size: [CELL; 2],
                    columns: side,
                    pixels: pixels.clone(),
                });
            }
            y += CELL + GAP;
        }
        plot.size[1] = y + 10.0;
    }
    plot
}
