//! Unpacks a span of a file's data section into a block of plain records.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::record::{HEAD, Records, put_record};

/// An unpacked chunk is no larger: writers make them of some MiB.
const CHUNK_LIMIT: usize = 256 << 20;

/// The records of `span`, those of its chunks in their place. A chunk's checksum is verified, which the container's
/// own indexed reader never does.
///
/// # Errors
/// A phrase that says what is damaged.
pub(super) fn unpack(span: &[u8]) -> Result<Vec<u8>, String> {
    let mut block = Vec::new();
    for record in Records::new(span) {
        let (opcode, body) = record?;
        if opcode != op::CHUNK {
            put_record(&mut block, opcode, body);
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
            block.extend_from_slice(&data);
        } else {
            // The reader holds what it unpacks to the size that is said.
            let said = header.uncompressed_size;
            let size = usize::try_from(said)
                .ok()
                .filter(|&size| size <= CHUNK_LIMIT);
            let limit = CHUNK_LIMIT >> 20;
            let size = size.ok_or_else(|| {
                format!("a chunk of {said} bytes, where {limit} MiB are read at most; write it in smaller ones")
            })?;
            block.reserve(size);
            decompress(body, &mut block)?;
        }
    }
    Ok(block)
}

/// Decompresses one chunk record by feeding it to the container's reader.
fn decompress(body: &[u8], block: &mut Vec<u8>) -> Result<(), String> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(CHUNK_LIMIT);
    let mut reader = LinearReader::new_with_options(options);
    let mut head = Vec::with_capacity(HEAD);
    put_record(&mut head, op::CHUNK, &[]);
    head[1..].copy_from_slice(&(body.len() as u64).to_le_bytes());
    let mut parts = [head.as_slice(), body];
    loop {
        match reader.next_event() {
            None => return Ok(()),
            Some(Ok(LinearReadEvent::Record { opcode, data })) => put_record(block, opcode, data),
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
    if opcode == op::ATTACHMENT {
        // Nothing here wants one, and the container's parser panics at one that is too short.
        let data = body.into();
        return Ok(Record::Unknown { opcode, data });
    }
    mcap::parse_record(opcode, body)
        .map_err(|error| format!("a record (opcode {opcode:#04x}) does not parse: {error}"))
}
