//! Which experts are left out while training, so that switches are in the model's distribution (after Wu & Goodman
//! 2018): one path of sets an episode and update, half of them full (before [`roll_out`] cuts some), else a set drawn from all sensor sets and redrawn
//! at random steps. The prior is always in.
//!
//! A redraw takes the empty set as often as all others together: what follows is a rollout from a belief that had seen
//! something, decoded and compared, which is what open-loop prediction is made of.

use rand::Rng;

use crate::modality::ExpertSet;

/// A set is redrawn at each step with this probability.
const REDRAW: f64 = 0.2;
/// A redraw takes the empty set with this probability, else any of them alike.
const NOTHING: f64 = 0.5;

/// From a random belief on, but the first, no sensor: what is decoded there is a rollout.
pub fn roll_out(sets: &mut [ExpertSet], rng: &mut impl Rng) {
    if sets.len() > 1 {
        let from = rng.random_range(1..sets.len());
        sets[from..].fill(ExpertSet(0));
    }
}

/// The set of sensor experts at each of `beliefs` steps, of `experts` in all.
pub fn path(experts: usize, beliefs: usize, rng: &mut impl Rng) -> Vec<ExpertSet> {
    let full = ExpertSet::full(experts);
    if rng.random_bool(0.5) {
        return vec![full; beliefs];
    }
    let mut set = ExpertSet(rng.random_range(0..=full.0));
    let mut sets = Vec::with_capacity(beliefs);
    for _ in 0..beliefs {
        sets.push(set);
        if rng.random_bool(REDRAW) {
            let nothing = rng.random_bool(NOTHING);
            set = ExpertSet(if nothing {
                0
            } else {
                rng.random_range(0..=full.0)
            });
        }
    }
    sets
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn a_rollout_has_seen_something_and_lasts_to_the_end() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        for _ in 0..200 {
            let mut sets = vec![ExpertSet(3); 5];
            roll_out(&mut sets, &mut rng);
            assert_eq!((sets[0], sets[4]), (ExpertSet(3), ExpertSet(0)));
            assert!(sets.windows(2).all(|pair| pair[0].0 >= pair[1].0));
        }
    }

    #[test]
    fn half_of_the_paths_are_full_and_every_set_occurs() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let paths: Vec<_> = (0..2000).map(|_| path(3, 15, &mut rng)).collect();
        let full = paths
            .iter()
            .filter(|path| path.iter().all(|set| *set == ExpertSet::full(3)))
            .count();
        assert!((950..1150).contains(&full), "{full}");
        for set in 0..8 {
            assert!(paths.iter().flatten().any(|s| s.0 == set));
        }
    }
}
