//! The picture as a PNG file, with where it comes from in its text chunks.

use std::collections::BTreeMap;

use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::{Figure, Kind};
use crate::export::output::Output;
use crate::export::{ExportError, color};

/// Writes a picture of so many columns and rows.
pub(super) fn write(
    [width, height]: [usize; 2],
    pixels: &[[u8; 3]],
    facts: &BTreeMap<String, String>,
    output: &mut Output,
) -> Result<(), ExportError> {
    let path = output.path().to_owned();
    let failed = |error: EncodingError| match error {
        EncodingError::IoError(cause) => ExportError::Io {
            path: path.clone(),
            cause,
        },
        other => ExportError::Format {
            path: path.clone(),
            what: other.to_string(),
        },
    };
    let mut encoder = Encoder::new(output, width as u32, height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    for (key, value) in facts {
        let key = format!("poescope.{key}");
        // Plain text chunks are Latin-1; names of models and episodes need not be.
        let added = if value.is_ascii() {
            encoder.add_text_chunk(key, value.clone())
        } else {
            encoder.add_itxt_chunk(key, value.clone())
        };
        added.map_err(&failed)?;
    }
    let mut writer = encoder.write_header().map_err(&failed)?;
    writer
        .write_image_data(pixels.as_flattened())
        .and_then(|()| writer.finish())
        .map_err(&failed)
}

/// How to read the picture.
pub(super) fn about(figure: Figure) -> BTreeMap<String, String> {
    let (name, rows) = match figure.kind {
        Kind::Strip => (
            "strip",
            "truth; then for each model its frames and their error",
        ),
        Kind::Sheet => ("sheet", "for each episode truth, then each model's frames"),
    };
    let error = format!(
        "frame minus truth; blue, white, orange from -{0} to {0} of 255 grey levels, beyond them as at the ends",
        color::ERROR_RANGE
    );
    BTreeMap::from([
        ("figure".to_owned(), name.to_owned()),
        ("rows".to_owned(), rows.to_owned()),
        (
            "frames".to_owned(),
            "of a model: the prediction where there is one, else the belief".to_owned(),
        ),
        ("error".to_owned(), error),
        ("zoom".to_owned(), figure.zoom.to_string()),
    ])
}
