//! A frame to a client: messages, compressed, and behind them the buffers of their arrays.
//!
//! ```text
//! u64 length of the msgpack │ u64 length of the zstd frame │ zstd frame │ pad to 8, buffer 0 │ pad to 8, buffer 1 …
//! ```

use std::io;

use super::array::{DTYPES, WRITTEN};
use super::pack::{Reader, Token, put_array, put_count, put_map, put_name};

/// Messages in one frame at most.
pub const WINDOW: usize = 128;
/// The client allocates what the header says and decodes faster than it downloads.
const LEVEL: i32 = 1;

/// Writes a frame of written messages; `secs` is the server's own clock at this moment.
pub fn encode<'a>(
    messages: impl ExactSizeIterator<Item = &'a [u8]>,
    secs: f64,
) -> io::Result<Vec<u8>> {
    let mut packed = Vec::new();
    let mut buffers = Vec::new();
    put_map(&mut packed, 3);
    put_name(&mut packed, "messages");
    put_array(&mut packed, messages.len());
    for message in messages {
        place(message, &mut packed, &mut buffers);
    }
    put_name(&mut packed, "timestampSec");
    packed.push(0xcb);
    packed.extend(secs.to_bits().to_be_bytes());
    put_name(&mut packed, "binaryBufferLengths");
    put_array(&mut packed, buffers.len());
    for buffer in &buffers {
        put_count(&mut packed, buffer.len());
    }

    let compressed = zstd::bulk::compress(&packed, LEVEL)?;
    let room: usize = buffers.iter().map(|buffer| buffer.len() + 8).sum();
    let mut frame = Vec::with_capacity(16 + compressed.len() + room);
    frame.extend((packed.len() as u64).to_le_bytes());
    frame.extend((compressed.len() as u64).to_le_bytes());
    frame.extend(compressed);
    for buffer in buffers {
        frame.resize(frame.len().next_multiple_of(8), 0);
        frame.extend(buffer);
    }
    Ok(frame)
}

/// Copies a value; arrays become placeholders, and what was written before takes the place of its extension.
fn place<'a>(value: &'a [u8], out: &mut Vec<u8>, buffers: &mut Vec<&'a [u8]>) {
    let mut reader = Reader::new(value);
    loop {
        let before = reader.rest();
        let Some(token) = reader.token() else {
            return;
        };
        match token {
            Token::Ext(WRITTEN, inside) => place(inside, out, buffers),
            Token::Ext(tag, bytes) => {
                let dtype = usize::try_from(tag).ok().and_then(|tag| DTYPES.get(tag));
                put_map(out, 2);
                put_name(out, "__binary_index");
                put_count(out, buffers.len());
                put_name(out, "dtype");
                put_name(out, dtype.unwrap_or(&"|u1"));
                buffers.push(bytes);
            }
            _ => out.extend(&before[..before.len() - reader.rest().len()]),
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use serde_json::json;

    use super::super::array::{Array, Written};
    use super::super::frame;
    use super::*;

    #[test]
    fn arrays_go_behind_and_start_at_multiples_of_eight() {
        let bytes = Array::u8([1, 2, 3]);
        let numbers = Array::f64([0.5, -1.0]);
        let first = rmp_serde::to_vec_named(&[&bytes, &numbers]).unwrap();
        let second = rmp_serde::to_vec_named(&[Written(&first)]).unwrap();
        let frame = encode([&first[..], &second[..]].into_iter(), 1.5).unwrap();
        let read = frame::read(&frame).unwrap();
        assert!((read.secs - 1.5).abs() < f64::EPSILON);
        let arrays = json!([
            {"dtype": "|u1", "values": [1, 2, 3]},
            {"dtype": "<f8", "values": [0.5, -1.0]}
        ]);
        assert_eq!(read.messages, [arrays.clone(), json!([arrays])]);
    }
}
