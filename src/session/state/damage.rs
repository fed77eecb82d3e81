//! Damaged inputs: `haptic:noise:0.5@3-7,vision:occlude:1@4-:0.25x0.75`: whose, how, how much, when, and of the
//! patch that occludes its centre in parts of the frame, from the left and from the top.

use std::collections::BTreeMap;

use super::names;
use super::reach;
use crate::measure::corruption::{Corruption, Damage, applies};
use crate::modality::Modality;
use crate::model::switches::Reach;

/// One entry a modality.
pub fn text(corruptions: &BTreeMap<Modality, Corruption>) -> String {
    let entries = corruptions.iter().map(|(&modality, corruption)| {
        let Corruption { from, until, .. } = *corruption;
        let patch = match (corruption.damage, corruption.patch) {
            (Damage::Occlude, [x, y]) => format!(":{x}x{y}"),
            _ => String::new(),
        };
        format!(
            "{}:{}:{}{}{patch}",
            modality.name(),
            corruption.damage.name(),
            corruption.severity,
            reach::text(Reach { from, until })
        )
    });
    entries.collect::<Vec<_>>().join(",")
}

/// The inverse, but for the seed.
pub fn read(text: &str) -> Result<BTreeMap<Modality, Corruption>, String> {
    let parts = text.split(',').filter(|part| !part.is_empty());
    parts
        .map(|part| {
            entry(part).ok_or_else(|| {
                format!(
                    "{part:?} is not like haptic:noise:0.5, proprio:hold:1@3-7 or vision:occlude:0.5:0.25x0.75"
                )
            })
        })
        .collect()
}

fn entry(text: &str) -> Option<(Modality, Corruption)> {
    let (modality, rest) = text.split_once(':')?;
    let modality = names::modality(modality).ok()?;
    let (damage, rest) = rest.split_once(':')?;
    let damage = Damage::from_name(damage)?;
    let (rest, patch) = match rest.split_once(':') {
        None => (rest, [0.5; 2]),
        Some((rest, patch)) if damage == Damage::Occlude => {
            let (x, y) = patch.split_once('x')?;
            (rest, [part(x)?, part(y)?])
        }
        Some(_) => return None,
    };
    let (severity, Reach { from, until }) = reach::split(rest)?;
    let corruption = Corruption {
        damage,
        severity: part(severity)?,
        from,
        until,
        patch,
        seed: 0,
    };
    applies(damage, modality).then_some((modality, corruption))
}

/// A number from 0 to 1.
fn part(text: &str) -> Option<f32> {
    let number: f32 = text.parse().ok()?;
    (0.0..=1.0).contains(&number).then_some(number)
}
