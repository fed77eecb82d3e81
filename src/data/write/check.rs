//! What must hold of a recording before it is written.

use crate::data::topics::Role;
use crate::episode::{Recording, Track};

/// One message to write.
pub(super) struct Scheduled {
    pub(super) stamp_nanos: i64,
    pub(super) role: Role,
    /// Which sample of its stream.
    pub(super) index: usize,
}

/// Every message, by role.
pub(super) fn schedule(recording: &Recording) -> Vec<Scheduled> {
    let mut messages = Vec::new();
    for role in Role::ALL {
        let stamps = stamps(recording, role);
        messages.extend(
            stamps
                .iter()
                .enumerate()
                .map(|(index, &stamp_nanos)| Scheduled {
                    stamp_nanos,
                    role,
                    index,
                }),
        );
    }
    messages
}

/// First and last nanosecond of a recording that begins after `last_end`.
///
/// # Errors
/// A phrase that says what does not fit.
pub(super) fn interval(recording: &Recording, last_end: Option<i64>) -> Result<(i64, i64), String> {
    lengths(recording)?;
    let stamps = Role::ALL
        .into_iter()
        .flat_map(|role| stamps(recording, role));
    let (first, last) = stamps.fold((i64::MAX, i64::MIN), |(first, last), &stamp| {
        (first.min(stamp), last.max(stamp))
    });
    if first > last {
        return Err("it holds no samples".to_owned());
    }
    let meta = &recording.meta;
    let (start, end) = match (meta.start_nanos, meta.end_nanos) {
        (0, 0) => (first, last),
        given => given,
    };
    if first < start || last > end || first < 0 {
        return Err(format!(
            "samples from {first} to {last} ns lie outside its interval, {start} to {end} ns"
        ));
    }
    if last_end.is_some_and(|last_end| start <= last_end) {
        return Err(
            "it begins before the one before it has ended; give each its own time".to_owned(),
        );
    }
    Ok((start, end))
}

fn lengths(recording: &Recording) -> Result<(), String> {
    fn paired<const N: usize>(track: &Track<N>) -> bool {
        track.stamps_nanos.len() == track.values.len()
    }
    let whole = recording.frame_stamps_nanos.len() == recording.frames.len()
        && paired(&recording.wrench)
        && paired(&recording.ee_position)
        && paired(&recording.ee_velocity)
        && paired(&recording.control)
        && paired(&recording.object);
    if !whole {
        return Err("a stream has not as many stamps as samples".to_owned());
    }
    let filled = |frame: &crate::episode::Frame| {
        !frame.pixels.is_empty() && frame.pixels.len() == frame.width * frame.height
    };
    if !recording.frames.iter().all(filled) {
        return Err("a frame has not width x height pixels".to_owned());
    }
    Ok(())
}

fn stamps(recording: &Recording, role: Role) -> &[i64] {
    match role {
        Role::Vision => &recording.frame_stamps_nanos,
        Role::Haptic => &recording.wrench.stamps_nanos,
        Role::EePose => &recording.ee_position.stamps_nanos,
        Role::EeTwist => &recording.ee_velocity.stamps_nanos,
        Role::Control => &recording.control.stamps_nanos,
        Role::Object => &recording.object.stamps_nanos,
    }
}
