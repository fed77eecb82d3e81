//! Common random numbers: the same noise for the same seed, sample and step, whatever is compared.

use rand::SeedableRng;
use rand::distr::Distribution;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// N(0, 1) noise `(samples, steps, latent)`. Each sample has a stream of its own, so that more samples or a longer
/// horizon leave the first ones as they were.
pub fn normal(seed: u64, samples: usize, steps: usize, latent: usize) -> Vec<f32> {
    let mut noise = Vec::with_capacity(samples * steps * latent);
    for sample in 0..samples {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(sample as u64);
        let normal = StandardNormal;
        noise.extend((0..steps * latent).map(|_| {
            let value: f32 = normal.sample(&mut rng);
            value
        }));
    }
    noise
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_samples_and_steps_stay() {
        let few = normal(7, 2, 3, 4);
        let many = normal(7, 5, 6, 4);
        assert_eq!(few[..12], many[..12]);
        assert_eq!(few[12..], many[24..36]);
        assert_ne!(normal(8, 1, 3, 4), few[..12]);
        let mean = many.iter().sum::<f32>() / many.len() as f32;
        assert!(mean.abs() < 0.3 && few[..4] != few[12..16]);
    }
}
