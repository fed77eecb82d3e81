//! The episodes of one update as tensors, with its noise and masks.

use candle_core::{Device, Tensor};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::{TrainError, masks};
use crate::episode::Episode;
use crate::model::config::Config;
use crate::model::observation::{Observations, observe};

/// What one update runs on. B episodes of T beliefs, M experts with the prior last.
#[derive(Debug)]
pub struct Batch {
    /// B.
    pub episodes: usize,
    /// T.
    pub beliefs: usize,
    /// What each expert sees, `(B T, inputs)`.
    pub seen: Vec<Tensor>,
    /// `(B, T - 1, U)`.
    pub controls: Tensor,
    /// `(B, T, M)`.
    pub alphas: Tensor,
    /// N(0, I), `(B, T, Z)`.
    pub noise: Tensor,
}

/// A generator for one purpose and one number: no draw depends on another.
fn generator(seed: u64, purpose: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(purpose << 56 | number);
    rng
}

/// Indices of the episodes of an update: the next ones of its epoch's order.
pub fn choose(
    episodes: usize,
    batch: usize,
    epoch_updates: u64,
    seed: u64,
    update: u64,
) -> Vec<usize> {
    let mut order: Vec<usize> = (0..episodes).collect();
    order.shuffle(&mut generator(seed, 1, update / epoch_updates));
    let start = (update % epoch_updates) as usize * batch;
    order.into_iter().skip(start).take(batch).collect()
}

impl Batch {
    /// A batch with the noise and masks of a seed and an update; without, on the mean path with every expert. Episodes
    /// must be of one length. Runs on one thread, the loader's, and leaves the others to the step.
    pub fn new(
        config: &Config,
        episodes: &[&Episode],
        draws: Option<(u64, u64)>,
    ) -> Result<Self, TrainError> {
        let observed: Vec<Observations> = episodes
            .iter()
            .map(|episode| observe(config, episode))
            .collect::<Result<_, _>>()?;
        let beliefs = observed.first().map_or(0, |o| o.beliefs);
        let count = observed.len();
        let mut seen = Vec::new();
        for expert in 0..config.experts.len() {
            let each: Vec<&[f32]> = observed
                .iter()
                .map(|o| o.experts[expert].as_slice())
                .collect();
            let all = each.concat();
            let width = all.len() / (count * beliefs);
            seen.push(Tensor::from_vec(
                all,
                (count * beliefs, width),
                &Device::Cpu,
            )?);
        }
        let controls: Vec<f32> = observed
            .iter()
            .flat_map(|o| o.controls.iter().flatten().copied())
            .collect();
        let controls = Tensor::from_vec(
            controls,
            (count, beliefs - 1, Config::CONTROL),
            &Device::Cpu,
        )?;
        let switches = config.switches();
        let mut alphas = vec![1.0_f32; count * beliefs * switches];
        let mut noise = vec![0.0_f32; count * beliefs * config.latent];
        if let Some((seed, update)) = draws {
            let mut rng = generator(seed, 2, update);
            noise.fill_with(|| rng.sample(StandardNormal));
            if config.training.masks {
                for episode in alphas.chunks_exact_mut(beliefs * switches) {
                    let path = masks::path(config.experts.len(), beliefs, &mut rng);
                    for (row, set) in episode.chunks_exact_mut(switches).zip(path) {
                        for (expert, alpha) in row[..switches - 1].iter_mut().enumerate() {
                            *alpha = f32::from(set.contains(expert));
                        }
                    }
                }
            }
        }
        let noise = Tensor::from_vec(noise, (count, beliefs, config.latent), &Device::Cpu)?;
        let alphas = Tensor::from_vec(alphas, (count, beliefs, switches), &Device::Cpu)?;
        Ok(Self {
            episodes: count,
            beliefs,
            seen,
            controls,
            alphas,
            noise,
        })
    }
}
