//! `:`: a line of text, and what fits it.

use super::{Action, Input};
use crate::session::keys::Key;
use crate::session::palette::{Does, Entry, PaletteView, matching};
use crate::session::prompt;
use crate::session::snapshot::Snapshot;

/// A longer line is nobody's; a state string is far shorter.
const LONGEST: usize = 4096;

/// What has been typed and picked.
#[derive(Clone, Debug, Default)]
pub(super) struct Typing {
    /// The line.
    pub line: String,
    /// The entry picked with the arrows.
    picked: Option<usize>,
}

impl Typing {
    pub fn from(start: &str) -> Self {
        Self {
            line: start.to_owned(),
            picked: None,
        }
    }

    pub fn palette(&self, snapshot: &Snapshot) -> PaletteView {
        let entries = matching(&self.line, snapshot);
        PaletteView {
            line: self.line.clone(),
            chosen: self.chosen(entries.len(), snapshot),
            entries: entries.into_iter().map(|entry| entry.shown).collect(),
        }
    }

    /// The picked entry; else the best one, unless the line makes sense as it is or is empty.
    fn chosen(&self, entries: usize, snapshot: &Snapshot) -> Option<usize> {
        let last = entries.checked_sub(1)?;
        let best = || {
            let is_whole =
                self.line.trim().is_empty() || prompt::understood(&self.line, snapshot).is_some();
            (!is_whole).then_some(0)
        };
        self.picked.map(|picked| picked.min(last)).or_else(best)
    }

    /// The entry that Enter does.
    fn entry(&self, snapshot: &Snapshot) -> Option<Entry> {
        let mut entries = matching(&self.line, snapshot);
        let chosen = self.chosen(entries.len(), snapshot)?;
        Some(entries.swap_remove(chosen))
    }

    /// Round and round.
    fn pick(&mut self, by: isize, snapshot: &Snapshot) {
        let entries = matching(&self.line, snapshot).len();
        if entries == 0 {
            return;
        }
        let next = match (self.chosen(entries, snapshot), by) {
            (None, 1..) => 0,
            (None, _) => entries - 1,
            (Some(at), by) => (at as isize + by).rem_euclid(entries as isize) as usize,
        };
        self.picked = Some(next);
    }
}

impl Input {
    pub(super) fn type_key(&mut self, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        let typing = &mut self.typing;
        match key.name() {
            "<esc>" => self.mode = None,
            "<backspace>" => {
                typing.picked = None;
                if typing.line.pop().is_none() {
                    self.mode = None;
                }
            }
            "<up>" => typing.pick(-1, snapshot),
            "<down>" => typing.pick(1, snapshot),
            "<tab>" => {
                // Where the line makes sense as it is, the entry that fits it best may still say more.
                let entry = typing.entry(snapshot);
                let best = || matching(&typing.line, snapshot).into_iter().next();
                if let Some(entry) = entry.or_else(best) {
                    let line = match entry.does {
                        Does::Press(_) => entry.shown.name,
                        Does::Type(line) | Does::Begin(line) => line,
                    };
                    *typing = Typing::from(&line);
                }
            }
            "<enter>" => return self.enter(snapshot),
            _ => {
                if typing.line.len() < LONGEST {
                    typing.line.extend(key.as_char());
                }
                typing.picked = None;
            }
        }
        None
    }

    fn enter(&mut self, snapshot: &Snapshot) -> Option<Action> {
        self.mode = None;
        let Some(entry) = self.typing.entry(snapshot) else {
            let line = std::mem::take(&mut self.typing.line);
            if line.trim().is_empty() {
                return None;
            }
            let nonsense = || Action::Explain {
                error: true,
                text: prompt::why_not(&line),
            };
            return Some(prompt::understood(&line, snapshot).unwrap_or_else(nonsense));
        };
        match entry.does {
            Does::Press(key) => self.plain(&Key::of_spelling(key).ok()?, snapshot),
            Does::Type(line) => prompt::understood(&line, snapshot),
            // The rest is to be typed first; once it has been begun, it makes no sense yet.
            Does::Begin(start) if is_longer(&self.typing.line, &start) => Some(Action::Explain {
                error: true,
                text: prompt::why_not(&self.typing.line),
            }),
            Does::Begin(start) => {
                self.mode = Some(super::Mode::Prompt);
                self.typing = Typing::from(&start);
                None
            }
        }
    }
}

fn is_longer(line: &str, start: &str) -> bool {
    line.strip_prefix(start)
        .is_some_and(|rest| !rest.trim().is_empty())
}
