//! What goes out: a frame at a time in one write, so that no terminal sees half of it for longer than it must.
//!
//! The backend writes even the terminal's own sixteen colours as numbers of a palette (`38;5;4`), which terminals that
//! have only those may take for something else; for them the codes are the original ones (`34`).

use std::io::{self, Write};

/// Collects until it is flushed.
pub struct Output<W> {
    out: W,
    frame: Vec<u8>,
    sixteen: bool,
}

impl<W: Write> Output<W> {
    /// Writes to `out`, with the original colour codes where there are `sixteen` colours.
    pub fn new(out: W, sixteen: bool) -> Self {
        Self {
            out,
            frame: Vec::new(),
            sixteen,
        }
    }
}

impl<W: Write> Write for Output<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.frame.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.sixteen {
            self.frame = original(&self.frame);
        }
        let written = self.out.write_all(&self.frame);
        self.frame.clear();
        written.and_then(|()| self.out.flush())
    }
}

/// The same bytes with the sixteen colours in their original codes.
fn original(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len());
    let mut rest = bytes;
    while let Some(start) = rest.windows(2).position(|pair| pair == b"\x1b[") {
        let (before, sequence) = rest.split_at(start + 2);
        out.extend_from_slice(before);
        let is_parameter = |byte: &u8| byte.is_ascii_digit() || *byte == b';';
        let end = sequence.iter().position(|byte| !is_parameter(byte));
        let (parameters, after) = sequence.split_at(end.unwrap_or(sequence.len()));
        if after.first() == Some(&b'm') {
            out.extend_from_slice(recoded(parameters).as_bytes());
        } else {
            out.extend_from_slice(parameters);
        }
        rest = after;
    }
    out.extend_from_slice(rest);
    out
}

fn recoded(parameters: &[u8]) -> String {
    let text = String::from_utf8_lossy(parameters);
    let codes: Vec<&str> = text.split(';').collect();
    let mut out: Vec<String> = Vec::new();
    let mut at = 0;
    while at < codes.len() {
        let color = match codes[at..] {
            [kind @ ("38" | "48"), "5", number, ..] => code(kind, number),
            _ => None,
        };
        at += if color.is_some() { 3 } else { 1 };
        out.push(color.unwrap_or_else(|| codes[at - 1].to_owned()));
    }
    out.join(";")
}

/// 30 to 37 for the first eight, 90 to 97 for their bright versions, ten more for backgrounds.
fn code(kind: &str, number: &str) -> Option<String> {
    let ground = if kind == "48" { 10 } else { 0 };
    let code = match number.parse::<u8>().ok()? {
        number @ 0..=7 => 30 + number,
        number @ 8..=15 => 82 + number,
        _ => return None,
    };
    Some((code + ground).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recoded(text: &str) -> String {
        String::from_utf8_lossy(&original(text.as_bytes())).into_owned()
    }

    #[test]
    fn sixteen_colours_have_their_original_codes() {
        assert_eq!(
            recoded("\x1b[38;5;4mV\x1b[38;5;1;49m"),
            "\x1b[34mV\x1b[31;49m"
        );
        assert_eq!(recoded("\x1b[1;38;5;9;48;5;15m"), "\x1b[1;91;107m");
        for same in [
            "38;5;4m",
            "\x1b[38;5;44m",
            "\x1b[4;5H",
            "\x1b[?25l",
            "\x1b[",
            "é",
        ] {
            assert_eq!(recoded(same), same);
        }
    }

    #[test]
    fn a_frame_is_one_write() {
        struct Writes(Vec<Vec<u8>>);
        impl Write for &mut Writes {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                self.0.push(bytes.to_vec());
                Ok(bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut writes = Writes(Vec::new());
        let mut output = Output::new(&mut writes, false);
        let frame = vec![b'x'; 1 << 20];
        let pieces = frame.chunks(1000);
        let written = pieces
            .map(|piece| output.write_all(piece))
            .all(|it| it.is_ok());
        assert!(written && output.flush().is_ok() && output.flush().is_ok());
        assert_eq!(writes.0, [frame]);
    }
}
