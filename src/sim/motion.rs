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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn turns_add_up_beyond_half_a_turn() {
        let mut recording = Recording::default();
        for i in 0..=10_i64 {
            let yaw = 0.4 * i as f64;
            let wrapped = yaw.sin().atan2(yaw.cos());
            recording.object.push(i, [0.01 * i as f64, 0.0, wrapped]);
        }
        let motion = Motion::of(&recording).expect("the recording has poses");
        assert!((motion.turn_rad - 4.0).abs() < 1e-9 && motion.turn_rad > PI);
        assert!((motion.shift_m - 0.1).abs() < 1e-12);
        assert!(motion.is_marked() && !motion.in_contact);
        assert_eq!(Motion::of(&Recording::default()), None);
    }

    #[test]
    fn percentiles_are_nearest_ranks() {
        let mut motions = Motions::default();
        motions.extend((1..=100).rev().map(|i| Motion {
            shift_m: f64::from(i) / 1000.0,
            turn_rad: 0.0,
            in_contact: i > 25,
        }));
        let text = motions.to_string();
        assert!(text.contains("contact     75.0 %"), "{text}");
        assert!(text.contains("moved > 1 cm or > 5°      90.0 %"), "{text}");
        assert!(text.contains("0.5 / 5.0 / 9.5 cm"), "{text}");
        let empty = Motions::default().to_string();
        assert!(empty.contains("0.0 / 0.0 / 0.0 cm"), "{empty}");
    }
}
