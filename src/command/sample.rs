//! Where the episodes and the model that ship with poescope lie.

use std::path::{Path, PathBuf};

use anyhow::bail;

use crate::model::checkpoint::CONFIG;

/// Below the working directory, or where poescope was built.
fn folder() -> anyhow::Result<PathBuf> {
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_data");
    let Some(found) = [PathBuf::from("sample_data"), built]
        .into_iter()
        .find(|folder| folder.is_dir())
    else {
        bail!(
            "no sample_data here; run inside the checkout, or name --data FILE.mcap and --model FOLDER"
        );
    };
    Ok(found)
}

/// The dataset asked for, or the sample episodes.
pub fn data(asked: Option<&PathBuf>) -> anyhow::Result<PathBuf> {
    asked.map_or_else(
        || Ok(folder()?.join("episodes.mcap")),
        |path| Ok(path.clone()),
    )
}

/// The checkpoint asked for, or the sample model.
pub fn model(asked: Option<&PathBuf>) -> anyhow::Result<PathBuf> {
    asked.map_or_else(|| Ok(folder()?.join("v-h-p")), |path| Ok(path.clone()))
}

/// The checkpoints beside a dataset: every folder with a config next to its file, or in its folder, by name.
pub fn beside(data: &Path) -> Vec<PathBuf> {
    let folder = if data.is_dir() {
        Some(data)
    } else {
        data.parent()
    };
    let entries = folder.and_then(|folder| std::fs::read_dir(folder).ok());
    let mut found: Vec<PathBuf> = entries
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.join(CONFIG).is_file())
        .collect();
    found.sort();
    found
}
