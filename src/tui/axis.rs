//! Steps of the episode on columns of a pane, with room for a label before them and a value after.

/// Columns of the labels.
pub const LABELS: u16 = 7;
/// Columns of the values.
pub const VALUES: u16 = 8;

/// How steps lie on columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// T.
    pub steps: usize,
    /// Columns a step takes; 1 where several steps share a column.
    pub columns: u16,
    /// Steps a column takes; 1 wherever they fit.
    pub every: usize,
}

impl Axis {
    /// The axis of a pane of this width.
    pub fn of(width: u16, steps: usize) -> Self {
        let room = width.saturating_sub(LABELS + VALUES).max(1);
        let columns = (usize::from(room) / steps.max(1)).min(8) as u16;
        Self {
            steps,
            columns: columns.max(1),
            every: steps.div_ceil(usize::from(room)).max(1),
        }
    }

    /// First column of a step.
    pub fn column(self, step: usize) -> u16 {
        LABELS + (step / self.every) as u16 * self.columns
    }

    /// Columns from the first to the last.
    pub fn width(self) -> u16 {
        (self.steps.div_ceil(self.every)) as u16 * self.columns
    }

    /// The step drawn at a column of the pane, held to the ends for drags beyond them; none without steps.
    pub fn step_at(self, column: u16) -> Option<usize> {
        let step = usize::from(column.saturating_sub(LABELS) / self.columns) * self.every;
        (self.steps > 0).then(|| step.min(self.steps - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_click_on_a_step_gives_that_step() {
        for (width, steps) in [(46, 16), (78, 48), (40, 300), (8, 3)] {
            let axis = Axis::of(width, steps);
            for step in (0..steps).step_by(axis.every) {
                assert_eq!(axis.step_at(axis.column(step)), Some(step));
            }
            assert_eq!(axis.step_at(0), Some(0));
            assert!(axis.step_at(u16::MAX).unwrap_or(steps) < steps);
        }
        assert_eq!(Axis::of(46, 0).step_at(9), None);
    }
}
