//! Pixels, rectangles, and letters of eight by eight.

use font8x8::legacy::BASIC_LEGACY;

use super::PIXELS_LIMIT;

/// A colour.
pub type Rgb = [u8; 3];

/// Ground.
pub const WHITE: Rgb = [255; 3];
/// Letters and borders.
pub const BLACK: Rgb = [0; 3];
/// Where there is no frame.
pub const NOTHING: Rgb = [232; 3];
/// Side of a letter in pixels.
pub const LETTER: usize = 8;

/// A picture, white at first. What is drawn outside of it is cut off.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

impl Canvas {
    /// So many columns and rows.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![WHITE; width * height],
        }
    }

    /// The same; none, and no memory taken, where that is more than a picture may have.
    pub fn within_limit(width: usize, height: usize) -> Option<Self> {
        let pixels = width.checked_mul(height)?;
        (pixels <= PIXELS_LIMIT).then(|| Self::new(width, height))
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Row major.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// One above the other, at the left.
    pub fn stack(blocks: &[Self]) -> Self {
        let width = blocks.iter().map(Self::width).max().unwrap_or(0);
        let height = blocks.iter().map(Self::height).sum();
        let mut stacked = Self::new(width, height);
        let mut top = 0;
        for block in blocks {
            for (row, pixels) in block.pixels.chunks_exact(block.width.max(1)).enumerate() {
                let at = (top + row) * width;
                stacked.pixels[at..at + block.width].copy_from_slice(pixels);
            }
            top += block.height;
        }
        stacked
    }

    /// A filled rectangle.
    pub fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], color: Rgb) {
        let (left, right) = (x.min(self.width), (x + width).min(self.width));
        for row in y..(y + height).min(self.height) {
            let at = row * self.width;
            self.pixels[at + left..at + right].fill(color);
        }
    }

    /// A picture of `width` columns, each of its pixels a square of side `zoom`.
    pub fn picture(&mut self, [x, y]: [usize; 2], width: usize, zoom: usize, pixels: &[Rgb]) {
        for (i, &color) in pixels.iter().enumerate() {
            let (column, row) = (i % width.max(1), i / width.max(1));
            self.fill([x + column * zoom, y + row * zoom], [zoom; 2], color);
        }
    }

    /// A line of letters; what is not ASCII is a question mark.
    pub fn text(&mut self, [x, y]: [usize; 2], text: &str, color: Rgb) {
        for (i, letter) in text.chars().enumerate() {
            let letter = if letter.is_ascii() { letter } else { '?' };
            let glyph = BASIC_LEGACY.get(letter as usize).copied();
            for (row, bits) in glyph.unwrap_or_default().into_iter().enumerate() {
                for column in (0..LETTER).filter(|column| bits >> column & 1 == 1) {
                    self.fill([x + i * LETTER + column, y + row], [1; 2], color);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_enlarged_by_whole_squares_and_cut_at_the_edge() {
        let mut canvas = Canvas::new(5, 4);
        canvas.picture([1, 1], 2, 2, &[[1; 3], [2; 3], [3; 3], [4; 3]]);
        let greys: Vec<u8> = canvas.pixels().iter().map(|pixel| pixel[0]).collect();
        assert_eq!(greys[..5], [255; 5]);
        assert_eq!(greys[5..10], [255, 1, 1, 2, 2]);
        assert_eq!(greys[10..15], greys[5..10]);
        assert_eq!(greys[15..], [255, 3, 3, 4, 4]);
        canvas.text([4, 3], "\u{e9}A", BLACK);
    }

    #[test]
    fn what_would_fill_the_memory_is_not_even_begun() {
        for (width, height) in [(1 << 20, 1 << 20), (usize::MAX, 2), (PIXELS_LIMIT + 1, 1)] {
            assert_eq!(Canvas::within_limit(width, height), None);
        }
        assert_eq!(Canvas::within_limit(3, 2), Some(Canvas::new(3, 2)));
    }

    #[test]
    fn letters_stand_upright_and_the_right_way_round() {
        let mut canvas = Canvas::new(8, 8);
        canvas.text([0, 0], "F", BLACK);
        let dark = |x: usize, y: usize| canvas.pixels()[y * 8 + x] == BLACK;
        let count = |xs: std::ops::Range<usize>, ys: std::ops::Range<usize>| {
            let all = ys.flat_map(|y| xs.clone().map(move |x| (x, y)));
            all.filter(|&(x, y)| dark(x, y)).count()
        };
        assert!(count(0..4, 0..8) > count(4..8, 0..8), "its stem is left");
        assert!(count(0..8, 0..4) > count(0..8, 4..8), "its bars are up");
    }

    #[test]
    fn blocks_lie_one_above_the_other() {
        let mut low = Canvas::new(1, 1);
        low.fill([0, 0], [9, 9], BLACK);
        let stacked = Canvas::stack(&[Canvas::new(2, 1), low]);
        assert_eq!(stacked.pixels(), [WHITE, WHITE, BLACK, WHITE]);
        assert_eq!(Canvas::stack(&[]), Canvas::new(0, 0));
    }
}
