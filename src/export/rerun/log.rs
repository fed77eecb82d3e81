//! A stream with an episode's clock: what is logged goes as whole columns, on three timelines. Every entity is on all of
//! them, so that none goes empty when one changes over.

use std::collections::BTreeSet;

use ::rerun::components::{FillMode, ImageBuffer, ImageFormat};
use ::rerun::datatypes::{ChannelDatatype, ColorModel};
use ::rerun::{
    Arrows3D, AsComponents, Boxes3D, Image, LineStrips3D, Quaternion, RecordingStream,
    RecordingStreamResult, Scalars, SerializationResult, SerializedComponentColumn, SeriesLines,
    TimeColumn,
};

use super::style::{NEAREST, Rgb, color};
use crate::episode::{Episode, Track};

/// The step as on screen, from 1.
pub(super) const STEP: &str = "step";
/// Seconds since the first image.
const SECS: &str = "t";
/// When it was measured.
const STAMP: &str = "stamp";
/// Rows of a column; longer ones are cut, so that a viewer can load a part.
const ROWS: usize = 4096;

/// What is there at some steps, from 0; none where there is nothing, so that an earlier one does not stay.
pub(super) type AtSteps<T> = Vec<(usize, Option<T>)>;

/// Where all of it is logged to.
pub(super) struct Log<'a> {
    stream: &'a RecordingStream,
    /// Stamps of the steps.
    steps_nanos: &'a [i64],
}

impl<'a> Log<'a> {
    pub(super) fn new(stream: &'a RecordingStream, episode: &'a Episode) -> Self {
        Self {
            stream,
            steps_nanos: &episode.steps_nanos,
        }
    }

    /// Something that is there at every time.
    pub(super) fn always(&self, path: &str, what: &impl AsComponents) -> RecordingStreamResult<()> {
        self.stream.log_static(path, what)
    }

    /// Names the series of an entity; one colour makes all of them alike, none leaves it to the viewer.
    pub(super) fn names(
        &self,
        path: &str,
        names: impl IntoIterator<Item = String>,
        rgb: Option<Rgb>,
    ) -> RecordingStreamResult<()> {
        let lines = SeriesLines::new().with_names(names);
        match rgb {
            Some(rgb) => self.always(path, &lines.with_colors([color(rgb)])),
            None => self.always(path, &lines),
        }
    }

    /// Rows of numbers, all as long as the first, or they could not be one entity; one with a number that is none is
    /// left out.
    pub(super) fn numbers<R: AsRef<[f32]>>(
        &self,
        path: &str,
        rows: impl IntoIterator<Item = (usize, R)>,
    ) -> RecordingStreamResult<()> {
        let (mut steps, mut values, mut width) = (Vec::new(), Vec::new(), 0);
        for (step, row) in rows {
            let row = row.as_ref();
            if steps.is_empty() {
                width = row.len();
            }
            if row.len() == width && row.iter().all(|value| value.is_finite()) {
                steps.push(step);
                values.extend(row.iter().copied().map(f64::from));
            }
        }
        let values = values.chunks(ROWS * width.max(1));
        for (steps, values) in steps.chunks(ROWS).zip(values) {
            self.scalars(path, self.at_steps(steps), width, values)?;
        }
        Ok(())
    }

    /// What a sensor said before some steps, as it was sampled.
    pub(super) fn samples<const N: usize>(
        &self,
        path: &str,
        track: &Track<N>,
        steps: &BTreeSet<usize>,
    ) -> RecordingStreamResult<()> {
        let all = track.stamps_nanos.iter().zip(&track.values);
        let theirs = all.filter(|(stamp, _)| steps.contains(&self.step_of(**stamp)));
        let (stamps, values): (Vec<i64>, Vec<[f64; N]>) = theirs.unzip();
        for (stamps, values) in stamps.chunks(ROWS).zip(values.chunks(ROWS)) {
            self.scalars(path, self.at_stamps(stamps), N, values.as_flattened())?;
        }
        Ok(())
    }

    fn scalars(
        &self,
        path: &str,
        times: [TimeColumn; 3],
        width: usize,
        values: &[f64],
    ) -> RecordingStreamResult<()> {
        let rows = values.len() / width.max(1);
        let columns = Scalars::new(values.iter().copied()).columns(vec![width; rows])?;
        self.stream.send_columns(path, times, columns)
    }

    /// Pictures of this size, columns and rows: bytes row by row, grey or red, green and blue.
    pub(super) fn pictures(
        &self,
        path: &str,
        size: [usize; 2],
        model: ColorModel,
        rows: AtSteps<Vec<u8>>,
    ) -> RecordingStreamResult<()> {
        let size = size.map(|side| side as u32);
        let format = ImageFormat::from_color_model(size, model, ChannelDatatype::U8);
        let look = Image::update_fields()
            .with_format(format)
            .with_magnification_filter(NEAREST);
        self.at_times(path, &look, rows, |bytes, lengths| {
            let buffers = bytes.into_iter().map(ImageBuffer::from);
            Image::update_fields()
                .with_many_buffer(buffers)
                .columns(lengths)
        })
    }

    /// Lines through points, in metres.
    pub(super) fn lines(
        &self,
        path: &str,
        (rgb, radius): (Rgb, f32),
        rows: AtSteps<Vec<[f32; 3]>>,
    ) -> RecordingStreamResult<()> {
        let look = LineStrips3D::update_fields()
            .with_colors([color(rgb)])
            .with_radii([radius]);
        self.at_times(path, &look, rows, |lines, lengths| {
            LineStrips3D::new(lines).columns(lengths)
        })
    }

    /// Arrows from a point by a vector, in metres.
    pub(super) fn arrows(
        &self,
        path: &str,
        (rgb, radius): (Rgb, f32),
        rows: AtSteps<[[f32; 3]; 2]>,
    ) -> RecordingStreamResult<()> {
        let look = Arrows3D::update_fields()
            .with_colors([color(rgb)])
            .with_radii([radius]);
        self.at_times(path, &look, rows, |arrows, lengths| {
            let (origins, vectors): (Vec<_>, Vec<_>) =
                arrows.into_iter().map(|[from, by]| (from, by)).unzip();
            Arrows3D::from_vectors(vectors)
                .with_origins(origins)
                .columns(lengths)
        })
    }

    /// Boxes with these sides at places in metres, turned about the vertical by radians.
    pub(super) fn boxes(
        &self,
        path: &str,
        (sides, rgb, fill): ([f32; 3], Rgb, FillMode),
        rows: AtSteps<([f32; 3], f32)>,
    ) -> RecordingStreamResult<()> {
        let look = Boxes3D::update_fields()
            .with_colors([color(rgb)])
            .with_fill_mode(fill);
        self.at_times(path, &look, rows, |places, lengths| {
            let (centers, turns): (Vec<_>, Vec<_>) = places.into_iter().unzip();
            let turns = turns.into_iter().map(|yaw: f32| {
                let (sin, cos) = (0.5 * yaw).sin_cos();
                Quaternion::from_xyzw([0.0, 0.0, sin, cos])
            });
            // A size that is always there would be drawn at the origin where there is no place.
            Boxes3D::from_half_sizes(vec![sides.map(|side| 0.5 * side); centers.len()])
                .with_centers(centers)
                .with_quaternions(turns)
                .columns(lengths)
        })
    }

    /// One thing that looks the same wherever it is there; nothing where it never is.
    fn at_times<T, C: Iterator<Item = SerializedComponentColumn>>(
        &self,
        path: &str,
        look: &impl AsComponents,
        rows: AtSteps<T>,
        columns: impl FnOnce(Vec<T>, Vec<usize>) -> SerializationResult<C>,
    ) -> RecordingStreamResult<()> {
        let lengths: Vec<usize> = rows
            .iter()
            .map(|(_, it)| usize::from(it.is_some()))
            .collect();
        if !lengths.contains(&1) {
            return Ok(());
        }
        self.always(path, look)?;
        let (steps, things): (Vec<usize>, Vec<Option<T>>) = rows.into_iter().unzip();
        let columns = columns(things.into_iter().flatten().collect(), lengths)?;
        self.stream
            .send_columns(path, self.at_steps(&steps), columns)
    }

    /// The times of images and of what is made of them; `steps` from 0.
    fn at_steps(&self, steps: &[usize]) -> [TimeColumn; 3] {
        let stamps: Vec<i64> = steps.iter().map(|&step| self.stamp(step)).collect();
        self.times(steps.iter().copied(), &stamps)
    }

    /// The times of samples on a clock of their own.
    fn at_stamps(&self, stamps: &[i64]) -> [TimeColumn; 3] {
        self.times(stamps.iter().map(|&stamp| self.step_of(stamp)), stamps)
    }

    fn times(&self, steps: impl Iterator<Item = usize>, stamps: &[i64]) -> [TimeColumn; 3] {
        let first = self.stamp(0);
        let secs = stamps
            .iter()
            .map(|stamp| stamp.saturating_sub(first) as f64 * 1e-9);
        [
            TimeColumn::new_sequence(STEP, steps.map(|step| step as i64 + 1)),
            TimeColumn::new_duration_secs(SECS, secs),
            TimeColumn::new_timestamp_nanos_since_epoch(STAMP, stamps.iter().copied()),
        ]
    }

    /// The step that a sample leads up to; the last one for those after it.
    fn step_of(&self, stamp: i64) -> usize {
        let last = self.steps_nanos.len().saturating_sub(1);
        self.steps_nanos
            .partition_point(|&own| own < stamp)
            .min(last)
    }

    fn stamp(&self, step: usize) -> i64 {
        self.steps_nanos.get(step).copied().unwrap_or_default()
    }
}
