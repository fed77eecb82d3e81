//! A checkpoint: a folder with `config.toml`, `weights.safetensors`, `probe.safetensors` and `report.json`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use candle_core::{DType, Device, Tensor};
use thiserror::Error;

use super::Model;
use super::config::{Config, ConfigError};
use super::probe::Probe;

/// Why a checkpoint could not be read or written.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// `config.toml` is not one.
    #[error("{}: {what}", path.display())]
    Config {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The weights do not fit the config, or are damaged.
    #[error("{}: {what}; train again, or copy the checkpoint anew", path.display())]
    Weights {
        /// Which.
        path: PathBuf,
        /// What is wrong with them.
        what: String,
    },
}

/// The config's file name.
pub const CONFIG: &str = "config.toml";
/// The weights' file name.
pub const WEIGHTS: &str = "weights.safetensors";
/// The position probe's file name.
pub const PROBE: &str = "probe.safetensors";
/// The mean training frame's file name: the predictor that always says it stands in every table.
pub const MEAN_FRAME: &str = "mean_frame.png";
/// The report's file name.
pub const REPORT: &str = "report.json";

/// Writes `bytes` to `path` by way of a temporary file beside it, so that a half-written one is never seen.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<(), CheckpointError> {
    let file_error = |source| CheckpointError::File {
        path: path.to_owned(),
        source,
    };
    let temporary = path.with_extension("part");
    std::fs::write(&temporary, bytes).map_err(file_error)?;
    std::fs::rename(&temporary, path).map_err(file_error)
}

/// Reads a config, and says which key is wrong.
pub fn load_config(path: &Path) -> Result<Config, CheckpointError> {
    let text = std::fs::read_to_string(path).map_err(|source| CheckpointError::File {
        path: path.to_owned(),
        source,
    })?;
    let refuse = |what: String| CheckpointError::Config {
        path: path.to_owned(),
        what,
    };
    let config: Config =
        toml::from_str(&text).map_err(|error| refuse(error.message().to_owned()))?;
    config
        .validate()
        .map_err(|error: ConfigError| refuse(error.to_string()))?;
    Ok(config)
}

/// Writes the config and the weights, as `dtype` numbers, into `folder`.
pub fn save(model: &Model, folder: &Path, dtype: DType) -> Result<(), CheckpointError> {
    std::fs::create_dir_all(folder).map_err(|source| CheckpointError::File {
        path: folder.to_owned(),
        source,
    })?;
    let path = folder.join(CONFIG);
    let text = toml::to_string(&model.config).map_err(|error| CheckpointError::Config {
        path: path.clone(),
        what: error.to_string(),
    })?;
    write_atomic(&path, text.as_bytes())?;
    let path = folder.join(WEIGHTS);
    let tensors = || -> candle_core::Result<Vec<(String, Tensor)>> {
        let mut all = Vec::new();
        for network in model.networks() {
            for (name, tensor) in network.tensors()? {
                all.push((name, tensor.to_dtype(dtype)?));
            }
        }
        Ok(all)
    };
    let refuse = |what: String| CheckpointError::Weights {
        path: path.clone(),
        what,
    };
    let tensors = tensors().map_err(|error| refuse(error.to_string()))?;
    write_tensors(&path, tensors)
}

/// Writes named tensors as safetensors, atomically.
pub fn write_tensors(path: &Path, tensors: Vec<(String, Tensor)>) -> Result<(), CheckpointError> {
    let bytes =
        safetensors::serialize(tensors, None).map_err(|error| CheckpointError::Weights {
            path: path.to_owned(),
            what: error.to_string(),
        })?;
    write_atomic(path, &bytes)
}

/// Reads named tensors.
pub fn read_tensors(path: &Path) -> Result<HashMap<String, Tensor>, CheckpointError> {
    let bytes = std::fs::read(path).map_err(|source| CheckpointError::File {
        path: path.to_owned(),
        source,
    })?;
    candle_core::safetensors::load_buffer(&bytes, &Device::Cpu).map_err(|error| {
        CheckpointError::Weights {
            path: path.to_owned(),
            what: format!("not safetensors ({error})"),
        }
    })
}

/// Fills the model's networks from `path`.
pub fn load_weights(model: &Model, path: &Path) -> Result<(), CheckpointError> {
    let refuse = |what: String| CheckpointError::Weights {
        path: path.to_owned(),
        what,
    };
    let tensors = read_tensors(path)?;
    for network in model.networks() {
        network
            .fill(|slot| {
                let name = format!("{}.{}", network.name, slot.name);
                let Some(tensor) = tensors.get(&name) else {
                    candle_core::bail!("tensor `{name}` is missing")
                };
                if tensor.dims() != slot.shape {
                    candle_core::bail!(
                        "tensor `{name}` is {:?} where the config wants {:?}",
                        tensor.dims(),
                        slot.shape
                    )
                }
                let numbers = tensor
                    .to_dtype(DType::F32)?
                    .flatten_all()?
                    .to_vec1::<f32>()?;
                if numbers.iter().any(|number| !number.is_finite()) {
                    candle_core::bail!("tensor `{name}` holds numbers that are not finite")
                }
                Ok(numbers)
            })
            .map_err(|error| refuse(error.to_string()))?;
    }
    Ok(())
}

/// Reads a checkpoint: the model, and its position probe where it has one.
pub fn load(folder: &Path) -> Result<(Model, Option<Probe>), CheckpointError> {
    let config = load_config(&folder.join(CONFIG))?;
    let path = folder.join(WEIGHTS);
    let refuse = |what: String| CheckpointError::Weights {
        path: path.clone(),
        what,
    };
    let model = Model::new(config, 0, &Device::Cpu).map_err(|error| refuse(error.to_string()))?;
    load_weights(&model, &path)?;
    let path = folder.join(PROBE);
    let probe = if path.exists() {
        Some(Probe::read(&path, model.config.latent)?)
    } else {
        None
    };
    Ok((model, probe))
}
