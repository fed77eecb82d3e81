//! FNV-1a, 64 bits: a hash that is the same on every run and machine (not for secrets).

/// A running hash.
pub(super) struct Fnv(u64);

impl Fnv {
    /// The offset basis.
    pub(super) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes `bytes` in.
    pub(super) fn update(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash so far.
    pub(super) fn value(&self) -> u64 {
        self.0
    }

    /// The hash so far as 16 hexadecimal digits.
    pub(super) fn hex(&self) -> String {
        format!("{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_published_vector() {
        // http://www.isthe.com/chongo/tech/comp/fnv/: FNV-1a 64 of "foobar".
        let mut hash = Fnv::new();
        hash.update(b"foo");
        hash.update(b"bar");
        assert_eq!(hash.hex(), "85944171f73967e8");
    }
}
