//! The records inside a span of a file's data section: a chunk, unpacked and checked, or plain messages.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::record::{LENGTH_LIMIT, Records};

/// Calls `each` with every record of `span`, going into chunks. A chunk whose checksum does not hold, or that cannot
/// be unpacked, is an error before any of its records is seen.
///
/// # Errors
/// A phrase that says what is damaged.
pub(super) fn for_each_record(
    span: &[u8],
    mut each: impl FnMut(u8, &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    for record in Records::new(span) {
        let (opcode, body) = record?;
        if opcode != op::CHUNK {
            each(opcode, body)?;
            continue;
        }
        let Record::Chunk { header, data } = parse(opcode, body)? else {
            continue;
        };
        if header.compression.is_empty() {
            let calculated = crc32fast::hash(&data);
            if header.uncompressed_crc != 0 && header.uncompressed_crc != calculated {
                return Err("the chunk's checksum does not hold".to_owned());
            }
            for inner in Records::new(&data) {
                let (opcode, body) = inner?;
                each(opcode, body)?;
            }
        } else {
            unpack(body, &mut each)?;
        }
    }
    Ok(())
}

/// Unpacks one compressed chunk record by feeding it to the container's reader.
fn unpack(
    body: &[u8],
    each: &mut impl FnMut(u8, &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(LENGTH_LIMIT);
    let mut reader = LinearReader::new_with_options(options);
    let mut head = vec![op::CHUNK];
    head.extend_from_slice(&(body.len() as u64).to_le_bytes());
    let mut parts = [head.as_slice(), body];
    loop {
        match reader.next_event() {
            None => return Ok(()),
            Some(Ok(LinearReadEvent::Record { opcode, data })) => each(opcode, data)?,
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                let part = usize::from(parts[0].is_empty());
                let (given, rest) = parts[part].split_at(wanted.min(parts[part].len()));
                reader.insert(given.len()).copy_from_slice(given);
                reader.notify_read(given.len());
                parts[part] = rest;
            }
            Some(Err(error)) => return Err(error.to_string()),
        }
    }
}

/// Parses a record's body.
///
/// # Errors
/// A phrase that says what is damaged.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    mcap::parse_record(opcode, body)
        .map_err(|error| format!("a record (opcode {opcode:#04x}) does not parse: {error}"))
}
