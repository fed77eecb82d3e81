//! α of experts: `vision:0@1-15,haptic:0.5@4`.

use super::reach;
use crate::modality::Expert;
use crate::model::switches::{Run, Switches, checked_alpha};

/// Every run of an α that is not as trained.
pub fn text(switches: &Switches) -> String {
    let runs = Expert::ALL.into_iter().flat_map(|expert| {
        let runs = switches.runs(expert).into_iter();
        runs.map(move |run| {
            let reach = reach::text(run.reach);
            format!("{}:{}{reach}", expert.name(), run.alpha)
        })
    });
    runs.collect::<Vec<_>>().join(",")
}

/// The inverse.
pub fn read(text: &str) -> Result<Switches, String> {
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
    let (text, reach) = reach::split(text)?;
    let (name, alpha) = text.split_once(':')?;
    let expert = Expert::ALL
        .into_iter()
        .find(|expert| expert.name() == name)?;
    let alpha = checked_alpha(alpha.parse().ok()?).ok()?;
    Some((expert, Run { reach, alpha }))
}
