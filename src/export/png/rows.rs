//! The grid that figures are made of: a column a step, a row a kind of frame, a bar where the context ends.

use super::Figure;
use super::canvas::{BLACK, Canvas, NOTHING, Rgb};
use crate::episode::Frame;
use crate::export::{Run, color};
use crate::session::snapshot::{Snapshot, StripCell};

/// White pixels between frames; the bar where the context ends fills them.
pub const GAP: usize = 2;

/// What a row shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// What was recorded.
    Truth,
    /// The model's prediction, before it the belief.
    Model(usize),
    /// That minus the truth.
    Error(usize),
}

/// The steps and the frames of a figure.
pub struct Grid<'a> {
    run: &'a Run,
    /// Steps that have a column, from 0.
    pub steps: Vec<usize>,
    /// Side of a cell in pixels of the figure.
    pub cell: usize,
    zoom: usize,
}

impl<'a> Grid<'a> {
    /// The exported steps of a run, as a figure wants them.
    pub fn new(run: &'a Run, figure: Figure) -> Self {
        let shown = run.models.first().map_or(&[][..], Vec::as_slice);
        let every = figure.every(shown.len());
        let frames = &run.episode.frames;
        let side = frames.iter().map(|frame| frame.width.max(frame.height));
        Self {
            run,
            steps: shown.iter().step_by(every).map(|at| at.cursor).collect(),
            cell: figure.zoom * side.max().unwrap_or(0),
            zoom: figure.zoom,
        }
    }

    /// Pixels of a row of frames, a gap after each.
    pub fn width(&self) -> usize {
        self.steps.len() * (self.cell + GAP)
    }

    /// Left edge of a column.
    pub fn column(&self, column: usize) -> usize {
        column * (self.cell + GAP)
    }

    /// The first column that shows a prediction; none where none does.
    pub fn first_predicted(&self) -> Option<usize> {
        let start = self.run.models.first()?.first()?.start;
        let column = self.steps.iter().position(|&step| step > start)?;
        let predicted = |step: usize| self.strip_cell(0, step)?.prediction.as_ref();
        predicted(self.steps[column]).map(|_| column)
    }

    /// Draws a row with its left upper corner there.
    pub fn draw(&self, canvas: &mut Canvas, [x, y]: [usize; 2], shows: Shows) {
        for (column, &step) in self.steps.iter().enumerate() {
            let at = [x + self.column(column), y];
            match self.pixels(shows, step) {
                Some((width, pixels)) => canvas.picture(at, width, self.zoom, &pixels),
                None => canvas.fill(at, [self.cell; 2], NOTHING),
            }
        }
    }

    /// Draws the bar where the context ends, down to `bottom`.
    pub fn bar(&self, canvas: &mut Canvas, [x, y]: [usize; 2], bottom: usize) {
        if let Some(column) = self.first_predicted().filter(|&column| column > 0) {
            let left = x + self.column(column) - GAP;
            canvas.fill([left, y], [GAP, bottom.saturating_sub(y)], BLACK);
        }
    }

    fn pixels(&self, shows: Shows, step: usize) -> Option<(usize, Vec<Rgb>)> {
        let grey = |frame: &Frame| {
            let pixels = frame.pixels.iter().map(|&grey| [grey; 3]);
            (frame.width, pixels.collect())
        };
        match shows {
            Shows::Truth => self.run.episode.frames.get(step).map(grey),
            Shows::Model(model) => compared(self.strip_cell(model, step)?).map(grey),
            Shows::Error(model) => {
                let cell = self.strip_cell(model, step)?;
                let frame = compared(cell)?;
                Some((frame.width, color::error(frame, &cell.truth)?))
            }
        }
    }

    fn strip_cell(&self, model: usize, step: usize) -> Option<&'a StripCell> {
        let snapshot: &Snapshot = self.run.models.get(model)?.first()?;
        snapshot.strip.get(step)
    }
}

fn compared(cell: &StripCell) -> Option<&Frame> {
    cell.prediction.as_deref().or(cell.belief.as_deref())
}
