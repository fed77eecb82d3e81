//! The episodes of one update as tensors, with its noise, its masks, and what of it is decoded.

use candle_core::{Device, Tensor};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::{TrainError, masks};
use crate::episode::Episode;
use crate::modality::ExpertSet;
use crate::model::config::Config;
use crate::model::observation::{Observations, observe};

/// What one update runs on. B episodes of T beliefs, M experts with the prior last.
#[derive(Debug)]
pub struct Batch {
    /// B.
    pub episodes: usize,
    /// T.
    pub beliefs: usize,
    /// What each stream holds, `(B T, inputs)`.
    pub seen: Vec<Tensor>,
    /// `(B, T - 1, U)`.
    pub controls: Tensor,
    /// `(B, T, M)`.
    pub alphas: Tensor,
    /// For each sensor expert the beliefs, of B T, at which it is on; none where that is all of them.
    pub sensed: Vec<Option<Vec<u32>>>,
    /// The beliefs, of B T, that are decoded; none for all of them.
    pub decoded: Option<Vec<u32>>,
    /// N(0, I), `(B, T, Z)`.
    pub noise: Tensor,
}

/// What is drawn for one update: the seed, its number, and how long a segment of each episode is taken.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    /// Of the run.
    pub seed: u64,
    /// Which update.
    pub update: u64,
    /// Beliefs of each episode, from a random one on; none for all.
    pub segment: Option<usize>,
}

/// A generator for one purpose and one number: what an update draws depends on no other update.
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

/// `len` beliefs of an episode from `start` on.
fn segment(observed: Observations, start: usize, len: usize) -> Observations {
    let part = |stream: Vec<f32>| {
        let width = stream.len() / observed.beliefs;
        stream[start * width..(start + len) * width].to_vec()
    };
    Observations {
        beliefs: len,
        streams: observed.streams.into_iter().map(part).collect(),
        controls: observed.controls[start..start + len - 1].to_vec(),
    }
}

/// The sensors that are on at each belief of one episode.
fn draw_sets(config: &Config, beliefs: usize, rng: &mut impl Rng) -> Vec<ExpertSet> {
    let experts = config.experts.len();
    let mut sets = if config.training.masks {
        masks::path(experts, beliefs, rng)
    } else {
        vec![ExpertSet::full(experts); beliefs]
    };
    if config.training.rollouts > 0.0 && rng.random_bool(config.training.rollouts) {
        masks::roll_out(&mut sets, rng);
    }
    sets
}

impl Batch {
    /// A batch with the noise, masks and segments of an update; without `draws`, whole, on the mean path and with every
    /// expert. Episodes must be of one length. Runs on the thread that calls, and leaves the others to the step.
    pub fn new(
        config: &Config,
        episodes: &[&Episode],
        draws: Option<Draws>,
    ) -> Result<Self, TrainError> {
        let mut observed: Vec<Observations> = episodes
            .iter()
            .map(|episode| observe(config, episode))
            .collect::<Result<_, _>>()?;
        let mut rng = draws.map(|draws| generator(draws.seed, 2, draws.update));
        let mut beliefs = observed.first().map_or(0, |o| o.beliefs);
        if let (Some(rng), Some(len)) = (&mut rng, draws.and_then(|draws| draws.segment)) {
            let len = len.min(beliefs);
            let cut = |o| segment(o, rng.random_range(0..=beliefs - len), len);
            observed = observed.into_iter().map(cut).collect();
            beliefs = len;
        }
        let count = observed.len();
        let full = ExpertSet::full(config.experts.len());
        let mut sets = vec![full; count * beliefs];
        let mut noise = vec![0.0_f32; count * beliefs * config.latent];
        let mut decoded = None;
        if let Some(rng) = &mut rng {
            noise.fill_with(|| rng.sample(StandardNormal));
            for episode in sets.chunks_exact_mut(beliefs) {
                episode.copy_from_slice(&draw_sets(config, beliefs, rng));
            }
            // What nothing is sensed of is a rollout, and a rollout goes along the means.
            for (noise, set) in noise.chunks_exact_mut(config.latent).zip(&sets) {
                if set.0 == 0 {
                    noise.fill(0.0);
                }
            }
            decoded = draw_decoded(count, beliefs, config.training.decoded, rng);
        }
        let device = &Device::Cpu;
        let shape = (count, beliefs, config.latent);
        let mut seen = Vec::new();
        for stream in 0..config.streams().len() {
            let each = observed.iter().map(|o| o.streams[stream].as_slice());
            let all = each.collect::<Vec<_>>().concat();
            let width = all.len() / (count * beliefs);
            seen.push(Tensor::from_vec(all, (count * beliefs, width), device)?);
        }
        let controls: Vec<f32> = observed
            .iter()
            .flat_map(|o| o.controls.iter().flatten().copied())
            .collect();
        let switches = config.switches();
        Ok(Self {
            episodes: count,
            beliefs,
            seen,
            controls: Tensor::from_vec(controls, (count, beliefs - 1, Config::CONTROL), device)?,
            alphas: Tensor::from_vec(alphas(&sets, switches), (count, beliefs, switches), device)?,
            sensed: (0..switches - 1).map(|i| members(&sets, i)).collect(),
            decoded,
            noise: Tensor::from_vec(noise, shape, device)?,
        })
    }
}

/// α of every expert: 1 for a member and for the prior, else 0.
fn alphas(sets: &[ExpertSet], switches: usize) -> Vec<f32> {
    let row = |set: &ExpertSet| {
        let set = *set;
        (0..switches).map(move |i| f32::from(i + 1 == switches || set.contains(i)))
    };
    sets.iter().flat_map(row).collect()
}

/// Where expert `i` is a member; none where it always is.
fn members(sets: &[ExpertSet], i: usize) -> Option<Vec<u32>> {
    let rows: Vec<u32> = (0..)
        .zip(sets)
        .filter(|(_, set)| set.contains(i))
        .map(|(row, _)| row)
        .collect();
    (rows.len() < sets.len()).then_some(rows)
}

/// `wanted` beliefs of each episode in order; none for all.
fn draw_decoded(
    episodes: usize,
    beliefs: usize,
    wanted: usize,
    rng: &mut impl Rng,
) -> Option<Vec<u32>> {
    if wanted == 0 || wanted >= beliefs {
        return None;
    }
    let mut rows = Vec::with_capacity(episodes * wanted);
    for episode in 0..episodes {
        let mut drawn = rand::seq::index::sample(rng, beliefs, wanted).into_vec();
        drawn.sort_unstable();
        rows.extend(
            drawn
                .iter()
                .map(|belief| (episode * beliefs + belief) as u32),
        );
    }
    Some(rows)
}
