//! A contact sheet: episodes at a glance.

use image::{GrayImage, Luma};

use crate::episode::Recording;

/// White pixels between pictures.
const GAP_PX: usize = 2;
/// Each pixel of a frame becomes a square of this side.
const ZOOM: usize = 2;

/// One row an episode, its frames in columns, thin white gaps between.
pub fn sheet(recordings: &[Recording]) -> GrayImage {
    let frames = || recordings.iter().flat_map(|recording| &recording.frames);
    let cell_width = GAP_PX + ZOOM * frames().map(|frame| frame.width).max().unwrap_or(0);
    let cell_height = GAP_PX + ZOOM * frames().map(|frame| frame.height).max().unwrap_or(0);
    let longest = recordings
        .iter()
        .map(|recording| recording.frames.len())
        .max()
        .unwrap_or(0);
    let mut sheet = GrayImage::from_pixel(
        (longest * cell_width + GAP_PX) as u32,
        (recordings.len() * cell_height + GAP_PX) as u32,
        Luma([255]),
    );
    for (row, recording) in recordings.iter().enumerate() {
        for (column, frame) in recording.frames.iter().enumerate() {
            for (i, grey) in frame.pixels.iter().enumerate() {
                let left = GAP_PX + column * cell_width + ZOOM * (i % frame.width);
                let top = GAP_PX + row * cell_height + ZOOM * (i / frame.width);
                for (x, y) in (0..ZOOM * ZOOM).map(|k| (left + k % ZOOM, top + k / ZOOM)) {
                    sheet.put_pixel(x as u32, y as u32, Luma([*grey]));
                }
            }
        }
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Frame;

    #[test]
    fn frames_lie_in_rows_with_white_gaps() {
        let episode = |greys: &[u8]| Recording {
            frames: greys
                .iter()
                .map(|grey| Frame {
                    width: 3,
                    height: 2,
                    pixels: vec![*grey; 6],
                })
                .collect(),
            ..Recording::default()
        };
        let sheet = sheet(&[episode(&[10, 20]), episode(&[30])]);
        assert_eq!(sheet.dimensions(), (18, 14));
        assert_eq!(sheet.get_pixel(2, 2).0, [10]);
        assert_eq!(sheet.get_pixel(15, 5).0, [20]);
        assert_eq!(sheet.get_pixel(2, 8).0, [30]);
        assert_eq!(sheet.get_pixel(8, 2).0, [255]);
        assert_eq!(sheet.get_pixel(12, 9).0, [255]);
    }
}
