//! Aligned episodes at hand, however many: in memory up to a budget, the others in a file of their own.
//!
//! An order that is shuffled anew for each epoch would unpack the chunks of a recording again and again, and lay out
//! the same frames each time. So an episode is read once, and what does not fit into memory is written as it is
//! ([`record`]) to a file without a name, which the system removes with the process however that ends.

mod record;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use super::error::DataError;
use crate::episode::Episode;
use crate::lock::lock;

/// Episodes by index.
#[derive(Debug)]
pub struct Store {
    slots: Vec<Slot>,
    /// Bytes that may still be held.
    room: u64,
    folder: PathBuf,
    file: Option<Mutex<File>>,
    /// Where the file ends.
    end: u64,
}

#[derive(Debug)]
struct Slot {
    id: String,
    steps: usize,
    home: Home,
}

#[derive(Debug)]
enum Home {
    Memory(Arc<Episode>),
    File { offset: u64, length: usize },
}

impl Store {
    /// An empty store that holds up to `budget` bytes, and writes what is beyond to a file in `folder`.
    pub fn new(budget: u64, folder: &Path) -> Self {
        Self {
            slots: Vec::new(),
            room: budget,
            folder: folder.to_owned(),
            file: None,
            end: 0,
        }
    }

    /// Adds an episode; returns its index.
    ///
    /// # Errors
    /// If the file cannot be made or written.
    pub fn push(&mut self, episode: Episode) -> Result<usize, DataError> {
        let (id, steps) = (episode.meta.id.clone(), episode.steps());
        let bytes = record::size(&episode);
        let home = if let Some(room) = self.room.checked_sub(bytes) {
            self.room = room;
            Home::Memory(Arc::new(episode))
        } else {
            self.spill(&episode)?
        };
        self.slots.push(Slot { id, steps, home });
        Ok(self.slots.len() - 1)
    }

    fn spill(&mut self, episode: &Episode) -> Result<Home, DataError> {
        let error = DataError::io(&self.folder);
        let mut file = match self.file.take() {
            Some(file) => file.into_inner().unwrap_or_else(PoisonError::into_inner),
            None => tempfile::tempfile_in(&self.folder).map_err(DataError::io(&self.folder))?,
        };
        let bytes = record::write(episode);
        file.seek(SeekFrom::Start(self.end))
            .and_then(|_| file.write_all(&bytes))
            .map_err(error)?;
        self.file = Some(Mutex::new(file));
        let offset = self.end;
        self.end += bytes.len() as u64;
        Ok(Home::File {
            offset,
            length: bytes.len(),
        })
    }

    /// How many episodes there are.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// T of an episode.
    pub fn steps(&self, index: usize) -> usize {
        self.slots[index].steps
    }

    /// Name of an episode.
    pub fn id(&self, index: usize) -> &str {
        &self.slots[index].id
    }

    /// Episodes in the file rather than in memory.
    pub fn spilled(&self) -> usize {
        let in_file = |slot: &&Slot| matches!(slot.home, Home::File { .. });
        self.slots.iter().filter(in_file).count()
    }

    /// An episode. Any thread may ask.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn get(&self, index: usize) -> Result<Arc<Episode>, DataError> {
        let (offset, length) = match &self.slots[index].home {
            Home::Memory(episode) => return Ok(Arc::clone(episode)),
            Home::File { offset, length } => (*offset, *length),
        };
        let mut bytes = vec![0; length];
        if let Some(file) = &self.file {
            let mut file = lock(file);
            file.seek(SeekFrom::Start(offset))
                .and_then(|_| file.read_exact(&mut bytes))
                .map_err(DataError::io(&self.folder))?;
        }
        let episode = record::read(&bytes).ok_or_else(|| DataError::Damaged {
            path: self.folder.clone(),
            offset,
            what: "an episode that was set aside there has changed".to_owned(),
        })?;
        Ok(Arc::new(episode))
    }
}

/// Some episodes of a store, in an order.
#[derive(Clone, Copy, Debug)]
pub struct Episodes<'a> {
    store: &'a Store,
    indices: &'a [usize],
}

impl<'a> Episodes<'a> {
    /// Those of `indices`, each of which the store must have.
    pub fn new(store: &'a Store, indices: &'a [usize]) -> Self {
        Self { store, indices }
    }

    /// How many there are.
    pub fn len(self) -> usize {
        self.indices.len()
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.indices.is_empty()
    }

    /// Name of the `i`-th.
    pub fn id(self, i: usize) -> &'a str {
        self.store.id(self.indices[i])
    }

    /// The `i`-th.
    ///
    /// # Errors
    /// Those of [`Store::get`].
    pub fn get(self, i: usize) -> Result<Arc<Episode>, DataError> {
        self.store.get(self.indices[i])
    }

    /// One after the other; no more than one is held at a time.
    pub fn iter(self) -> impl Iterator<Item = Result<Arc<Episode>, DataError>> + 'a {
        self.indices.iter().map(move |&index| self.store.get(index))
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;
    use crate::episode::{EpisodeMeta, Flag, Frame, Layout, PlanarPose};

    /// An episode of two steps; what a recording may lack is there on request.
    fn episode(number: u8, whole: bool) -> Episode {
        let x = f32::from(number) + 0.1;
        Episode {
            meta: EpisodeMeta {
                id: format!("push-{number}"),
                seed: Some(u64::MAX),
                ..EpisodeMeta::default()
            },
            layout: Layout {
                frame_size: 3,
                window: 2,
            },
            steps_nanos: vec![i64::MIN, 7],
            frames: [number, 255]
                .map(|grey| Frame {
                    width: 3,
                    height: 3,
                    pixels: vec![grey; 9],
                })
                .to_vec(),
            haptic: whole.then(|| vec![x; 24]),
            proprio: Some(vec![-x; 24]),
            controls: whole.then(|| vec![[x, f32::MIN_POSITIVE]]),
            object: whole.then(|| {
                vec![
                    PlanarPose {
                        x,
                        y: 2.0,
                        yaw: 3.0
                    };
                    2
                ]
            }),
            tip: Some(vec![[x, -0.0]; 2]),
            flags: vec![Flag {
                topic: "/wrench".to_owned(),
                stamp_nanos: -1,
                what: "gap of 1.0 s".to_owned(),
                gap: true,
            }],
        }
    }

    #[test]
    fn what_does_not_fit_into_memory_comes_back_from_the_file() {
        let episodes: Vec<Episode> = (0..5).map(|i| episode(i, i != 3)).collect();
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::new(2 * record::size(&episodes[0]), folder.path());
        for episode in &episodes {
            store.push(episode.clone()).unwrap();
        }
        assert_eq!((store.len(), store.spilled()), (5, 3));
        let order = [4, 0, 2, 3, 1];
        let chosen = Episodes::new(&store, &order);
        for (found, &index) in chosen.iter().zip(&order) {
            assert_eq!(*found.unwrap(), episodes[index]);
        }
        assert_eq!((chosen.id(1), store.steps(0)), ("push-0", 2));
        // Nothing is left under a name, whatever becomes of the process.
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_record_that_was_cut_is_none() {
        let bytes = record::write(&episode(1, true));
        assert_eq!(record::read(&bytes), Some(episode(1, true)));
        for length in 0..bytes.len() {
            assert_eq!(record::read(&bytes[..length]), None, "{length} bytes");
        }
    }
}
