//! How colours reach the terminal: as given, by the nearest of 256, as one of its own 16, or not at all.
//!
//! Nothing needs hue. Where a terminal has no colours to spare, letters and fills say the same.

use ratatui::style::{Color, Modifier, Style};

use crate::modality::Expert;

/// An sRGB colour.
pub type Rgb = (u8, u8, u8);

/// The prediction's colour: Okabe and Ito's sky blue, which no modality has.
pub const PREDICTION: Rgb = (0x56, 0xB4, 0xE9);
/// The second model's colour: Okabe and Ito's reddish purple. Its lines have strokes of their own as well.
pub const SECOND: Rgb = (0xCC, 0x79, 0xA7);
/// What asks for attention: Okabe and Ito's vermillion.
pub const WARNING: Rgb = (0xD5, 0x5E, 0x00);

/// How many colours there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 24 bits.
    #[default]
    True,
    /// The 256 indexed colours: a cube of 216 and a ramp of greys.
    Indexed,
    /// The terminal's own sixteen, which every user sets otherwise: letters and fills carry the meaning, a colour
    /// only repeats it, images are characters.
    Sixteen,
    /// None: letters and fills only, images as characters.
    Plain,
}

impl Depth {
    /// What the environment says of the terminal, `NO_COLOR` above all. One that names no number of colours has the
    /// sixteen that all have; only a `dumb` or unnamed one, or a monochrome one, has none.
    pub fn detect(variable: impl Fn(&str) -> Option<String>) -> Self {
        let set = |name: &str| variable(name).filter(|value| !value.is_empty());
        let term = set("TERM").unwrap_or_default();
        let direct = [
            "direct",
            "truecolor",
            "kitty",
            "alacritty",
            "foot",
            "wezterm",
            "ghostty",
        ];
        if set("NO_COLOR").is_some() || term == "dumb" || term.ends_with("-m") {
            Self::Plain
        } else if set("COLORTERM").is_some_and(|value| value == "truecolor" || value == "24bit")
            || direct.iter().any(|name| term.contains(name))
        {
            Self::True
        } else if term.contains("256") {
            Self::Indexed
        } else if term.is_empty() {
            Self::Plain
        } else {
            Self::Sixteen
        }
    }

    /// Whether there are enough colours for images and for fills to be told apart by colour alone.
    pub fn has_shades(self) -> bool {
        matches!(self, Self::True | Self::Indexed)
    }

    /// This terminal's version of a colour; the terminal's own foreground where there is none.
    pub fn color(self, rgb: Rgb) -> Color {
        match self {
            Self::True => Color::Rgb(rgb.0, rgb.1, rgb.2),
            Self::Indexed => Color::Indexed(nearest_indexed(rgb)),
            Self::Sixteen => ansi(rgb),
            Self::Plain => Color::Reset,
        }
    }

    /// Text or fill in a colour.
    pub fn ink(self, rgb: Rgb) -> Style {
        match self {
            Self::Plain => Style::new(),
            _ => Style::new().fg(self.color(rgb)),
        }
    }
}

/// Titles and values that matter.
pub fn strong() -> Style {
    Style::new().add_modifier(Modifier::BOLD)
}

/// Labels, units and rules.
pub fn dim() -> Style {
    Style::new().add_modifier(Modifier::DIM)
}

/// The palette in the names that sixteen-colour terminals have. Chosen by hand: by distance, vision and proprio would
/// both be cyan. Greys are the terminal's own foreground, since its two greys may be its background.
fn ansi(rgb: Rgb) -> Color {
    let named = [
        (Expert::Vision.rgb(), Color::Blue),
        (Expert::Haptic.rgb(), Color::Red),
        (Expert::Proprio.rgb(), Color::Green),
        (Expert::Joint.rgb(), Color::Yellow),
        (Expert::Concat.rgb(), Color::Magenta),
        (PREDICTION, Color::Cyan),
        (WARNING, Color::Red),
    ];
    if let Some(&(_, color)) = named.iter().find(|(known, _)| *known == rgb) {
        return color;
    }
    let (r, g, b) = rgb;
    let (low, high) = (r.min(g).min(b), r.max(g).max(b));
    if high - low < 48 {
        return Color::Reset;
    }
    let middle = low.midpoint(high);
    match (r > middle, g > middle, b > middle) {
        (true, true, _) => Color::Yellow,
        (true, false, false) => Color::Red,
        (true, false, true) => Color::Magenta,
        (false, true, false) => Color::Green,
        (false, true, true) => Color::Cyan,
        (false, false, _) => Color::Blue,
    }
}

/// The nearest of the 6×6×6 cube and the 24 greys of the 256-colour palette.
fn nearest_indexed((r, g, b): Rgb) -> u8 {
    const LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];
    let nearest = |value: u8| {
        (0..6_u8)
            .min_by_key(|&i| LEVELS[usize::from(i)].abs_diff(value))
            .unwrap_or(0)
    };
    let distance = |a: Rgb| {
        let square = |x: u8, y: u8| u32::from(x.abs_diff(y)).pow(2);
        square(a.0, r) + square(a.1, g) + square(a.2, b)
    };
    let cube = [nearest(r), nearest(g), nearest(b)];
    let [cr, cg, cb] = cube.map(|i| LEVELS[usize::from(i)]);
    let mean = (u16::from(r) + u16::from(g) + u16::from(b)) / 3;
    let step = (mean.saturating_sub(3) / 10).min(23) as u8;
    let grey = 8 + 10 * step;
    if distance((grey, grey, grey)) < distance((cr, cg, cb)) {
        232 + step
    } else {
        16 + 36 * cube[0] + 6 * cube[1] + cube[2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detect(pairs: &[(&str, &str)]) -> Depth {
        Depth::detect(|name| {
            let found = pairs.iter().find(|(key, _)| *key == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn no_color_wins_over_what_the_terminal_can() {
        assert_eq!(detect(&[("COLORTERM", "truecolor")]), Depth::True);
        assert_eq!(detect(&[("TERM", "xterm-256color")]), Depth::Indexed);
        for sixteen in ["linux", "xterm", "screen", "vt220"] {
            assert_eq!(detect(&[("TERM", sixteen)]), Depth::Sixteen, "{sixteen}");
        }
        for plain in ["dumb", "xterm-m"] {
            assert_eq!(detect(&[("TERM", plain)]), Depth::Plain, "{plain}");
        }
        assert_eq!(detect(&[]), Depth::Plain);
        assert_eq!(
            detect(&[("TERM", "linux"), ("NO_COLOR", "1")]),
            Depth::Plain
        );
        assert_eq!(
            detect(&[("COLORTERM", "truecolor"), ("NO_COLOR", "1")]),
            Depth::Plain
        );
        assert_eq!(
            detect(&[("COLORTERM", "truecolor"), ("NO_COLOR", "")]),
            Depth::True
        );
    }

    #[test]
    fn sixteen_colours_tell_the_experts_of_one_model_apart() {
        let of = |experts: &[Expert]| -> Vec<Color> {
            let colors = experts
                .iter()
                .map(|expert| Depth::Sixteen.color(expert.rgb()));
            colors.collect()
        };
        for model in [
            &[
                Expert::Vision,
                Expert::Haptic,
                Expert::Proprio,
                Expert::Prior,
            ][..],
            &[Expert::Vision, Expert::Joint, Expert::Prior],
        ] {
            let colors = of(model);
            for (i, color) in colors.iter().enumerate() {
                assert!(!colors[..i].contains(color), "{model:?}: {colors:?}");
            }
        }
        assert_eq!(Depth::Sixteen.color((200, 200, 210)), Color::Reset);
        assert_eq!(Depth::Sixteen.color((33, 102, 172)), Color::Blue);
        assert_eq!(Depth::Sixteen.color((230, 97, 1)), Color::Red);
    }

    #[test]
    fn greys_take_the_ramp_and_corners_the_cube() {
        assert_eq!(nearest_indexed((0, 0, 0)), 16);
        assert_eq!(nearest_indexed((255, 255, 255)), 231);
        assert_eq!(nearest_indexed((128, 128, 128)), 244);
        assert_eq!(nearest_indexed((255, 0, 0)), 196);
    }
}
