//! Going to what stands out: failures, events, marks; and a selection to stay in.

use std::sync::Arc;

use super::Session;
use super::command::Looping;
use super::snapshot::{Event, EventKind};
use super::worker::Target;
use crate::measure::failure::Order;

impl Session {
    /// So many places on in the queue of failures; where nothing is scored yet, once everything is.
    pub(super) fn failure(&mut self, by: i64) {
        self.survey();
        if self.table.view().queue.is_empty() && self.survey_runs() {
            self.awaiting_failure = Some(by);
            self.inform("scoring every episode first".to_owned());
            return;
        }
        self.go_to_failure(by);
    }

    pub(super) fn go_to_failure(&mut self, by: i64) {
        let order = self.table.view().order;
        let Some((failure, moved)) = self.table.step(by) else {
            self.complain(match order {
                Order::Gain => {
                    "gain is over a model that sees frames alone: load one, with --model".to_owned()
                }
                order => {
                    let fault = self.table.view().first_fault();
                    let why = fault.map_or_else(String::new, |why| format!(": {why}"));
                    format!("no episode can be ranked by {}{why}", order.name())
                }
            });
            return;
        };
        self.go_to(Target {
            episode: failure.episode,
            ..self.target
        });
        self.seek_when_open(failure.step);
        let view = self.table.view();
        let place = view.place.unwrap_or(0) + 1;
        let (count, total) = (view.scored, view.rows.len());
        let so_far = if count < total {
            format!(", {count} of {total} episodes scored so far")
        } else {
            String::new()
        };
        let end = if moved { "" } else { ", the end of the queue" };
        self.inform(format!(
            "failure {place}/{} by {}: {}{end}{so_far}",
            view.queue.len(),
            order.name(),
            order.spelt(failure.value),
        ));
    }

    /// Lists only some episodes; says how many, since the list may be closed.
    pub(super) fn filter(&mut self, text: String) {
        self.table.filter(text);
        let view = self.table.view();
        let (shown, total) = (view.shown.len(), view.rows.len());
        let told = if view.filter.is_empty() {
            format!("all {total} episodes are listed")
        } else {
            let filter = &view.filter;
            format!("{shown} of {total} episodes have {filter:?} in name or split; E lists them")
        };
        self.inform(told);
    }

    /// The next oddity of the recording, after the last the first again.
    pub(super) fn tell_oddity(&mut self) {
        let flags = self.opened().map(|opened| opened.view.flags.clone());
        let flags = flags.unwrap_or_default();
        let Some(at) = self.oddity.checked_rem(flags.len()) else {
            self.inform("nothing is odd about this recording".to_owned());
            return;
        };
        self.oddity = at + 1;
        self.inform(format!(
            "recording ({} of {}): {}",
            at + 1,
            flags.len(),
            flags[at]
        ));
    }

    pub(super) fn rank_by(&mut self, order: Order) {
        self.table.rank_by(order);
        self.inform(format!("failures are ranked by {}", order.meaning()));
    }

    /// Contact onsets and marks of the present episode, in order.
    pub(super) fn events(&self) -> Arc<Vec<Event>> {
        let Some(opened) = self.opened() else {
            return Arc::default();
        };
        let event = |kind| move |&step: &usize| Event { step, kind };
        let contacts = opened.onsets.iter().map(event(EventKind::Contact));
        let key = self.episode_keys.get(self.target.episode);
        let marks = key
            .and_then(|key| self.marks.get(key))
            .into_iter()
            .flatten();
        let mut events: Vec<Event> = contacts.chain(marks.map(event(EventKind::Mark))).collect();
        events.sort_by_key(|event| (event.step, event.kind));
        Arc::new(events)
    }

    /// So many events on.
    pub(super) fn go_events(&mut self, by: i64, steps: usize) {
        let cursor = self.playback.cursor;
        let events = self.events();
        let mut places: Vec<usize> = events.iter().map(|event| event.step).collect();
        places.dedup();
        let found = if by < 0 {
            let before: Vec<usize> = places.into_iter().filter(|&step| step < cursor).collect();
            let back = usize::try_from(by.unsigned_abs()).unwrap_or(usize::MAX);
            before
                .len()
                .checked_sub(back.min(before.len()).max(1))
                .map(|i| before[i])
        } else {
            let after: Vec<usize> = places.into_iter().filter(|&step| step > cursor).collect();
            let on = usize::try_from(by).unwrap_or(usize::MAX);
            let at = on.saturating_sub(1).min(after.len().saturating_sub(1));
            after.get(at).copied()
        };
        let Some(step) = found else {
            let side = if by < 0 { "before" } else { "after" };
            self.inform(format!(
                "no event {side} step {}; * marks a step",
                cursor + 1
            ));
            return;
        };
        self.playback.seek(step, steps);
        let what: Vec<&str> = events
            .iter()
            .filter(|event| event.step == step)
            .map(|event| match event.kind {
                EventKind::Contact => "contact begins",
                EventKind::Mark => "marked",
            })
            .collect();
        self.inform(format!("step {}: {}", step + 1, what.join(", ")));
    }

    /// Marks the step under the cursor, or takes its mark away.
    pub(super) fn toggle_mark(&mut self) {
        let step = self.playback.cursor;
        let Some(id) = self.episode_keys.get(self.target.episode).cloned() else {
            return;
        };
        let marks = self.marks.entry(id.clone()).or_default();
        let is_new = marks.insert(step);
        if !is_new {
            marks.remove(&step);
        }
        if marks.is_empty() {
            self.marks.remove(&id);
        }
        let verb = if is_new { "marked" } else { "no longer marked" };
        self.inform(format!("step {} {verb}; {{ and }} go to marks", step + 1));
    }

    /// Begins a selection, ends it, forgets it.
    pub(super) fn select(&mut self) {
        let cursor = self.playback.cursor;
        let (selection, text) = match self.playback.selection {
            None => (
                Some((cursor, None)),
                format!("selection from step {}: V again ends it", cursor + 1),
            ),
            Some((from, None)) => {
                let (first, last) = (from.min(cursor), from.max(cursor));
                (
                    Some((first, Some(last))),
                    format!("steps {} to {} selected; L loops them", first + 1, last + 1),
                )
            }
            Some(_) => {
                if self.playback.looping == Looping::Selection {
                    self.playback.looping = Looping::Off;
                }
                (None, "nothing selected".to_owned())
            }
        };
        self.playback.selection = selection;
        self.inform(text);
    }
}
