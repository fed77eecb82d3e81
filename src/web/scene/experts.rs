//! A switch and an α an expert, and who makes up the belief.

use std::fmt::Write;

use super::names::{ALPHA, SCOPES, SWITCH};
use super::panel::{Panel, Range};
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;

/// The α slider goes so far, and further only where α is already.
const MOST: f64 = 2.0;

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot) {
    panel.folder("experts", "Experts", true);
    let scope = SCOPES.iter().find(|(_, scope)| *scope == snapshot.scope);
    let scopes = SCOPES.iter().map(|(name, _)| (*name).to_owned()).collect();
    let hint = "How far the next switch or α reaches";
    panel.dropdown(
        "scope",
        ("Switches reach", hint),
        scope.map_or("", |(name, _)| name),
        scopes,
    );
    for view in &snapshot.experts {
        let (name, letter) = (view.expert.name(), view.expert.letter());
        let enabled = switchable(snapshot, view.expert);
        let hint = if enabled {
            "Off: its precision counts 0 times"
        } else {
            "This model has nothing to switch here"
        };
        let label = format!("{letter} {name}");
        panel.checkbox(
            &format!("{SWITCH}{name}"),
            (&label, hint),
            view.alpha > 0.0,
            enabled,
        );
        let alpha = tidy(view.alpha);
        let range = Range {
            min: 0.0,
            max: MOST.max(alpha),
            step: 0.1,
        };
        let hint = "Its precision counts α times: 0 off, 1 as trained";
        panel.slider(
            &format!("{ALPHA}{name}"),
            (&format!("α {name}"), hint),
            alpha,
            range,
            enabled,
        );
    }
    panel.button("all-on", "All as trained", "Every α is 1 everywhere");
    panel.html("shares", shares(snapshot));
}

/// Whether the present model lets this expert be switched.
pub fn switchable(snapshot: &Snapshot, expert: Expert) -> bool {
    let model = snapshot.shown_model();
    model.is_some_and(|model| model.can_switch(expert))
}

/// An `f32` as the decimal that it was typed as.
pub fn tidy(value: f32) -> f64 {
    (f64::from(value) * 1e4).round() / 1e4
}

/// A bar an expert: its share of the belief's precision at the cursor.
fn shares(snapshot: &Snapshot) -> String {
    let mut html =
        String::from("<div style=\"font-size:0.8em\">share of the belief&#39;s precision");
    for view in &snapshot.experts {
        let (r, g, b) = view.expert.rgb();
        let percent = if view.share_mean.is_finite() {
            100.0 * view.share_mean.abs()
        } else {
            0.0
        };
        // Writing to a string cannot fail.
        let _ = write!(
            html,
            "<div style=\"display:flex;gap:0.5em;align-items:center\"><span style=\"width:5em\">{} {}</span>\
             <span style=\"flex:1\"><span style=\"display:inline-block;height:0.7em;width:{percent:.1}%;\
             background:rgb({r},{g},{b})\"></span></span><span style=\"width:3em;text-align:right\">{percent:.0} %</span></div>",
            view.expert.letter(),
            view.expert.name(),
        );
    }
    html.push_str("</div>");
    html
}
