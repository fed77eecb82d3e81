//! A short name for what a checkpoint's files hold: what was computed from them is kept under it.

use std::path::Path;

use super::{CONFIG, CheckpointError, PROBE, WEIGHTS, read_bytes};

/// 16 hexadecimal digits that differ where the files in `folder` do: eight of the weights, then eight of the config
/// and the probe. It is for finding things again, not a proof against forgery.
pub fn hash(folder: &Path) -> Result<String, CheckpointError> {
    let config = read_bytes(&folder.join(CONFIG))?;
    let weights = read_bytes(&folder.join(WEIGHTS))?;
    Ok(of_files(&config, &weights, probe(folder)?.as_deref()))
}

/// The probe's file, where there is one.
pub(super) fn probe(folder: &Path) -> Result<Option<Vec<u8>>, CheckpointError> {
    let path = folder.join(PROBE);
    path.exists().then(|| read_bytes(&path)).transpose()
}

/// The same of files that have been read.
pub(super) fn of_files(config: &[u8], weights: &[u8], probe: Option<&[u8]>) -> String {
    let mut about = crc32fast::Hasher::new();
    // Or what is moved from the end of one to the start of the other would not be seen.
    about.update(&(config.len() as u64).to_le_bytes());
    about.update(config);
    about.update(probe.unwrap_or_default());
    format!("{:08x}{:08x}", crc32fast::hash(weights), about.finalize())
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use candle_core::{DType, Device};

    use super::*;
    use crate::model::Model;
    use crate::model::checkpoint::{load_with_hash, save};
    use crate::model::config::Config;
    use crate::model::probe::Probe;

    #[test]
    fn it_is_of_every_file_and_the_same_when_loading() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let mut config = Config::named("v").unwrap();
        config.hidden = 8;
        let store = |config: &Config, seed| {
            let model = Model::new(config.clone(), seed, &Device::Cpu).unwrap();
            save(&model, path, DType::F16, None).unwrap();
            hash(path).unwrap()
        };
        let first = store(&config, 1);
        assert!(first.len() == 16 && first.bytes().all(|b| b.is_ascii_hexdigit()));
        let other = store(&config, 2);
        assert_ne!(first[..8], other[..8]);
        assert_eq!(first[8..], other[8..]);
        assert_eq!(store(&config, 1), first);
        let probe = Probe {
            weights: vec![0.5; 32],
            bias: [0.1, 0.2],
            residual: [0.0; 3],
        };
        probe.write(&path.join(PROBE), None).unwrap();
        let probed = hash(path).unwrap();
        assert_ne!(probed, first);
        config.step_secs = Some(0.25);
        assert_ne!(store(&config, 1), probed);
        assert_eq!(load_with_hash(path).unwrap().2, hash(path).unwrap());
    }
}
