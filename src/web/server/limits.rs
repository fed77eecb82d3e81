//! How much one viewer may say.

use std::time::Instant;

/// Messages a second, in the long run. A viser client that drags everything at once stays below 150.
const RATE: f64 = 200.0;
/// Messages at once.
const BURST: f64 = 400.0;

/// What one viewer may still say.
#[derive(Debug)]
pub struct Allowance {
    left: f64,
    since: Instant,
}

impl Allowance {
    /// Of one who has said nothing yet.
    pub fn new(now: Instant) -> Self {
        Self {
            left: BURST,
            since: now,
        }
    }

    /// Takes one message off; false if there was none left.
    pub fn take(&mut self, now: Instant) -> bool {
        let gone = now.saturating_duration_since(self.since).as_secs_f64();
        self.left = (self.left + RATE * gone).min(BURST);
        self.since = now;
        let may = self.left >= 1.0;
        self.left -= f64::from(u8::from(may));
        may
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_burst_is_taken_a_flood_is_not_and_time_mends_it() {
        let start = Instant::now();
        let mut allowance = Allowance::new(start);
        assert_eq!((0..1000).filter(|_| allowance.take(start)).count(), 400);
        let later = start + Duration::from_millis(500);
        assert_eq!((0..1000).filter(|_| allowance.take(later)).count(), 100);
    }
}
