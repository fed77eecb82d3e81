//! The fast way to an index: the summary section at a file's end. Anything it leaves out or gets wrong is no error but
//! a reason to take the slow way, [`super::scan`].

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use mcap::MAGIC;
use mcap::records::{MetadataIndex, Record, Statistics, op};

use super::chunk::parse;
use super::index::Index;
use super::record::{HEAD, LENGTH_LIMIT, Records, split_head};

/// Footer record and end magic.
const TAIL: u64 = 9 + 20 + 8;
/// The part of the footer that the summary's checksum covers: head, two offsets.
const FOOTER_CHECKED: usize = 9 + 16;

/// Reads the index of a file of `length` bytes.
///
/// # Errors
/// A phrase that says why the summary cannot be used.
pub(super) fn read(file: &mut File, length: u64) -> Result<Index, String> {
    let bytes = summary_and_footer(file, length)?;
    let section = &bytes[..bytes.len() - FOOTER_CHECKED];
    let mut index = Index {
        bytes: length,
        ..Index::default()
    };
    let header = record_at(file, length, MAGIC.len() as u64)?;
    index.describe(parse(op::HEADER, &header)?);
    let mut statistics = None;
    let mut unpacked = Vec::new();
    let mut metadata = Vec::new();
    for record in Records::new(section) {
        let (opcode, body) = record?;
        match parse(opcode, body)? {
            Record::Statistics(found) => statistics = Some(found),
            Record::MetadataIndex(found) => metadata.push(found),
            Record::ChunkIndex(chunk) => {
                index.chunk(&chunk.compression);
                if chunk.compression.is_empty() {
                    unpacked.push(chunk.chunk_start_offset);
                }
                index.spans.push(chunk.into());
            }
            described => index.describe(described),
        }
    }
    let statistics = statistics.ok_or("the summary has no statistics")?;
    check_complete(&index, &statistics, &metadata)?;
    index.spans.sort_by_key(|span| span.offset);
    for found in metadata.iter().filter(|found| found.name == "episode") {
        let body = record_at(file, length, found.offset)?;
        index.describe(parse(op::METADATA, &body)?);
    }
    if statistics.message_count > 0 {
        index.log_times = Some((statistics.message_start_time, statistics.message_end_time));
    }
    index.counts = statistics.channel_message_counts;
    let mut indexing = bytes;
    for offset in unpacked {
        indexing.extend(chunk_sum(file, offset)?);
    }
    index.seal(&indexing);
    Ok(index)
}

/// The checksum that a chunk says of itself. What is packed shows in its length; of two chunks that are not, an index has
/// nothing that tells them apart.
fn chunk_sum(file: &mut File, offset: u64) -> Result<[u8; 4], String> {
    // Before it stand the first and last log time and the size.
    let mut head = [0; HEAD + 3 * 8 + 4];
    read_at(file, offset, &mut head)?;
    let [.., a, b, c, d] = head;
    Ok([a, b, c, d])
}

/// The bytes from the summary's first to the end of what its checksum covers.
fn summary_and_footer(file: &mut File, length: u64) -> Result<Vec<u8>, String> {
    let tail_start = length
        .checked_sub(TAIL)
        .ok_or("it is too short for a footer")?;
    let mut tail = [0; TAIL as usize];
    read_at(file, tail_start, &mut tail)?;
    if tail[HEAD + 20..] != *MAGIC {
        return Err("its end is missing".to_owned());
    }
    let Ok(Record::Footer(footer)) = parse(tail[0], &tail[HEAD..HEAD + 20]) else {
        return Err("its footer is damaged".to_owned());
    };
    if footer.summary_start == 0 {
        return Err("it has no summary".to_owned());
    }
    let size = tail_start
        .checked_sub(footer.summary_start)
        .and_then(|size| usize::try_from(size).ok())
        .filter(|&size| size <= LENGTH_LIMIT * 4)
        .ok_or("its footer points nowhere")?;
    let mut bytes = vec![0; size + FOOTER_CHECKED];
    read_at(file, footer.summary_start, &mut bytes)?;
    if footer.summary_crc != 0 && footer.summary_crc != crc32fast::hash(&bytes) {
        return Err("its summary's checksum does not hold".to_owned());
    }
    Ok(bytes)
}

/// Whether the summary says enough to find every message.
fn check_complete(
    index: &Index,
    statistics: &Statistics,
    metadata: &[MetadataIndex],
) -> Result<(), String> {
    let counted: u64 = statistics.channel_message_counts.values().sum();
    if counted != statistics.message_count {
        return Err("its summary does not count messages by channel".to_owned());
    }
    if index.spans.len() != statistics.chunk_count as usize
        || (statistics.message_count > 0 && index.spans.is_empty())
    {
        return Err("its summary does not index its chunks".to_owned());
    }
    if metadata.len() != statistics.metadata_count as usize {
        return Err("its summary does not index its metadata".to_owned());
    }
    let known = |id: &u16| {
        index.channels.get(id).is_some_and(|channel| {
            channel.schema_id == 0 || index.schemas.contains_key(&channel.schema_id)
        })
    };
    if !statistics.channel_message_counts.keys().all(known) {
        return Err("its summary does not repeat channels and schemas".to_owned());
    }
    Ok(())
}

/// The body of the record at `offset`.
pub(super) fn record_at(file: &mut File, length: u64, offset: u64) -> Result<Vec<u8>, String> {
    let mut head = [0; HEAD];
    read_at(file, offset, &mut head)?;
    let (_, size) = split_head(head);
    if size > length.saturating_sub(offset) || size > LENGTH_LIMIT as u64 {
        return Err(format!("the record at byte {offset} is too long"));
    }
    let mut body = vec![0; size as usize];
    read_at(file, offset + HEAD as u64, &mut body)?;
    Ok(body)
}

fn read_at(file: &mut File, offset: u64, into: &mut [u8]) -> Result<(), String> {
    file.seek(SeekFrom::Start(offset))
        .and_then(|_| file.read_exact(into))
        .map_err(|error| format!("cannot read at byte {offset}: {error}"))
}
