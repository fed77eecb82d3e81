//! Where to look first: episodes and steps ordered by how badly they went (D23).

use serde::{Deserialize, Serialize};

/// What "badly" means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    /// Squared error of the predicted frame.
    #[default]
    Error,
    /// Distance of the position estimate from the truth.
    Distance,
    /// Normalised error ε of the position (D11).
    Nees,
    /// Conflict energy Q (D10).
    Conflict,
    /// Gain `g = SE_V − SE_VHP` over vision alone; the most negative is the worst.
    Gain,
    /// The first step outside its 95 % ellipse; the earliest is the worst.
    Escape,
}

impl Order {
    /// Every order, as they follow each other.
    pub const ALL: [Self; 6] = [
        Self::Error,
        Self::Distance,
        Self::Nees,
        Self::Conflict,
        Self::Gain,
        Self::Escape,
    ];

    /// `error`, `distance`, `nees`, `conflict`, `gain` or `escape`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Distance => "distance",
            Self::Nees => "nees",
            Self::Conflict => "conflict",
            Self::Gain => "gain",
            Self::Escape => "escape",
        }
    }

    /// The order of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|order| order.name() == name)
    }

    /// What it ranks by, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Error => "squared error of the frame",
            Self::Distance => "distance of the position from the truth",
            Self::Nees => "NEES of the position",
            Self::Conflict => "conflict energy",
            Self::Gain => "gain over vision alone, the smallest first",
            Self::Escape => "first step outside the 95 % ellipse",
        }
    }

    /// A value of it with its unit.
    pub fn spelt(self, value: f32) -> String {
        match self {
            Self::Error => format!("squared error {value:.1}"),
            Self::Distance => format!("{:.1} cm off", 100.0 * value),
            Self::Nees => format!("NEES {value:.1}"),
            Self::Conflict => format!("Q {value:.0}"),
            Self::Gain => format!("gain {value:+.1}"),
            Self::Escape => format!("outside from step {value:.0} on"),
        }
    }

    /// The one after it, round and round.
    #[must_use]
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()]
    }
}

/// What is known of an episode, or of one step of it; none where it cannot be had (no truth, no `v` model).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Squared error of the predicted frame, summed over pixels in grey 0 to 1.
    pub error: Option<f32>,
    /// Distance of the position estimate from the truth, in metres.
    pub distance_m: Option<f32>,
    /// ε of the position (D11).
    pub nees: Option<f32>,
    /// Q of the experts (D10).
    pub conflict: Option<f32>,
    /// `SE_V − SE_VHP`: how much better than vision alone; signed.
    pub gain: Option<f32>,
    /// The first step outside its 95 % ellipse; for a step, its own index if it lies outside.
    pub escape: Option<usize>,
}

impl Scores {
    /// What an order ranks by; steps count from 1.
    pub fn value(&self, order: Order) -> Option<f32> {
        match order {
            Order::Error => self.error,
            Order::Distance => self.distance_m,
            Order::Nees => self.nees,
            Order::Conflict => self.conflict,
            Order::Gain => self.gain,
            Order::Escape => self.escape.map(|step| (step + 1) as f32),
        }
    }

    /// Larger is worse; none where it is not known or not a number.
    fn badness(&self, order: Order) -> Option<f64> {
        let known = |score: Option<f32>| score.map(f64::from);
        match order {
            Order::Error => known(self.error),
            Order::Distance => known(self.distance_m),
            Order::Nees => known(self.nees),
            Order::Conflict => known(self.conflict),
            Order::Gain => known(self.gain).map(|gain| -gain),
            Order::Escape => self.escape.map(|step| -(step as f64)),
        }
        .filter(|badness| !badness.is_nan())
    }
}

/// Indices into `rows`, the worst first; equal ones in their own order, those without a score last.
pub fn rank(rows: &[Scores], order: Order) -> Vec<usize> {
    let mut ranked: Vec<(usize, Option<f64>)> = rows
        .iter()
        .map(|row| row.badness(order))
        .enumerate()
        .collect();
    // None sorts below every number, and the sort is stable.
    ranked.sort_by(|(_, a), (_, b)| b.partial_cmp(a).unwrap_or(std::cmp::Ordering::Equal));
    ranked.into_iter().map(|(index, _)| index).collect()
}

/// The worst step of each episode as `(episode, step)`, the worst episode first; what `n` and `N` walk through.
///
/// A row is an episode's index and the scores of its steps. Equal steps count by index, equal episodes as they
/// stand in `per_episode`. An episode of which no step has a score has no worst step and is not in the queue.
pub fn queue<'a>(
    per_episode: impl IntoIterator<Item = (usize, &'a [Scores])>,
    order: Order,
) -> Vec<(usize, usize)> {
    let (places, worst): (Vec<(usize, usize)>, Vec<Scores>) = per_episode
        .into_iter()
        .filter_map(|(episode, steps)| {
            let mut worst: Option<(usize, f64)> = None;
            for (step, scores) in steps.iter().enumerate() {
                let badness = scores.badness(order);
                if let Some(badness) = badness.filter(|&b| worst.is_none_or(|(_, most)| b > most)) {
                    worst = Some((step, badness));
                }
            }
            let (step, _) = worst?;
            Some(((episode, step), steps[step]))
        })
        .unzip();
    rank(&worst, order)
        .into_iter()
        .map(|index| places[index])
        .collect()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;

    fn error(error: f32) -> Scores {
        Scores {
            error: Some(error),
            ..Scores::default()
        }
    }

    fn gain(gain: f32) -> Scores {
        Scores {
            gain: Some(gain),
            ..Scores::default()
        }
    }

    fn escape(step: Option<usize>) -> Scores {
        Scores {
            escape: step,
            ..Scores::default()
        }
    }

    #[test]
    fn the_worst_come_first_and_the_unknown_last() {
        let rows = [
            error(1.0),
            Scores::default(),
            error(3.0),
            error(f32::NAN),
            error(1.0),
            error(f32::INFINITY),
        ];
        assert_eq!(rank(&rows, Order::Error), [5, 2, 0, 4, 1, 3]);
        assert_eq!(rank(&rows, Order::Nees), [0, 1, 2, 3, 4, 5]);
        assert_eq!(rank(&[], Order::Error), [0; 0]);
    }

    #[test]
    fn worse_than_vision_alone_is_worst() {
        assert_eq!(
            rank(&[gain(2.0), gain(-5.0), gain(0.0)], Order::Gain),
            [1, 2, 0]
        );
    }

    #[test]
    fn the_earliest_escape_is_worst() {
        let rows = [escape(Some(9)), escape(None), escape(Some(0))];
        assert_eq!(rank(&rows, Order::Escape), [2, 0, 1]);
    }

    #[test]
    fn the_queue_leads_to_the_worst_step_of_each_episode() {
        fn listed(episodes: &[(usize, Vec<Scores>)]) -> impl Iterator<Item = (usize, &[Scores])> {
            episodes
                .iter()
                .map(|(episode, steps)| (*episode, steps.as_slice()))
        }
        let episodes = [
            (4, vec![error(1.0), error(2.0), error(2.0)]),
            (7, vec![Scores::default()]),
            (9, vec![error(0.5), error(8.0)]),
            (2, vec![]),
            (1, vec![error(2.0)]),
        ];
        assert_eq!(
            queue(listed(&episodes), Order::Error),
            [(9, 1), (4, 1), (1, 0)]
        );
        let outside = [
            (0, vec![escape(None), escape(None), escape(Some(2))]),
            (1, vec![escape(None), escape(Some(1)), escape(Some(2))]),
        ];
        assert_eq!(queue(listed(&outside), Order::Escape), [(1, 1), (0, 2)]);
    }

    #[test]
    fn orders_go_round_and_keep_their_names() {
        let mut order = Order::default();
        for expected in Order::ALL {
            assert_eq!(order, expected);
            let name = serde_json::to_string(&order).unwrap();
            assert_eq!(name, format!("\"{}\"", order.name()));
            assert_eq!(serde_json::from_str::<Order>(&name).unwrap(), order);
            assert_eq!(Order::from_name(order.name()), Some(order));
            order = order.next();
        }
        assert_eq!(order, Order::default());
        assert_eq!(Order::from_name("worst"), None);
    }
}
