//! A snapshot as lines of text for scripts and screen readers: one labelled fact a line, always in the same order,
//! ASCII labels and units spelled out. What is not known is `none`; a label is left out only with its whole subject.
//!
//! ```text
//! opened … told   what the overview shows
//! fusion          readings at the cursor: NIS, KL, pairs, conflict, pulls, dimensions, NEES
//! rollout, consistency, sets, response    of the views that ask for them
//! finding         contacts, marks, selection, scores, failures
//! ```

mod consistency;
mod finding;
mod fusion;
mod response;
mod rollout;
mod sets;

use std::fmt::{Display, Write};

use crate::measure::spread::axis_sigmas;
use crate::session::command::Scope;
use crate::session::model_key;
use crate::session::snapshot::{
    Badge, Estimate, ExpertView, LatentView, PositionView, Snapshot, StepPsnr, estimate_at,
};

/// Writes the report.
pub fn plain(snapshot: &Snapshot) -> String {
    let mut report = Report::default();
    opened(&mut report, snapshot);
    time(&mut report, snapshot);
    for expert in &snapshot.experts {
        of_expert(&mut report, expert);
    }
    latent(&mut report, "belief", snapshot.belief.as_ref());
    position(&mut report, snapshot.position.as_ref(), snapshot.cursor);
    frames(&mut report, snapshot);
    changed(&mut report, snapshot);
    beside(&mut report, snapshot);
    told(&mut report, snapshot);
    fusion::tell(&mut report, snapshot);
    rollout::tell(&mut report, snapshot);
    consistency::tell(&mut report, snapshot);
    sets::tell(&mut report, snapshot);
    response::tell(&mut report, snapshot);
    finding::tell(&mut report, snapshot);
    config(&mut report, snapshot);
    report.0
}

/// What the model was made and trained as, a line of its config a line.
fn config(report: &mut Report, snapshot: &Snapshot) {
    let model = snapshot.shown_model();
    let lines = model.into_iter().flat_map(|model| model.config.lines());
    for line in lines.filter(|line| !line.is_empty()) {
        report.fact("model config", line);
    }
}

/// Lines of `label: fact`.
#[derive(Default)]
struct Report(String);

impl Report {
    /// One line, whatever the fact has in it: what comes from files may hold line breaks or escape sequences.
    fn fact(&mut self, label: &str, fact: impl Display) {
        let fact = fact.to_string().replace(char::is_control, " ");
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{label}: {}", fact.trim());
    }

    /// A number with its unit.
    fn number(&mut self, label: &str, value: Option<f32>, unit: &str) {
        match value.filter(|value| value.is_finite()) {
            Some(value) => self.fact(label, format!("{value:.3} {unit}")),
            None => self.fact(label, "none"),
        }
    }

    /// Numbers with blanks between them.
    fn numbers(&mut self, label: &str, values: &[f32]) {
        let text = values.iter().map(|value| {
            if value.is_finite() {
                format!("{value:.3}")
            } else {
                "none".to_owned()
            }
        });
        self.list(label, text);
    }

    /// A place on the table, or a way on it.
    fn place(&mut self, label: &str, metres: Option<[f32; 2]>) {
        let centimetres = metres.map(|[x, y]| [x * 100.0, y * 100.0]);
        self.numbers(
            &format!("{label}, x y in cm"),
            centimetres.as_ref().map_or(&[][..], |place| place),
        );
    }

    /// Anything with blanks between.
    fn list(&mut self, label: &str, values: impl Iterator<Item = impl Display>) {
        let text: Vec<String> = values.map(|value| value.to_string()).collect();
        if text.is_empty() {
            self.fact(label, "none");
        } else {
            self.fact(label, text.join(" "));
        }
    }
}

fn opened(report: &mut Report, snapshot: &Snapshot) {
    report.fact("dataset", &snapshot.dataset);
    match snapshot.shown_model() {
        Some(model) => {
            report.fact("model", &model.name);
            report.fact(
                "model number",
                of(snapshot.model + 1, snapshot.models.len()),
            );
            report.fact("model source", &model.source);
            match model.update {
                Some(update) => report.fact("model update", update),
                None => report.fact("model update", "none"),
            }
        }
        None => report.fact("model", "none"),
    }
    match &snapshot.episode {
        Some(episode) => {
            report.fact("episode", &episode.id);
            report.fact(
                "episode number",
                of(snapshot.episode_index + 1, snapshot.episode_count),
            );
            report.fact(
                "episode split",
                episode.split.map_or("none", |it| it.name()),
            );
            for flag in &episode.flags {
                report.fact("recording", flag);
            }
            for missing in &episode.missing {
                report.fact("recording lacks", missing);
            }
        }
        None => report.fact("episode", "none"),
    }
}

fn time(report: &mut Report, snapshot: &Snapshot) {
    let cursor = snapshot.cursor;
    let episode = snapshot.episode.as_deref();
    report.fact("step", of(cursor + 1, snapshot.steps()));
    let secs = episode.and_then(|episode| episode.secs.get(cursor));
    report.number("time", secs.map(|&secs| secs as f32), "s");
    let force = episode.and_then(|episode| episode.force_newtons.get(cursor));
    report.number("force", force.copied(), "N");
    report.fact("context", format!("{} images", snapshot.context));
    report.fact("horizon", format!("{} images", snapshot.horizon));
    report.fact("prediction from step", snapshot.start + 2);
    let scope = match snapshot.scope {
        Scope::Episode => "episode",
        Scope::Onward => "onward",
        Scope::Frame => "frame",
    };
    report.fact("scope", scope);
}

fn of_expert(report: &mut Report, view: &ExpertView) {
    let name = format!("expert {}", view.expert.name());
    let label = |what: &str| format!("{name} {what}");
    report.number(&label("alpha"), Some(view.alpha), "");
    latent(report, &name, view.latent.as_ref());
    report.numbers(&label("share per dimension"), &view.share);
    report.number(&label("share"), percent(Some(view.share_mean)), "percent");
    report.number(
        &label("share of position"),
        percent(view.share_position),
        "percent",
    );
}

fn latent(report: &mut Report, name: &str, latent: Option<&LatentView>) {
    let parts = latent.map_or((&[][..], &[][..]), |it| (&it.mean, &it.sigma));
    report.numbers(&format!("{name} mean"), parts.0);
    report.numbers(&format!("{name} sigma"), parts.1);
}

fn position(report: &mut Report, position: Option<&PositionView>, cursor: usize) {
    let Some(position) = position else {
        report.fact("position", "none");
        return;
    };
    let truth = position.truth.get(cursor).map(|pose| [pose.x, pose.y]);
    report.place("position truth", truth);
    report.place("position tip", position.tip.get(cursor).copied());
    for (name, estimates, error) in [
        ("belief", &position.belief, position.belief_error_m),
        (
            "prediction",
            &position.prediction,
            position.prediction_error_m,
        ),
    ] {
        let estimate: Option<Estimate> = estimate_at(estimates, cursor);
        let label = format!("position {name}");
        report.place(&label, estimate.map(|it| [it.x, it.y]));
        let sigma = estimate.map(|it| axis_sigmas(it.covariance));
        report.place(&format!("{label} sigma"), sigma);
        let error = error.map(|metres| metres * 100.0);
        report.number(&format!("{label} error"), error, "cm");
    }
}

fn frames(report: &mut Report, snapshot: &Snapshot) {
    let psnr: StepPsnr = snapshot
        .psnr_db
        .get(snapshot.cursor)
        .copied()
        .unwrap_or_default();
    report.number("belief PSNR", psnr.belief, "dB");
    report.number("prediction PSNR", psnr.prediction, "dB");
}

/// What is not as recorded: inputs, controls; and whether a sample is shown.
fn changed(report: &mut Report, snapshot: &Snapshot) {
    for (modality, corruption) in &snapshot.corruptions {
        let (kind, severity) = (corruption.damage.name(), corruption.strength());
        let from = corruption.from + 1;
        let steps = match corruption.until {
            Some(until) => format!("steps {from} to {until}"),
            None => format!("from step {from}"),
        };
        let label = format!("input {} damaged", modality.name());
        report.fact(&label, format!("{kind} {severity:.3}, {steps}"));
    }
    if let Some(edit) = &snapshot.control_edit {
        let (from, turned, scale) = (edit.from + 1, edit.rotate_deg, edit.scale);
        let mirrored = if edit.mirror { ", mirrored" } else { "" };
        let what =
            format!("from step {from}, turned {turned:.1} degrees, scaled {scale:.3}{mirrored}");
        report.fact("controls edited", what);
    }
    if snapshot.sampling.shown {
        report.fact(
            "shown",
            format!("a sample, seed {}", snapshot.sampling.seed),
        );
    }
}

/// The second model under the cursor.
fn beside(report: &mut Report, snapshot: &Snapshot) {
    let Some(other) = &snapshot.other else {
        return;
    };
    report.fact("other model", model_key(&snapshot.models, other.model));
    if let Some(fault) = &other.fault {
        report.fact("other model shows nothing", fault);
        return;
    }
    let psnr = other.psnr_db.get(snapshot.cursor).copied();
    let psnr = psnr.unwrap_or_default();
    report.number("other model belief PSNR", psnr.belief, "dB");
    report.number("other model prediction PSNR", psnr.prediction, "dB");
    let error = |of: fn(&PositionView) -> Option<f32>| other.position.as_ref().and_then(of);
    for (name, error) in [
        ("belief", error(|at| at.belief_error_m)),
        ("prediction", error(|at| at.prediction_error_m)),
    ] {
        let label = format!("other model position {name} error");
        report.number(&label, error.map(|metres| metres * 100.0), "cm");
    }
    report.fact("other model switches", trained(&other.badge));
}

fn trained(badge: &Badge) -> String {
    match badge {
        Badge::Trained => "trained".to_owned(),
        Badge::Untrained(why) => format!("untrained, {why}"),
        Badge::NoProduct => "none, the model has no product".to_owned(),
    }
}

fn told(report: &mut Report, snapshot: &Snapshot) {
    report.fact("switches", trained(&snapshot.badge));
    if snapshot.busy {
        report.fact("busy", "still computing");
    }
    match &snapshot.message {
        Some(message) if message.error => report.fact("error", &message.text),
        Some(message) => report.fact("message", &message.text),
        None => report.fact("message", "none"),
    }
    report.fact("state", &snapshot.state);
}

fn of(number: usize, count: usize) -> String {
    format!("{number} of {count}")
}

fn percent(share: Option<f32>) -> Option<f32> {
    share.map(|share| share * 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::corruption::{Corruption, Damage};
    use crate::modality::Modality;
    use crate::session::settings::ControlEdit;
    use crate::session::snapshot::Message;
    use crate::tui::fixture;

    #[test]
    fn a_fact_a_line_in_a_fixed_order() {
        insta::assert_snapshot!(plain(&fixture::snapshot(8, 16)));
    }

    #[test]
    fn the_config_is_told_line_by_line() {
        let mut snapshot = fixture::snapshot(8, 16);
        let mut model = (*snapshot.models[0]).clone();
        model.config = "latent = 16\n\n[training]\nbatch = 32\n".to_owned();
        snapshot.models[0] = model.into();
        let told =
            "model config: latent = 16\nmodel config: [training]\nmodel config: batch = 32\n";
        assert!(plain(&snapshot).ends_with(told));
    }

    #[test]
    fn what_is_not_as_recorded_is_said_and_so_is_the_model_beside() {
        let mut snapshot = fixture::snapshot(8, 16);
        fixture::compare(&mut snapshot);
        let damage = Corruption {
            damage: Damage::Noise,
            severity: 0.5,
            from: 2,
            ..Corruption::default()
        };
        snapshot.corruptions = vec![(Modality::Haptic, damage)];
        snapshot.control_edit = Some(ControlEdit {
            mirror: true,
            ..ControlEdit::from(6)
        });
        let text = plain(&snapshot);
        for line in [
            "input haptic damaged: noise 0.500, from step 3",
            "controls edited: from step 7, turned 0.0 degrees, scaled 1.000, mirrored",
            "other model: vhp",
            "other model switches: trained",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
    }

    #[test]
    fn what_is_not_known_is_none_and_never_a_special_number() {
        let mut snapshot = fixture::snapshot(0, 16);
        snapshot.position = None;
        snapshot.experts[0].share_mean = f32::NAN;
        let text = plain(&snapshot);
        for line in [
            "position: none",
            "belief mean: none",
            "belief PSNR: none",
            "expert vision share: none",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn text_from_files_stays_on_its_line() {
        let mut snapshot = fixture::snapshot(8, 16);
        snapshot.dataset = "a\nstate: \x1b[2Jb".to_owned();
        snapshot.message = Some(Message {
            error: true,
            text: "no such step".to_owned(),
        });
        let text = plain(&snapshot);
        assert!(text.starts_with("dataset: a state:  [2Jb\nmodel: v-h-p\n"));
        assert!(text.contains("\nerror: no such step\n"));
        let labelled = |line: &str| {
            line.split_once(": ")
                .is_some_and(|(_, fact)| !fact.is_empty())
        };
        assert!(text.lines().all(labelled), "{text}");
    }
}
