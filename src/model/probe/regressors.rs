//! Pose regressors that ship with a model, fitted on its training split: least squares and the network, each for
//! beliefs that saw everything and for predicted ones.

use std::path::Path;

use candle_core::{Device, Result, Tensor};
use serde::{Deserialize, Serialize};

use super::{Hidden, Linear, Pairs, numbers};
use crate::model::checkpoint::{CheckpointError, read_tensors};
use crate::model::probe::hidden::UNITS;

/// Least squares and the network, fitted on the same pairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Readers {
    /// Least squares.
    pub linear: Linear,
    /// The network with one hidden layer.
    pub network: Hidden,
}

impl Readers {
    /// Fits both. None with fewer pairs than latents.
    pub fn fit(pairs: &Pairs) -> Result<Option<Self>> {
        let fitted = Linear::fit(pairs).zip(Hidden::fit(pairs, 0)?);
        Ok(fitted.map(|(linear, network)| Self { linear, network }))
    }

    fn parts(&self) -> [(&'static str, &Linear); 3] {
        [
            ("linear", &self.linear),
            ("hidden", &self.network.first),
            ("output", &self.network.second),
        ]
    }
}

/// Of the two kinds of beliefs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Regressors {
    /// For beliefs that saw every sensor.
    pub filtered: Readers,
    /// For predicted ones.
    pub predicted: Readers,
}

impl Regressors {
    /// What is read: x, y in metres, and where `outputs` is four the yaw's sine and cosine.
    pub fn outputs(&self) -> usize {
        self.filtered.linear.bias.len()
    }

    /// Whether they read `outputs` numbers from `latent` ones, and all of theirs are finite.
    pub fn suit(&self, latent: usize, outputs: usize) -> bool {
        let sizes = [[latent, outputs], [latent, UNITS], [UNITS, outputs]];
        let sound = |(linear, [inputs, outputs]): (&Linear, [usize; 2])| {
            let Linear { weight, bias } = linear;
            let finite = weight.iter().chain(bias).all(|v| v.is_finite());
            finite && weight.len() == inputs * outputs && bias.len() == outputs
        };
        let all = |readers: &Readers| {
            readers
                .parts()
                .map(|(_, part)| part)
                .into_iter()
                .zip(sizes)
                .all(sound)
        };
        all(&self.filtered) && all(&self.predicted)
    }

    /// As named tensors, `filtered.hidden.weight` and the like.
    pub fn tensors(&self) -> Result<Vec<(String, Tensor)>> {
        let mut all = Vec::new();
        for (kind, readers) in [("filtered", &self.filtered), ("predicted", &self.predicted)] {
            for (part, Linear { weight, bias }) in readers.parts() {
                let (rows, columns) = (bias.len(), weight.len() / bias.len().max(1));
                let weight = Tensor::from_slice(weight, (rows, columns), &Device::Cpu)?;
                let bias = Tensor::from_slice(bias, rows, &Device::Cpu)?;
                all.push((format!("{kind}.{part}.weight"), weight));
                all.push((format!("{kind}.{part}.bias"), bias));
            }
        }
        Ok(all)
    }

    /// Reads them from the file of the probe, for a model of `latent` dimensions; none where it has none.
    pub fn read(path: &Path, latent: usize) -> std::result::Result<Option<Self>, CheckpointError> {
        let tensors = read_tensors(path)?;
        let Some(bias) = tensors.get("filtered.linear.bias") else {
            return Ok(None);
        };
        let outputs = bias.elem_count();
        let readers = |kind: &str| -> std::result::Result<Readers, CheckpointError> {
            let part = |part: &str, outputs: usize, inputs: usize| -> std::result::Result<_, _> {
                let name = |what: &str| format!("{kind}.{part}.{what}");
                Ok::<_, CheckpointError>(Linear {
                    weight: numbers(&tensors, path, &name("weight"), outputs * inputs)?,
                    bias: numbers(&tensors, path, &name("bias"), outputs)?,
                })
            };
            Ok(Readers {
                linear: part("linear", outputs, latent)?,
                network: Hidden {
                    first: part("hidden", UNITS, latent)?,
                    second: part("output", outputs, UNITS)?,
                },
            })
        };
        Ok(Some(Self {
            filtered: readers("filtered")?,
            predicted: readers("predicted")?,
        }))
    }
}
