//! What is open, and where in it the cursor is.

use std::fmt::Write;

use super::escape::escaped;
use super::names::{SPEEDS, entry, episodes};
use super::panel::{Panel, Range};
use crate::session::snapshot::{Badge, Snapshot};

/// Adds the line of status, the lists, time, and how far the scoring is.
pub fn add(panel: &mut Panel, snapshot: &Snapshot) {
    panel.markdown("status", status(snapshot));
    let listed = episodes(snapshot);
    let number = (snapshot.episode_index + 1).to_string();
    let present = listed
        .iter()
        .find(|entry| entry.split(' ').next() == Some(&number));
    let present = present
        .cloned()
        .unwrap_or_else(|| entry(snapshot.episode_index, ""));
    panel.dropdown("episode", ("Episode", "Keys: [ and ]"), &present, listed);
    let models = snapshot.models.iter().enumerate();
    let models: Vec<String> = models
        .map(|(index, model)| entry(index, &model.name))
        .collect();
    let model = models.get(snapshot.model).cloned().unwrap_or_default();
    panel.dropdown("model", ("Model", "Keys: ( and )"), &model, models);

    let steps = snapshot.steps();
    let step = (snapshot.cursor + 1) as f64;
    panel.slider(
        "step",
        ("Step", "Counted from 1"),
        step,
        Range::whole(1, steps),
        true,
    );
    let play = if snapshot.playing { "Pause" } else { "Play" };
    panel.button("play", play, "At the recorded rate times the speed");
    let speed = SPEEDS
        .iter()
        .find(|(_, speed)| speed.total_cmp(&snapshot.speed).is_eq());
    let speeds = SPEEDS.iter().map(|(name, _)| (*name).to_owned()).collect();
    panel.dropdown(
        "speed",
        ("Speed", ""),
        speed.map_or("1×", |(name, _)| name),
        speeds,
    );

    let (done, of) = (snapshot.table.scored, snapshot.table.rows.len());
    let percent = 100.0 * done as f64 / of.max(1) as f64;
    panel.progress("progress", percent, snapshot.table.asked && done < of);
}

fn status(snapshot: &Snapshot) -> String {
    let Some(episode) = &snapshot.episode else {
        let why = snapshot
            .message
            .as_ref()
            .map_or("reading", |message| message.text.as_str());
        return format!("**{}**: {}", escaped(&snapshot.dataset), escaped(why));
    };
    let mut line = format!(
        "**{}** of {}, step **{}** of {}",
        escaped(&episode.id),
        escaped(&snapshot.dataset),
        snapshot.cursor + 1,
        episode.secs.len()
    );
    // Writing to a string cannot fail.
    if let Some(secs) = episode.secs.get(snapshot.cursor) {
        let _ = write!(line, ", {secs:.2} s");
    }
    let _ = match &snapshot.badge {
        Badge::Trained => write!(line, ". Trained on these switches."),
        Badge::Untrained(why) => write!(line, ". **Not trained on this**: {}.", escaped(why)),
        Badge::NoProduct => write!(line, ". No product: nothing to switch."),
    };
    if !episode.missing.is_empty() {
        let missing = escaped(&episode.missing.join(", "));
        let _ = write!(line, " The recording lacks {missing}.");
    }
    if !snapshot.current {
        line.push_str(" _computing_");
    }
    line
}
