//! Gaps, stamps that run backwards, and values that are no numbers.

use crate::episode::{Flag, Track};

/// A gap is longer than so many nominal periods.
const GAP_PERIODS: i64 = 3;
/// Rounding of stamps, in nanoseconds, is no gap.
const ROUNDING_NANOS: i64 = 1000;

/// Appends what is odd about `stamps` (in the order of recording) to `flags`. The nominal period is the median one; a
/// stream that begins so long after, or ends so long before what it should `cover` (first and last stamp) has a gap
/// there, too, and a single sample covers nothing.
pub(super) fn find(topic: &str, stamps: &[i64], cover: (i64, i64), flags: &mut Vec<Flag>) {
    let mut flag = |stamp_nanos: i64, gap: bool, what: String| {
        flags.push(Flag {
            topic: topic.to_owned(),
            stamp_nanos,
            what,
            gap,
        });
    };
    for pair in stamps.windows(2) {
        let back = pair[0].saturating_sub(pair[1]);
        if back > 0 {
            flag(
                pair[1],
                false,
                format!("stamps run backwards by {}", duration(back)),
            );
        }
    }
    let mut sorted = stamps.to_vec();
    sorted.sort_unstable();
    let periods = |pair: &[i64]| pair[1].saturating_sub(pair[0]);
    let mut lengths: Vec<_> = sorted.windows(2).map(periods).collect();
    lengths.sort_unstable();
    let Some(&nominal) = lengths.get(lengths.len().saturating_sub(1) / 2) else {
        if let [only] = stamps {
            flag(*only, false, "a single sample".to_owned());
        }
        return;
    };
    let (from, until) = cover;
    if sorted.first().is_some_and(|&first| from < first) {
        sorted.insert(0, from);
    }
    if sorted.last().is_some_and(|&last| until > last) {
        sorted.push(until);
    }
    let limit = nominal
        .saturating_mul(GAP_PERIODS)
        .saturating_add(ROUNDING_NANOS);
    for pair in sorted.windows(2) {
        let length = periods(pair);
        if length > limit {
            flag(pair[0], true, format!("gap of {}", duration(length)));
        }
    }
}

/// When the first value that is not finite was measured.
pub(super) fn not_finite<const N: usize>(track: &Track<N>) -> Option<i64> {
    let mut samples = track.stamps_nanos.iter().zip(&track.values);
    let broken = samples.find(|(_, value)| !value.iter().all(|x| x.is_finite()));
    broken.map(|(&stamp, _)| stamp)
}

fn duration(nanos: i64) -> String {
    let secs = nanos as f64 * 1e-9;
    if secs >= 1.0 {
        format!("{secs:.1} s")
    } else {
        format!("{:.3} ms", secs * 1e3)
    }
}
