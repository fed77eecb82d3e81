//! What a control that was used, or a place that was clicked on, asks of the session.

use super::protocol::inbound::Value;
use super::scene::names::{
    ALPHA, AS_RECORDED, DAMAGE, PATH_POINTS, SCOPES, SEVERITY, SPEEDS, SWITCH, element, index,
    modality,
};
use crate::measure::corruption::{Corruption, Damage, applies};
use crate::modality::Modality;
use crate::session::command::Command;
use crate::session::snapshot::Snapshot;

/// What it comes to.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// These, one after the other; none where the session is so already.
    Commands(Vec<Command>),
    /// A key, as it is spelled, with the number of the press.
    Key(String, u64),
    /// A line, as if typed, with the number of the press.
    Line(String, u64),
    /// Whether the spread of samples is looked at.
    Spread(bool),
    /// Nothing that there is.
    Nothing,
}

/// What it means that a control has this value.
pub fn of_control(uuid: &str, value: &Value, snapshot: &Snapshot) -> Asked {
    let Some(element) = element(uuid) else {
        return Asked::Nothing;
    };
    match (element, value) {
        ("key", Value::Text(text)) => {
            numbered(text).map_or(Asked::Nothing, |(key, n)| Asked::Key(key, n))
        }
        ("line", Value::Text(text)) => {
            numbered(text).map_or(Asked::Nothing, |(line, n)| Asked::Line(line, n))
        }
        ("spread", Value::Bool(on)) => Asked::Spread(*on),
        (element, value) => {
            commands(element, value, snapshot).map_or(Asked::Nothing, Asked::Commands)
        }
    }
}

/// What a click on a node means.
pub fn of_click(name: &str, place: Option<u32>) -> Asked {
    match place {
        Some(step) if name == PATH_POINTS => {
            Asked::Commands(vec![Command::SeekClamped(step as usize)])
        }
        _ => Asked::Nothing,
    }
}

/// Text and the number behind its last `#`.
fn numbered(text: &str) -> Option<(String, u64)> {
    let (text, number) = text.rsplit_once('#')?;
    Some((text.to_owned(), number.parse().ok()?))
}

fn commands(element: &str, value: &Value, snapshot: &Snapshot) -> Option<Vec<Command>> {
    // The snapshot may be older than what another viewer has just asked for: what is wanted is passed on as it is.
    if let (Some(expert), Value::Bool(on)) = (element.strip_prefix(SWITCH), value) {
        let (expert, on) = (place(expert, snapshot)?, *on);
        return Some(vec![Command::SwitchExpert { expert, on }]);
    }
    if let (Some(expert), Value::Number(alpha)) = (element.strip_prefix(ALPHA), value) {
        let (expert, alpha) = (place(expert, snapshot)?, tenths(*alpha));
        return Some(vec![Command::SetAlpha { expert, alpha }]);
    }
    if let (Some(name), Value::Text(kind)) = (element.strip_prefix(DAMAGE), value) {
        return damage(modality(name)?, kind, snapshot);
    }
    if let (Some(name), Value::Number(severity)) = (element.strip_prefix(SEVERITY), value) {
        let modality = modality(name)?;
        let severity = tenths(*severity).clamp(0.0, 1.0);
        let now = snapshot.corruption_of(modality)?;
        let corruption = Some(Corruption { severity, ..now });
        return Some(vec![Command::Corrupt {
            modality,
            corruption,
        }]);
    }
    let one = match (element, value) {
        ("episode", Value::Text(entry)) => Command::SelectEpisode(index(entry)?),
        ("model", Value::Text(entry)) => Command::SelectModel(index(entry)?),
        ("step", Value::Number(step)) => Command::SeekClamped(whole(*step).saturating_sub(1)),
        ("speed", Value::Text(name)) => Command::SetSpeed(named(&SPEEDS, name)?),
        ("scope", Value::Text(name)) => Command::SetScope(named(&SCOPES, name)?),
        ("context", Value::Number(context)) => Command::SetContext(whole(*context)),
        ("horizon", Value::Number(horizon)) => Command::SetHorizon(whole(*horizon)),
        ("sampled", Value::Bool(on)) => Command::ShowSamples(*on),
        ("state", Value::Text(state)) => Command::Restore(state.clone()),
        (button, Value::Bool(true)) => pressed(button)?,
        _ => return None,
    };
    Some(vec![one])
}

fn pressed(button: &str) -> Option<Command> {
    Some(match button {
        "play" => Command::TogglePlay,
        "all-on" => Command::AllOn,
        "predict-here" => Command::PredictHere,
        "failure-next" => Command::Failure(1),
        "failure-previous" => Command::Failure(-1),
        "event-next" => Command::Event(1),
        "event-previous" => Command::Event(-1),
        "undo" => Command::Undo,
        "redo" => Command::Redo,
        _ => return None,
    })
}

/// Whether an element has a value that a client and the session must agree on. The others are pressed or typed into.
pub fn is_kept(uuid: &str) -> bool {
    element(uuid).is_some_and(|element| {
        pressed(element).is_none() && !matches!(element, "key" | "line" | "face" | "state")
    })
}

/// Position of the expert of this name, the prior last.
fn place(expert: &str, snapshot: &Snapshot) -> Option<usize> {
    snapshot
        .experts
        .iter()
        .position(|view| view.expert.name() == expert)
}

/// What stands beside a name.
fn named<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    let found = table.iter().find(|(known, _)| *known == name);
    found.map(|&(_, value)| value)
}

/// A new damage reaches as far as the scope at the cursor says; another kind keeps its steps and its severity.
fn damage(modality: Modality, kind: &str, snapshot: &Snapshot) -> Option<Vec<Command>> {
    if kind == AS_RECORDED {
        return Some(vec![Command::Corrupt {
            modality,
            corruption: None,
        }]);
    }
    let damage = Damage::from_name(kind)?;
    if !applies(damage, modality) {
        return None;
    }
    let now = snapshot.corruption_of(modality);
    let now = now.unwrap_or_else(|| snapshot.aimed(damage));
    let corruption = Some(Corruption { damage, ..now });
    Some(vec![Command::Corrupt {
        modality,
        corruption,
    }])
}

/// A slider's value, as near as its steps are.
fn tenths(value: f64) -> f32 {
    ((value * 10.0).round() / 10.0) as f32
}

/// A slider's value as a count; what is below 0 or not finite is 0.
fn whole(value: f64) -> usize {
    value.round() as usize
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::*;
    use crate::session::Session;
    use crate::session::command::Scope;
    use crate::session::fake::{FakePredictor, FakeSource};

    fn session() -> Session {
        let source = Arc::new(FakeSource::new(3));
        let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
        assert!(session.wait_idle(Duration::from_secs(20)));
        session
    }

    fn use_control(session: &mut Session, name: &str, value: &Value) {
        let asked = of_control(&format!("poescope-{name}"), value, &session.snapshot());
        let Asked::Commands(commands) = asked else {
            panic!("{name}: {asked:?}");
        };
        for command in commands {
            session.apply(command);
        }
        assert!(session.wait_idle(Duration::from_secs(20)));
    }

    fn text(text: &str) -> Value {
        Value::Text(text.to_owned())
    }

    #[test]
    fn every_control_changes_what_it_says() {
        let mut session = session();
        use_control(&mut session, "step", &Value::Number(7.0));
        use_control(&mut session, "scope", &text("this step"));
        use_control(&mut session, "scope", &text("from here on"));
        use_control(&mut session, "switch-haptic", &Value::Bool(false));
        use_control(&mut session, "alpha-vision", &Value::Number(0.700_000_1));
        use_control(&mut session, "speed", &text("4×"));
        use_control(&mut session, "damage-vision", &text("noise"));
        use_control(&mut session, "severity-vision", &Value::Number(0.3));
        use_control(&mut session, "context", &Value::Number(5.0));
        use_control(&mut session, "horizon", &Value::Number(6.0));
        use_control(&mut session, "sampled", &Value::Bool(true));
        let snapshot = session.snapshot();
        assert_eq!((snapshot.cursor, snapshot.scope), (6, Scope::Onward));
        let alphas: Vec<f32> = snapshot.experts.iter().map(|view| view.alpha).collect();
        assert_eq!(format!("{alphas:?}"), "[0.7, 0.0, 1.0, 1.0]");
        assert_eq!(
            (snapshot.context, snapshot.horizon, snapshot.sampling.shown),
            (5, 6, true)
        );
        assert!((snapshot.speed - 4.0).abs() < f32::EPSILON);
        let (_, corruption) = snapshot.corruptions[0];
        assert_eq!((corruption.damage, corruption.from), (Damage::Noise, 6));
        assert!((corruption.severity - 0.3).abs() < f32::EPSILON);

        use_control(&mut session, "damage-vision", &text("as recorded"));
        use_control(&mut session, "all-on", &Value::Bool(true));
        use_control(&mut session, "episode", &text("2 whatever it is called"));
        let snapshot = session.snapshot();
        assert!(snapshot.corruptions.is_empty());
        assert_eq!(snapshot.episode_index, 1);
    }

    #[test]
    fn two_viewers_who_want_the_same_do_not_undo_each_other() {
        let mut session = session();
        // What both have before them.
        let snapshot = session.snapshot();
        let mut ask = |control: &str, value: &Value| {
            let asked = of_control(control, value, &snapshot);
            let Asked::Commands(commands) = asked else {
                panic!("{asked:?}");
            };
            for command in commands {
                session.apply(command);
            }
            assert!(session.wait_idle(Duration::from_secs(20)));
            session.snapshot()
        };
        let mut alpha = |on| ask("poescope-switch-vision", &Value::Bool(on)).experts[0].alpha;
        let alphas = [alpha(false), alpha(false), alpha(true), alpha(true)];
        assert_eq!(format!("{alphas:?}"), "[0.0, 0.0, 1.0, 1.0]");
        for _ in 0..2 {
            let shown = ask("poescope-sampled", &Value::Bool(true)).sampling.shown;
            let speed = ask("poescope-speed", &text("4×")).speed;
            let scope = ask("poescope-scope", &text("from here on")).scope;
            assert_eq!((shown, speed, scope), (true, 4.0, Scope::Onward));
        }
    }

    #[test]
    fn what_is_no_control_or_no_value_of_it_is_nothing() {
        let snapshot = session().snapshot();
        for (uuid, value) in [
            ("poescope-step", text("3")),
            ("poescope-nothing", Value::Bool(true)),
            ("another-step", Value::Number(3.0)),
            ("poescope-switch-joint", Value::Bool(false)),
            ("poescope-damage-haptic", text("occlude")),
            ("poescope-speed", text("3×")),
            ("poescope-episode", text("none")),
            ("poescope-key", text("no number")),
            ("poescope-play", Value::Bool(false)),
        ] {
            assert_eq!(
                of_control(uuid, &value, &snapshot),
                Asked::Nothing,
                "{uuid}"
            );
        }
        assert_eq!(of_click("/plate", Some(3)), Asked::Nothing);
        assert_eq!(of_click("/path/points", None), Asked::Nothing);
    }

    #[test]
    fn a_key_comes_with_its_number_even_the_key_of_the_sign() {
        let snapshot = session().snapshot();
        let key = |value| of_control("poescope-key", &text(value), &snapshot);
        assert_eq!(key("<s-left>#17"), Asked::Key("<s-left>".to_owned(), 17));
        assert_eq!(key("##2"), Asked::Key("#".to_owned(), 2));
    }
}
