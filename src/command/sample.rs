//! Where the episodes and the model that ship with poescope lie.

use std::path::{Path, PathBuf};

use anyhow::bail;

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
