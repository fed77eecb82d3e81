//! The first and the last line: what is open, and what there is to say.
//!
//! ```text
//! overview  sample_data  v-h-p    computing…  episode 3/24  push-00003 test  scope episode
//! …
//! ! untrained switches: vision alone was never trained without the prior
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::widgets::{Clear, Widget};

use super::face::Face;
use super::paint::{right, text, width};
use super::theme::{WARNING, dim, strong};
use super::words::wrap;
use crate::session::command::Scope;
use crate::session::snapshot::{Badge, Snapshot};

/// A message takes no more lines than these above its own.
const MOST_ABOVE: u16 = 5;

/// Draws the first line.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let mut at = text(buf, pane, 0, 0, face.view.name(), strong());
    if face.zoomed {
        at = text(
            buf,
            pane,
            at + 1,
            0,
            &format!("▸ {}", face.focus.name()),
            Style::new(),
        );
    }
    at = text(buf, pane, at + 2, 0, &snapshot.dataset, dim());
    if let Some(model) = snapshot.shown_model() {
        at = text(buf, pane, at + 2, 0, &model.name, strong());
        if snapshot.models.len() > 1 {
            let of = format!("{}/{}", snapshot.model + 1, snapshot.models.len());
            at = text(buf, pane, at + 1, 0, &of, dim());
        }
        // Where room is short the episode's name says more.
        if let Some(update) = model.update.filter(|_| pane.width >= 96) {
            at = text(buf, pane, at + 2, 0, &format!("update {update}"), dim());
        }
        let source = 2 + width(&model.source);
        if pane.width >= 110 && at + source < pane.width / 2 {
            at = text(buf, pane, at + 2, 0, &model.source, dim());
        }
    }
    if let Some(badge) = badge(&snapshot.badge) {
        at = text(
            buf,
            pane,
            at + 2,
            0,
            badge,
            strong().patch(face.depth.ink(WARNING)),
        );
    }
    if snapshot.busy {
        at = text(buf, pane, at + 2, 0, "computing…", dim());
    }

    let scope = match snapshot.scope {
        Scope::Episode => "scope episode",
        Scope::Onward => "scope onward",
        Scope::Frame => "scope frame",
    };
    let mut parts = vec![format!(
        "episode {}/{}",
        snapshot.episode_index + 1,
        snapshot.episode_count
    )];
    if let Some(episode) = &snapshot.episode {
        let split = episode.split.map_or("", crate::episode::Split::name);
        parts.push(format!("{} {split}", episode.id).trim_end().to_owned());
    }
    parts.push(scope.to_owned());
    // Where room is short the episode's name goes first, then the scope.
    while parts.len() > 1 && at + 2 + width(&parts.join("  ")) > pane.width {
        parts.remove(if parts.len() == 3 { 1 } else { parts.len() - 1 });
    }
    let line = parts.join("  ");
    if at + 2 + width(&line) <= pane.width {
        right(buf, pane, pane.width, 0, &line, Style::new());
    }
}

/// Draws the last line: what is typed, else the last message, else a warning, else some keys.
pub fn message(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let warning = strong().patch(face.depth.ink(WARNING));
    if let Some(prompt) = &face.prompt {
        if prompt.starts_with(':') {
            // The end of a long line is where it is typed.
            let line = ending(prompt, pane.width.saturating_sub(1));
            let at = text(buf, pane, 0, 0, line, strong());
            text(buf, pane, at, 0, "▏", Style::new());
        } else {
            let (now, keys) = prompt.split_once(" | ").unwrap_or((prompt, ""));
            let at = text(buf, pane, 0, 0, now, strong());
            if !keys.is_empty() {
                let at = text(buf, pane, at, 0, " | ", dim());
                keys_of(buf, pane, at, keys);
            }
        }
        return;
    }
    let episode = snapshot.episode.as_deref();
    if let Some(message) = &snapshot.message {
        let mark = if message.error { "! " } else { "" };
        let lines = wrap(&message.text, pane.width - width(mark).min(pane.width));
        // What does not fit on a line takes those above it: it may be what is to be copied, or to be done.
        let rows = (lines.len() as u16).clamp(1, 1 + pane.y.min(MOST_ABOVE));
        let pane = Rect {
            y: pane.y + 1 - rows,
            height: rows,
            ..pane
        };
        Clear.render(pane, buf);
        let at = text(buf, pane, 0, 0, mark, warning);
        for (row, line) in lines.iter().enumerate() {
            text(buf, pane, at, row as u16, line, Style::new());
        }
    } else if let Some(missing) = episode
        .map(|episode| &episode.missing)
        .filter(|missing| !missing.is_empty())
    {
        let at = text(buf, pane, 0, 0, "! ", warning);
        let line = format!(
            "this recording lacks {}, which the model needs",
            missing.join(", ")
        );
        text(buf, pane, at, 0, &line, Style::new());
    } else if let Badge::Untrained(why) = &snapshot.badge {
        let at = text(buf, pane, 0, 0, "! untrained switches: ", warning);
        text(buf, pane, at, 0, why, Style::new());
    } else if let Some(flag) = episode.and_then(|episode| episode.flags.first()) {
        let count = episode.map_or(0, |episode| episode.flags.len());
        let which = if count > 1 {
            format!("recording (1 of {count}): ")
        } else {
            "recording: ".to_owned()
        };
        let at = text(buf, pane, 0, 0, &which, dim());
        let at = text(buf, pane, at, 0, flag, Style::new());
        if count > 1 {
            text(buf, pane, at, 0, ", :recording for the next", dim());
        }
    } else {
        hints(buf, pane);
    }
}

/// The keys of a mode, as many as there is room for: the most useful ones stand first.
fn keys_of(buf: &mut Buffer, pane: Rect, mut at: u16, keys: &str) {
    for key in keys.split(", ") {
        if at + width(key) > pane.width {
            return;
        }
        at = text(buf, pane, at, 0, key, dim()) + 2;
    }
}

/// The last characters of a text that so many columns hold.
fn ending(text: &str, columns: u16) -> &str {
    let starts = text.char_indices().map(|(start, _)| &text[start..]);
    let mut fitting = starts.filter(|rest| width(rest) <= columns);
    fitting.next().unwrap_or("")
}

/// As many keys as there is room for, the way to all the others always among them.
fn hints(buf: &mut Buffer, pane: Rect) {
    const KEYS: [(&str, &str); 9] = [
        ("?", "keys"),
        ("space", "play"),
        ("←→", "step"),
        ("1…9", "switch"),
        ("s", "scope"),
        ("p", "predict here"),
        ("[ ]", "episode"),
        ("⏎", "zoom"),
        ("q", "quit"),
    ];
    let mut at = 0;
    for (key, does) in KEYS {
        if at + width(key) + 1 + width(does) > pane.width {
            return;
        }
        at = text(buf, pane, at, 0, key, Style::new());
        at = text(buf, pane, at + 1, 0, does, dim()) + 2;
    }
}

fn badge(badge: &Badge) -> Option<&'static str> {
    match badge {
        Badge::Trained => None,
        Badge::Untrained(_) => Some("! untrained"),
        Badge::NoProduct => Some("no product"),
    }
}
