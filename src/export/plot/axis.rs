//! Round numbers along an axis.

/// Numbers at round steps within `[low, high]`, about `count` of them; none where the range is empty or not finite.
pub fn ticks([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    let rough = (high - low) / count.max(1) as f64;
    if !(rough.is_finite() && rough > 0.0) {
        return Vec::new();
    }
    let unit = 10_f64.powf(rough.log10().floor());
    if !unit.is_normal() {
        return Vec::new();
    }
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * unit)
        .find(|step| *step >= rough * 0.999)
        .unwrap_or(unit);
    let first = (low / step - 1e-6).ceil() as i64;
    let last = (high / step + 1e-6).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// A number with as many digits as tell it from its neighbours.
pub fn label(value: f64, step: f64) -> String {
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    // Rounding may leave a zero with a sign.
    if text.trim_start_matches('-').parse() == Ok(0.0) {
        return text.trim_start_matches('-').to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        assert_eq!(ticks([0.0, 10.0], 5), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(ticks([17.3, 28.9], 4), [20.0, 25.0]);
        let small: Vec<String> = ticks([0.81, 0.97], 4)
            .into_iter()
            .map(|t| label(t, 0.05))
            .collect();
        assert_eq!(small, ["0.85", "0.90", "0.95"]);
        assert_eq!(ticks([1.0, 1.0], 4), [0.0; 0]);
        assert_eq!(ticks([0.0, f64::NAN], 4), [0.0; 0]);
        assert_eq!(ticks([0.0, 3e-323], 4), [0.0; 0]);
        assert_eq!(label(-0.0, 1.0), "0");
    }
}
