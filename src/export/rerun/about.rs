//! What each entity is, as a text in the recording, and where all of it comes from, as its properties.

use std::fmt::Write as _;

use ::rerun::components::Text;
use ::rerun::{AnyValues, ComponentIdentifier, RecordingStreamResult, TextDocument};

use super::log::Log;
use super::{Shown, each, recorded, space};
use crate::episode::PLATE_M;
use crate::export::Run;
use crate::export::step::{READINGS, readings_of};

/// Where the text is.
pub(super) const ABOUT: &str = "about";

pub(super) fn describe(log: &Log<'_>, run: &Run) -> RecordingStreamResult<()> {
    log.always(ABOUT, &TextDocument::from_markdown(text(run)))
}

/// Where the run comes from: enough to make it again.
pub(super) fn property(run: &Run) -> AnyValues {
    let mut facts = run.provenance.facts();
    if let Some(own) = run.models.iter().flatten().next() {
        // It names the episode too, where the export's own is for all of them.
        facts.insert("state".to_owned(), own.state.clone());
    }
    facts.insert("episode".to_owned(), run.episode.meta.id.clone());
    let mut property = AnyValues::default();
    for (key, value) in facts {
        // Only an empty key is none.
        if let Ok(key) = ComponentIdentifier::try_new(key) {
            property = property.with_component::<Text>(key, [value]);
        }
    }
    property
}

/// Markdown.
fn text(run: &Run) -> String {
    let id = &run.episode.meta.id;
    let mut text = format!("# {id}\n\n");
    for model in &run.provenance.models {
        let _ = writeln!(text, "- `{}`: {}", model.name, model.source);
    }
    let _ = write!(
        text,
        "\nTimelines: `step` as on screen, from 1; `t` in s since the first image; `stamp` as recorded. Letters in \
         brackets name diagnostics: docs/diagnostics.md of poescope.\n\n| entity | what |\n| --- | --- |\n"
    );
    let root = space::ROOT;
    for (entity, what) in [
        (recorded::FRAME, "the camera"),
        (recorded::FORCE, "force at the tip, N"),
        (recorded::TORQUE, "torque at the tip, N·m"),
        (recorded::POSITION, "the tip's position, m"),
        (recorded::VELOCITY, "the tip's velocity, m/s"),
        (recorded::CONTROL, "the command that holds from there on"),
    ] {
        row(&mut text, entity, what);
    }
    row(
        &mut text,
        &format!("{root}/plate, {root}/tip, {root}/path"),
        &format!(
            "as recorded, m; a plate is drawn {:.0} cm square whatever was pushed",
            100.0 * PLATE_M[0]
        ),
    );
    for model in each(run) {
        of_model(&mut text, &model);
    }
    text
}

fn of_model(text: &mut String, shown: &Shown<'_>) {
    let (root, model) = (space::ROOT, &shown.name);
    row(
        text,
        &format!("{model}/frames/belief, prediction"),
        "decoded",
    );
    row(
        text,
        &format!("{model}/frames/error"),
        "prediction less truth, else belief less truth: blue too dark, orange too bright",
    );
    row(
        text,
        &format!("{model}/belief/mean, sigma, log_var"),
        "the product, a series a latent dimension",
    );
    row(
        text,
        &format!("{root}/{model}/belief/ellipse_1_sigma, ellipse_95"),
        "position read from it: 39 % and 95 % of the mass",
    );
    row(
        text,
        &format!("{root}/{model}/prediction/ellipse_1_sigma"),
        "the head's one-step spread, which does not grow over the horizon",
    );
    row(
        text,
        &format!("{root}/{model}/prediction/plate"),
        "where the plate is predicted; it is turned as the recorded one",
    );
    row(
        text,
        &format!("{root}/{model}/pull/EXPERT"),
        "from where the prior has the plate, by what a sensor pulls it (D7)",
    );
    for reading in READINGS {
        row(
            text,
            &format!("{model}/readings/{}", reading.name),
            reading.says,
        );
    }
    for view in &shown.first().experts {
        let path = shown.of_expert(view.expert);
        row(
            text,
            &format!("{path}/mean, sigma, log_var"),
            "as the model states it, before α",
        );
        row(
            text,
            &format!("{path}/share"),
            "share of the belief's precision in each dimension (D1)",
        );
        for reading in readings_of(view.expert) {
            row(text, &format!("{path}/{}", reading.name), reading.says);
        }
    }
}

fn row(text: &mut String, entity: &str, what: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "| {entity} | {what} |");
}
