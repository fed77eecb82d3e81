//! Figures: what was recorded beside what the models make of it, frames pixel by pixel.

mod canvas;
mod encode;
mod rows;
mod sheet;
mod strip;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use self::canvas::Canvas;
use super::output::Output;
use super::{ExportError, Provenance, Run, Sink};

/// A picture of more pixels cannot be looked at, and would fill the memory.
const PIXELS_LIMIT: usize = 100_000_000;
/// Columns of frames, where nobody says which steps to show.
const COLUMNS: usize = 16;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Figure {
    /// How.
    pub kind: Kind,
    /// Every so many steps; none for so many that at most 16 are shown.
    pub every: Option<usize>,
    /// Each pixel of a frame becomes a square of this side.
    pub zoom: usize,
}

/// How an episode is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rows of truth, and of each model's frames and errors, with labels.
    Strip,
    /// A row of truth and one of each model's frames, close together.
    Sheet,
}

/// The picture, growing downwards.
pub struct Picture {
    output: Output,
    figure: Figure,
    blocks: Vec<Canvas>,
    provenance: Option<Arc<Provenance>>,
}

impl Picture {
    /// Begins the file.
    ///
    /// # Errors
    /// If it cannot be begun.
    pub fn create(out: &Path, force: bool, figure: Figure) -> Result<Self, ExportError> {
        Ok(Self {
            output: Output::create(out, force)?,
            figure,
            blocks: Vec::new(),
            provenance: None,
        })
    }

    fn too_large(&self, episodes: usize) -> ExportError {
        ExportError::Format {
            path: self.output.path().to_owned(),
            what: format!(
                "{episodes} episode(s) make a picture of more than 100 megapixels; choose fewer with --episode, fewer steps with --every, a smaller --zoom, or --figure sheet"
            ),
        }
    }
}

impl Figure {
    /// Every so many of `steps` steps.
    fn every(&self, steps: usize) -> usize {
        self.every.unwrap_or(steps.div_ceil(COLUMNS)).max(1)
    }
}

impl Sink for Picture {
    fn take(&mut self, run: &Run) -> Result<(), ExportError> {
        self.provenance = Some(Arc::clone(&run.provenance));
        let block = match self.figure.kind {
            Kind::Strip => strip::strip(run, self.figure),
            Kind::Sheet => sheet::sheet(run, self.figure, self.blocks.is_empty()),
        };
        let Some(block) = block else {
            return Err(self.too_large(self.blocks.len() + 1));
        };
        self.blocks.push(block);
        let width = self.blocks.iter().map(Canvas::width).max().unwrap_or(0);
        let height: usize = self.blocks.iter().map(Canvas::height).sum();
        if width * height > PIXELS_LIMIT {
            return Err(self.too_large(self.blocks.len()));
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), ExportError> {
        if self.figure.kind == Kind::Strip {
            self.blocks.push(strip::legend());
        }
        let picture = Canvas::stack(&self.blocks);
        let facts = self.provenance.map(|provenance| provenance.facts());
        let mut facts = facts.unwrap_or_default();
        facts.extend(encode::about(self.figure));
        let size = [picture.width(), picture.height()];
        save(self.output, size, picture.pixels(), &facts)
    }
}

/// Writes a picture of so many columns and rows, row major, with facts about it as text chunks.
///
/// # Errors
/// If it cannot be written.
pub fn save(
    mut output: Output,
    size: [usize; 2],
    pixels: &[[u8; 3]],
    facts: &BTreeMap<String, String>,
) -> Result<(), ExportError> {
    encode::write(size, pixels, facts, &mut output)?;
    output.commit()
}
