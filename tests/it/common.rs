//! What several themes need: the program itself, simulated episodes, a model before training.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use candle_core::{DType, Device};
use poescope::model::Model;
use poescope::model::checkpoint::{self, MEAN_FRAME};
use poescope::model::config::Config;

/// The program; arguments follow.
pub(crate) fn poescope() -> Command {
    Command::new(env!("CARGO_BIN_EXE_poescope"))
}

/// What it wrote to standard output; it must succeed.
pub(crate) fn answer(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let said = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{command:?}: {said}");
    String::from_utf8(stdout).unwrap()
}

/// A Python that has the packages. The interpreter that CI names must have them; another one is asked whether it does.
pub(crate) fn python(packages: &str) -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("POESCOPE_PYTHON") {
        return Some(PathBuf::from(named));
    }
    let mut ask = Command::new("python3");
    let asked = ask.args(["-c", &format!("import {packages}")]).output();
    let has_them = asked.is_ok_and(|output| output.status.success());
    has_them.then(|| PathBuf::from("python3"))
}

/// A dataset of simulated episodes.
pub(crate) fn simulated(path: PathBuf, episodes: usize, options: &[&str]) -> PathBuf {
    let episodes = episodes.to_string();
    let mut command = poescope();
    command.args(["simulate", "--threads", "2", "--episodes", &episodes]);
    answer(command.args(options).arg("--out").arg(&path));
    path
}

/// A checkpoint of a model as it is before training, seeded; its mean training frame is grey.
pub(crate) fn untrained(folder: PathBuf, config: Config) -> PathBuf {
    let side = config.frame_size as u32;
    let model = Model::new(config, 7, &Device::Cpu).unwrap();
    checkpoint::save(&model, &folder, DType::F16, None).unwrap();
    image::GrayImage::from_pixel(side, side, image::Luma([128]))
        .save(folder.join(MEAN_FRAME))
        .unwrap();
    folder
}

/// The model of three experts, as it was trained on simulated episodes.
pub(crate) fn three_experts() -> Config {
    let mut config = Config::named("v-h-p").unwrap();
    config.step_secs = Some(32.0 / 120.0);
    config
}

/// The tensors of a safetensors file as bytes, by name.
pub(crate) fn tensors(path: &Path) -> Vec<(String, Vec<u8>)> {
    let bytes = std::fs::read(path).unwrap();
    let file = safetensors::SafeTensors::deserialize(&bytes).unwrap();
    let mut tensors: Vec<_> = file
        .tensors()
        .into_iter()
        .map(|(name, tensor)| (name, tensor.data().to_vec()))
        .collect();
    tensors.sort();
    tensors
}
