//! msgpack, as far as it has to be looked into after serde has written it: what comes next, what a map holds.

/// One token; containers announce how many values follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Token<'a> {
    /// Nothing.
    Nil,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Int(i128),
    /// Any number.
    Float(f64),
    /// Text.
    Text(&'a str),
    /// Bytes.
    Bin(&'a [u8]),
    /// Bytes of a kind of their own.
    Ext(i8, &'a [u8]),
    /// So many values follow.
    Array(usize),
    /// So many pairs follow.
    Map(usize),
}

/// A place in bytes that are read from front to back. Nothing that they hold makes it panic.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// At their beginning.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// What is left.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    /// A big-endian number of up to eight bytes.
    fn number(&mut self, bytes: usize) -> Option<u64> {
        let taken = self.take(bytes)?;
        Some(
            taken
                .iter()
                .fold(0, |sum, &byte| sum << 8 | u64::from(byte)),
        )
    }

    fn size(&mut self, bytes: usize) -> Option<usize> {
        usize::try_from(self.number(bytes)?).ok()
    }

    fn text(&mut self, count: usize) -> Option<Token<'a>> {
        std::str::from_utf8(self.take(count)?).ok().map(Token::Text)
    }

    fn ext(&mut self, count: usize) -> Option<Token<'a>> {
        let tag = self.number(1)? as u8 as i8;
        Some(Token::Ext(tag, self.take(count)?))
    }

    /// The next token; none at the end, and where there is no msgpack.
    pub fn token(&mut self) -> Option<Token<'a>> {
        let head = self.number(1)? as u8;
        Some(match head {
            0x00..=0x7f => Token::Int(i128::from(head)),
            0x80..=0x8f => Token::Map(usize::from(head & 0x0f)),
            0x90..=0x9f => Token::Array(usize::from(head & 0x0f)),
            0xa0..=0xbf => self.text(usize::from(head & 0x1f))?,
            0xc0 => Token::Nil,
            0xc1 => return None,
            0xc2 | 0xc3 => Token::Bool(head == 0xc3),
            0xc4..=0xc6 => {
                let count = self.size(1 << (head - 0xc4))?;
                Token::Bin(self.take(count)?)
            }
            0xc7..=0xc9 => {
                let count = self.size(1 << (head - 0xc7))?;
                self.ext(count)?
            }
            0xca => Token::Float(f64::from(f32::from_bits(self.number(4)? as u32))),
            0xcb => Token::Float(f64::from_bits(self.number(8)?)),
            0xcc..=0xcf => Token::Int(i128::from(self.number(1 << (head - 0xcc))?)),
            0xd0 => Token::Int(i128::from(self.number(1)? as u8 as i8)),
            0xd1 => Token::Int(i128::from(self.number(2)? as u16 as i16)),
            0xd2 => Token::Int(i128::from(self.number(4)? as u32 as i32)),
            0xd3 => Token::Int(i128::from(self.number(8)? as i64)),
            0xd4..=0xd8 => self.ext(1 << (head - 0xd4))?,
            0xd9..=0xdb => {
                let count = self.size(1 << (head - 0xd9))?;
                self.text(count)?
            }
            0xdc | 0xdd => Token::Array(self.size(2 << (head - 0xdc))?),
            0xde | 0xdf => Token::Map(self.size(2 << (head - 0xde))?),
            0xe0..=0xff => Token::Int(i128::from(head as i8)),
        })
    }

    /// The bytes of the next value, with all that it holds.
    pub fn value(&mut self) -> Option<&'a [u8]> {
        let start = self.rest;
        let mut left = 1_usize;
        while left > 0 {
            left -= 1;
            let inside = match self.token()? {
                Token::Array(count) => count,
                Token::Map(count) => count.checked_mul(2)?,
                _ => 0,
            };
            left = left.checked_add(inside)?;
        }
        Some(&start[..start.len() - self.rest.len()])
    }
}

/// The entries of a map with text for keys, each with the bytes of its value; none where it is something else.
pub fn entries(map: &[u8]) -> Option<Vec<(&str, &[u8])>> {
    let mut reader = Reader::new(map);
    let Token::Map(count) = reader.token()? else {
        return None;
    };
    // An entry has at least two bytes, so a count that lies ends soon.
    (0..count)
        .map(|_| {
            let Token::Text(key) = reader.token()? else {
                return None;
            };
            Some((key, reader.value()?))
        })
        .collect()
}

/// Writes the head of a map of at most 15 entries.
pub fn put_map(out: &mut Vec<u8>, count: u8) {
    out.push(0x80 | count.min(15));
}

/// Writes the head of an array.
pub fn put_array(out: &mut Vec<u8>, count: usize) {
    match count {
        0..=15 => out.push(0x90 | count as u8),
        16..=0xffff => {
            out.push(0xdc);
            out.extend((count as u16).to_be_bytes());
        }
        _ => {
            out.push(0xdd);
            out.extend((count as u32).to_be_bytes());
        }
    }
}

/// Writes text of less than 256 bytes; longer text is cut.
pub fn put_name(out: &mut Vec<u8>, text: &str) {
    let end = text.floor_char_boundary(255);
    out.extend([0xd9, end as u8]);
    out.extend(&text.as_bytes()[..end]);
}

/// Writes a count.
pub fn put_count(out: &mut Vec<u8>, count: usize) {
    out.push(0xcf);
    out.extend((count as u64).to_be_bytes());
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use proptest::prelude::*;
    use serde::Serialize;

    use super::*;

    #[derive(Serialize)]
    struct Sample {
        small: i64,
        list: Vec<f64>,
        name: String,
        none: Option<u8>,
    }

    fn sample(small: i64, name: String) -> Vec<u8> {
        let list = vec![0.5; 20];
        rmp_serde::to_vec_named(&Sample {
            small,
            list,
            name,
            none: None,
        })
        .unwrap()
    }

    #[test]
    fn a_map_comes_apart_into_its_values() {
        let bytes = sample(-40_000, "x".repeat(300));
        let entries = entries(&bytes).unwrap();
        let names: Vec<&str> = entries.iter().map(|entry| entry.0).collect();
        assert_eq!(names, ["small", "list", "name", "none"]);
        assert_eq!(Reader::new(entries[0].1).token(), Some(Token::Int(-40_000)));
        assert_eq!(entries[1].1.len(), 3 + 20 * 9);
        assert_eq!(entries[3].1, [0xc0]);
    }

    proptest! {
        #[test]
        fn anything_can_be_read(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let mut reader = Reader::new(&bytes);
            while reader.value().is_some() {}
            let _ = entries(&bytes);
        }

        #[test]
        fn what_is_cut_off_is_no_value(small: i64, name in "\\PC{0,40}", part in 0.0..1.0_f64) {
            let bytes = sample(small, name);
            prop_assert_eq!(Reader::new(&bytes).value(), Some(&bytes[..]));
            let cut = (bytes.len() as f64 * part) as usize;
            prop_assert_eq!(Reader::new(&bytes[..cut]).value(), None);
        }
    }
}
