//! From values to a part of an axis, and the round numbers to print beside it.

/// An axis from one value to another, even in the values or in their logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The value at its beginning.
    pub low: f32,
    /// The value at its end.
    pub high: f32,
    /// Whether equal factors take equal room.
    pub is_log: bool,
}

impl Scale {
    /// An axis between these ends; equal ones are moved apart.
    pub fn linear(low: f32, high: f32) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Self {
            low,
            high,
            is_log: false,
        }
    }

    /// An axis from zero to a round number that holds all the values.
    pub fn from_zero(values: impl Iterator<Item = f32>) -> Self {
        let most = values.filter(|value| value.is_finite()).fold(0.0, f32::max);
        Self::linear(0.0, round_up(most * 1.05))
    }

    /// An axis between round numbers that holds all the values; none without any.
    pub fn around(values: impl Iterator<Item = f32>) -> Option<Self> {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        (low <= high).then(|| {
            let step = round_up((high - low).max(1e-6) / 4.0);
            let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
            Self::linear(low, high)
        })
    }

    /// An axis of factors between positive ends.
    pub fn log(low: f32, high: f32) -> Self {
        let low = low.max(1e-6);
        Self {
            low,
            high: high.max(low * 2.0),
            is_log: true,
        }
    }

    /// Where a value lies: 0 at the beginning, 1 at the end, beyond them outside.
    pub fn part(self, value: f32) -> f32 {
        if self.is_log {
            (value.max(1e-9) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// About so many round numbers on it, in order, with how they are written; its ends, where there would be one.
    pub fn ticks(self, most: usize) -> Vec<(f32, String)> {
        if most == 0 || !self.low.is_finite() || !self.high.is_finite() {
            return Vec::new();
        }
        if self.is_log {
            return self.log_ticks(most);
        }
        let step = round_up((self.high - self.low) / most as f32);
        let first = (self.low / step - 1e-3).ceil() as i64;
        let last = (self.high / step + 1e-3).floor() as i64;
        let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
        let tick = |value: f32| (value, format!("{value:.decimals$}"));
        // A low plot has room for no more than its ends.
        if last <= first && most > 0 {
            return vec![tick(self.low), tick(self.high)];
        }
        (first..=last).map(|i| tick(i as f32 * step)).collect()
    }

    fn log_ticks(self, most: usize) -> Vec<(f32, String)> {
        let is_short = self.high / self.low < 50.0;
        let steps: &[f32] = if most > 4 || is_short {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let tick = |value: f32| {
            let decimals = (-value.log10().floor()).clamp(0.0, 6.0) as usize;
            (value, format!("{value:.decimals$}"))
        };
        decades
            .flat_map(|decade| steps.iter().map(move |step| step * 10_f32.powi(decade)))
            .filter(|&value| (-1e-3..=1.001).contains(&self.part(value)))
            .map(tick)
            .collect()
    }
}

/// The next of 1, 2 and 5 times a power of ten.
pub fn round_up(value: f32) -> f32 {
    if !value.is_finite() || value <= 0.0 {
        return 1.0;
    }
    let power = 10_f32.powf(value.log10().floor());
    let rounded = [1.0, 2.0, 5.0].map(|step| step * power);
    rounded
        .into_iter()
        .find(|&step| step >= value * 0.999)
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, most: usize) -> Vec<String> {
        scale
            .ticks(most)
            .into_iter()
            .map(|(_, label)| label)
            .collect()
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(labels(Scale::linear(0.0, 1.0), 2), ["0.0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::linear(-3.0, 12.0), 4), ["0", "5", "10"]);
        assert_eq!(
            labels(Scale::log(1.0, 60.0), 6),
            ["1", "2", "5", "10", "20", "50"]
        );
        assert!(labels(Scale::linear(f32::NAN, 1.0), 4).is_empty());
        assert_eq!(labels(Scale::linear(10.0, 30.0), 1), ["10", "30"]);
    }

    #[test]
    fn an_axis_holds_its_values() {
        let scale =
            Scale::around([23.4, 29.1, f32::NAN].into_iter()).unwrap_or(Scale::linear(0.0, 0.0));
        assert_eq!((scale.low, scale.high), (22.0, 30.0));
        assert_eq!(Scale::around([f32::NAN].into_iter()), None);
        assert!((Scale::log(1.0, 100.0).part(10.0) - 0.5).abs() < 1e-6);
        assert!((Scale::from_zero([1.7].into_iter()).high - 2.0).abs() < 1e-6);
    }
}
