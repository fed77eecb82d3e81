//! A checkpoint: a folder with `config.toml`, `weights.safetensors`, `probe.safetensors` and `report.json`.

mod hash;

pub use self::hash::hash;

use std::collections::HashMap;
use std::io::{ErrorKind, Read, Write};
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
    #[error("{}: {cause}{}", path.display(), advice(cause))]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// `config.toml` is not one.
    #[error("{}: {what}; correct it there, or start from the config of a trained model", path.display())]
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

impl CheckpointError {
    /// For `map_err`: the file at `path` could not be read or written.
    pub fn io(path: &Path) -> impl Fn(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |cause| Self::File {
            path: path.clone(),
            cause,
        }
    }

    /// What is wrong with the weights, or other tensors, at `path`.
    pub fn weights(path: &Path) -> impl Fn(String) -> Self + use<> {
        let path = path.to_owned();
        move |what| Self::Weights {
            path: path.clone(),
            what,
        }
    }
}

/// What to do about an error of the operating system, where that can be known.
fn advice(cause: &std::io::Error) -> &'static str {
    match cause.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => {
            "; check the path: a checkpoint is a folder that `poescope train` has written"
        }
        ErrorKind::PermissionDenied => "; change the permissions, or choose another path",
        ErrorKind::StorageFull => "; make room, or choose another disk",
        _ => "",
    }
}

/// An error of a tensor operation on one line: under `RUST_BACKTRACE` a backtrace follows.
pub fn first_line(error: &candle_core::Error) -> String {
    let text = error.to_string();
    text.lines().next().unwrap_or_default().to_owned()
}

/// The config's file name.
pub const CONFIG: &str = "config.toml";
/// The weights' file name.
pub const WEIGHTS: &str = "weights.safetensors";
/// Key in the weights' header: the update of its run that they are of.
const UPDATE: &str = "update";
/// A header is no longer than this.
const MOST_HEADER: u64 = 1 << 20;
/// The position probe's file name.
pub const PROBE: &str = "probe.safetensors";
/// The mean training frame's file name: the predictor that always says it stands in every table.
pub const MEAN_FRAME: &str = "mean_frame.png";
/// The report's file name.
pub const REPORT: &str = "report.json";

/// Writes `bytes` to `path` by way of a temporary file beside it, so that a half-written one is never seen.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<(), CheckpointError> {
    let failed = CheckpointError::io(path);
    let temporary = path.with_extension("part");
    let mut file = std::fs::File::create(&temporary).map_err(&failed)?;
    // On disk before it has its name: a power cut must not leave an empty file under it.
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    let renamed = written.and_then(|()| std::fs::rename(&temporary, path));
    renamed.map_err(|cause| {
        // On a full disk it would be in the way of everything else.
        let _ = std::fs::remove_file(&temporary);
        failed(cause)
    })
}

/// Everything in a file.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, CheckpointError> {
    std::fs::read(path).map_err(CheckpointError::io(path))
}

/// Reads a config, and says which key is wrong.
pub fn load_config(path: &Path) -> Result<Config, CheckpointError> {
    parse_config(path, &read_bytes(path)?)
}

fn parse_config(path: &Path, bytes: &[u8]) -> Result<Config, CheckpointError> {
    let refuse = |what: String| CheckpointError::Config {
        path: path.to_owned(),
        what,
    };
    let text = std::str::from_utf8(bytes).map_err(|error| refuse(error.to_string()))?;
    let config: Config =
        toml::from_str(text).map_err(|error| refuse(what_is_wrong(text, &error)))?;
    config
        .validate()
        .map_err(|error: ConfigError| refuse(error.to_string()))?;
    Ok(config)
}

/// The parser's complaint and its line: a wrong type is told without its key.
fn what_is_wrong(text: &str, error: &toml::de::Error) -> String {
    // What is missing is told of the whole file.
    let span = error.span().filter(|span| span.start > 0);
    match span.and_then(|span| text.get(..span.start)) {
        Some(before) => format!(
            "line {}: {}",
            before.matches('\n').count() + 1,
            error.message()
        ),
        None => error.message().to_owned(),
    }
}

/// Writes the config and the weights, as `dtype` numbers, into `folder`; `update` says of which update of a run.
pub fn save(
    model: &Model,
    folder: &Path,
    dtype: DType,
    update: Option<u64>,
) -> Result<(), CheckpointError> {
    std::fs::create_dir_all(folder).map_err(CheckpointError::io(folder))?;
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
    let refuse = CheckpointError::weights(&path);
    let tensors = tensors().map_err(|error| refuse(first_line(&error)))?;
    let about = update.map(|update| (UPDATE, update.to_string()));
    write_tensors(&path, tensors, about)
}

/// Writes named tensors as safetensors, atomically, with what is said of them in the header: one key at most, for the
/// order of several there is random.
pub fn write_tensors(
    path: &Path,
    tensors: Vec<(String, Tensor)>,
    about: Option<(&str, String)>,
) -> Result<(), CheckpointError> {
    let about = about.map(|(key, text)| HashMap::from([(key.to_owned(), text)]));
    let bytes = safetensors::serialize(tensors, about)
        .map_err(|error| CheckpointError::weights(path)(error.to_string()))?;
    write_atomic(path, &bytes)
}

/// The update of its run that the weights in `folder` are of; none where they do not say. Reads their header only.
pub fn update_of(folder: &Path) -> Option<u64> {
    let mut file = std::fs::File::open(folder.join(WEIGHTS)).ok()?;
    let mut length = [0; 8];
    file.read_exact(&mut length).ok()?;
    let mut header = Vec::new();
    file.take(u64::from_le_bytes(length).min(MOST_HEADER))
        .read_to_end(&mut header)
        .ok()?;
    let header: serde_json::Value = serde_json::from_slice(&header).ok()?;
    header["__metadata__"][UPDATE].as_str()?.parse().ok()
}

/// Reads named tensors.
pub fn read_tensors(path: &Path) -> Result<HashMap<String, Tensor>, CheckpointError> {
    parse_tensors(path, &read_bytes(path)?)
}

/// The same of bytes that have been read.
pub(super) fn parse_tensors(
    path: &Path,
    bytes: &[u8],
) -> Result<HashMap<String, Tensor>, CheckpointError> {
    candle_core::safetensors::load_buffer(bytes, &Device::Cpu).map_err(|error| {
        let what = format!("not safetensors ({})", first_line(&error));
        CheckpointError::weights(path)(what)
    })
}

/// Fills the model's networks from what `path` holds.
fn fill(model: &Model, path: &Path, bytes: &[u8]) -> Result<(), CheckpointError> {
    let refuse = CheckpointError::weights(path);
    let tensors = parse_tensors(path, bytes)?;
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
            .map_err(|error| refuse(first_line(&error)))?;
    }
    Ok(())
}

/// Reads a checkpoint: the model, and its position probe where it has one.
pub fn load(folder: &Path) -> Result<(Model, Option<Probe>), CheckpointError> {
    let (model, probe, _) = load_with_hash(folder)?;
    Ok((model, probe))
}

/// The same, and the [`hash`] of just what was read: a run may write a newer one meanwhile.
pub fn load_with_hash(folder: &Path) -> Result<(Model, Option<Probe>, String), CheckpointError> {
    let path = folder.join(CONFIG);
    let about = read_bytes(&path)?;
    let config = parse_config(&path, &about)?;
    let path = folder.join(WEIGHTS);
    let refuse = CheckpointError::weights(&path);
    let model = Model::blank(config, &Device::Cpu).map_err(|error| refuse(first_line(&error)))?;
    let weights = read_bytes(&path)?;
    fill(&model, &path, &weights)?;
    let found = hash::probe(folder)?;
    let hash = hash::of_files(&about, &weights, found.as_deref());
    let probe = found
        .map(|bytes| Probe::parse(&folder.join(PROBE), &bytes, model.config.latent))
        .transpose()?;
    Ok((model, probe, hash))
}
