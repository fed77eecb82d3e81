//! The slow way to an index: one pass over the records, for files without a usable summary and for what is left of
//! damaged ones.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};

use mcap::MAGIC;
use mcap::records::{Record, op};

use super::chunk::{parse, unpack};
use super::index::{Index, Span};
use super::record::{HEAD, LENGTH_LIMIT, Records, split_head, split_message};

/// A run of plain messages is cut here, so that reading an episode does not read the whole file.
const RUN_LENGTH: u64 = 1 << 20;

/// Reads through a file of `length` bytes; `why` says what was wrong with its summary.
///
/// # Errors
/// Those of reading the file. Damage is none: what is whole is indexed, and a note says where it ended.
pub(super) fn read(file: &mut File, length: u64, why: &str) -> std::io::Result<Index> {
    let mut index = Index {
        bytes: length,
        scanned: true,
        notes: vec![format!("{why}: the file was read through once")],
        ..Index::default()
    };
    let mut scan = Scan {
        index: &mut index,
        sums: Vec::new(),
        run: None,
    };
    let mut reader = BufReader::with_capacity(1 << 18, file);
    let mut offset = reader.seek(SeekFrom::Start(MAGIC.len() as u64))?;
    let mut body = Vec::new();
    loop {
        let mut head = [0; HEAD];
        match reader.read_exact(&mut head) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                scan.ended(offset);
                break;
            }
            Err(error) => return Err(error),
        }
        let (opcode, size) = split_head(head);
        let next = size
            .checked_add(offset + HEAD as u64)
            .filter(|&next| next <= length);
        let Some(next) = next else {
            scan.ended(offset);
            break;
        };
        if opcode == op::DATA_END || opcode == op::FOOTER {
            break;
        }
        let wanted = matches!(
            opcode,
            op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::METADATA
        );
        if wanted && size <= LENGTH_LIMIT as u64 {
            body.clear();
            body.extend_from_slice(&head);
            body.resize(HEAD + size as usize, 0);
            reader.read_exact(&mut body[HEAD..])?;
            scan.record(offset, opcode, &body);
        } else {
            // What is passed over stands between two runs of messages, and may be larger than any of them.
            scan.close_run();
            if wanted {
                let note = format!("the record at byte {offset} has {size} bytes: left out");
                scan.index.notes.push(note);
            }
            reader.seek_relative(i64::try_from(size).unwrap_or(i64::MAX))?;
        }
        offset = next;
    }
    scan.close_run();
    let sums = scan.sums;
    index.seal(&sums);
    Ok(index)
}

struct Scan<'a> {
    index: &'a mut Index,
    /// What stands for the content in the data hash: a checksum of each record.
    sums: Vec<u8>,
    run: Option<Span>,
}

impl Scan<'_> {
    /// Takes in one whole record of the data section, head included.
    fn record(&mut self, offset: u64, opcode: u8, bytes: &[u8]) {
        self.sums
            .extend_from_slice(&crc32fast::hash(bytes).to_le_bytes());
        if opcode != op::MESSAGE {
            self.close_run();
        }
        let mut seen = Seen::default();
        let index = &mut *self.index;
        if let Err(what) = unpack(bytes).and_then(|block| seen.block(&block, index)) {
            index
                .notes
                .push(format!("damaged at byte {offset}: {what}"));
        }
        if opcode == op::CHUNK {
            let Ok(Record::Chunk { header, .. }) = parse(opcode, &bytes[HEAD..]) else {
                return;
            };
            index.chunk(&header.compression);
            index.spans.push(Span {
                offset,
                length: bytes.len() as u64,
                log_times: (header.message_start_time, header.message_end_time),
                message_indexes: BTreeMap::new(),
            });
        }
        if let Some(log_times) = seen.log_times {
            widen(&mut index.log_times, log_times);
            for (channel, count) in seen.counts {
                *index.counts.entry(channel).or_default() += count;
            }
            if opcode == op::MESSAGE {
                self.extend_run(offset, bytes.len() as u64, log_times);
            }
        }
    }

    fn extend_run(&mut self, offset: u64, length: u64, log_times: (u64, u64)) {
        if self
            .run
            .as_ref()
            .is_some_and(|run| run.length >= RUN_LENGTH)
        {
            self.close_run();
        }
        let run = self.run.get_or_insert(Span {
            offset,
            length: 0,
            log_times,
            message_indexes: BTreeMap::new(),
        });
        run.length = offset + length - run.offset;
        run.log_times.0 = run.log_times.0.min(log_times.0);
        run.log_times.1 = run.log_times.1.max(log_times.1);
    }

    fn close_run(&mut self) {
        self.index.spans.extend(self.run.take());
    }

    fn ended(&mut self, offset: u64) {
        let messages: u64 = self.index.counts.values().sum();
        let secs = self.index.log_times.map_or(0.0, |(first, last)| {
            last.saturating_sub(first) as f64 * 1e-9
        });
        let cut = format!(
            "cut off at byte {offset} of {}: {messages} messages over {secs:.3} s stand before it",
            self.index.bytes
        );
        self.index.notes.push(cut.clone());
        self.index.cut = Some(cut);
    }
}

/// The messages of one record.
#[derive(Default)]
struct Seen {
    counts: BTreeMap<u16, u64>,
    log_times: Option<(u64, u64)>,
}

impl Seen {
    /// Counts a block's messages, and takes in what describes the file.
    fn block(&mut self, block: &[u8], index: &mut Index) -> Result<(), String> {
        for record in Records::new(block) {
            let (opcode, body) = record?;
            if opcode != op::MESSAGE {
                index.describe(parse(opcode, body)?);
                continue;
            }
            let (header, _) = split_message(body).ok_or("a message without a head")?;
            *self.counts.entry(header.channel_id).or_default() += 1;
            widen(&mut self.log_times, (header.log_time, header.log_time));
        }
        Ok(())
    }
}

fn widen(range: &mut Option<(u64, u64)>, (first, last): (u64, u64)) {
    let (start, end) = range.unwrap_or((first, last));
    *range = Some((start.min(first), end.max(last)));
}
