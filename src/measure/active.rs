//! Which latents a model uses at all (D19): a dimension whose mean hardly moves over the data says nothing.

use serde::Serialize;

/// The variance of `μ*_d` over data above which a dimension counts as active (Burda et al. 2016).
pub const THRESHOLD: f32 = 0.01;

/// Mean and variance of the posterior mean `μ*` over data, gathered one belief at a time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LatentStats {
    /// Beliefs seen.
    pub count: usize,
    /// `μ̄_d`, Z; empty before the first belief.
    pub mean: Vec<f32>,
    /// `Var_data[μ*_d]` over the beliefs seen (divided by their number), Z.
    pub variance: Vec<f32>,
}

impl LatentStats {
    /// Takes in the posterior mean of one belief, Z, by Welford's method; the first one sets Z. Whether it was
    /// counted: one that is empty, of another size or not finite is not.
    pub fn push(&mut self, belief_mean: &[f32]) -> bool {
        if belief_mean.is_empty() || belief_mean.iter().any(|x| !x.is_finite()) {
            return false;
        }
        if self.count == 0 {
            self.mean = vec![0.0; belief_mean.len()];
            self.variance = self.mean.clone();
        }
        if self.mean.len() != belief_mean.len() || self.variance.len() != belief_mean.len() {
            return false;
        }
        self.count += 1;
        let n = self.count as f64;
        for ((&x, mean), variance) in belief_mean
            .iter()
            .zip(&mut self.mean)
            .zip(&mut self.variance)
        {
            let (x, old, spread) = (f64::from(x), f64::from(*mean), f64::from(*variance));
            let new = old + (x - old) / n;
            *mean = new as f32;
            *variance = (spread + ((x - old) * (x - new) - spread) / n) as f32;
        }
        true
    }

    /// Which dimensions vary by more than [`THRESHOLD`], Z; none before two beliefs were seen.
    pub fn active(&self) -> Vec<bool> {
        self.variance.iter().map(|&v| v > THRESHOLD).collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_still_dimension_is_not_active() {
        let mut stats = LatentStats::default();
        assert_eq!(stats.active(), [false; 0]);
        assert!(stats.push(&[1.0, 5.0]));
        assert_eq!(stats.active(), [false, false]);
        assert!(stats.push(&[2.0, 5.01]));
        assert_eq!(stats.active(), [true, false]);
    }

    #[test]
    fn what_does_not_fit_is_not_counted() {
        let mut stats = LatentStats::default();
        assert!(!stats.push(&[]));
        assert!(!stats.push(&[f32::NAN]));
        assert!(stats.push(&[1.0, 2.0]));
        assert!(!stats.push(&[1.0]));
        assert!(!stats.push(&[1.0, f32::INFINITY]));
        assert_eq!((stats.count, stats.mean), (1, vec![1.0, 2.0]));
    }

    proptest! {
        #[test]
        fn it_agrees_with_two_passes(rows in prop::collection::vec(prop::array::uniform2(-3.0_f32..3.0), 1..60)) {
            let mut stats = LatentStats::default();
            for row in &rows {
                prop_assert!(stats.push(row));
            }
            let n = rows.len() as f64;
            for d in 0..2 {
                let mean = rows.iter().map(|row| f64::from(row[d])).sum::<f64>() / n;
                let variance = rows.iter().map(|row| (f64::from(row[d]) - mean).powi(2)).sum::<f64>() / n;
                prop_assert!((f64::from(stats.mean[d]) - mean).abs() < 1e-5);
                prop_assert!((f64::from(stats.variance[d]) - variance).abs() < 1e-4);
            }
        }
    }
}
