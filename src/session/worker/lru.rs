//! A small memo that forgets what was used longest ago.

/// At most `capacity` values; looked up by comparing keys one by one, so for a handful of them.
#[derive(Debug)]
pub struct Lru<K, V> {
    capacity: usize,
    /// The most recently used last.
    entries: Vec<(K, V)>,
}

impl<K: PartialEq, V> Lru<K, V> {
    /// An empty memo.
    pub fn new(capacity: usize) -> Self {
        Self {
            capacity,
            entries: Vec::new(),
        }
    }

    /// The value of a key, which becomes the most recently used.
    pub fn get(&mut self, key: &K) -> Option<&mut V> {
        let found = self.entries.iter().position(|(k, _)| k == key)?;
        let entry = self.entries.remove(found);
        self.entries.push(entry);
        self.entries.last_mut().map(|(_, value)| value)
    }

    /// Drops some of the keys.
    pub fn forget(&mut self, which: impl Fn(&K) -> bool) {
        self.entries.retain(|(key, _)| !which(key));
    }

    /// The value of a key, made where it is missing.
    pub fn get_or_try_insert<E>(
        &mut self,
        key: K,
        make: impl FnOnce() -> Result<V, E>,
    ) -> Result<&mut V, E> {
        let entry = match self.entries.iter().position(|(k, _)| *k == key) {
            Some(found) => self.entries.remove(found),
            None => (key, make()?),
        };
        if self.entries.len() >= self.capacity {
            self.entries.remove(0);
        }
        Ok(&mut self.entries.push_mut(entry).1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forgets_what_was_used_longest_ago() {
        let mut lru = Lru::new(2);
        let mut make = |key: u8| {
            let mut made = false;
            let _ = lru.get_or_try_insert(key, || {
                made = true;
                Ok::<_, ()>(key)
            });
            made
        };
        assert!(make(1) && make(2) && !make(1) && make(3));
        assert!(!make(1) && make(2));
        assert_eq!(lru.get(&3), None);
        assert_eq!(lru.get(&2), Some(&mut 2));
    }

    #[test]
    fn a_failure_is_not_remembered() {
        let mut lru = Lru::<u8, u8>::new(2);
        assert_eq!(lru.get_or_try_insert(1, || Err("no")), Err("no"));
        assert_eq!(lru.get_or_try_insert(1, || Ok::<_, ()>(5)), Ok(&mut 5));
    }
}
