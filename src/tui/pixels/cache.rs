//! Images that have been encoded, found by what they show, as many as the terminal can be asked to hold. The one that
//! was drawn longest ago makes room.

use std::collections::VecDeque;

use ratatui::layout::Size;
use ratatui_image::protocol::Protocol;

use super::kitty::Payload;
use super::placeholder::Id;

/// Images that are kept: four at each of 48 steps. Below the number of colours that are ids.
const KEPT: usize = 192;
/// Bytes of pixels that the terminal is asked to hold; kitty itself drops images at 320 MB.
const HELD: usize = 64 << 20;
/// Colours that are ids; the first sixteen are the user's to set, and tmux may write them in another form.
const COLORS: std::ops::RangeInclusive<u8> = 16..=255;

/// What an encoded image depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Of its values.
    pub hash: u32,
    /// Whether they are signed.
    pub signed: bool,
    /// Cells.
    pub size: Size,
}

/// What the encoder has made of an image.
pub enum Made {
    /// To be sent once and placed.
    Kitty(Payload),
    /// To be written into the cells whenever it is drawn.
    Cells(Protocol),
}

/// An image as it can be drawn.
pub enum Image {
    /// Not at all: it could not be encoded.
    Failed,
    /// In the terminal under an id, once what is `unsent` has been sent.
    Kitty {
        /// Where its placeholders point to.
        id: Id,
        /// Taken when it is sent.
        unsent: Option<Payload>,
        /// Bytes of pixels in the terminal.
        held: usize,
    },
    /// Written into the cells.
    Cells(Protocol),
}

struct Kept {
    key: Key,
    image: Image,
    used: u64,
}

/// The images.
pub struct Cache {
    kept: Vec<Kept>,
    now: u64,
    high: u8,
    free: VecDeque<u8>,
}

impl Cache {
    /// An empty one, whose ids share their highest byte. Not 0: such ids are what other programs begin with.
    pub fn new(high: u8) -> Self {
        Self {
            kept: Vec::new(),
            now: 0,
            high: high.max(1),
            free: COLORS.collect(),
        }
    }

    /// The image of a key, which from now on is the one that was used last.
    pub fn find(&mut self, key: Key) -> Option<&mut Image> {
        self.now += 1;
        let kept = self.kept.iter_mut().find(|kept| kept.key == key)?;
        kept.used = self.now;
        Some(&mut kept.image)
    }

    /// Takes in what was made, and makes room for it; ids that the terminal is to forget.
    pub fn insert(&mut self, key: Key, made: Option<Made>) -> Vec<Id> {
        let mut forgotten = self.remove(|kept| kept.key == key);
        while self.kept.len() >= KEPT || self.held() > HELD {
            let Some(oldest) = self.kept.iter().map(|kept| kept.used).min() else {
                break;
            };
            forgotten.extend(self.remove(|kept| kept.used == oldest));
        }
        let image = match made {
            Some(Made::Kitty(payload)) => match self.free.pop_front() {
                Some(color) => Image::Kitty {
                    id: Id {
                        high: self.high,
                        color,
                    },
                    held: payload.held(),
                    unsent: Some(payload),
                },
                None => Image::Failed,
            },
            Some(Made::Cells(protocol)) => Image::Cells(protocol),
            None => Image::Failed,
        };
        self.now += 1;
        self.kept.push(Kept {
            key,
            image,
            used: self.now,
        });
        forgotten
    }

    /// Forgets all; ids that the terminal is to forget.
    pub fn clear(&mut self) -> Vec<Id> {
        self.remove(|_| true)
    }

    fn held(&self) -> usize {
        let held = |kept: &Kept| match kept.image {
            Image::Kitty { held, .. } => held,
            _ => 0,
        };
        self.kept.iter().map(held).sum()
    }

    fn remove(&mut self, which: impl Fn(&Kept) -> bool) -> Vec<Id> {
        let mut ids = Vec::new();
        self.kept.retain(|kept| {
            let goes = which(kept);
            if let (true, Image::Kitty { id, unsent, .. }) = (goes, &kept.image) {
                self.free.push_back(id.color);
                // One that was never sent cannot be forgotten.
                ids.extend(unsent.is_none().then_some(*id));
            }
            !goes
        });
        ids
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(hash: usize) -> Key {
        Key {
            hash: hash as u32,
            signed: false,
            size: Size::new(4, 2),
        }
    }

    fn made() -> Made {
        Made::Kitty(Payload::new(1, 1, &[0; 3], false))
    }

    /// Inserts and marks as sent.
    fn sent(cache: &mut Cache, hash: usize) -> (Id, Vec<Id>) {
        let forgotten = cache.insert(key(hash), Some(made()));
        let Some(Image::Kitty { id, unsent, .. }) = cache.find(key(hash)) else {
            panic!("{hash} was not kept");
        };
        assert!(unsent.take().is_some());
        (*id, forgotten)
    }

    #[test]
    fn the_image_drawn_longest_ago_makes_room() {
        let mut cache = Cache::new(5);
        let ids: Vec<Id> = (0..KEPT).map(|i| sent(&mut cache, i).0).collect();
        assert!(cache.find(key(0)).is_some());
        let (_, forgotten) = sent(&mut cache, KEPT);
        assert_eq!(forgotten, [ids[1]]);
        assert!(cache.find(key(0)).is_some());
        assert!(cache.find(key(1)).is_none());
    }

    #[test]
    fn ids_never_run_out_and_are_never_shared() {
        let mut cache = Cache::new(0);
        let mut live: Vec<Id> = Vec::new();
        for i in 0..2000 {
            let (id, forgotten) = sent(&mut cache, i);
            live.retain(|id| !forgotten.contains(id));
            assert!(!live.contains(&id) && id.high == 1 && id.color >= 16);
            live.push(id);
        }
        assert_eq!(live.len(), KEPT);
        assert_eq!(cache.clear().len(), KEPT);
    }

    #[test]
    fn large_images_leave_room_for_fewer() {
        let mut cache = Cache::new(1);
        let side = 2048;
        for i in 0..20 {
            let large = Payload::new(side, side, &[], false);
            cache.insert(key(i), Some(Made::Kitty(large)));
        }
        assert!(cache.kept.len() < 8, "{}", cache.kept.len());
    }

    #[test]
    fn what_cannot_be_encoded_is_remembered_as_such() {
        let mut cache = Cache::new(1);
        cache.insert(key(1), None);
        assert!(matches!(cache.find(key(1)), Some(Image::Failed)));
        assert_eq!(cache.clear(), []);
    }
}
