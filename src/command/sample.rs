//! Where the episodes and the models that ship with poescope lie, and which checkpoints belong to a dataset.

use std::cmp::Reverse;
use std::path::{Path, PathBuf};

use anyhow::bail;

use crate::model::checkpoint::{CONFIG, load_config};

/// The episodes' file in a folder of samples.
const EPISODES: &str = "episodes.mcap";

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

/// The dataset asked for, or the sample episodes. A name that is no file but that of a second sample, such as
/// `pybullet`, is that sample.
pub fn data(asked: Option<&PathBuf>) -> anyhow::Result<PathBuf> {
    let Some(asked) = asked else {
        return Ok(folder()?.join(EPISODES));
    };
    if !asked.exists()
        && let Ok(folder) = folder()
    {
        let sample = folder.join(asked).join(EPISODES);
        if sample.is_file() {
            return Ok(sample);
        }
    }
    Ok(asked.clone())
}

/// The checkpoints beside a dataset, in the folder that it is or lies in: those with the most experts first, then by
/// name; the sample's where there are none.
pub fn models(data: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let around = if data.is_dir() {
        Some(data)
    } else {
        data.parent()
    };
    let mut found = around.map(checkpoints).unwrap_or_default();
    if found.is_empty() {
        found = checkpoints(&folder()?);
    }
    if found.is_empty() {
        bail!("no model beside the data; name one with --model FOLDER");
    }
    Ok(found)
}

fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut found: Vec<(Reverse<usize>, PathBuf)> = paths
        .filter(|path| path.join(CONFIG).is_file())
        .map(|path| {
            // One that cannot be read says so when it is opened.
            let experts = load_config(&path.join(CONFIG)).map_or(0, |config| config.experts.len());
            (Reverse(experts), path)
        })
        .collect();
    found.sort();
    found.into_iter().map(|(_, path)| path).collect()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;
    use crate::model::config::Config;

    #[test]
    fn a_dataset_has_the_checkpoints_beside_it_the_richest_first() {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("own.mcap");
        let own = |path: &Path| -> Vec<String> {
            let name = |path: PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
            models(path).unwrap().into_iter().map(name).collect()
        };
        assert_eq!(own(&data)[0], "v-h-p", "else the sample's");
        for name in ["v", "vhp", "v-h-p"] {
            let path = folder.path().join(name);
            std::fs::create_dir(&path).unwrap();
            let config = Config::named(name).unwrap();
            std::fs::write(path.join(CONFIG), toml::to_string(&config).unwrap()).unwrap();
        }
        assert_eq!(own(&data), ["v-h-p", "vhp", "v"]);
        assert_eq!(own(folder.path()), ["v-h-p", "vhp", "v"]);
    }

    #[test]
    fn a_sample_is_known_by_its_name_where_no_file_has_it() {
        let plain = PathBuf::from("no/such/file.mcap");
        assert_eq!(data(Some(&plain)).unwrap(), plain);
        assert!(data(None).unwrap().ends_with("sample_data/episodes.mcap"));
    }
}
