//! Which episodes and steps are exported.

use std::ops::RangeInclusive;

use anyhow::bail;

use crate::cli::ExportArgs;
use crate::data::Dataset;
use crate::episode::EpisodeSource;
use crate::session::Session;
use crate::session::state::State;

/// Indices of the episodes: those of the split, those that are named, the state's, or the first. `session` is of the
/// dataset, and `seed` is what cuts a validation split where the data name none.
pub(super) fn episodes(
    dataset: &Dataset,
    session: &Session,
    args: &ExportArgs,
    state: Option<&State>,
    seed: impl FnOnce() -> anyhow::Result<u64>,
) -> anyhow::Result<Vec<usize>> {
    if let Some(split) = args.split {
        let splits = dataset.splits(seed()?).into_iter().enumerate();
        let found: Vec<usize> = splits
            .filter_map(|(index, of)| (of == split).then_some(index))
            .collect();
        if found.is_empty() {
            bail!(
                "{} has no episode of split {}; see what it has with `poescope info`",
                dataset.name(),
                split.name()
            );
        }
        return Ok(found);
    }
    let own = state.and_then(|state| state.episode.as_ref());
    let named = if args.episode.is_empty() {
        own.map(std::slice::from_ref).unwrap_or_default()
    } else {
        &args.episode
    };
    if named.is_empty() {
        return Ok(vec![0]);
    }
    // As state strings call them: where several files have episodes of one name, the second is `name#2`.
    let index = |name: &String| {
        let mut all = 0..dataset.metas().len();
        let found = all.find(|&index| session.episode_key(index) == Some(name));
        let Some(found) = found else {
            bail!(
                "{} has no episode {name:?}; see what it has with `poescope info`",
                dataset.name()
            );
        };
        Ok(found)
    };
    let mut found = Vec::new();
    for index in named.iter().map(index) {
        let index = index?;
        if !found.contains(&index) {
            found.push(index);
        }
    }
    Ok(found)
}

/// First and last step, from 0: those that are named, else those that the state selects in its own episode.
pub(super) fn steps(args: &ExportArgs, state: Option<&State>) -> Option<RangeInclusive<usize>> {
    if let Some(steps) = &args.steps {
        return Some(steps.start() - 1..=steps.end() - 1);
    }
    if args.split.is_some() || !args.episode.is_empty() {
        return None;
    }
    state?.selected()
}
