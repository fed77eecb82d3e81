//! Images by the terminal's own graphics (kitty, sixel, iTerm2), encoded on a thread beside the drawing.
//!
//! ```text
//! draw ── not there ──► encoder's thread ──► cache ──► draw ──► outbox: sent once, before the cells that show it
//!      └─ there: kitty's placeholders, or the image itself, into the cells
//! ```
//! An image that is not encoded yet is drawn as half-blocks; when it arrives, the face is woken and draws again.
//! The queue is short and a full one drops: the next drawing asks again for what is then visible.

pub mod ask;
pub mod tmux;

mod cache;
mod diacritics;
mod encode;
mod kitty;
mod placeholder;

use std::cell::RefCell;
use std::fmt;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use ratatui::buffer::Buffer;
use ratatui::layout::{Rect, Size};
use ratatui::widgets::Widget;

use super::image::Raster;
use ask::{CellSize, Graphics};
use cache::{Cache, Image, Key, Made};
use placeholder::{Id, Placed};

/// Images that may wait to be encoded: two rows of frames.
const QUEUE: usize = 8;

/// The encoder's thread and what it has made.
pub struct Pixels {
    graphics: Graphics,
    requests: SyncSender<(Key, Raster, Graphics)>,
    encoded: Receiver<(Key, Option<Made>)>,
    /// Drawing is given the face to read, and what it finds missing is written down here.
    state: RefCell<State>,
}

struct State {
    cache: Cache,
    asked: Vec<Key>,
    /// Images on the frame that is being drawn.
    placed: Vec<Placed>,
    /// Sequences for the terminal, to be written before the cells.
    outbox: Vec<u8>,
}

impl fmt::Debug for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pixels")
            .field("graphics", &self.graphics)
            .finish_non_exhaustive()
    }
}

impl Pixels {
    /// Starts the encoder; it calls `wake` after each image and ends with this value.
    pub fn start(graphics: Graphics, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let (requests, to_encode) = sync_channel::<(Key, Raster, Graphics)>(QUEUE);
        let (done, encoded) = sync_channel(QUEUE);
        thread::Builder::new()
            .name("poescope-images".to_owned())
            .spawn(move || {
                for (key, raster, graphics) in to_encode {
                    let made = encode::encode(graphics, &raster, key.size);
                    if done.send((key, made)).is_err() {
                        return;
                    }
                    wake();
                }
            })?;
        let state = State {
            cache: Cache::new(std::process::id() as u8),
            asked: Vec::new(),
            placed: Vec::new(),
            outbox: Vec::new(),
        };
        Ok(Self {
            graphics,
            requests,
            encoded,
            state: RefCell::new(state),
        })
    }

    /// Takes in what has been encoded since; whether there was anything.
    pub fn receive(&mut self) -> bool {
        let state = self.state.get_mut();
        let mut arrived = false;
        for (key, made) in self.encoded.try_iter() {
            state.take_in(key, made, self.graphics.tmux);
            arrived = true;
        }
        arrived
    }

    /// Waits until all that was asked for has been encoded, but no longer than this; whether there was anything. An
    /// image of usual size takes a few milliseconds, and one that is there at once never flickers.
    pub fn wait(&mut self, patience: Duration) -> bool {
        let deadline = Instant::now() + patience;
        let state = self.state.get_mut();
        let mut arrived = false;
        while !state.asked.is_empty() {
            let left = deadline.saturating_duration_since(Instant::now());
            let Ok((key, made)) = self.encoded.recv_timeout(left) else {
                break;
            };
            state.take_in(key, made, self.graphics.tmux);
            arrived = true;
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
        let state = &mut *self.state.borrow_mut();
        match state.cache.find(key) {
            Some(Image::Kitty { id, unsent, .. }) => {
                if let Some(payload) = unsent.take() {
                    let tmux = self.graphics.tmux;
                    payload.send(&mut state.outbox, id.number(), key.size, tmux);
                }
                let area = Rect::from((pane.as_position(), key.size));
                let placed = Placed { id: *id, area };
                placed.write(buf);
                state.placed.push(placed);
                true
            }
            Some(Image::Cells(protocol)) => {
                ratatui_image::Image::new(protocol).render(pane, buf);
                true
            }
            Some(Image::Failed) => false,
            None => {
                if !state.asked.contains(&key) {
                    let request = (key, raster.clone(), self.graphics);
                    if self.requests.try_send(request).is_ok() {
                        state.asked.push(key);
                    }
                }
                false
            }
        }
    }

    /// Ends a drawing, after everything that may cover an image in part.
    pub fn finish(&self, buf: &mut Buffer) {
        for placed in std::mem::take(&mut self.state.borrow_mut().placed) {
            placed.mark(buf);
        }
    }

    /// What is to be written to the terminal before the cells of the frame.
    pub fn to_send(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.state.get_mut().outbox)
    }

    /// Forgets all images, and has the terminal forget them: at the end, and when it may have lost them.
    pub fn forget(&mut self) {
        let state = self.state.get_mut();
        let ids = state.cache.clear();
        state.delete(&ids, self.graphics.tmux);
    }

    /// Draws images another way from now on: the terminal has answered more.
    pub fn change(&mut self, graphics: Graphics) {
        // What the terminal holds was sent in the old way, so it is forgotten in it.
        self.forget();
        self.graphics = graphics;
    }

    /// The screen has another size: other cells, perhaps of other pixels, perhaps of another terminal behind tmux.
    pub fn resized(&mut self, cell: Option<CellSize>) {
        self.graphics.cell = cell.unwrap_or(self.graphics.cell);
        self.forget();
    }
}

impl State {
    fn take_in(&mut self, key: Key, made: Option<Made>, tmux: bool) {
        self.asked.retain(|asked| *asked != key);
        let ids = self.cache.insert(key, made);
        self.delete(&ids, tmux);
    }

    fn delete(&mut self, ids: &[Id], tmux: bool) {
        for id in ids {
            kitty::delete(&mut self.outbox, id.number(), tmux);
        }
    }
}

fn hash(raster: &Raster) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for value in &raster.values {
        hasher.update(&value.to_bits().to_le_bytes());
    }
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use ratatui_image::picker::ProtocolType;

    use super::*;

    const LONG: Duration = Duration::from_secs(30);

    fn raster(shade: f32) -> Raster {
        Raster {
            width: 2,
            height: 2,
            values: vec![0.0, 1.0, 0.5, shade],
            signed: false,
        }
    }

    fn pixels(protocol: ProtocolType) -> Pixels {
        let graphics = ask::Host::default().forced(protocol).unwrap();
        Pixels::start(graphics, || {}).unwrap()
    }

    /// Draws one image, waiting for it; what is sent to the terminal before the cells.
    fn shown(pixels: &mut Pixels, shade: f32, buf: &mut Buffer) -> String {
        let pane = buf.area;
        if !pixels.draw(buf, pane, &raster(shade)) {
            assert!(pixels.wait(LONG));
            assert!(pixels.draw(buf, pane, &raster(shade)));
        }
        pixels.finish(buf);
        String::from_utf8(pixels.to_send()).unwrap()
    }

    #[test]
    fn an_image_is_asked_for_once_and_drawn_when_it_has_come() {
        for protocol in [
            ProtocolType::Kitty,
            ProtocolType::Sixel,
            ProtocolType::Iterm2,
        ] {
            let mut pixels = pixels(protocol);
            let mut buf = Buffer::empty(Rect::new(0, 0, 8, 4));
            let pane = buf.area;
            assert!(!pixels.draw(&mut buf, pane, &raster(0.1)));
            assert!(!pixels.draw(&mut buf, pane, &raster(0.1)));
            assert!(pixels.wait(LONG));
            assert!(pixels.draw(&mut buf, pane, &raster(0.1)));
            assert!(!pixels.wait(LONG) && !pixels.receive());
        }
    }

    #[test]
    fn a_kitty_image_is_sent_once_and_placed_as_often_as_one_likes() {
        let mut pixels = pixels(ProtocolType::Kitty);
        let mut first = Buffer::empty(Rect::new(0, 0, 8, 4));
        assert!(shown(&mut pixels, 0.1, &mut first).starts_with("\x1b_Ga=T,U=1,"));
        let mut other = Buffer::empty(first.area);
        assert!(shown(&mut pixels, 0.2, &mut other).starts_with("\x1b_Ga=T,U=1,"));
        assert_ne!(first, other);
        // Back again, and elsewhere.
        let mut again = Buffer::empty(first.area);
        assert_eq!(shown(&mut pixels, 0.1, &mut again), "");
        assert_eq!(first, again);
        let mut elsewhere = Buffer::empty(Rect::new(40, 9, 8, 4));
        assert_eq!(shown(&mut pixels, 0.1, &mut elsewhere), "");
        assert_eq!(first.content, elsewhere.content);
    }

    #[test]
    fn images_that_make_room_and_those_at_the_end_are_deleted() {
        let mut pixels = pixels(ProtocolType::Kitty);
        let mut buf = Buffer::empty(Rect::new(0, 0, 8, 4));
        let mut sent = String::new();
        for i in 0..200 {
            sent += &shown(&mut pixels, i as f32 / 200.0, &mut buf);
        }
        let count = |text: &str, part: &str| text.matches(part).count();
        assert_eq!(count(&sent, "a=T,"), 200);
        assert_eq!(count(&sent, "a=d,d=I,"), 8);
        pixels.forget();
        let end = String::from_utf8(pixels.to_send()).unwrap();
        assert_eq!(count(&end, "a=d,d=I,"), 192);
        assert!(shown(&mut pixels, 0.0, &mut buf).contains("a=T,"));
    }
}
