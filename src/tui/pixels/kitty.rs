//! The kitty graphics protocol, as bytes: an image is sent once under an id, then shown wherever its placeholders
//! stand (`placeholder.rs`), and deleted when it is kept no longer.
//!
//! <https://sw.kovidgoyal.net/kitty/graphics-protocol/>

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use ratatui::layout::Size;

use super::tmux;

/// Bytes of base64 in one sequence, as the protocol allows and tmux passes on.
const CHUNK: usize = 4096;

/// An image ready to be sent: the work for the encoder's thread ends here.
#[derive(Debug)]
pub struct Payload {
    width: usize,
    height: usize,
    compressed: bool,
    base64: String,
}

impl Payload {
    /// Packs pixels of three bytes each, row major.
    pub fn new(width: usize, height: usize, rgb: &[u8], compress: bool) -> Self {
        let deflated = compress.then(|| deflate(rgb));
        let base64 = STANDARD.encode(deflated.as_deref().unwrap_or(rgb));
        Self {
            width,
            height,
            compressed: compress,
            base64,
        }
    }

    /// Bytes that the terminal holds while it has the image.
    pub fn held(&self) -> usize {
        self.width * self.height * 3
    }

    /// Appends the sequences that give the terminal the image and a virtual placement over so many cells, which is
    /// drawn nowhere by itself. The terminal is to answer nothing, not even errors: answers would look like keys.
    pub fn send(&self, out: &mut Vec<u8>, id: u32, cells: Size, in_tmux: bool) {
        let mut chunks = self.base64.as_bytes().chunks(CHUNK).peekable();
        let zlib = if self.compressed { ",o=z" } else { "" };
        let mut control = format!(
            "a=T,U=1,q=2,i={id},f=24,s={},v={}{zlib},c={},r={}",
            self.width, self.height, cells.width, cells.height
        );
        while let Some(chunk) = chunks.next() {
            let more = u8::from(chunks.peek().is_some());
            command(out, &format!("{control},m={more}"), chunk, in_tmux);
            "q=2".clone_into(&mut control);
        }
    }
}

/// Appends the sequence that deletes an image and all its placements, and frees it.
pub fn delete(out: &mut Vec<u8>, id: u32, in_tmux: bool) {
    command(out, &format!("a=d,d=I,q=2,i={id}"), b"", in_tmux);
}

fn command(out: &mut Vec<u8>, control: &str, data: &[u8], in_tmux: bool) {
    let mut sequence = Vec::with_capacity(control.len() + data.len() + 8);
    sequence.extend_from_slice(b"\x1b_G");
    sequence.extend_from_slice(control.as_bytes());
    if !data.is_empty() {
        sequence.push(b';');
        sequence.extend_from_slice(data);
    }
    sequence.extend_from_slice(b"\x1b\\");
    tmux::pass(out, &sequence, in_tmux);
}

/// As zlib; enlarged pixels shrink to a hundredth. Writing into a vector cannot fail, so an error is an empty image.
fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(bytes);
    written.and_then(|()| encoder.finish()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::io::Read;

    use flate2::read::ZlibDecoder;

    use super::*;

    fn noise(bytes: usize) -> Vec<u8> {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..bytes).map(|_| next()).collect()
    }

    /// Control data of each sequence, and the image they carry together.
    fn received(bytes: &[u8]) -> (Vec<String>, Vec<u8>) {
        let text = std::str::from_utf8(bytes).unwrap();
        let mut controls = Vec::new();
        let mut data = String::new();
        for sequence in text.split_terminator("\x1b\\") {
            let inner = sequence.strip_prefix("\x1b_G").unwrap();
            let (control, chunk) = inner.split_once(';').unwrap_or((inner, ""));
            assert!(chunk.len() <= CHUNK);
            controls.push(control.to_owned());
            data.push_str(chunk);
        }
        (controls, STANDARD.decode(data).unwrap())
    }

    #[test]
    fn an_image_is_sent_whole_in_chunks() {
        let rgb = noise(64 * 64 * 3);
        for compress in [false, true] {
            let mut out = Vec::new();
            let payload = Payload::new(64, 64, &rgb, compress);
            payload.send(&mut out, 7, Size::new(32, 16), false);
            let (controls, data) = received(&out);
            let zlib = if compress { ",o=z" } else { "" };
            let first = format!("a=T,U=1,q=2,i=7,f=24,s=64,v=64{zlib},c=32,r=16,m=1");
            assert_eq!(controls[0], first);
            let (last, middle) = controls[1..].split_last().unwrap();
            assert!(middle.iter().all(|control| control == "q=2,m=1"));
            assert_eq!(last, "q=2,m=0");
            let mut shown = Vec::new();
            if compress {
                ZlibDecoder::new(&data[..]).read_to_end(&mut shown).unwrap();
            } else {
                shown = data;
            }
            assert_eq!(shown, rgb);
        }
    }

    #[test]
    fn deleting_frees_the_image_too() {
        let mut out = Vec::new();
        delete(&mut out, 300, false);
        assert_eq!(out, b"\x1b_Ga=d,d=I,q=2,i=300\x1b\\");
    }

    #[test]
    fn within_tmux_every_chunk_is_wrapped_by_itself() {
        let mut out = Vec::new();
        Payload::new(64, 64, &noise(64 * 64 * 3), false).send(&mut out, 7, Size::new(32, 16), true);
        let text = String::from_utf8(out).unwrap();
        let count = |part: &str| text.matches(part).count();
        assert_eq!(count("\x1bPtmux;\x1b\x1b_G"), 4);
        assert_eq!(count("\x1b\x1b\\\x1b\\"), 4);
    }
}
