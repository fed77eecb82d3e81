//! What part of each pixel of a cell its character covers: blocks and braille exactly, letters from a bitmap font.

use font8x8::legacy::{BASIC_LEGACY, BOX_LEGACY, GREEK_LEGACY, LATIN_LEGACY};

/// Columns of a cell.
pub const WIDTH: usize = 8;
/// Rows of a cell.
pub const HEIGHT: usize = 16;

/// Characters that the font lacks: eight rows of eight bits, the leftmost the highest.
const MARKS: [(char, [u8; 8]); 20] = [
    ('●', [0x00, 0x3c, 0x7e, 0x7e, 0x7e, 0x7e, 0x3c, 0x00]),
    ('○', [0x00, 0x3c, 0x66, 0x42, 0x42, 0x66, 0x3c, 0x00]),
    ('□', [0x00, 0x7e, 0x42, 0x42, 0x42, 0x42, 0x7e, 0x00]),
    ('◐', [0x00, 0x3c, 0x76, 0x72, 0x72, 0x76, 0x3c, 0x00]),
    ('◆', [0x00, 0x18, 0x3c, 0x7e, 0x7e, 0x3c, 0x18, 0x00]),
    ('◇', [0x00, 0x18, 0x24, 0x42, 0x42, 0x24, 0x18, 0x00]),
    ('▲', [0x00, 0x18, 0x18, 0x3c, 0x3c, 0x7e, 0x7e, 0x00]),
    ('▼', [0x00, 0x7e, 0x7e, 0x3c, 0x3c, 0x18, 0x18, 0x00]),
    ('▸', [0x20, 0x30, 0x38, 0x3c, 0x3c, 0x38, 0x30, 0x20]),
    ('←', [0x00, 0x10, 0x30, 0x7f, 0x7f, 0x30, 0x10, 0x00]),
    ('→', [0x00, 0x08, 0x0c, 0xfe, 0xfe, 0x0c, 0x08, 0x00]),
    ('↑', [0x18, 0x3c, 0x7e, 0x18, 0x18, 0x18, 0x18, 0x18]),
    ('↓', [0x18, 0x18, 0x18, 0x18, 0x18, 0x7e, 0x3c, 0x18]),
    ('⏎', [0x06, 0x06, 0x16, 0x36, 0x7e, 0x7e, 0x30, 0x10]),
    ('…', [0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xdb, 0xdb]),
    ('–', [0x00, 0x00, 0x00, 0x7e, 0x7e, 0x00, 0x00, 0x00]),
    ('−', [0x00, 0x00, 0x00, 0x7e, 0x7e, 0x00, 0x00, 0x00]),
    ('‖', [0x66, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66, 0x66]),
    ('ᵀ', [0x7c, 0x10, 0x10, 0x10, 0x00, 0x00, 0x00, 0x00]),
    ('≤', [0x06, 0x18, 0x60, 0x18, 0x06, 0x00, 0x7e, 0x00]),
];

/// From 0, the ground, to 1, the letter.
pub fn coverage(symbol: char, x: usize, y: usize) -> f32 {
    let solid = |is: bool| f32::from(u8::from(is));
    match symbol as u32 {
        0x2580 => solid(y < HEIGHT / 2),
        // Eighths from below, up to the full block.
        eighths @ 0x2581..=0x2588 => solid(HEIGHT - y <= (eighths - 0x2580) as usize * HEIGHT / 8),
        // Eighths from the left, the fewer the later.
        fewer @ 0x2589..=0x258f => solid(x < (0x2590 - fewer) as usize * WIDTH / 8),
        0x2590 => solid(x >= WIDTH / 2),
        shade @ 0x2591..=0x2593 => (shade - 0x2590) as f32 / 4.0,
        0x2594 => solid(y < HEIGHT / 8),
        0x2595 => solid(x == WIDTH - 1),
        dots @ 0x2800..=0x28ff => solid(braille(dots - 0x2800, x, y)),
        code => solid(letter(symbol, code as usize, x, y / 2)),
    }
}

/// Two columns of four dots, each two pixels wide, with room around.
fn braille(dots: u32, x: usize, y: usize) -> bool {
    let (column, row) = (x / 4, y / 4);
    let inside = (1..3).contains(&(x % 4)) && (1..3).contains(&(y % 4));
    let bit = match (column, row) {
        (0, 3) => 6,
        (_, 3) => 7,
        (column, row) => 3 * column + row,
    };
    inside && dots >> bit & 1 == 1
}

/// The font has eight rows, each of which becomes two.
fn letter(symbol: char, code: usize, x: usize, row: usize) -> bool {
    if let Some((_, rows)) = MARKS.iter().find(|(mark, _)| *mark == symbol) {
        return rows[row] >> (WIDTH - 1 - x) & 1 == 1;
    }
    let from = |table: &[[u8; 8]], first: usize| table.get(code.wrapping_sub(first)).copied();
    let glyph = from(&BASIC_LEGACY, 0)
        .or_else(|| from(&LATIN_LEGACY, 0xa0))
        .or_else(|| from(&GREEK_LEGACY, 0x390))
        .or_else(|| from(&BOX_LEGACY, 0x2500));
    // In the font the leftmost is the lowest bit.
    glyph.unwrap_or(BASIC_LEGACY['?' as usize])[row] >> x & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(symbol: char) -> f32 {
        let all = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
        all.map(|(x, y)| coverage(symbol, x, y)).sum()
    }

    #[test]
    fn blocks_cover_what_they_say() {
        let whole = (WIDTH * HEIGHT) as f32;
        for (symbol, part) in [
            (' ', 0.0),
            ('█', 1.0),
            ('▀', 0.5),
            ('▄', 0.5),
            ('▌', 0.5),
            ('▐', 0.5),
            ('▁', 0.125),
            ('▇', 0.875),
            ('▏', 0.125),
            ('▉', 0.875),
            ('▔', 0.125),
            ('░', 0.25),
            ('▓', 0.75),
        ] {
            assert!((covered(symbol) - part * whole).abs() < 1e-3, "{symbol}");
        }
    }

    #[test]
    fn braille_has_its_dots_where_they_belong() {
        assert!((covered('⣿') - 32.0).abs() < 1e-3);
        for (symbol, x, y) in [
            ('⠁', 1, 1),
            ('⠈', 5, 1),
            ('⡀', 1, 13),
            ('⢀', 5, 13),
            ('⠄', 1, 9),
        ] {
            assert!(coverage(symbol, x, y) > 0.5, "{symbol}");
            assert!((covered(symbol) - 4.0).abs() < 1e-3, "{symbol}");
        }
    }

    /// A question mark stands for what cannot be drawn; none of what the screens are made of may be one.
    #[test]
    fn every_character_of_the_screens_can_be_drawn() {
        let pixels = |symbol: char| -> Vec<bool> {
            let all = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
            all.map(|(x, y)| coverage(symbol, x, y) > 0.5).collect()
        };
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/tui");
        let mut seen = std::collections::BTreeSet::new();
        for folder in ["snapshots", "tests/snapshots"].map(|name| format!("{folder}/{name}")) {
            for entry in std::fs::read_dir(folder).expect("snapshots") {
                let path = entry.expect("an entry").path();
                seen.extend(std::fs::read_to_string(path).expect("text").chars());
            }
        }
        assert!(seen.len() > 150);
        let unknown: String = seen
            .into_iter()
            .filter(|symbol| *symbol != '?' && pixels(*symbol) == pixels('?'))
            .collect();
        assert_eq!(unknown, "");
    }
}
