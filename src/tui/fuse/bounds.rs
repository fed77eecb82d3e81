//! Where a reading lies against the bounds that 95 % of well-specified experts keep: a mark, so that no hue is needed.

use crate::measure::chi2::Bounds;

/// `▲` above the bounds, `▼` below them, a blank inside them and where there are none.
pub fn mark(value: f32, bounds: Option<Bounds>) -> char {
    match bounds {
        Some(bounds) if value > bounds.high => '▲',
        Some(bounds) if value < bounds.low => '▼',
        _ => ' ',
    }
}

/// The bounds as they are stated: `6.9–28.8`.
pub fn range(bounds: Bounds) -> String {
    format!("{:.1}–{:.1}", bounds.low, bounds.high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lies_outside_is_marked() {
        let bounds = Some(Bounds {
            low: 6.9,
            high: 28.8,
        });
        assert_eq!(
            [30.0, 20.0, 6.9, 1.0].map(|v| mark(v, bounds)),
            ['▲', ' ', ' ', '▼']
        );
        assert_eq!(mark(f32::NAN, bounds), ' ');
        assert_eq!(mark(1e9, None), ' ');
    }
}
