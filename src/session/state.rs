//! The state string: a session in one line that can be pasted into a shell, a chat or a paper.
//!
//! ```text
//! v=1;episode=push_0007;step=6;model=v-h-p;context=4;horizon=11;scope=frame;speed=0.5;loop=all;alpha=vision:0@1-15,haptic:0.5@4
//! ```
//! Steps count from 1. A run of α is `expert:α` for every step, `@4` for one step, `@4-7` for some, `@4-` for all
//! from there on; what is not mentioned is as trained. `%`, `;` and white space in names are written as `%xx`.
//! Keys that are not known are kept and written back.

use std::fmt::{self, Write};

use super::command::{Looping, Scope};
use super::switches::{Reach, Run, Switches, checked_alpha};
use crate::modality::Expert;

/// The version written, and the only one that can be read.
const VERSION: &str = "1";

/// What a state string says; a key that is not there is left as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The episode's name.
    pub episode: Option<String>,
    /// Step under the cursor, from 1.
    pub step: Option<usize>,
    /// The model's name; the second of the same name is `name#2`.
    pub model: Option<String>,
    /// c, the images seen.
    pub context: Option<usize>,
    /// h, the images predicted.
    pub horizon: Option<usize>,
    /// How far the next switch reaches.
    pub scope: Option<Scope>,
    /// Playback speed.
    pub speed: Option<f32>,
    /// What playback does at the end.
    pub looping: Option<Looping>,
    /// α where it is not as trained; a string without any means every expert as trained.
    pub switches: Switches,
    /// Keys that mean nothing to this version, in order.
    pub unknown: Vec<(String, String)>,
}

impl State {
    /// Reads a state string. Each complaint names the key it is about; all other keys count.
    pub fn parse(text: &str) -> (Self, Vec<String>) {
        let mut state = Self::default();
        let mut complaints = Vec::new();
        let mut has_version = false;
        for part in text
            .trim()
            .split(';')
            .filter(|part| !part.trim().is_empty())
        {
            let Some((key, raw)) = part.trim().split_once('=') else {
                complaints.push(format!("{part:?} is not key=value"));
                continue;
            };
            let value = unescape(raw);
            has_version |= key == "v";
            if let Err(why) = state.take(key, &value) {
                complaints.push(format!("{key}: {why}"));
            }
        }
        if !has_version {
            complaints.push(format!("v: missing, read as version {VERSION}"));
        }
        (state, complaints)
    }

    fn take(&mut self, key: &str, value: &str) -> Result<(), String> {
        match key {
            "v" if value == VERSION => {}
            "v" => return Err(format!("version {value:?}, this poescope reads {VERSION}")),
            "episode" => self.episode = Some(value.to_owned()),
            "step" => self.step = Some(count(value)?),
            "model" => self.model = Some(value.to_owned()),
            "context" => self.context = Some(count(value)?),
            "horizon" => self.horizon = Some(count(value)?),
            "scope" => self.scope = Some(one_of(value, &SCOPES)?),
            "speed" => {
                let speed = value.parse();
                self.speed = Some(speed.map_err(|_| format!("{value:?} is not a number"))?);
            }
            "loop" => self.looping = Some(one_of(value, &LOOPINGS)?),
            "alpha" => self.switches = switches(value)?,
            _ => self.unknown.push((key.to_owned(), value.to_owned())),
        }
        Ok(())
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "v={VERSION}")?;
        let numbers = |n: Option<usize>| n.map(|n| n.to_string());
        let pairs = [
            ("episode", self.episode.clone()),
            ("step", numbers(self.step)),
            ("model", self.model.clone()),
            ("context", numbers(self.context)),
            ("horizon", numbers(self.horizon)),
            (
                "scope",
                self.scope.and_then(|scope| name_of(scope, &SCOPES)),
            ),
            ("speed", self.speed.map(|speed| speed.to_string())),
            (
                "loop",
                self.looping.and_then(|looping| name_of(looping, &LOOPINGS)),
            ),
            (
                "alpha",
                Some(alpha_text(&self.switches)).filter(|text| !text.is_empty()),
            ),
        ];
        let known = pairs
            .into_iter()
            .filter_map(|(key, value)| Some((key.to_owned(), value?)));
        for (key, value) in known.chain(self.unknown.iter().cloned()) {
            write!(f, ";{key}={}", escape(&value))?;
        }
        Ok(())
    }
}

const SCOPES: [(&str, Scope); 3] = [
    ("episode", Scope::Episode),
    ("onward", Scope::Onward),
    ("frame", Scope::Frame),
];
const LOOPINGS: [(&str, Looping); 2] = [("off", Looping::Off), ("all", Looping::All)];

fn one_of<T: Copy>(text: &str, table: &[(&str, T)]) -> Result<T, String> {
    let found = table.iter().find(|(name, _)| *name == text);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<&str> = table.iter().map(|&(name, _)| name).collect();
        format!("{text:?} is not one of {}", names.join(", "))
    })
}

fn name_of<T: Copy + PartialEq>(value: T, table: &[(&str, T)]) -> Option<String> {
    table
        .iter()
        .find(|(_, v)| *v == value)
        .map(|(name, _)| (*name).to_owned())
}

fn count(text: &str) -> Result<usize, String> {
    let number: Option<usize> = text.parse().ok();
    number
        .filter(|&n| n > 0 && n < usize::MAX)
        .ok_or_else(|| format!("{text:?} is not a number from 1 on"))
}

/// `vision:0@1-15,haptic:0.5@4`.
fn alpha_text(switches: &Switches) -> String {
    let runs = Expert::ALL.into_iter().flat_map(|expert| {
        let runs = switches.runs(expert).into_iter();
        runs.map(move |run| format!("{}:{}{}", expert.name(), run.alpha, reach_text(run.reach)))
    });
    runs.collect::<Vec<_>>().join(",")
}

fn reach_text(reach: Reach) -> String {
    match reach {
        Reach::EPISODE => String::new(),
        Reach { from, until: None } => format!("@{}-", from + 1),
        Reach {
            from,
            until: Some(until),
        } if until == from + 1 => format!("@{until}"),
        Reach {
            from,
            until: Some(until),
        } => format!("@{}-{until}", from + 1),
    }
}

fn switches(text: &str) -> Result<Switches, String> {
    let mut switches = Switches::default();
    for part in text.split(',').filter(|part| !part.is_empty()) {
        let (expert, run) = run(part).ok_or_else(|| {
            format!("{part:?} is not like vision:0, haptic:0.5@4, prior:0@2-7 or joint:0@3-")
        })?;
        switches.set(expert, run.reach, run.alpha);
    }
    Ok(switches)
}

fn run(text: &str) -> Option<(Expert, Run)> {
    let (name, rest) = text.split_once(':')?;
    let expert = Expert::ALL
        .into_iter()
        .find(|expert| expert.name() == name)?;
    let (alpha, steps) = rest
        .split_once('@')
        .map_or((rest, None), |(alpha, steps)| (alpha, Some(steps)));
    let alpha = checked_alpha(alpha.parse().ok()?).ok()?;
    let reach = match steps.map(|steps| {
        steps
            .split_once('-')
            .map_or((steps, None), |(a, b)| (a, Some(b)))
    }) {
        None => Reach::EPISODE,
        Some((from, None)) => {
            let until = count(from).ok()?;
            Reach {
                from: until - 1,
                until: Some(until),
            }
        }
        Some((from, Some(""))) => Reach {
            from: count(from).ok()? - 1,
            until: None,
        },
        Some((from, Some(until))) => {
            let (from, until) = (count(from).ok()?, count(until).ok()?);
            (from <= until).then_some(Reach {
                from: from - 1,
                until: Some(until),
            })?
        }
    };
    Some((expert, Run { reach, alpha }))
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if matches!(c, '%' | ';') || c.is_whitespace() || c.is_control() {
            for byte in c.to_string().bytes() {
                // Writing to a string cannot fail.
                let _ = write!(escaped, "%{byte:02x}");
            }
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// The inverse of `escape`; a `%` that escapes nothing stands for itself.
fn unescape(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('%') {
        bytes.extend_from_slice(before.as_bytes());
        let byte = after
            .get(..2)
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(byte.unwrap_or(b'%'));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    bytes.extend_from_slice(rest.as_bytes());
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "α is compared as it was set")]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn reads_what_the_documentation_shows() {
        let text = "v=1;episode=a%20b;step=6;alpha=vision:0@1-15,haptic:0.5@4;later=x%3by";
        let (state, complaints) = State::parse(text);
        assert_eq!(complaints, Vec::<String>::new());
        assert_eq!(state.episode.as_deref(), Some("a b"));
        let switches = &state.switches;
        assert!(
            switches.alpha(Expert::Vision, 14) == 0.0 && switches.alpha(Expert::Vision, 15) == 1.0
        );
        assert!(
            switches.alpha(Expert::Haptic, 3) == 0.5 && switches.alpha(Expert::Haptic, 4) == 1.0
        );
        assert_eq!(state.unknown, [("later".to_owned(), "x;y".to_owned())]);
        assert_eq!(state.to_string(), text);
    }

    #[test]
    fn a_bad_value_is_named_and_the_others_count() {
        let (state, complaints) =
            State::parse("v=2;step=0;context=7;scope=all;alpha=vison:0;speed=x;junk");
        assert_eq!(state.context, Some(7));
        let keys: Vec<&str> = complaints
            .iter()
            .map(|c| c.split(':').next().unwrap_or_default())
            .collect();
        assert_eq!(keys[..5], ["v", "step", "scope", "alpha", "speed"]);
        assert_eq!(complaints.len(), 6);
        assert_eq!((state.step, state.scope), (None, None));
    }

    #[test]
    fn an_escape_cut_short_stands_for_itself() {
        for text in ["%", "%4", "a%zzb", "%é", "100%"] {
            assert_eq!(unescape(text), text);
        }
    }

    fn any_switches() -> impl Strategy<Value = Switches> {
        let run = (
            0_usize..5,
            0_usize..20,
            prop::option::of(1_usize..9),
            0_u8..9,
        );
        prop::collection::vec(run, 0..8).prop_map(|runs| {
            let mut switches = Switches::default();
            for (expert, from, length, tenth) in runs {
                let until = length.map(|length| from + length);
                switches.set(
                    Expert::ALL[expert],
                    Reach { from, until },
                    f32::from(tenth) / 8.0,
                );
            }
            switches
        })
    }

    proptest! {
        #[test]
        fn what_is_written_reads_back(
            episode in prop::option::of("\\PC{0,12}"),
            model in prop::option::of("[a-z =;%#-]{1,9}"),
            numbers in (prop::option::of(1_usize..99), prop::option::of(1_usize..99), prop::option::of(1_usize..99)),
            scope in 0_usize..3,
            speed in prop::option::of(-3_i32..4),
            switches in any_switches(),
            unknown in prop::collection::vec(("[a-z]{8,9}", ".{0,6}"), 0..3),
        ) {
            let state = State {
                episode,
                model,
                step: numbers.0,
                context: numbers.1,
                horizon: numbers.2,
                scope: Some(SCOPES[scope].1),
                speed: speed.map(|e| 2.0_f32.powi(e)),
                looping: Some(Looping::Off),
                switches,
                unknown,
            };
            prop_assert_eq!(State::parse(&state.to_string()), (state, Vec::new()));
        }

        #[test]
        fn any_text_can_be_read(text in ".{0,40}", alpha in "[a-z:0-9@.,-]{0,20}") {
            State::parse(&text);
            State::parse(&format!("v=1;alpha={alpha};step={alpha}"));
        }
    }
}
