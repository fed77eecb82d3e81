//! Each command's effect on the session.

use std::sync::Arc;

use super::command::{Command, Looping, Needs, Scope};
use super::fusing::{self, Place, Refusal};
use super::settings::Settings;
use super::snapshot::ModelInfo;
use super::worker::Target;
use super::{Pending, Session};
use crate::measure::protocol::Protocol;
use crate::modality::Expert;
use crate::model::switches::{Reach, Switches};

impl Session {
    /// Carries out a command whose episode is there if it needs one.
    #[expect(
        clippy::too_many_lines,
        reason = "a line or two a command, none left out"
    )]
    pub(super) fn perform(&mut self, command: Command) {
        let steps = self.steps();
        match command {
            Command::TogglePlay => self.playback.toggle(steps),
            Command::Step(by) => self.playback.step(by, steps),
            Command::SeekTo(step) if (1..=steps).contains(&step) => {
                self.playback.seek(step - 1, steps);
            }
            Command::SeekTo(step) => self.complain(format!("step {step} is outside 1 to {steps}")),
            Command::SeekClamped(step) => self.playback.seek(step, steps),
            Command::First => self.playback.seek(0, steps),
            Command::Last => self.playback.seek(steps, steps),
            Command::FirstPredicted => self.playback.seek(self.rollout().start + 1, steps),
            Command::Episode(by) => self.go_episodes(by),
            Command::SelectEpisode(index) => self.select_episode(index),
            Command::SelectModel(index) => self.select_model(index),
            Command::ToggleExpert(position) => {
                self.switch(|model, switches, place| {
                    fusing::toggle(model, switches, place, position)
                });
            }
            Command::SwitchExpert { expert, on } => {
                self.switch(|model, switches, place| {
                    fusing::turn(model, switches, place, expert, on)
                });
            }
            Command::Solo(position) => {
                self.switch(|model, switches, place| {
                    fusing::solo(model, switches, place, position)
                });
            }
            Command::SetAlpha { expert, alpha } => {
                self.switch(|model, switches, place| {
                    fusing::temper(model, switches, place, expert, alpha)
                });
            }
            Command::Temper { expert, tenths } => {
                self.switch(|model, switches, place| {
                    fusing::temper_by(model, switches, place, expert, tenths)
                });
            }
            Command::AllOn => self.change(|session| {
                session.settings.switches = Switches::default();
                Ok("every expert as trained".to_owned())
            }),
            Command::CycleScope => self.reach(match self.settings.scope {
                Scope::Episode => Scope::Onward,
                Scope::Onward => Scope::Frame,
                Scope::Frame => Scope::Episode,
            }),
            Command::SetScope(scope) => self.reach(scope),
            Command::PredictHere => {
                let context = self.playback.cursor + 1;
                self.change(|session| session.set_context(context));
            }
            Command::SetContext(context) => self.change(|session| session.set_context(context)),
            Command::Context(by) => self.change(|session| Ok(session.change_context(by))),
            Command::SetHorizon(horizon) => self.change(|session| session.set_horizon(horizon)),
            Command::Predict(Protocol { context, horizon }) => self.change(|session| {
                let seen = session.set_context(context)?;
                Ok(format!("{seen}, {}", session.set_horizon(horizon)?))
            }),
            Command::Horizon(by) => self.change(|session| Ok(session.change_horizon(by))),
            Command::Speed(by) => {
                self.playback.change_speed(by);
                self.inform(format!("speed {}", self.playback.speed()));
            }
            Command::SetSpeed(speed) => {
                if self.playback.set_speed(speed) {
                    self.inform(format!("speed {speed}"));
                } else {
                    self.complain(format!(
                        "no speed {speed}; there are powers of two from 1/8 to 8"
                    ));
                }
            }
            Command::CycleLoop => {
                let selected = self.playback.selected().is_some();
                let (looping, words) = match self.playback.looping {
                    Looping::Off => (Looping::All, "loops"),
                    Looping::All if selected => (Looping::Selection, "loops the selection"),
                    Looping::All | Looping::Selection => (Looping::Off, "stops at the end"),
                };
                self.playback.looping = looping;
                self.inform(words.to_owned());
            }
            Command::Undo => {
                let before = self.history.undo(&self.settings);
                self.travel(before, "undo");
            }
            Command::Redo => {
                let after = self.history.redo(&self.settings);
                self.travel(after, "redo");
            }
            Command::Restore(text) => self.restore(&text),
            Command::UseSet(active) => self.change(|session| session.use_set(&active)),
            Command::Corrupt {
                modality,
                corruption,
            } => self.change(|session| session.corrupt(modality, corruption)),
            Command::EditControls(edit) => self.change(|session| session.edit_controls(edit)),
            Command::ToggleSamples => {
                let shown = !self.settings.sampling.shown;
                self.change(|session| Ok(session.show_samples(shown)));
            }
            Command::ShowSamples(shown) => {
                self.change(|session| Ok(session.show_samples(shown)));
            }
            Command::SetSamples(count) => self.change(|session| session.set_samples(count)),
            Command::SetSeed(seed) => self.change(|session| {
                session.settings.sampling.seed = seed;
                for corruption in session.settings.corruptions.values_mut() {
                    corruption.seed = seed;
                }
                Ok(format!("seed {seed}"))
            }),
            Command::CompareWith(model) => self.compare_with(model),
            Command::Failure(by) => self.failure(by),
            Command::CycleFailureOrder => self.rank_by(self.table.view().order.next()),
            Command::RankBy(order) => self.rank_by(order),
            Command::SortBy(column) => self.table.sort_by(column),
            Command::Filter(text) => self.filter(text),
            Command::Oddity => self.tell_oddity(),
            Command::Event(by) => self.go_events(by, steps),
            Command::ToggleMark => self.toggle_mark(),
            Command::Select => self.select(),
        }
    }

    /// Edits the settings so that it can be undone; tells what came of it.
    pub(super) fn change(&mut self, edit: impl FnOnce(&mut Self) -> Result<String, Refusal>) {
        let before = self.settings.clone();
        match edit(self) {
            Ok(text) => self.inform(text),
            Err(why) => self.complain(why),
        }
        if self.settings != before {
            self.history.record(before);
        }
    }

    /// Has switches reach this far from now on.
    fn reach(&mut self, scope: Scope) {
        let words = match scope {
            Scope::Episode => "the whole episode",
            Scope::Onward => "from the cursor on",
            Scope::Frame => "this step only",
        };
        self.change(|session| {
            session.settings.scope = scope;
            Ok(format!("switches reach {words}"))
        });
    }

    /// Goes to another model or episode; switches keep their experts by name.
    pub(super) fn go_to(&mut self, target: Target) {
        if target.episode != self.target.episode {
            self.forget_steps();
            self.playback.forget_selection();
            self.oddity = 0;
        }
        self.target = target;
        self.repair();
    }

    /// Of what waits for an episode that is left unseen, steps and marks would land in another.
    fn forget_steps(&mut self) {
        self.pending.retain(|pending| match pending {
            Pending::Seek(_) => false,
            Pending::Command(command) => command.needs() != Needs::Step,
            // Its settings are of every episode; what it says of steps it keeps to its own.
            Pending::Restoration(_) => true,
        });
    }

    fn switch(
        &mut self,
        edit: impl FnOnce(&ModelInfo, &mut Switches, Place) -> Result<String, Refusal>,
    ) {
        self.change(|session| {
            let Some(model) = session.model().map(Arc::clone) else {
                return Err("no model is loaded".to_owned());
            };
            let place = Place {
                scope: session.settings.scope,
                step: session.playback.cursor.max(model.frame_stack),
            };
            edit(&model, &mut session.settings.switches, place)
        });
    }

    fn travel(&mut self, settings: Option<Settings>, verb: &str) {
        if let Some(settings) = settings {
            self.settings = settings;
            let repaired = self.switch_on_all();
            self.inform(repaired.unwrap_or_else(|| format!("{verb}: done")));
        } else {
            self.inform(format!("nothing to {verb}"));
        }
    }

    /// Switches from another model may leave this one without an active expert somewhere: then all come on.
    pub(super) fn repair(&mut self) {
        if self.is_silent() {
            self.change(|session| Ok(session.switch_on_all().unwrap_or_default()));
        }
    }

    /// Whether the switches leave the model without an active expert somewhere.
    fn is_silent(&self) -> bool {
        let switches = &self.settings.switches;
        self.model()
            .is_some_and(|model| model.silent_step(switches).is_some())
    }

    /// Switches every expert on where the model is silent, and says so. No change of its own: on the way through what
    /// was done before, one would stand in the way of all that is earlier.
    fn switch_on_all(&mut self) -> Option<String> {
        let model = self.model().map(Arc::clone).filter(|_| self.is_silent())?;
        let factors = model.factors();
        for &expert in &factors {
            self.settings.switches.set(expert, Reach::EPISODE, 1.0);
        }
        let names: Vec<&str> = factors.iter().copied().map(Expert::name).collect();
        let (names, name) = (names.join(", "), &model.name);
        Some(format!(
            "{names} on again: nothing else was active in {name}"
        ))
    }

    fn go_episodes(&mut self, by: i64) {
        let last = self.source.metas().len().saturating_sub(1);
        let by = isize::try_from(by).unwrap_or(if by < 0 { isize::MIN } else { isize::MAX });
        let episode = self.target.episode.saturating_add_signed(by).min(last);
        if episode == self.target.episode {
            let end = if by < 0 { "first" } else { "last" };
            self.inform(format!("this is the {end} episode"));
        } else {
            self.go_to(Target {
                episode,
                ..self.target
            });
        }
    }

    fn select_episode(&mut self, episode: usize) {
        let count = self.source.metas().len();
        if episode < count {
            self.go_to(Target {
                episode,
                ..self.target
            });
        } else {
            self.complain(format!("episode {} is outside 1 to {count}", episode + 1));
        }
    }

    fn compare_with(&mut self, model: usize) {
        match self.models.get(model) {
            Some(_) if model == self.target.model => {
                self.complain("a model is compared with another one".to_owned());
            }
            Some(info) => {
                let text = format!("beside it: {}", info.name);
                self.compare = Some(model);
                self.inform(text);
            }
            None => {
                let count = self.models.len();
                self.complain(format!("model {} is outside 1 to {count}", model + 1));
            }
        }
    }

    fn select_model(&mut self, model: usize) {
        let count = self.models.len();
        if model < count {
            self.go_to(Target {
                model,
                ..self.target
            });
        } else {
            self.complain(format!("model {} is outside 1 to {count}", model + 1));
        }
    }
}
