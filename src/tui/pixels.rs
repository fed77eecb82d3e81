//! Images by the terminal's own graphics (kitty, sixel, iTerm2), encoded on a thread beside the drawing.
//!
//! An image that is not encoded yet is drawn as half-blocks; when it arrives, the face is woken and draws again.
//! The queue is short and a full one drops: the next drawing asks again for what is then visible.

use std::cell::RefCell;
use std::fmt;
use std::io::{self, Write};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use image::{DynamicImage, Rgba, RgbaImage};
use ratatui::buffer::Buffer;
use ratatui::layout::{Rect, Size};
use ratatui::widgets::Widget;
use ratatui_image::picker::cap_parser::QueryStdioOptions;
use ratatui_image::picker::{Picker, ProtocolType};
use ratatui_image::protocol::Protocol;
use ratatui_image::{Image, Resize};

use super::image::Raster;

/// Encoded images that are kept.
const KEPT: usize = 64;
/// Images that may wait to be encoded: two rows of frames.
const QUEUE: usize = 8;
/// How long the terminal may take to answer what it can do.
const ANSWER: Duration = Duration::from_millis(300);

/// What an encoded image depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Key {
    hash: u32,
    signed: bool,
    size: Size,
}

/// The encoder's thread and what it has made.
pub struct Pixels {
    requests: SyncSender<(Key, Raster)>,
    encoded: Receiver<(Key, Option<Protocol>)>,
    /// Oldest first; none for an image that cannot be encoded.
    kept: Vec<(Key, Option<Protocol>)>,
    asked: RefCell<Vec<Key>>,
}

/// Asks the terminal what it can do; none if it has no images of its own, or does not answer.
///
/// To be called in raw mode, before anything else reads the terminal's input.
pub fn ask_terminal() -> Option<Picker> {
    let picker = query()?;
    (picker.protocol_type() != ProtocolType::Halfblocks).then_some(picker)
}

/// A picker for a protocol that was asked for by name.
pub fn forced(protocol: ProtocolType) -> Picker {
    let mut picker = query().unwrap_or_else(Picker::halfblocks);
    picker.set_protocol_type(protocol);
    picker
}

fn query() -> Option<Picker> {
    let options = QueryStdioOptions {
        timeout: ANSWER,
        // Enlarged pixels deflate to a hundredth, which counts over SSH; the encoder's thread has the time.
        kitty_compression: true,
        ..QueryStdioOptions::default()
    };
    let picker = Picker::from_query_stdio_with_options(options).ok()?;
    if picker.capabilities().is_empty() {
        release_reader();
    }
    Some(picker)
}

/// After a query without an answer, its thread still waits for input and would swallow the user's first keys. A
/// status report is answered by any terminal, also by a tmux that passed the query on to nobody; it takes that.
fn release_reader() {
    let mut out = io::stdout();
    if out.write_all(b"\x1b[5n").and_then(|()| out.flush()).is_ok() {
        thread::sleep(ANSWER / 6);
    }
}

impl fmt::Debug for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pixels")
            .field("kept", &self.kept.len())
            .finish_non_exhaustive()
    }
}

impl Pixels {
    /// Starts the encoder; it calls `wake` after each image and ends with this value.
    pub fn start(picker: Picker, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let (requests, to_encode) = sync_channel::<(Key, Raster)>(QUEUE);
        let (done, encoded) = sync_channel(QUEUE);
        thread::Builder::new()
            .name("poescope-images".to_owned())
            .spawn(move || {
                for (key, raster) in to_encode {
                    let protocol = encode(&picker, &raster, key.size);
                    if done.send((key, protocol)).is_err() {
                        return;
                    }
                    wake();
                }
            })?;
        Ok(Self {
            requests,
            encoded,
            kept: Vec::new(),
            asked: RefCell::default(),
        })
    }

    /// Takes in what has been encoded since; whether there was anything.
    pub fn receive(&mut self) -> bool {
        let before = self.kept.len();
        self.kept.extend(self.encoded.try_iter());
        let arrived = self.kept.len() > before;
        if arrived {
            let kept = &self.kept[before..];
            self.asked
                .borrow_mut()
                .retain(|asked| kept.iter().all(|(key, _)| key != asked));
            self.kept.drain(..self.kept.len().saturating_sub(KEPT));
        }
        arrived
    }

    /// Draws the image if it is encoded; otherwise asks for it and says no.
    pub fn draw(&self, buf: &mut Buffer, pane: Rect, raster: &Raster) -> bool {
        let pane = pane.intersection(buf.area);
        if pane.is_empty() {
            return false;
        }
        let (width, height) = raster.fit(pane.width, pane.height);
        let key = Key {
            hash: hash(raster),
            signed: raster.signed,
            size: Size::new(width as u16, height.div_ceil(2) as u16),
        };
        if let Some((_, protocol)) = self.kept.iter().rev().find(|(kept, _)| *kept == key) {
            let Some(protocol) = protocol else {
                return false;
            };
            Image::new(protocol).render(pane, buf);
            return true;
        }
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&key) && self.requests.try_send((key, raster.clone())).is_ok() {
            asked.push(key);
        }
        false
    }
}

fn hash(raster: &Raster) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for value in &raster.values {
        hasher.update(&value.to_bits().to_le_bytes());
    }
    hasher.finalize()
}

/// Enlarges to the pixels of so many cells, edges kept sharp, and encodes.
fn encode(picker: &Picker, raster: &Raster, size: Size) -> Option<Protocol> {
    let font = picker.font_size();
    let room = (
        u32::from(size.width) * u32::from(font.width),
        u32::from(size.height) * u32::from(font.height),
    );
    let scale = (room.0 as f32 / raster.width as f32).min(room.1 as f32 / raster.height as f32);
    let pixels = |side: usize| ((side as f32 * scale) as usize).max(1);
    let large = raster.resize(pixels(raster.width), pixels(raster.height));
    let mut image = RgbaImage::new(room.0, room.1);
    for (row, values) in large.values.chunks_exact(large.width).enumerate() {
        for (column, &value) in values.iter().enumerate() {
            let (r, g, b) = large.rgb(value);
            if let Some(pixel) = image.get_pixel_mut_checked(column as u32, row as u32) {
                *pixel = Rgba([r, g, b, u8::MAX]);
            }
        }
    }
    picker
        .new_protocol(DynamicImage::ImageRgba8(image), size, Resize::Fit(None))
        .ok()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::sync::mpsc::channel;

    use super::*;

    fn raster() -> Raster {
        Raster {
            width: 2,
            height: 2,
            values: vec![0.0, 1.0, 0.5, 0.25],
            signed: false,
        }
    }

    #[test]
    fn every_protocol_fills_the_cells_it_was_asked_for() {
        for protocol in [
            ProtocolType::Kitty,
            ProtocolType::Sixel,
            ProtocolType::Iterm2,
        ] {
            let mut picker = Picker::halfblocks();
            picker.set_protocol_type(protocol);
            let encoded = encode(&picker, &raster(), Size::new(8, 4)).unwrap();
            assert_eq!(encoded.size(), Size::new(8, 4), "{protocol:?}");
        }
    }

    #[test]
    fn an_image_is_asked_for_once_and_drawn_when_it_has_come() {
        let (wake, woken) = channel();
        let mut picker = Picker::halfblocks();
        picker.set_protocol_type(ProtocolType::Kitty);
        let mut pixels = Pixels::start(picker, move || wake.send(()).unwrap()).unwrap();
        let mut buf = Buffer::empty(Rect::new(0, 0, 8, 4));
        let pane = buf.area;
        assert!(!pixels.draw(&mut buf, pane, &raster()));
        woken.recv().unwrap();
        assert!(pixels.receive());
        assert!(pixels.draw(&mut buf, pane, &raster()));
        assert!(woken.try_recv().is_err());
    }
}
