//! The other side of [`super::batch`]: what a client makes of a frame. For tests and benches, which are clients.

use serde_json::{Map, Number, Value, json};
use thiserror::Error;

use super::pack::{Reader, Token};

/// No frame holds more; the length in its header is not believed beyond it.
const LARGEST: usize = 64 << 20;

/// A frame, read.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The server's clock.
    pub secs: f64,
    /// The messages; an array is `{"dtype", "values"}`, bytes are `{"bin": [..]}`.
    pub messages: Vec<Value>,
}

/// It is no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("not a frame: {0}")]
pub struct Malformed(&'static str);

/// Reads a frame.
pub fn read(frame: &[u8]) -> Result<Frame, Malformed> {
    let length = |at: usize| {
        let bytes = frame.get(at..at + 8)?;
        let number = bytes.try_into().map(u64::from_le_bytes).ok()?;
        usize::try_from(number)
            .ok()
            .filter(|&length| length <= LARGEST)
    };
    let packed = length(0).ok_or(Malformed("no length"))?;
    let end = length(8)
        .map(|length| 16 + length)
        .ok_or(Malformed("no length"))?;
    let compressed = frame.get(16..end).ok_or(Malformed("cut off"))?;
    let packed = zstd::bulk::decompress(compressed, packed).map_err(|_| Malformed("no zstd"))?;
    let mut reader = Reader::new(&packed);
    let mut whole = json(&mut reader, 0).ok_or(Malformed("no msgpack"))?;
    let lengths: Option<Vec<usize>> = whole["binaryBufferLengths"].as_array().and_then(|lengths| {
        lengths
            .iter()
            .map(|length| length.as_u64().map(|l| l as usize))
            .collect()
    });
    let mut buffers = Vec::new();
    let mut at = end;
    for length in lengths.ok_or(Malformed("no buffer lengths"))? {
        at = at.next_multiple_of(8);
        let end = at.checked_add(length).ok_or(Malformed("no buffer"))?;
        buffers.push(frame.get(at..end).ok_or(Malformed("no buffer"))?);
        at = end;
    }
    if at != frame.len() {
        return Err(Malformed("more behind the last buffer"));
    }
    let Value::Array(mut messages) = whole["messages"].take() else {
        return Err(Malformed("no messages"));
    };
    for message in &mut messages {
        fill(message, &buffers);
    }
    Ok(Frame {
        secs: whole["timestampSec"]
            .as_f64()
            .ok_or(Malformed("no clock"))?,
        messages,
    })
}

fn json(reader: &mut Reader, depth: usize) -> Option<Value> {
    if depth > 32 {
        return None;
    }
    Some(match reader.token()? {
        Token::Nil | Token::Ext(..) => Value::Null,
        Token::Bool(it) => Value::Bool(it),
        Token::Int(it) => Value::Number(Number::from_i128(it)?),
        Token::Float(it) => json!(it),
        Token::Text(it) => json!(it),
        Token::Bin(it) => json!({ "bin": it }),
        Token::Array(count) => {
            let values = (0..count).map(|_| json(reader, depth + 1));
            Value::Array(values.collect::<Option<_>>()?)
        }
        Token::Map(count) => {
            let mut map = Map::new();
            for _ in 0..count {
                let Token::Text(key) = reader.token()? else {
                    return None;
                };
                map.insert(key.to_owned(), json(reader, depth + 1)?);
            }
            Value::Object(map)
        }
    })
}

/// Puts arrays in the places of their placeholders.
fn fill(value: &mut Value, buffers: &[&[u8]]) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|value| fill(value, buffers)),
        Value::Object(map) => {
            let index = map.get("__binary_index").and_then(Value::as_u64);
            let dtype = map.get("dtype").and_then(Value::as_str);
            if let (Some(index), Some(dtype)) = (index, dtype) {
                let numbers = buffers
                    .get(index as usize)
                    .map(|buffer| numbers(buffer, dtype));
                *value = json!({ "dtype": dtype, "values": numbers });
            } else {
                map.values_mut().for_each(|value| fill(value, buffers));
            }
        }
        _ => {}
    }
}

fn numbers(buffer: &[u8], dtype: &str) -> Vec<Value> {
    match dtype {
        "<f4" => chunks(buffer, |bytes| json!(f32::from_le_bytes(bytes))),
        "<f8" => chunks(buffer, |bytes| json!(f64::from_le_bytes(bytes))),
        "<u4" => chunks(buffer, |bytes| json!(u32::from_le_bytes(bytes))),
        _ => buffer.iter().map(|byte| json!(byte)).collect(),
    }
}

fn chunks<const N: usize>(buffer: &[u8], number: impl Fn([u8; N]) -> Value) -> Vec<Value> {
    buffer
        .as_chunks()
        .0
        .iter()
        .map(|&bytes| number(bytes))
        .collect()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use proptest::prelude::*;

    use super::super::{batch, pack, replay::ReplayDone};
    use super::*;

    #[test]
    fn every_captured_frame_can_be_read() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/viser");
        let mut read_ones = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if name.starts_with("s2c_") {
                let frame = read(&std::fs::read(&path).unwrap());
                assert!(
                    frame.is_ok_and(|frame| !frame.messages.is_empty()),
                    "{name}"
                );
                read_ones += 1;
            }
        }
        assert!(read_ones > 20, "{read_ones}");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..96)) {
            let _ = read(&bytes);
        }

        #[test]
        fn a_frame_cut_off_is_refused(part in 0.0..1.0_f64) {
            let done = super::super::write(&ReplayDone {});
            let frame = batch::encode([&done[..]].into_iter(), 0.0).unwrap();
            let cut = (frame.len() as f64 * part) as usize;
            prop_assert!(read(&frame[..cut]).is_err());
            prop_assert!(pack::entries(&done).is_some());
        }
    }
}
