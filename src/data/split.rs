//! Which episodes train, which choose checkpoints, and which are only scored.

use super::hash::Fnv;
use crate::episode::{EpisodeMeta, Split};

/// One episode in so many of the training split becomes `val` where a dataset names none.
const VAL_SHARE: usize = 10;

/// The split of each episode: the one it names, `train` where it names none. Where no episode is of `val`, a tenth of
/// those of `train` (one at least, if there are two) are, chosen by `seed`.
pub(super) fn splits(metas: &[EpisodeMeta], seed: u64) -> Vec<Split> {
    let mut splits: Vec<_> = metas
        .iter()
        .map(|meta| meta.split.unwrap_or(Split::Train))
        .collect();
    if splits.contains(&Split::Val) {
        return splits;
    }
    let mut train: Vec<_> = (0..metas.len())
        .filter(|&i| splits[i] == Split::Train)
        .map(|i| (key(seed, i, &metas[i].id), i))
        .collect();
    train.sort_unstable();
    let val = match train.len() {
        0 | 1 => 0,
        n => (n / VAL_SHARE).max(1),
    };
    for &(_, i) in &train[..val] {
        splits[i] = Split::Val;
    }
    splits
}

/// A place in the shuffle, well mixed (splitmix64's finaliser over FNV).
fn key(seed: u64, index: usize, id: &str) -> u64 {
    let mut hash = Fnv::new();
    hash.update(&seed.to_le_bytes());
    hash.update(&(index as u64).to_le_bytes());
    hash.update(id.as_bytes());
    let mut x = hash.value();
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metas(splits: &[Option<Split>]) -> Vec<EpisodeMeta> {
        let meta = |(i, &split): (usize, &Option<Split>)| EpisodeMeta {
            id: format!("{i:04}"),
            split,
            ..EpisodeMeta::default()
        };
        splits.iter().enumerate().map(meta).collect()
    }

    #[test]
    fn val_is_a_tenth_of_train_by_seed() {
        let mut named = vec![Some(Split::Train); 200];
        named.extend([Some(Split::Test); 50]);
        let metas = metas(&named);
        let count = |splits: &[Split], split| splits.iter().filter(|&&s| s == split).count();
        let first = splits(&metas, 1);
        assert_eq!(count(&first, Split::Val), 20);
        assert_eq!(count(&first, Split::Test), 50);
        assert_eq!(first, splits(&metas, 1));
        assert_ne!(first, splits(&metas, 2));
    }

    #[test]
    fn a_named_val_is_kept() {
        let metas = metas(&[Some(Split::Val), None, Some(Split::Train)]);
        assert_eq!(splits(&metas, 3), [Split::Val, Split::Train, Split::Train]);
    }
}
