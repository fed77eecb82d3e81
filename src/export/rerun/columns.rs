//! Columns on the three timelines. Every entity is on all of them, so that none goes empty when one changes over.

use std::collections::BTreeSet;

use ::rerun::components::{Color, ImageBuffer, ImageFormat};
use ::rerun::datatypes::{ChannelDatatype, ColorModel};
use ::rerun::{
    Arrows3D, Boxes3D, Image, LineStrips3D, RecordingStream, RecordingStreamResult, Scalars,
    TimeColumn,
};

use super::style;
use crate::episode::{Episode, Track};

/// The step as on screen, from 1.
pub(super) const STEP: &str = "step";
/// Seconds since the first image.
const SECS: &str = "t";
/// When it was measured.
const STAMP: &str = "stamp";
/// Rows of a column; longer ones are cut, so that a viewer can load a part.
const ROWS: usize = 4096;

/// When the steps of an episode were.
pub(super) struct Clock(Vec<i64>);

impl Clock {
    pub(super) fn of(episode: &Episode) -> Self {
        Self(episode.steps_nanos.clone())
    }

    /// Of images and what is made of them; `steps` from 0.
    fn of_steps(&self, steps: &[usize]) -> [TimeColumn; 3] {
        let stamps: Vec<i64> = steps.iter().map(|&step| self.stamp(step)).collect();
        self.columns(steps.iter().map(|&step| step as i64 + 1), &stamps)
    }

    /// The step that a sample leads up to; the last one for those after it.
    fn step_of(&self, stamp: i64) -> usize {
        let last = self.0.len().saturating_sub(1);
        self.0.partition_point(|&own| own < stamp).min(last)
    }

    /// Of samples on a clock of their own.
    fn of_stamps(&self, stamps: &[i64]) -> [TimeColumn; 3] {
        let steps = stamps.iter().map(|&stamp| self.step_of(stamp) as i64 + 1);
        self.columns(steps, stamps)
    }

    fn columns(&self, steps: impl Iterator<Item = i64>, stamps: &[i64]) -> [TimeColumn; 3] {
        let first = self.stamp(0);
        let secs = stamps.iter().map(|stamp| (stamp - first) as f64 * 1e-9);
        [
            TimeColumn::new_sequence(STEP, steps),
            TimeColumn::new_duration_secs(SECS, secs),
            TimeColumn::new_timestamp_nanos_since_epoch(STAMP, stamps.iter().copied()),
        ]
    }

    fn stamp(&self, step: usize) -> i64 {
        self.0.get(step).copied().unwrap_or_default()
    }
}

/// Rows of numbers with the steps they are of; all as long as the first, or they could not be one entity.
#[derive(Default)]
pub(super) struct Rows {
    steps: Vec<usize>,
    values: Vec<f64>,
    width: usize,
}

impl Rows {
    /// Adds a row, unless it has another length or a number that is none.
    pub(super) fn push(&mut self, step: usize, row: &[f32]) {
        if self.width == 0 {
            self.width = row.len();
        }
        if row.len() == self.width && row.iter().all(|value| value.is_finite()) {
            self.steps.push(step);
            self.values.extend(row.iter().copied().map(f64::from));
        }
    }

    /// Logs them, if there are any.
    pub(super) fn log(
        &self,
        stream: &RecordingStream,
        clock: &Clock,
        path: &str,
    ) -> RecordingStreamResult<()> {
        let values = self.values.chunks(ROWS * self.width.max(1));
        for (steps, values) in self.steps.chunks(ROWS).zip(values) {
            scalars(stream, path, clock.of_steps(steps), self.width, values)?;
        }
        Ok(())
    }
}

/// What sensors said before some steps, as it was sampled.
pub(super) struct Samples<'a> {
    pub(super) stream: &'a RecordingStream,
    pub(super) clock: &'a Clock,
    /// From 0.
    pub(super) steps: &'a BTreeSet<usize>,
}

impl Samples<'_> {
    /// Those of one sensor.
    pub(super) fn log<const N: usize>(
        &self,
        path: &str,
        track: &Track<N>,
    ) -> RecordingStreamResult<()> {
        let all = track.stamps_nanos.iter().zip(&track.values);
        let theirs = all.filter(|(stamp, _)| self.steps.contains(&self.clock.step_of(**stamp)));
        let (stamps, values): (Vec<i64>, Vec<[f64; N]>) = theirs.unzip();
        for (stamps, values) in stamps.chunks(ROWS).zip(values.chunks(ROWS)) {
            let times = self.clock.of_stamps(stamps);
            scalars(self.stream, path, times, N, values.as_flattened())?;
        }
        Ok(())
    }
}

fn scalars(
    stream: &RecordingStream,
    path: &str,
    times: [TimeColumn; 3],
    width: usize,
    values: &[f64],
) -> RecordingStreamResult<()> {
    let rows = values.len() / width.max(1);
    let columns = Scalars::new(values.iter().copied()).columns(vec![width; rows])?;
    stream.send_columns(path, times, columns)
}

/// Pictures of one entity.
pub(super) struct Pictures {
    /// Columns and rows of each.
    pub(super) size: [usize; 2],
    /// Grey, or red, green and blue.
    pub(super) model: ColorModel,
    /// The step of each, and its bytes; none where there is no picture, so that an earlier one does not stay.
    pub(super) rows: Vec<(usize, Option<Vec<u8>>)>,
}

impl Pictures {
    pub(super) fn log(
        self,
        stream: &RecordingStream,
        clock: &Clock,
        path: &str,
    ) -> RecordingStreamResult<()> {
        if self.rows.iter().all(|(_, bytes)| bytes.is_none()) {
            return Ok(());
        }
        let size = self.size.map(|side| side as u32);
        let format = ImageFormat::from_color_model(size, self.model, ChannelDatatype::U8);
        stream.log_static(
            path,
            &Image::update_fields()
                .with_format(format)
                .with_magnification_filter(style::NEAREST),
        )?;
        let steps: Vec<usize> = self.rows.iter().map(|(step, _)| *step).collect();
        let lengths: Vec<usize> = self
            .rows
            .iter()
            .map(|(_, bytes)| usize::from(bytes.is_some()))
            .collect();
        let buffers = self
            .rows
            .into_iter()
            .filter_map(|(_, bytes)| bytes)
            .map(ImageBuffer::from);
        let columns = Image::update_fields()
            .with_many_buffer(buffers)
            .columns(lengths)?;
        stream.send_columns(path, clock.of_steps(&steps), columns)
    }
}

/// A line, a box or an arrow that is there at some steps.
pub(super) struct Shapes<T> {
    steps: Vec<usize>,
    shapes: Vec<Option<T>>,
}

impl<T> Shapes<T> {
    pub(super) fn new(rows: impl IntoIterator<Item = (usize, Option<T>)>) -> Self {
        let (steps, shapes) = rows.into_iter().unzip();
        Self { steps, shapes }
    }

    fn is_empty(&self) -> bool {
        self.shapes.iter().all(Option::is_none)
    }

    fn lengths(&self) -> Vec<usize> {
        self.shapes
            .iter()
            .map(|shape| usize::from(shape.is_some()))
            .collect()
    }
}

impl Shapes<Vec<[f32; 3]>> {
    /// Through points in metres.
    pub(super) fn log_lines(
        self,
        stream: &RecordingStream,
        clock: &Clock,
        path: &str,
        color: Color,
        radius: f32,
    ) -> RecordingStreamResult<()> {
        if self.is_empty() {
            return Ok(());
        }
        stream.log_static(
            path,
            &LineStrips3D::update_fields()
                .with_colors([color])
                .with_radii([radius]),
        )?;
        let times = clock.of_steps(&self.steps);
        let lengths = self.lengths();
        let columns = LineStrips3D::new(self.shapes.into_iter().flatten()).columns(lengths)?;
        stream.send_columns(path, times, columns)
    }
}

impl Shapes<[[f32; 3]; 2]> {
    /// From a point by a vector, in metres.
    pub(super) fn log_arrows(
        self,
        stream: &RecordingStream,
        clock: &Clock,
        path: &str,
        color: Color,
        radius: f32,
    ) -> RecordingStreamResult<()> {
        if self.is_empty() {
            return Ok(());
        }
        stream.log_static(
            path,
            &Arrows3D::update_fields()
                .with_colors([color])
                .with_radii([radius]),
        )?;
        let times = clock.of_steps(&self.steps);
        let lengths = self.lengths();
        let shapes: Vec<[[f32; 3]; 2]> = self.shapes.into_iter().flatten().collect();
        let columns = Arrows3D::from_vectors(shapes.iter().map(|[_, vector]| *vector))
            .with_origins(shapes.iter().map(|[origin, _]| *origin))
            .columns(lengths)?;
        stream.send_columns(path, times, columns)
    }
}

impl Shapes<([f32; 3], f32)> {
    /// Boxes at a place in metres, turned about the vertical by radians.
    pub(super) fn log_boxes(
        self,
        stream: &RecordingStream,
        clock: &Clock,
        path: &str,
        solid: &Boxes3D,
    ) -> RecordingStreamResult<()> {
        if self.is_empty() {
            return Ok(());
        }
        stream.log_static(path, solid)?;
        let times = clock.of_steps(&self.steps);
        let lengths = self.lengths();
        let places: Vec<([f32; 3], f32)> = self.shapes.into_iter().flatten().collect();
        let columns = Boxes3D::update_fields()
            .with_centers(places.iter().map(|(at, _)| *at))
            .with_quaternions(places.iter().map(|(_, yaw)| {
                let (sin, cos) = (0.5 * yaw).sin_cos();
                ::rerun::Quaternion::from_xyzw([0.0, 0.0, sin, cos])
            }))
            .columns(lengths)?;
        stream.send_columns(path, times, columns)
    }
}
