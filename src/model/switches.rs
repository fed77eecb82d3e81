//! α of every expert over the steps, independent of any one episode and model.
//!
//! Each expert has a step function over all steps from 0 on. So a setting survives a change of episode or model
//! as it is, and "off and on again" leaves exactly what was there before.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::trace::Alphas;
use crate::modality::Expert;

/// α as trained. Values are compared as they were set; none is computed.
const TRAINED: f32 = 1.0;
/// The weakest and the strongest tempering; wider than means anything, and all precisions stay finite.
const TEMPERINGS: std::ops::RangeInclusive<f32> = 0.001..=1000.0;

/// Takes α as a user gives it: off, or within bounds.
pub fn checked_alpha(alpha: f32) -> Result<f32, String> {
    let alpha = if alpha == 0.0 { 0.0 } else { alpha };
    if alpha == 0.0 || TEMPERINGS.contains(&alpha) {
        return Ok(alpha);
    }
    let (least, most) = (TEMPERINGS.start(), TEMPERINGS.end());
    Err(format!("α is 0, or from {least} to {most}, not {alpha}"))
}

/// The steps a change reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// First step.
    pub from: usize,
    /// The first step it does not reach any more; none if it goes on for ever.
    pub until: Option<usize>,
}

impl Reach {
    /// Every step.
    pub const EPISODE: Self = Self {
        from: 0,
        until: None,
    };
}

/// A stretch of steps with one α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Where.
    pub reach: Reach,
    /// 0 off, 1 as trained.
    pub alpha: f32,
}

/// α of every expert at every step; an expert that was never touched is as trained.
///
/// Written as the stretches that are not as trained.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<Stretch>", into = "Vec<Stretch>")]
pub struct Switches {
    /// For each expert the steps at which a new α begins, the first at step 0, neighbours unequal.
    starts: BTreeMap<Expert, Starts>,
    /// What an expert had when it was switched off, and how far that reached: switched on again over the same steps, it
    /// is as it was.
    kept: BTreeMap<Expert, (Reach, Option<Starts>)>,
}

/// The steps at which a new α begins.
type Starts = Vec<(usize, f32)>;

impl Switches {
    /// α of an expert at a step.
    pub fn alpha(&self, expert: Expert, step: usize) -> f32 {
        self.starts
            .get(&expert)
            .map_or(TRAINED, |starts| value_at(starts, step))
    }

    /// Sets α of an expert over some steps.
    pub fn set(&mut self, expert: Expert, reach: Reach, alpha: f32) {
        if reach.until.is_some_and(|until| until <= reach.from) {
            return;
        }
        self.kept.remove(&expert);
        let starts = self
            .starts
            .entry(expert)
            .or_insert_with(|| vec![(0, TRAINED)]);
        let after = reach.until.map(|until| (until, value_at(starts, until)));
        starts.retain(|&(start, _)| {
            start < reach.from || after.is_some_and(|(until, _)| start > until)
        });
        starts.push((reach.from, alpha));
        starts.extend(after);
        starts.sort_by_key(|&(start, _)| start);
        starts.dedup_by(|later, earlier| later.1.total_cmp(&earlier.1).is_eq());
        if *starts == [(0, TRAINED)] {
            self.starts.remove(&expert);
        }
    }

    /// Switches an expert off over some steps.
    pub fn off(&mut self, expert: Expert, reach: Reach) {
        let before = self.starts.get(&expert).cloned();
        self.set(expert, reach, 0.0);
        self.kept.insert(expert, (reach, before));
    }

    /// Switches an expert on over some steps: as it was before it was switched off there, else as trained.
    pub fn on(&mut self, expert: Expert, reach: Reach) {
        match self.kept.remove(&expert) {
            Some((same, Some(before))) if same == reach => {
                self.starts.insert(expert, before);
            }
            _ => self.set(expert, reach, TRAINED),
        }
    }

    /// The stretches of an expert that are not as trained, in order.
    pub fn runs(&self, expert: Expert) -> Vec<Run> {
        let Some(starts) = self.starts.get(&expert) else {
            return Vec::new();
        };
        let ends = starts
            .iter()
            .skip(1)
            .map(|&(start, _)| Some(start))
            .chain([None]);
        starts
            .iter()
            .zip(ends)
            .filter(|((_, alpha), _)| alpha.total_cmp(&TRAINED).is_ne())
            .map(|(&(from, alpha), until)| Run {
                reach: Reach { from, until },
                alpha,
            })
            .collect()
    }

    /// The first step from `first` on at which none of these experts is active, if there is one.
    pub fn silent_step(&self, experts: &[Expert], first: usize) -> Option<usize> {
        let starts = experts.iter().filter_map(|expert| self.starts.get(expert));
        let changes = starts.flatten().map(|&(start, _)| start.max(first));
        let is_silent = |&step: &usize| experts.iter().all(|&e| self.alpha(e, step) == 0.0);
        changes.chain([first]).filter(is_silent).min()
    }

    /// The experts that are not as trained at some step.
    pub fn switched(&self) -> impl Iterator<Item = Expert> {
        self.starts.keys().copied()
    }

    /// Leaves these experts' α alone, and all others as trained.
    pub fn retain(&mut self, is_kept: impl Fn(Expert) -> bool) {
        self.starts.retain(|&expert, _| is_kept(expert));
        self.kept.retain(|&expert, _| is_kept(expert));
    }

    /// α of these experts at some steps, a row a step.
    pub fn alphas(&self, experts: &[Expert], steps: std::ops::Range<usize>) -> Alphas {
        let row = |step| experts.iter().map(move |&expert| self.alpha(expert, step));
        Alphas {
            experts: experts.len(),
            values: steps.flat_map(row).collect(),
        }
    }
}

/// As switches are written: α of an expert over some steps.
#[derive(Serialize, Deserialize)]
struct Stretch {
    expert: Expert,
    from: usize,
    until: Option<usize>,
    alpha: f32,
}

impl From<Switches> for Vec<Stretch> {
    fn from(switches: Switches) -> Self {
        let of = |expert| {
            let runs = switches.runs(expert).into_iter();
            runs.map(move |Run { reach, alpha }| Stretch {
                expert,
                from: reach.from,
                until: reach.until,
                alpha,
            })
        };
        switches.switched().flat_map(of).collect()
    }
}

impl From<Vec<Stretch>> for Switches {
    fn from(stretches: Vec<Stretch>) -> Self {
        let mut switches = Self::default();
        for Stretch {
            expert,
            from,
            until,
            alpha,
        } in stretches
        {
            switches.set(expert, Reach { from, until }, alpha);
        }
        switches
    }
}

fn value_at(starts: &[(usize, f32)], step: usize) -> f32 {
    let count = starts.partition_point(|&(start, _)| start <= step);
    count
        .checked_sub(1)
        .and_then(|i| starts.get(i))
        .map_or(TRAINED, |&(_, alpha)| alpha)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const V: Expert = Expert::Vision;

    fn reach(from: usize, until: Option<usize>) -> Reach {
        Reach { from, until }
    }

    #[test]
    fn a_later_change_cuts_into_an_earlier_one() {
        let mut switches = Switches::default();
        switches.set(V, reach(3, None), 0.0);
        switches.set(V, reach(5, Some(6)), 0.5);
        let alphas: Vec<f32> = (0..8).map(|t| switches.alpha(V, t)).collect();
        assert_eq!(alphas, [1.0, 1.0, 1.0, 0.0, 0.0, 0.5, 0.0, 0.0]);
        assert_eq!(
            switches.runs(V),
            [
                Run {
                    reach: reach(3, Some(5)),
                    alpha: 0.0
                },
                Run {
                    reach: reach(5, Some(6)),
                    alpha: 0.5
                },
                Run {
                    reach: reach(6, None),
                    alpha: 0.0
                },
            ]
        );
    }

    #[test]
    fn off_and_on_again_leaves_nothing_behind() {
        let mut switches = Switches::default();
        switches.set(V, reach(4, Some(5)), 0.0);
        switches.set(V, Reach::EPISODE, 1.0);
        assert_eq!(switches, Switches::default());
    }

    #[test]
    fn finds_where_nobody_is_left() {
        let mut switches = Switches::default();
        let both = [V, Expert::Prior];
        switches.set(V, reach(2, None), 0.0);
        switches.set(Expert::Prior, reach(0, Some(3)), 0.0);
        assert_eq!(switches.silent_step(&both, 0), Some(2));
        assert_eq!(switches.silent_step(&both, 3), None);
        switches.set(V, reach(2, Some(3)), 0.1);
        assert_eq!(switches.silent_step(&both, 0), None);
        assert_eq!(switches.silent_step(&[V], 0), Some(3));
        assert_eq!(switches.silent_step(&[V], 5), Some(5));
    }

    #[test]
    fn what_is_written_reads_as_it_was() -> serde_json::Result<()> {
        let mut switches = Switches::default();
        switches.set(V, reach(3, None), 0.0);
        switches.set(Expert::Prior, reach(5, Some(6)), 0.5);
        let text = serde_json::to_string(&switches)?;
        assert_eq!(
            text,
            r#"[{"expert":"vision","from":3,"until":null,"alpha":0.0},{"expert":"prior","from":5,"until":6,"alpha":0.5}]"#
        );
        assert_eq!(serde_json::from_str::<Switches>(&text)?, switches);
        Ok(())
    }

    proptest! {
        #[test]
        fn agrees_with_a_plain_table(
            changes in prop::collection::vec((0_usize..12, prop::option::of(0_usize..14), 0_u8..4), 0..12)
        ) {
            let mut switches = Switches::default();
            let mut table = [1.0_f32; 20];
            for (from, until, quarter) in changes {
                let alpha = f32::from(quarter) / 2.0;
                switches.set(V, reach(from, until), alpha);
                for (t, value) in table.iter_mut().enumerate() {
                    if t >= from && until.is_none_or(|until| t < until) {
                        *value = alpha;
                    }
                }
            }
            let seen: Vec<f32> = (0..20).map(|t| switches.alpha(V, t)).collect();
            prop_assert_eq!(seen, table.to_vec());
        }
    }
}
