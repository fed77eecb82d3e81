//! What our own client shows besides the elements: numbers that the stock client has no element for, the keys, the state.

use serde_json::{Value, json};

use super::experts::switchable;
use super::panel::Panel;
use crate::episode::Split;
use crate::session::keymap::{Binding, FaceCommand, Meaning, bindings};
use crate::session::snapshot::{Badge, ExpertView, Snapshot};

/// Adds the hidden elements.
pub fn add(panel: &mut Panel, snapshot: &Snapshot, read_only: bool) {
    panel.hidden("key", String::new());
    panel.hidden("line", String::new());
    panel.hidden("state", snapshot.state.clone());
    let keys: Vec<Value> = bindings().iter().map(key).collect();
    panel.hidden("keys", Value::from(keys).to_string());
    panel.hidden("meta", meta(snapshot, read_only).to_string());
    panel.hidden("face", json!({ "n": 0 }).to_string());
}

fn key(binding: &Binding) -> Value {
    let face = match &binding.meaning {
        Meaning::Face(command) => Some(face_name(*command)),
        _ => None,
    };
    json!({
        "group": binding.group,
        "keys": binding.keys,
        "label": binding.label(),
        "help": binding.help,
        "face": face,
    })
}

/// What a command of the face is called on the wire.
pub fn face_name(command: FaceCommand) -> String {
    let name = match command {
        FaceCommand::Help => "help",
        FaceCommand::Quit => "quit",
        FaceCommand::FocusNext => "focus-next",
        FaceCommand::FocusPrevious => "focus-previous",
        FaceCommand::Zoom => "zoom",
        FaceCommand::Back => "back",
        FaceCommand::NextView => "next-view",
        FaceCommand::View(name) => return format!("view {name}"),
        FaceCommand::Difference => "difference",
        FaceCommand::Blink => "blink",
        FaceCommand::Wipe => "wipe",
        FaceCommand::Episodes => "episodes",
        FaceCommand::CopyState => "copy-state",
        FaceCommand::Export => "export",
    };
    name.to_owned()
}

fn meta(snapshot: &Snapshot, read_only: bool) -> Value {
    let episode = snapshot.episode.as_deref();
    let cursor = snapshot.cursor;
    let fusion = snapshot.fusion.as_deref();
    let psnr = snapshot.psnr_db.get(cursor).copied().unwrap_or_default();
    let position = snapshot.position.as_ref();
    let cm = |metres: Option<f32>| metres.map(|metres| 100.0 * metres);
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "read_only": read_only,
        "dataset": snapshot.dataset,
        "model": model(snapshot),
        "episode": episode.map(|episode| json!({
            "index": snapshot.episode_index,
            "count": snapshot.episode_count,
            "id": episode.id,
            "split": episode.split.map(Split::name),
            "flags": episode.flags,
            "missing": episode.missing,
        })),
        "step": cursor,
        "steps": snapshot.steps(),
        "secs": episode.and_then(|episode| episode.secs.get(cursor)),
        "playing": snapshot.playing,
        "speed": snapshot.speed,
        "looping": snapshot.looping,
        "scope": snapshot.scope,
        "context": snapshot.context,
        "horizon": snapshot.horizon,
        "start": snapshot.start,
        "selection": snapshot.selection,
        "events": *snapshot.events,
        "force_newtons": episode.and_then(|episode| episode.force_newtons.get(cursor)),
        "force_over_time": episode.map(|episode| &episode.force_newtons),
        "experts": experts(snapshot),
        "active": fusion.map(|fusion| fusion.active.as_slice()).unwrap_or_default(),
        "badge": badge(&snapshot.badge),
        "error_of": snapshot.frames.error_of,
        "position_error_cm": {
            "belief": cm(position.and_then(|position| position.belief_error_m)),
            "prediction": cm(position.and_then(|position| position.prediction_error_m)),
        },
        "psnr_db": { "belief": psnr.belief, "prediction": psnr.prediction },
        "corruptions": snapshot.corruptions.iter().map(|(modality, corruption)| json!({
            "modality": modality,
            "damage": corruption.damage,
            "severity": corruption.severity,
            "from": corruption.from,
            "until": corruption.until,
        })).collect::<Vec<_>>(),
        "control_edit": snapshot.control_edit.map(|edit| edit.what()),
        "sampling": snapshot.sampling,
        "scored": {
            "done": snapshot.table.scored,
            "of": snapshot.table.rows.len(),
            "asked": snapshot.table.asked,
        },
        "failure": {
            "order": snapshot.table.order.name(),
            "place": snapshot.table.place,
            "count": snapshot.table.queue.len(),
        },
        "message": snapshot.message,
        "told": snapshot.told,
        "busy": snapshot.busy,
        "current": snapshot.current,
    })
}

fn model(snapshot: &Snapshot) -> Option<Value> {
    let model = snapshot.shown_model()?;
    Some(json!({
        "index": snapshot.model,
        "count": snapshot.models.len(),
        "name": model.name,
        "source": model.source,
        "update": model.update,
        "latent": model.latent,
        "product": snapshot.badge != Badge::NoProduct,
    }))
}

fn experts(snapshot: &Snapshot) -> Vec<Value> {
    let readings = snapshot
        .fusion
        .as_ref()
        .map(|fusion| fusion.experts.as_slice())
        .unwrap_or_default();
    let last = snapshot.experts.len().saturating_sub(1);
    let one = |(place, view): (usize, &ExpertView)| {
        let reading = readings.get(place);
        let (r, g, b) = view.expert.rgb();
        let key = if place == last { 9 } else { place + 1 };
        json!({
            "name": view.expert.name(),
            "letter": view.expert.letter(),
            "key": key.to_string(),
            "color": format!("#{r:02X}{g:02X}{b:02X}"),
            "fill": view.expert.fill(),
            "alpha": view.alpha,
            "damaged": snapshot.damage_of(view.expert).is_some(),
            "switchable": switchable(snapshot, view.expert),
            "share": view.share,
            "share_mean": view.share_mean,
            "share_position": view.share_position,
            "information_nats": reading.and_then(|reading| reading.information_nats),
            "nis": reading.and_then(|reading| reading.nis),
            "pull_cm": reading.and_then(|reading| reading.pull_m).map(|pull| pull.map(|metres| 100.0 * metres)),
        })
    };
    snapshot.experts.iter().enumerate().map(one).collect()
}

fn badge(badge: &Badge) -> Value {
    let (kind, text) = match badge {
        Badge::Trained => ("trained", "trained on these switches"),
        Badge::Untrained(why) => ("untrained", why.as_str()),
        Badge::NoProduct => ("no-product", "nothing to switch"),
    };
    json!({ "kind": kind, "text": text })
}
