//! The cursor in time: which step is shown, how fast it moves, what happens at the end. Pure; time is handed in.

use std::time::Duration;

use super::command::Looping;

/// A longer pause between two updates counts as this long, so that a stalled face does not jump ahead.
const LONGEST_UPDATE_SECS: f64 = 0.25;
/// Two stamps closer than this, or in the wrong order, count as this far apart.
const SHORTEST_STEP_SECS: f64 = 1e-3;
/// Speeds are powers of two from 2⁻³ to 2³.
const SPEED_LIMIT: i64 = 3;

/// Cursor, speed and looping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Playback {
    /// The step shown, from 0.
    pub cursor: usize,
    /// Whether it moves.
    pub playing: bool,
    /// What it does at the end.
    pub looping: Looping,
    /// First and last selected step; the last is none until it is chosen.
    pub selection: Option<(usize, Option<usize>)>,
    /// Speed as a power of two.
    exponent: i64,
    /// Recorded seconds gone by since the cursor came to its step.
    into_step_secs: f64,
}

impl Playback {
    /// 1 as recorded; a power of two from 1/8 to 8.
    pub fn speed(&self) -> f32 {
        2.0_f32.powi(self.exponent as i32)
    }

    /// Faster (positive) or slower by factors of two, within the limits.
    pub fn change_speed(&mut self, by: i64) {
        self.exponent = self
            .exponent
            .saturating_add(by)
            .clamp(-SPEED_LIMIT, SPEED_LIMIT);
    }

    /// Takes over a speed if it is one of the powers of two that there are.
    pub fn set_speed(&mut self, speed: f32) -> bool {
        let found = (-SPEED_LIMIT..=SPEED_LIMIT)
            .find(|&e| 2.0_f32.powi(e as i32).total_cmp(&speed).is_eq());
        self.exponent = found.unwrap_or(self.exponent);
        found.is_some()
    }

    /// Puts the cursor on a step; it stops at the last of `steps`.
    pub fn seek(&mut self, step: usize, steps: usize) {
        self.cursor = step.min(steps.saturating_sub(1));
        self.into_step_secs = 0.0;
    }

    /// Moves the cursor by so many steps; it stops at the ends.
    pub fn step(&mut self, by: i64, steps: usize) {
        let by = isize::try_from(by).unwrap_or(if by < 0 { isize::MIN } else { isize::MAX });
        self.seek(self.cursor.saturating_add_signed(by), steps);
    }

    /// Plays or pauses; playing from the end starts again.
    pub fn toggle(&mut self, steps: usize) {
        self.playing = !self.playing;
        if self.playing && self.looping == Looping::Off && self.cursor + 1 >= steps {
            self.seek(0, steps);
        }
    }

    /// Lets `dt` go by on the recording's own clock, `secs` being the time of each step. True if the cursor moved
    /// or playing ended.
    pub fn update(&mut self, dt: Duration, secs: &[f64]) -> bool {
        if !self.playing || secs.is_empty() {
            return false;
        }
        let before = (self.cursor, self.playing);
        let gone = dt.as_secs_f64().min(LONGEST_UPDATE_SECS) * f64::from(self.speed());
        self.into_step_secs += gone;
        let (first, last) = self.round(secs.len());
        while self.into_step_secs >= step_secs(secs, self.cursor) {
            self.into_step_secs -= step_secs(secs, self.cursor);
            if self.looping == Looping::Selection && !(first..last).contains(&self.cursor) {
                self.cursor = first;
            } else if self.cursor + 1 < secs.len() {
                self.cursor += 1;
            } else if self.looping != Looping::Off {
                self.cursor = 0;
            } else {
                self.playing = false;
                self.into_step_secs = 0.0;
                break;
            }
        }
        before != (self.cursor, self.playing)
    }

    /// Another episode has other steps.
    pub fn forget_selection(&mut self) {
        self.selection = None;
        if self.looping == Looping::Selection {
            self.looping = Looping::All;
        }
    }

    /// First and last selected step, once both are chosen.
    pub fn selected(&self) -> Option<(usize, usize)> {
        let (first, last) = self.selection?;
        Some((first, last?))
    }

    /// First and last step of a round.
    fn round(&self, steps: usize) -> (usize, usize) {
        let (first, last) = self.selected().unwrap_or((0, usize::MAX));
        let end = steps.saturating_sub(1);
        (first.min(end), last.min(end))
    }

    /// How soon to look again whether the cursor moves on: no later than an update counts for. None while it rests.
    pub fn next_step_in(&self, secs: &[f64]) -> Option<Duration> {
        if !self.playing || secs.is_empty() {
            return None;
        }
        let left = (step_secs(secs, self.cursor) - self.into_step_secs) / f64::from(self.speed());
        Some(Duration::from_secs_f64(
            left.clamp(0.0, LONGEST_UPDATE_SECS),
        ))
    }
}

/// How long a step is shown, in recorded seconds: until the next one; the last as long as the one before it.
fn step_secs(secs: &[f64], step: usize) -> f64 {
    let next = (step + 1).min(secs.len() - 1);
    let length = if next == 0 {
        0.0
    } else {
        secs[next] - secs[next - 1]
    };
    if length.is_finite() {
        length.max(SHORTEST_STEP_SECS)
    } else {
        SHORTEST_STEP_SECS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECS: [f64; 4] = [0.0, 0.1, 0.2, 0.5];

    fn playing(looping: Looping) -> Playback {
        Playback {
            playing: true,
            looping,
            ..Playback::default()
        }
    }

    #[test]
    fn follows_the_times_of_the_recording() {
        let mut playback = playing(Looping::All);
        assert!(!playback.update(Duration::from_millis(90), &SECS));
        assert_eq!(
            playback.next_step_in(&SECS),
            Some(Duration::from_millis(10))
        );
        assert!(playback.update(Duration::from_millis(20), &SECS));
        assert_eq!(playback.cursor, 1);
        assert!(playback.update(Duration::from_millis(100), &SECS));
        assert!(!playback.update(Duration::from_millis(200), &SECS));
        assert_eq!(
            playback.cursor, 2,
            "the third step lasts three times as long"
        );
    }

    #[test]
    fn loops_or_stops_at_the_end() {
        let mut looping = playing(Looping::All);
        looping.seek(3, 4);
        for _ in 0..2 {
            looping.update(Duration::from_millis(160), &SECS);
        }
        assert_eq!((looping.cursor, looping.playing), (0, true));

        let mut stopping = playing(Looping::Off);
        stopping.seek(3, 4);
        for _ in 0..2 {
            stopping.update(Duration::from_millis(160), &SECS);
        }
        assert_eq!((stopping.cursor, stopping.playing), (3, false));
        stopping.toggle(4);
        assert_eq!((stopping.cursor, stopping.playing), (0, true));
    }

    #[test]
    fn a_stall_does_not_jump_and_a_pause_does_not_move() {
        let mut playback = playing(Looping::All);
        playback.update(Duration::from_hours(1), &SECS);
        assert_eq!(playback.cursor, 2);
        playback.playing = false;
        assert!(!playback.update(Duration::from_secs(1), &SECS));
        assert_eq!(playback.next_step_in(&SECS), None);
    }

    #[test]
    fn a_slow_step_lasts_as_long_as_it_should_for_a_face_that_sleeps() {
        let mut playback = playing(Looping::All);
        playback.change_speed(-3);
        let mut gone = Duration::ZERO;
        while playback.cursor == 0 {
            let nap = playback.next_step_in(&SECS).unwrap_or_default();
            playback.update(nap, &SECS);
            gone += nap;
        }
        assert!((gone.as_secs_f64() - 0.8).abs() < 1e-3, "{gone:?}");
    }

    #[test]
    fn speeds_are_powers_of_two_within_limits() {
        let mut playback = playing(Looping::All);
        playback.change_speed(i64::MAX);
        assert!((playback.speed() - 8.0).abs() < f32::EPSILON);
        playback.change_speed(-99);
        assert!((playback.speed() - 0.125).abs() < f32::EPSILON);
        assert!(playback.set_speed(0.5) && !playback.set_speed(3.0));
        assert!((playback.speed() - 0.5).abs() < f32::EPSILON);
    }

    #[test]
    fn stamps_that_stand_still_or_run_backwards_do_not_hang() {
        let mut playback = playing(Looping::All);
        playback.update(Duration::from_secs(1), &[0.0, -5.0, f64::NAN, 0.0]);
        playback.update(Duration::from_secs(1), &[0.0]);
        playback.update(Duration::from_secs(1), &[]);
    }

    #[test]
    fn a_selection_goes_round() {
        let mut playback = playing(Looping::Selection);
        playback.selection = Some((0, Some(1)));
        let mut seen = Vec::new();
        for _ in 0..5 {
            let left = playback.next_step_in(&SECS).unwrap_or_default();
            playback.update(left + Duration::from_millis(1), &SECS);
            seen.push(playback.cursor);
        }
        assert_eq!(seen, [1, 0, 1, 0, 1]);
    }

    #[test]
    fn the_cursor_stops_at_the_ends() {
        let mut playback = Playback::default();
        playback.step(i64::MAX, 4);
        assert_eq!(playback.cursor, 3);
        playback.step(i64::MIN, 4);
        assert_eq!(playback.cursor, 0);
        playback.seek(7, 0);
        assert_eq!(playback.cursor, 0);
    }
}
