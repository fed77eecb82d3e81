//! Whether a model was trained on what the switches say.

use super::snapshot::{Badge, ModelInfo};
use crate::modality::{Expert, ExpertSet};
use crate::model::switches::Switches;

/// Whether the model was trained on the switches of the steps `first..=step`: the belief at `step` has come through all
/// of them. Says at which step they were not, where that is an earlier one.
pub fn badge(model: &ModelInfo, switches: &Switches, first: usize, step: usize) -> Badge {
    if !model.has_product() {
        return Badge::NoProduct;
    }
    if let Some(why) = untrained(model, switches, step) {
        return Badge::Untrained(why);
    }
    let earlier = (first..step).find_map(|at| Some((at, untrained(model, switches, at)?)));
    earlier.map_or(Badge::Trained, |(at, why)| {
        Badge::Untrained(format!("{why}, at step {}", at + 1))
    })
}

/// Why the switches at one step were not trained, if they were not.
fn untrained(model: &ModelInfo, switches: &Switches, step: usize) -> Option<String> {
    let mut factors = model
        .factors()
        .into_iter()
        .map(|expert| (expert, switches.alpha(expert, step)));
    if let Some((expert, alpha)) = factors.find(|(_, alpha)| ![0.0, 1.0].contains(alpha)) {
        return Some(format!("{} α {alpha}", expert.name()));
    }
    if model.prior_expert && switches.alpha(Expert::Prior, step) == 0.0 {
        return Some("prior off".to_owned());
    }
    let is_active = |i: usize| {
        model
            .experts
            .get(i)
            .is_some_and(|&e| switches.alpha(e, step) > 0.0)
    };
    let matches =
        |set: &ExpertSet| (0..model.experts.len()).all(|i| set.contains(i) == is_active(i));
    if model.trained_sets.iter().any(matches) {
        return None;
    }
    Some(format!(
        "{} never trained; trained: {}",
        set_name(model, &is_active),
        trained_names(model)
    ))
}

/// What the model was trained on, in a few words.
fn trained_names(model: &ModelInfo) -> String {
    match model.trained_sets.len() {
        0 => "none".to_owned(),
        count @ 1..=3 => {
            let sets = &model.trained_sets[..count];
            let names: Vec<String> = sets
                .iter()
                .map(|set| set_name(model, &|i| set.contains(i)))
                .collect();
            names.join(", ")
        }
        count => format!("{count} sets"),
    }
}

fn set_name(model: &ModelInfo, is_member: &dyn Fn(usize) -> bool) -> String {
    let members = model
        .experts
        .iter()
        .enumerate()
        .filter(|&(i, _)| is_member(i));
    let letters: Vec<String> = members
        .map(|(_, expert)| expert.letter().to_string())
        .collect();
    if letters.is_empty() {
        "prior alone".to_owned()
    } else {
        letters.join("+")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::switches::Reach;
    use crate::session::command::Scope;

    fn vhp(prior_expert: bool) -> ModelInfo {
        ModelInfo {
            name: "vhp".to_owned(),
            experts: vec![Expert::Vision, Expert::Joint],
            latent: 2,
            frame_stack: 1,
            prior_expert,
            trained_sets: vec![ExpertSet::full(2)],
            ..ModelInfo::default()
        }
    }

    #[test]
    fn the_badge_says_what_was_trained() {
        let (model, mut switches) = (vhp(true), Switches::default());
        assert_eq!(badge(&model, &switches, 1, 3), Badge::Trained);
        switches.set(Expert::Vision, Reach::EPISODE, 0.0);
        let untrained = |why: &str| Badge::Untrained(why.to_owned());
        assert_eq!(
            badge(&model, &switches, 1, 3),
            untrained("J never trained; trained: V+J")
        );
        switches.set(Expert::Vision, Reach::EPISODE, 1.0);
        switches.set(Expert::Joint, Reach::EPISODE, 0.5);
        assert_eq!(badge(&model, &switches, 1, 3), untrained("joint α 0.5"));
        switches.set(Expert::Joint, Reach::EPISODE, 1.0);
        switches.set(Expert::Prior, Reach::EPISODE, 0.0);
        assert_eq!(badge(&model, &switches, 1, 3), untrained("prior off"));
    }

    #[test]
    fn a_belief_depends_on_the_switches_of_earlier_steps() {
        let (model, mut switches) = (vhp(true), Switches::default());
        switches.set(Expert::Vision, Scope::Frame.reach(4), 0.5);
        assert_eq!(badge(&model, &switches, 1, 3), Badge::Trained);
        let why = |why: &str| Badge::Untrained(why.to_owned());
        assert_eq!(badge(&model, &switches, 1, 4), why("vision α 0.5"));
        assert_eq!(
            badge(&model, &switches, 1, 9),
            why("vision α 0.5, at step 5")
        );
    }

    #[test]
    fn two_sensors_are_a_product_without_a_prior_and_one_is_none() {
        let mut model = vhp(false);
        assert_eq!(badge(&model, &Switches::default(), 1, 1), Badge::Trained);
        model.experts.pop();
        assert_eq!(badge(&model, &Switches::default(), 1, 1), Badge::NoProduct);
    }
}
