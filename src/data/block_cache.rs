//! The blocks that were unpacked last: neighbouring episodes often share a chunk.

use crate::lock::lock;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

/// Unpacked bytes to keep, in all.
const BYTES_LIMIT: usize = 64 << 20;

/// Which block: number of the file, offset in it.
pub(super) type Key = (usize, u64);

/// Least recently used first. Any thread may ask.
#[derive(Debug, Default)]
pub(super) struct BlockCache {
    blocks: Mutex<VecDeque<(Key, Arc<Vec<u8>>)>>,
}

impl BlockCache {
    /// The block of `key`, made by `unpack` if it is not here.
    pub(super) fn get<E>(
        &self,
        key: Key,
        unpack: impl FnOnce() -> Result<Vec<u8>, E>,
    ) -> Result<Arc<Vec<u8>>, E> {
        if let Some(block) = self.take(key) {
            self.put(key, Arc::clone(&block));
            return Ok(block);
        }
        // Unlocked, so that threads unpack side by side.
        let block = Arc::new(unpack()?);
        self.put(key, Arc::clone(&block));
        Ok(block)
    }

    fn take(&self, key: Key) -> Option<Arc<Vec<u8>>> {
        let mut blocks = lock(&self.blocks);
        let at = blocks.iter().position(|(held, _)| *held == key)?;
        blocks.remove(at).map(|(_, block)| block)
    }

    fn put(&self, key: Key, block: Arc<Vec<u8>>) {
        let mut blocks = lock(&self.blocks);
        blocks.retain(|(held, _)| *held != key);
        blocks.push_back((key, block));
        let mut bytes: usize = blocks.iter().map(|(_, block)| block.len()).sum();
        while bytes > BYTES_LIMIT {
            let Some((_, oldest)) = blocks.pop_front() else {
                break;
            };
            bytes -= oldest.len();
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;

    #[test]
    fn keeps_what_was_used_last() {
        let cache = BlockCache::default();
        let third = || Ok::<_, ()>(vec![0; BYTES_LIMIT / 3]);
        for offset in [1, 2, 3, 1, 4] {
            cache.get((0, offset), third).unwrap();
        }
        let held = |offset| cache.get((0, offset), || Err(())).is_ok();
        assert_eq!([1, 2, 3, 4].map(held), [true, false, true, true]);
    }
}
