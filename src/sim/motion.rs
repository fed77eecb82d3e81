//! What a push did to the plate, per episode and over many.

use std::fmt;

use crate::episode::Recording;

/// A force beyond the sensor's noise, in newtons: the plate was touched.
const CONTACT_NEWTONS: f64 = 0.5;

/// What one episode did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// From the plate's first to its last position, in metres.
    pub shift_m: f64,
    /// From its first to its last yaw, unsigned, over whole turns, in radians.
    pub turn_rad: f64,
    /// Whether the rod felt the plate.
    pub in_contact: bool,
}

impl Motion {
    /// The motion that a recording shows; none if it has no object poses.
    pub fn of(recording: &Recording) -> Option<Self> {
        let poses = &recording.object.values;
        let ([x0, y0, _], [x1, y1, _]) = (poses.first()?, poses.last()?);
        // Yaw is recorded within half a turn; small differences add up to whole turns.
        let turn: f64 = poses
            .windows(2)
            .map(|pair| {
                let difference = pair[1][2] - pair[0][2];
                difference.sin().atan2(difference.cos())
            })
            .sum();
        let in_contact = recording
            .wrench
            .values
            .iter()
            .any(|[fx, fy, ..]| fx.hypot(*fy) > CONTACT_NEWTONS);
        Some(Self {
            shift_m: (x1 - x0).hypot(y1 - y0),
            turn_rad: turn.abs(),
            in_contact,
        })
    }

    /// Whether the plate moved more than 1 cm or turned more than 5°.
    pub fn is_marked(&self) -> bool {
        self.shift_m > 0.01 || self.turn_rad.to_degrees() > 5.0
    }
}

/// How a set of episodes is distributed; shown as a few lines of text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motions(Vec<Motion>);

impl Extend<Motion> for Motions {
    fn extend<I: IntoIterator<Item = Motion>>(&mut self, motions: I) {
        self.0.extend(motions);
    }
}

impl Motions {
    /// Share of the episodes with some property, 0 to 1.
    pub fn share(&self, property: impl Fn(&Motion) -> bool) -> f64 {
        let count = self.0.iter().filter(|motion| property(motion)).count();
        count as f64 / self.0.len().max(1) as f64
    }

    /// The 5th, 50th and 95th percentile of a value, by nearest rank; zeros if there is no episode.
    pub fn percentiles(&self, value: impl Fn(&Motion) -> f64) -> [f64; 3] {
        let mut values: Vec<f64> = self.0.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        [0.05, 0.50, 0.95].map(|share| {
            let rank = (share * values.len() as f64).ceil() as usize;
            values.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
        })
    }
}

impl fmt::Display for Motions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |property: fn(&Motion) -> bool| 100.0 * self.share(property);
        let [low, middle, high] = self.percentiles(|motion| 100.0 * motion.shift_m);
        writeln!(
            f,
            "episodes with contact    {:5.1} %",
            percent(|m| m.in_contact)
        )?;
        writeln!(
            f,
            "moved > 1 cm or > 5°     {:5.1} %",
            percent(Motion::is_marked)
        )?;
        writeln!(
            f,
            "shift, 5/50/95 %         {low:.1} / {middle:.1} / {high:.1} cm"
        )?;
        let [low, middle, high] = self.percentiles(|motion| motion.turn_rad.to_degrees());
        write!(
            f,
            "turn, 5/50/95 %          {low:.1} / {middle:.1} / {high:.1}°"
        )
    }
}
