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
                (from.0 + view.length(factor * x), from.1 - view.length(factor * y))
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

    /// Draws the letters at the tips; one that another has taken moves aside.
    pub fn letters(&self, buf: &mut Buffer, pane: Rect, view: &Plane, face: &Face) {
        let prior = Expert::Prior;
        let ink = |expert: Expert| strong().patch(face.depth.ink(expert.rgb()));
        let mut taken: Vec<(u16, u16)> = Vec::new();
        let mut letter = |at: (f32, f32), symbol: char, style: Style| {
            let Some((column, row)) = view.cell(at) else { return };
            let free = (0..4).map(|aside| (column + aside, row));
            if let Some(cell) = free.into_iter().find(|cell| !taken.contains(cell)) {
                put(buf, pane, cell.0, cell.1, symbol, style);
                taken.push(cell);
            }
        };
        letter(self.start, prior.letter(), ink(prior));
        // At its true length the correction ends where the belief's own mark stands.
        if self.factor > 1.0 {
            letter(self.sum, 'Σ', strong());
        }
        for &(expert, tip) in &self.tips {
            letter(tip, expert.letter(), ink(expert));
        }
    }
}

/// Draws where the belief would be without each expert: its letter in brackets, where that is a cell or more away.
pub fn ghosts(buf: &mut Buffer, pane: Rect, view: &Plane, snapshot: &Snapshot, face: &Face) {
    let Some(fusion) = &snapshot.fusion else {
        return;
    };
    for (expert, reading) in std::iter::zip(&snapshot.experts, &fusion.experts) {
        let Some(without) = reading.without else {
            continue;
        };
        if let Some((column, row)) = view.cell(view.dot([without.x, without.y])) {
            let ink = dim().patch(face.depth.ink(expert.expert.rgb()));
            let first = column.saturating_sub(1);
            for (i, symbol) in ['(', expert.expert.letter(), ')'].into_iter().enumerate() {
                put(buf, pane, first + i as u16, row, symbol, ink);
            }
        }
    }
}
