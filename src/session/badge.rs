//! Whether a model was trained on what the switches say.

use super::snapshot::{Badge, ModelInfo};
use super::switches::Switches;
use crate::modality::Expert;

/// Whether the model was trained on the switches at a step.
pub fn badge(model: &ModelInfo, switches: &Switches, step: usize) -> Badge {
    if !model.has_product() {
        return Badge::NoProduct;
    }
    if let Some((expert, alpha)) = model
        .factors()
        .into_iter()
        .map(|expert| (expert, switches.alpha(expert, step)))
        .find(|(_, alpha)| ![0.0, 1.0].contains(alpha))
    {
        return Badge::Untrained(format!("{} α {alpha}", expert.name()));
    }
    if model.prior_expert && switches.alpha(Expert::Prior, step) == 0.0 {
        return Badge::Untrained("prior off".to_owned());
    }
    let is_active = |i: usize| {
        model
            .experts
            .get(i)
            .is_some_and(|&e| switches.alpha(e, step) > 0.0)
    };
    let matches = |member: &dyn Fn(usize) -> bool| {
        (0..model.experts.len()).all(|i| member(i) == is_active(i))
    };
    if model
        .trained_sets
        .iter()
        .any(|set| matches(&|i| set.contains(i)))
    {
        return Badge::Trained;
    }
    Badge::Untrained(format!(
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
    use crate::modality::ExpertSet;
    use crate::session::switches::Reach;

    fn vhp(prior_expert: bool) -> ModelInfo {
        ModelInfo {
            name: "vhp".to_owned(),
            source: String::new(),
            experts: vec![Expert::Vision, Expert::Joint],
            latent: 2,
            frame_stack: 1,
            prior_expert,
            trained_sets: vec![ExpertSet::full(2)],
        }
    }

    #[test]
    fn the_badge_says_what_was_trained() {
        let (model, mut switches) = (vhp(true), Switches::default());
        assert_eq!(badge(&model, &switches, 3), Badge::Trained);
        switches.set(Expert::Vision, Reach::EPISODE, 0.0);
        let untrained = |why: &str| Badge::Untrained(why.to_owned());
        assert_eq!(
            badge(&model, &switches, 3),
            untrained("J never trained; trained: V+J")
        );
        switches.set(Expert::Vision, Reach::EPISODE, 1.0);
        switches.set(Expert::Joint, Reach::EPISODE, 0.5);
        assert_eq!(badge(&model, &switches, 3), untrained("joint α 0.5"));
        switches.set(Expert::Joint, Reach::EPISODE, 1.0);
        switches.set(Expert::Prior, Reach::EPISODE, 0.0);
        assert_eq!(badge(&model, &switches, 3), untrained("prior off"));
    }

    #[test]
    fn two_sensors_are_a_product_without_a_prior_and_one_is_none() {
        let mut model = vhp(false);
        assert_eq!(badge(&model, &Switches::default(), 1), Badge::Trained);
        model.experts.pop();
        assert_eq!(badge(&model, &Switches::default(), 1), Badge::NoProduct);
    }
}
