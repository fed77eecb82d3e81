//! MCAP's framing: a record is an opcode, eight bytes of length, and a body.

use mcap::records::MessageHeader;

/// Opcode and length.
pub(super) const HEAD: usize = 9;

/// No record of ours is longer; a length beyond it is damage and would ask for absurd memory.
pub(super) const LENGTH_LIMIT: usize = 64 << 20;

/// Splits the head of a record.
pub(super) fn split_head(head: [u8; HEAD]) -> (u8, u64) {
    let [opcode, length @ ..] = head;
    (opcode, u64::from_le_bytes(length))
}

/// Appends a record.
pub(super) fn put_record(bytes: &mut Vec<u8>, opcode: u8, body: &[u8]) {
    bytes.push(opcode);
    bytes.extend_from_slice(&(body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(body);
}

/// Splits a message into its head and its payload. Read here by hand, since a chunk holds tens of thousands and most are
/// of other episodes.
pub(super) fn split_message(body: &[u8]) -> Option<(MessageHeader, &[u8])> {
    let (channel, rest) = body.split_first_chunk::<2>()?;
    let (sequence, rest) = rest.split_first_chunk::<4>()?;
    let (log_time, rest) = rest.split_first_chunk::<8>()?;
    let (publish_time, payload) = rest.split_first_chunk::<8>()?;
    let header = MessageHeader {
        channel_id: u16::from_le_bytes(*channel),
        sequence: u32::from_le_bytes(*sequence),
        log_time: u64::from_le_bytes(*log_time),
        publish_time: u64::from_le_bytes(*publish_time),
    };
    Some((header, payload))
}

/// Walks the records of a block of bytes: opcode, body.
pub(super) struct Records<'a> {
    rest: &'a [u8],
}

impl<'a> Records<'a> {
    /// From the first record's opcode on.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }
}

impl<'a> Iterator for Records<'a> {
    /// The error is a phrase; nothing comes after it.
    type Item = Result<(u8, &'a [u8]), String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let rest = std::mem::take(&mut self.rest);
        let Some((&head, after)) = rest.split_first_chunk::<HEAD>() else {
            return Some(Err("it ends in the middle of a record".to_owned()));
        };
        let (opcode, length) = split_head(head);
        let body = usize::try_from(length)
            .ok()
            .and_then(|n| after.split_at_checked(n));
        let Some((body, rest)) = body else {
            return Some(Err(format!(
                "a record of {length} bytes where {} are left",
                after.len()
            )));
        };
        self.rest = rest;
        Some(Ok((opcode, body)))
    }
}
