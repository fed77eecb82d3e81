//! An aligned episode as bytes: a JSON head (length first), the frames, then every number that was recorded, f32 and
//! little-endian. It lives as long as the process that wrote it.

use serde::{Deserialize, Serialize};

use crate::episode::{Episode, EpisodeMeta, Flag, Frame, Layout, PlanarPose};

/// What is not pixels or samples, and how many numbers of each kind follow; none where it was not recorded.
#[derive(Serialize, Deserialize)]
struct Head {
    meta: EpisodeMeta,
    layout: Layout,
    steps_nanos: Vec<i64>,
    flags: Vec<Flag>,
    haptic: Option<usize>,
    proprio: Option<usize>,
    controls: Option<usize>,
    object: Option<usize>,
    tip: Option<usize>,
}

/// Bytes that an episode takes, in memory or as a record, give or take its name.
pub(super) fn size(episode: &Episode) -> u64 {
    let pixels: usize = episode.frames.iter().map(|frame| frame.pixels.len()).sum();
    let numbers = [
        episode.haptic.as_ref().map_or(0, Vec::len),
        episode.proprio.as_ref().map_or(0, Vec::len),
        2 * episode.controls.as_ref().map_or(0, Vec::len),
        3 * episode.object.as_ref().map_or(0, Vec::len),
        2 * episode.tip.as_ref().map_or(0, Vec::len),
        2 * episode.steps(),
    ];
    let head = size_of::<Episode>() as u64;
    head + (pixels + size_of::<f32>() * numbers.iter().sum::<usize>()) as u64
}

/// The record of an episode whose frames have its layout's size.
pub(super) fn write(episode: &Episode) -> Vec<u8> {
    let head = Head {
        meta: episode.meta.clone(),
        layout: episode.layout,
        steps_nanos: episode.steps_nanos.clone(),
        flags: episode.flags.clone(),
        haptic: episode.haptic.as_ref().map(Vec::len),
        proprio: episode.proprio.as_ref().map(Vec::len),
        controls: episode.controls.as_ref().map(Vec::len),
        object: episode.object.as_ref().map(Vec::len),
        tip: episode.tip.as_ref().map(Vec::len),
    };
    let head = serde_json::json!(head).to_string();
    let mut bytes = Vec::with_capacity(size(episode) as usize + head.len());
    bytes.extend((head.len() as u64).to_le_bytes());
    bytes.extend(head.as_bytes());
    for frame in &episode.frames {
        bytes.extend(&frame.pixels);
    }
    let mut put = |numbers: &[f32]| bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    put(episode.haptic.as_deref().unwrap_or_default());
    put(episode.proprio.as_deref().unwrap_or_default());
    put(episode
        .controls
        .as_deref()
        .unwrap_or_default()
        .as_flattened());
    for pose in episode.object.iter().flatten() {
        put(&[pose.x, pose.y, pose.yaw]);
    }
    put(episode.tip.as_deref().unwrap_or_default().as_flattened());
    bytes
}

/// The episode of a record; none if it is not one.
pub(super) fn read(bytes: &[u8]) -> Option<Episode> {
    let (length, bytes) = bytes.split_first_chunk()?;
    let (head, mut bytes) = bytes.split_at_checked(u64::from_le_bytes(*length) as usize)?;
    let head: Head = serde_json::from_slice(head).ok()?;
    let side = head.layout.frame_size;
    let mut take = |length: usize| {
        let (taken, rest) = bytes.split_at_checked(length)?;
        bytes = rest;
        Some(taken)
    };
    let mut frames = Vec::with_capacity(head.steps_nanos.len());
    for _ in &head.steps_nanos {
        frames.push(Frame {
            width: side,
            height: side,
            pixels: take(side * side)?.to_vec(),
        });
    }
    let mut numbers = |rows: Option<usize>, columns: usize| {
        let length = rows.unwrap_or(0) * columns * size_of::<f32>();
        let (numbers, _) = take(length)?.as_chunks();
        let numbers = numbers.iter().copied().map(f32::from_le_bytes);
        Some(rows.map(|_| numbers.collect::<Vec<f32>>()))
    };
    let pairs = |numbers: Vec<f32>| numbers.as_chunks().0.to_vec();
    let pose = |&[x, y, yaw]: &[f32; 3]| PlanarPose { x, y, yaw };
    let poses = |numbers: Vec<f32>| numbers.as_chunks().0.iter().map(pose).collect();
    let haptic = numbers(head.haptic, 1)?;
    let proprio = numbers(head.proprio, 1)?;
    let controls = numbers(head.controls, 2)?.map(pairs);
    let object = numbers(head.object, 3)?.map(poses);
    let tip = numbers(head.tip, 2)?.map(pairs);
    Some(Episode {
        meta: head.meta,
        layout: head.layout,
        steps_nanos: head.steps_nanos,
        frames,
        haptic,
        proprio,
        controls,
        object,
        tip,
        flags: head.flags,
    })
}
