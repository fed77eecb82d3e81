//! Two images in one place: their difference, by turns, or either side of a border. A is the model's image, B that of
//! the second model, or the truth where there is none.

use std::time::Duration;

use super::image::Raster;

/// How long blinking shows either one.
pub const BLINK: Duration = Duration::from_millis(500);
/// The border where a wipe begins, and where it goes from there.
const BORDERS: [f32; 3] = [0.5, 0.75, 0.25];

/// How A and B share a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Compare {
    /// A alone.
    #[default]
    Off,
    /// A minus B.
    Difference,
    /// By turns; whether it is B's.
    Blink(bool),
    /// A left of this part of the width, B right of it.
    Wipe(f32),
}

impl Compare {
    /// Differences, or A alone again.
    #[must_use]
    pub fn difference(self) -> Self {
        match self {
            Self::Difference => Self::Off,
            _ => Self::Difference,
        }
    }

    /// By turns, beginning with A, or A alone again.
    #[must_use]
    pub fn blink(self) -> Self {
        match self {
            Self::Blink(_) => Self::Off,
            _ => Self::Blink(false),
        }
    }

    /// A border in the middle, then a quarter to the right, a quarter to the left, and A alone again.
    #[must_use]
    pub fn wipe(self) -> Self {
        let Self::Wipe(border) = self else {
            return Self::Wipe(BORDERS[0]);
        };
        // After a drag to some other place the next key goes back to the middle.
        let at = BORDERS.iter().position(|&b| (b - border).abs() < 1e-3);
        match at {
            Some(at) => BORDERS.get(at + 1).map_or(Self::Off, |&b| Self::Wipe(b)),
            None => Self::Wipe(BORDERS[0]),
        }
    }
}

/// A left of the border and B right of it, with a light line between them; none where their sizes differ.
pub fn wiped(a: &Raster, b: &Raster, border: f32) -> Option<Raster> {
    let same = (a.width, a.height) == (b.width, b.height) && a.values.len() == b.values.len();
    if !same || a.width == 0 || a.signed != b.signed {
        return None;
    }
    let at = (border.clamp(0.0, 1.0) * a.width as f32).round() as usize;
    // Wide enough to survive being shrunk to half a cell.
    let line = a.width.div_ceil(32);
    let values = a.values.iter().zip(&b.values).enumerate();
    let values = values.map(|(i, (&a_value, &b_value))| match i % a.width {
        column if column < at => a_value,
        column if column < at + line => 1.0,
        _ => b_value,
    });
    Some(Raster {
        values: values.collect(),
        ..a.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_mode_ends_by_its_own_key() {
        let off = Compare::Off;
        assert_eq!(off.difference().difference(), off);
        assert_eq!(off.blink(), Compare::Blink(false));
        assert_eq!(Compare::Blink(true).blink(), off);
        assert_eq!(off.difference().blink(), Compare::Blink(false));
    }

    #[test]
    fn a_wipe_goes_by_quarters_and_ends() {
        let mut compare = Compare::Off;
        for border in BORDERS {
            compare = compare.wipe();
            assert_eq!(compare, Compare::Wipe(border));
        }
        assert_eq!(compare.wipe(), Compare::Off);
        assert_eq!(Compare::Wipe(0.1).wipe(), Compare::Wipe(0.5));
    }

    #[test]
    fn a_border_stands_between_the_two() {
        let image = |value: f32| Raster {
            width: 4,
            height: 1,
            values: vec![value; 4],
            signed: false,
        };
        let both = wiped(&image(0.25), &image(0.75), 0.5).map(|raster| raster.values);
        assert_eq!(both, Some(vec![0.25, 0.25, 1.0, 0.75]));
        let other = Raster {
            width: 2,
            height: 2,
            ..image(0.0)
        };
        assert_eq!(wiped(&image(0.0), &other, 0.5), None);
    }
}
