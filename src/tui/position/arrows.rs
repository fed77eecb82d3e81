//! The pulls as arrows, head to tail from the prior's position, so that the eye sees them sum to the correction (D7).

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::braille::{Canvas, Stroke};
use super::super::face::Face;
use super::super::paint::put;
use super::super::plane::Plane;
use super::super::theme::{dim, strong};
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;

/// Factors by which arrows are drawn longer than they are.
const FACTORS: [f32; 7] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
/// The length of a chain that is easy to see, as a part of the plane's smaller side.
const CLEAR: f32 = 0.3;

/// The chain at the cursor, in dots of a plane.
#[derive(Clone, Debug)]
pub struct Arrows {
    /// How much longer than true they are drawn.
    pub factor: f32,
    /// The prior's position.
    start: (f32, f32),
    /// Where each sensor's arrow ends.
    tips: Vec<(Expert, (f32, f32))>,
    /// Where the correction ends.
    sum: (f32, f32),
}

impl Arrows {
    /// None without a probe or a product. They are magnified where they would be too short to see, and no further than
    /// the plane holds them.
    pub fn of(snapshot: &Snapshot, view: &Plane) -> Option<Self> {
        let fusion = snapshot.fusion.as_ref()?;
        let start = view.dot(fusion.prior_m?);
        let correction = fusion.correction_m?;
        let pulls: Vec<(Expert, [f32; 2])> = std::iter::zip(&snapshot.experts, &fusion.experts)
            .filter_map(|(expert, reading)| Some((expert.expert, reading.pull_m?)))
            .collect();
        if pulls.is_empty() {
            return None;
        }
        let chain = |factor: f32| {
            let to = |from: (f32, f32), [x, y]: [f32; 2]| {
                (
                    from.0 + view.length(factor * x),
                    from.1 - view.length(factor * y),
                )
            };
            let mut at = start;
            let tips = pulls.iter().map(|&(expert, pull)| {
                at = to(at, pull);
                (expert, at)
            });
            Self {
                factor,
                tips: tips.collect(),
                start,
                sum: to(start, correction),
            }
        };
        let clear = CLEAR * view.dots.0.min(view.dots.1);
        let larger = FACTORS[1..].iter().map(|&factor| chain(factor));
        let best = larger
            .take_while(|arrows| arrows.reach() <= clear && arrows.is_within(view))
            .last();
        Some(best.unwrap_or_else(|| chain(1.0)))
    }

    fn ends(&self) -> impl Iterator<Item = (f32, f32)> {
        self.tips.iter().map(|&(_, tip)| tip).chain([self.sum])
    }

    fn reach(&self) -> f32 {
        let away = |(x, y): (f32, f32)| (x - self.start.0).abs().max((y - self.start.1).abs());
        self.ends().map(away).fold(0.0, f32::max)
    }

    fn is_within(&self, view: &Plane) -> bool {
        self.ends().all(|end| view.cell(end).is_some())
    }

    /// Draws the shafts.
    pub fn lines(&self, canvas: &mut Canvas, face: &Face) {
        canvas.path(&[self.start, self.sum], Stroke::Dotted, strong());
        let mut from = self.start;
        for &(expert, tip) in &self.tips {
            canvas.path(&[from, tip], Stroke::Solid, face.depth.ink(expert.rgb()));
            from = tip;
        }
    }

    /// The letters with their cells: the prior, the sum where it is not the belief itself, the sensors. One whose cell
    /// another mark or letter has taken moves aside.
    fn letters(
        &self,
        view: &Plane,
        taken: &[(u16, u16)],
    ) -> Vec<((u16, u16), char, Option<Expert>)> {
        let prior = (self.start, Expert::Prior.letter(), Some(Expert::Prior));
        // At its true length the correction ends where the belief's own mark stands.
        let sum = (self.factor > 1.0).then_some((self.sum, 'Σ', None));
        let tips = self
            .tips
            .iter()
            .map(|&(expert, tip)| (tip, expert.letter(), Some(expert)));
        let mut placed: Vec<((u16, u16), char, Option<Expert>)> = Vec::new();
        for (at, symbol, expert) in [prior].into_iter().chain(sum).chain(tips) {
            let Some((column, row)) = view.cell(at) else {
                continue;
            };
            let is_free = |cell: &(u16, u16)| {
                !taken.contains(cell) && placed.iter().all(|(taken, ..)| taken != cell)
            };
            let free = (0..5).map(|aside| (column + aside, row)).find(is_free);
            if let Some(cell) = free {
                placed.push((cell, symbol, expert));
            }
        }
        placed
    }

    /// The cells of the letters, beside those that marks have taken.
    pub fn cells(&self, view: &Plane, taken: &[(u16, u16)]) -> Vec<(u16, u16)> {
        self.letters(view, taken)
            .into_iter()
            .map(|(cell, ..)| cell)
            .collect()
    }

    /// Draws the letters.
    pub fn draw(
        &self,
        buf: &mut Buffer,
        (pane, taken): (Rect, &[(u16, u16)]),
        view: &Plane,
        face: &Face,
    ) {
        for ((column, row), symbol, expert) in self.letters(view, taken) {
            let ink = expert.map_or_else(Style::new, |expert| face.depth.ink(expert.rgb()));
            put(buf, pane, column, row, symbol, strong().patch(ink));
        }
    }
}

/// Draws where the belief would be without each expert, its letter in brackets; not over a letter or a mark: it
/// could hardly be told from it.
pub fn ghosts(
    buf: &mut Buffer,
    (pane, taken): (Rect, &[(u16, u16)]),
    view: &Plane,
    snapshot: &Snapshot,
    face: &Face,
) {
    let Some(fusion) = &snapshot.fusion else {
        return;
    };
    for (expert, reading) in std::iter::zip(&snapshot.experts, &fusion.experts) {
        let Some(without) = reading.without else {
            continue;
        };
        let Some((column, row)) = view.cell(view.dot([without.x, without.y])) else {
            continue;
        };
        let cells = [0, 1, 2].map(|i| ((column + i).saturating_sub(1), row));
        if taken.iter().any(|cell| cells.contains(cell)) {
            continue;
        }
        let ink = dim().patch(face.depth.ink(expert.expert.rgb()));
        for (cell, symbol) in cells.into_iter().zip(['(', expert.expert.letter(), ')']) {
            put(buf, pane, cell.0, row, symbol, ink);
        }
    }
}
