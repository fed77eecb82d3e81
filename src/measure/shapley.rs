//! How much of a result each expert has a right to (D24): exact Shapley values (Shapley 1953; Lundberg & Lee 2017).

/// `φ_i = Σ_{S ∌ i} |S|! (n − |S| − 1)! / n! · (v(S ∪ i) − v(S))` for each of n players.
///
/// `values` has v of every set, the set's bits being its index: `2^n` of them. The φ add up to what all have over
/// none. None where the number of values is no power of two, or one of them is not finite.
pub fn shapley(values: &[f64]) -> Option<Vec<f64>> {
    if !values.len().is_power_of_two() || values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let players = values.len().trailing_zeros();
    let weights: Vec<f64> = (0..players).map(|size| weight(players, size)).collect();
    let of = |player: u32| -> f64 {
        let without = (0..values.len()).filter(|set| set >> player & 1 == 0);
        without
            .map(|set| {
                weights[set.count_ones() as usize] * (values[set | 1 << player] - values[set])
            })
            .sum()
    };
    Some((0..players).map(of).collect())
}

/// `s! (n − s − 1)! / n!`: the share of all orders in which just those s come before a player.
fn weight(players: u32, size: u32) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    factorial(size) * factorial(players - size - 1) / factorial(players)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_pair_of_gloves_is_shared_as_in_the_books() {
        // Players 0 and 1 have a left glove each, player 2 the right one; a pair is worth 1: 1/6, 1/6, 2/3.
        let values: Vec<f64> = (0..8)
            .map(|set: usize| f64::from(u8::from(set & 4 != 0 && set & 3 != 0)))
            .collect();
        let shares = shapley(&values).unwrap();
        for (share, known) in shares.iter().zip([1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0]) {
            assert!((share - known).abs() < 1e-12, "{shares:?}");
        }
    }

    #[test]
    fn what_is_no_game_is_not_shared() {
        assert_eq!(shapley(&[]), None);
        assert_eq!(shapley(&[1.0, 2.0, 3.0]), None);
        assert_eq!(shapley(&[1.0, f64::NAN]), None);
        assert_eq!(shapley(&[1.0]).unwrap(), [0.0; 0]);
    }

    proptest! {
        #[test]
        fn shares_add_up_and_a_dummy_has_its_own(
            values in prop::collection::vec(-10.0_f64..10.0, 8),
            own in -5.0_f64..5.0,
        ) {
            let shares = shapley(&values).unwrap();
            prop_assert!((shares.iter().sum::<f64>() - (values[7] - values[0])).abs() < 1e-9);
            // A fourth player who adds the same to every set.
            let more: Vec<f64> = values.iter().copied().chain(values.iter().map(|v| v + own)).collect();
            let with = shapley(&more).unwrap();
            prop_assert!((with[3] - own).abs() < 1e-9);
            for (a, b) in shares.iter().zip(&with) {
                prop_assert!((a - b).abs() < 1e-9);
            }
        }
    }
}
