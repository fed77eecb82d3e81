//! What the samples of the rollout look like at the cursor: their mean, their spread, one of them (D22).
//!
//! ```text
//! samples ─────────── 32, seed 0, +6
//! mean of 16    σ 0…0.2     one
//! ▀▀▀▀▀▀▀▀▀▀    ▀▀▀▀▀▀▀▀    ▀▀▀▀▀▀▀▀
//! mean of samples is blurrier than the truth: 0.41 of its edges
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::face::Face;
use super::super::image::Raster;
use super::super::paint::{below_title, text, title, width};
use super::super::theme::{dim, strong};
use super::super::view::Pane;
use super::super::words::{sentence, wrap};
use super::{cursor_ahead, heat};
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::spread::SampleFrames;

/// Draws the three images with their sentences.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Samples);
    if pane.is_empty() {
        return;
    }
    let Some(spread) = &snapshot.spread else {
        title(buf, pane, "samples", "", focused);
        let why = if snapshot.busy {
            "computing…"
        } else {
            "not computed yet"
        };
        text(buf, below_title(pane), 0, 0, why, dim());
        return;
    };
    let ahead = cursor_ahead(snapshot).filter(|&ahead| ahead > 0);
    // While the cursor moves on the images are of a step before.
    let frames = spread.frames.as_ref().filter(|_| ahead.is_some());
    let at = frames.and_then(|frames| frames.step.checked_sub(snapshot.start));
    let at = at.map_or_else(String::new, |ahead| format!(", +{ahead}"));
    let note = format!("{}, seed {}{at}", spread.samples, spread.seed);
    title(buf, pane, "samples", &note, focused);
    let inner = below_title(pane);
    let Some(frames) = frames else {
        let why = if ahead.is_some() {
            "decoding…".to_owned()
        } else {
            format!(
                "from step {} to {}",
                snapshot.start + 2,
                snapshot.start + snapshot.horizon + 1
            )
        };
        text(buf, inner, 0, 0, &why, dim());
        return;
    };

    // On a low pane pictures say more than sentences.
    let sentences = if inner.height < 8 {
        short(frames)
    } else {
        sentences(frames)
    };
    let lines = sentences.iter().map(|line| wrap(line, inner.width).len());
    let wanted = (lines.sum::<usize>() as u16).min(inner.height / 2);
    let side = (inner.width.saturating_sub(2) / 3).min(inner.height.saturating_sub(1 + wanted) * 2);
    if side >= 4 {
        images(buf, inner, (side, frames), face);
    }
    let mut row = if side >= 4 { 1 + side.div_ceil(2) } else { 0 };
    for line in &sentences {
        row = sentence(buf, inner, row, line, Style::new());
    }
}

fn images(buf: &mut Buffer, pane: Rect, (side, frames): (u16, &SampleFrames), face: &Face) {
    let range = heat::range(&frames.deviation);
    let names = [
        format!("mean of {}", frames.decoded),
        format!("σ 0…{range}"),
        "one".to_owned(),
    ];
    for (i, name) in names.iter().enumerate() {
        let at = i as u16 * (side + 1);
        let cell = Rect {
            x: pane.x + at,
            width: side.min(pane.width.saturating_sub(at)),
            ..pane
        };
        let short = match i {
            0 if width(name) > side => "mean".to_owned(),
            1 if width(name) > side => format!("σ≤{range}"),
            _ => name.clone(),
        };
        text(buf, cell, 0, 0, &short, strong());
        let image = Rect {
            y: cell.y + 1,
            height: side.div_ceil(2).min(cell.height.saturating_sub(1)),
            ..cell
        };
        match i {
            0 => picture(buf, image, &Raster::from(&*frames.mean), face),
            1 => heat::draw(
                buf,
                image,
                (frames.mean.width, &frames.deviation),
                face.depth,
            ),
            _ => picture(buf, image, &Raster::from(&*frames.sample), face),
        }
    }
}

fn picture(buf: &mut Buffer, pane: Rect, raster: &Raster, face: &Face) {
    let shown = face
        .pixels
        .as_ref()
        .is_some_and(|pixels| pixels.draw(buf, pane, raster));
    if !shown {
        raster.draw(buf, pane, face.depth);
    }
}

/// The blur index alone.
fn short(frames: &SampleFrames) -> Vec<String> {
    let index = frames.blur_of_samples.filter(|index| index.is_finite());
    let said = |index: f32| format!("mean: {index:.2} of the edges");
    index.map(said).into_iter().collect()
}

/// What the blur indices say.
fn sentences(frames: &SampleFrames) -> Vec<String> {
    let said = |name: &str, index: Option<f32>| {
        let index = index.filter(|index| index.is_finite())?;
        Some(match index {
            index if index < 0.9 => {
                format!("{name} is blurrier than the truth: {index:.2} of its edges")
            }
            index if index > 1.1 => {
                format!("{name} has more edges than the truth: {index:.2} of its edges")
            }
            index => format!("{name} is as sharp as the truth: {index:.2} of its edges"),
        })
    };
    let both = [
        said("mean of samples", frames.blur_of_samples),
        said("mean path", frames.blur_of_mean_path),
    ];
    both.into_iter().flatten().collect()
}
