//! The picture as a PNG file, with where it comes from in its text chunks.

use std::collections::BTreeMap;

use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::{Figure, Kind};
use crate::export::output::Output;
use crate::export::{ExportError, color};

/// The longest keyword that PNG has room for.
const KEYWORD: usize = 79;

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
        let key = keyword(key);
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

/// A longer one is cut in its middle: its ends say what it is and tell models of one name apart.
fn keyword(key: &str) -> String {
    let key = format!("poescope.{key}");
    let letters = key.chars().count();
    if letters <= KEYWORD {
        return key;
    }
    let half = KEYWORD / 2;
    let (start, end) = (key.chars().take(half), key.chars().skip(letters - half));
    start.chain(['~']).chain(end).collect()
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

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;

    #[test]
    fn a_model_may_have_a_long_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let name = "long".repeat(30);
        let keys = [format!("model.{name}.hash"), format!("model.{name}_2.hash")];
        let facts = BTreeMap::from(keys.map(|key| (key, "1".to_owned())));
        let output = Output::create(&path, false).unwrap();
        crate::export::png::save(output, [1, 1], &[[0; 3]], &facts).unwrap();
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let reader = png::Decoder::new(file).read_info().unwrap();
        let texts = &reader.info().uncompressed_latin1_text;
        let [one, two] = &texts[..] else {
            panic!("two facts");
        };
        assert_ne!(one.keyword, two.keyword);
        let ends = [&one.keyword[..19], &one.keyword[KEYWORD - 5..]];
        assert_eq!(ends, ["poescope.model.long", ".hash"]);
    }
}
