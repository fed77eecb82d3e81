//! What the models are called: by name, by recipe where there are several, by seed within one.

use crate::command::open::Training;
use crate::eval::score::Candidate;
use crate::model::config::{Config, Preset};

/// How a model came about, whichever of the named models it is: two of one recipe differ in their experts alone.
#[derive(Debug)]
pub(super) struct Recipe {
    /// Without the numbers read off the training set, and without what the model's name already says.
    config: Config,
    /// Of its training, where its report says so.
    updates: Option<u64>,
    /// What it was trained on, where its report says so: its name, and what names all that it holds.
    data: Option<String>,
    data_hash: Option<String>,
}

impl Recipe {
    /// Of a model's config and the report of its training.
    pub(super) fn of(config: &Config, training: &Training) -> Self {
        let mut config = config.clone();
        for channels in [&mut config.haptic, &mut config.proprio] {
            channels.mean.clear();
            channels.scale.clear();
        }
        config.training.error_weights.clear();
        config.step_secs = None;
        // A name that says which experts there are and how they are masked leaves the recipe; another stays in it.
        let named = Config::named(&config.name).filter(|named| {
            named.experts == config.experts
                && named.prior_expert == config.prior_expert
                && named.training.masks == config.training.masks
        });
        if named.is_some() {
            config.name.clear();
            config.experts.clear();
            config.prior_expert = false;
            config.training.masks = false;
        }
        Self {
            config,
            updates: training.updates,
            data: training.data.clone(),
            data_hash: training.data_hash.clone(),
        }
    }

    /// Whether the same was done. A budget in minutes comes to a few updates more or less.
    fn is_like(&self, other: &Self) -> bool {
        let near = match (self.updates, other.updates) {
            (Some(a), Some(b)) => a.abs_diff(b) <= a.max(b) / 20,
            (a, b) => a == b,
        };
        near && self.config == other.config && self.data_hash == other.data_hash
    }

    /// The preset of its sizes and its training; channels and their units are the dataset's matter, and epochs are what
    /// updates count.
    fn preset(&self) -> Option<Preset> {
        if !self.config.name.is_empty() {
            return None;
        }
        let own = &self.config;
        Preset::ALL.into_iter().find(|&preset| {
            let Some(config) = Config::preset("v", preset) else {
                return false;
            };
            // What the name says, and what the data is like.
            let mut same = Config {
                name: own.name.clone(),
                experts: own.experts.clone(),
                prior_expert: own.prior_expert,
                window: own.window,
                haptic: own.haptic.clone(),
                proprio: own.proprio.clone(),
                ..config
            };
            same.training.force_scale = own.training.force_scale;
            same.training.epochs = own.training.epochs;
            same == *own
        })
    }

    /// What to call it, of a folder and its whole path: the shortest words first, the surest last.
    fn words(&self, [own, path]: &[String; 2]) -> [String; 4] {
        let [own, path] = [own.clone(), path.clone()];
        let Some(preset) = self.preset() else {
            return [own.clone(), own.clone(), own, path];
        };
        let preset = preset.name();
        let counted = self.updates.map(|n| format!("{preset}, {n} updates"));
        let data = self.data.as_ref().map(|data| format!("{preset}, {data}"));
        let [counted, data] = [counted, data].map(|words| words.unwrap_or_else(|| own.clone()));
        [preset.to_owned(), counted, data, path]
    }
}

/// Names the candidates; each has its recipe, and its folder's name and path.
pub(super) fn name(candidates: &mut [Candidate], recipes: &[Recipe], folders: &[[String; 2]]) {
    // The first candidate of each recipe.
    let mut kinds: Vec<usize> = Vec::new();
    for (i, recipe) in recipes.iter().enumerate() {
        if !kinds.iter().any(|&kind| recipes[kind].is_like(recipe)) {
            kinds.push(i);
        }
    }
    let words: Vec<[String; 4]> = kinds
        .iter()
        .map(|&kind| recipes[kind].words(&folders[kind]))
        .collect();
    let called = |kind: usize| {
        let tells = |level: &usize| {
            let same = words.iter().filter(|w| w[*level] == words[kind][*level]);
            same.count() == 1
        };
        words[kind][(0..3).find(tells).unwrap_or(3)].clone()
    };
    for (candidate, recipe) in candidates.iter_mut().zip(recipes) {
        let kind = kinds.iter().position(|&kind| recipes[kind].is_like(recipe));
        candidate.recipe = kind
            .filter(|_| kinds.len() > 1)
            .map_or_else(String::new, called);
    }
    let groups: Vec<String> = candidates.iter().map(Candidate::group).collect();
    for (i, candidate) in candidates.iter_mut().enumerate() {
        let alone = groups.iter().filter(|group| **group == groups[i]).count() == 1;
        candidate.label = match candidate.seed {
            _ if alone => groups[i].clone(),
            Some(seed) => format!("{} seed {seed}", groups[i]),
            None => format!("{}#{}", groups[i], i + 1),
        };
    }
    // The same checkpoint named twice is told apart all the same.
    for i in 1..candidates.len() {
        let label = candidates[i].label.clone();
        if candidates[..i].iter().any(|other| other.label == label) {
            candidates[i].label = format!("{label}#{}", i + 1);
        }
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;

    /// Labels of `(model, preset, updates, folder)`, the first of them changed. What a folder lies in is what it was trained on.
    fn called(runs: &[(&str, Preset, u64, &str)], change: fn(&mut Config)) -> Vec<String> {
        let mut recipes = Vec::new();
        let mut candidates = Vec::new();
        for (i, &(name, preset, updates, folder)) in runs.iter().enumerate() {
            let mut config = Config::preset(name, preset).unwrap();
            config.training.error_weights = vec![1.0; i % 2];
            if i == 0 {
                change(&mut config);
            }
            let data = folder.split_once('/').map(|(data, _)| data.to_owned());
            let training = Training {
                updates: Some(updates),
                data: data.clone(),
                data_hash: data,
                ..Training::default()
            };
            recipes.push(Recipe::of(&config, &training));
            candidates.push(Candidate {
                label: String::new(),
                recipe: String::new(),
                seed: Some(i as u64),
                config,
                hash: String::new(),
                contact_newtons: None,
                regressors: None,
            });
        }
        let last = |path: &str| path.rsplit('/').next().unwrap().to_owned();
        let folders = runs.iter().map(|run| [last(run.3), run.3.to_owned()]);
        let folders: Vec<[String; 2]> = folders.collect();
        name(&mut candidates, &recipes, &folders);
        candidates.into_iter().map(|c| c.label).collect()
    }

    #[test]
    fn a_label_says_what_differs_and_no_more() {
        use Preset::{Fast, Released};
        let same: fn(&mut Config) = |_| {};
        let runs = [
            ("v", Fast, 9, "a"),
            ("vhp", Fast, 9, "b"),
            ("v-h-p", Fast, 9, "c"),
        ];
        assert_eq!(called(&runs, same), ["v", "vhp", "v-h-p"]);
        let runs = [
            ("v", Fast, 9, "a"),
            ("vhp", Fast, 9, "b"),
            ("vhp", Fast, 9, "c"),
        ];
        assert_eq!(called(&runs, same), ["v", "vhp seed 1", "vhp seed 2"]);
        let runs = [
            ("v", Fast, 9, "a"),
            ("v", Released, 9, "b"),
            ("vhp", Released, 8, "c"),
        ];
        assert_eq!(called(&runs[..2], same), ["v fast", "v released"]);
        // Updates are said where they tell recipes apart.
        assert_eq!(
            called(&runs, same),
            ["v fast", "v released, 9 updates", "vhp released, 8 updates"]
        );
        // A budget in minutes does not come to the same number.
        let runs = [("v", Fast, 995, "a"), ("v", Fast, 1003, "b")];
        assert_eq!(called(&runs, same), ["v seed 0", "v seed 1"]);
        // Nor are runs on other data further seeds.
        let runs = [
            ("v", Fast, 9, "sim/v"),
            ("v", Fast, 9, "real/v"),
            ("vhp", Fast, 9, "real/vhp"),
        ];
        assert_eq!(
            called(&runs, same),
            ["v fast, sim", "v fast, real", "vhp fast, real"]
        );
        // One that was changed by hand is called by its folder.
        let runs = [("v", Fast, 9, "runs/a"), ("v", Fast, 9, "runs/b")];
        assert_eq!(
            called(&runs, |config| config.training.kl_weight = 2.0),
            ["v a", "v fast"]
        );
        assert_eq!(
            called(&runs, |config| config.hidden = 64),
            ["v a", "v fast"]
        );
        // And a name that does not say what it is, is no recipe that others share.
        assert_eq!(
            called(&runs, |config| config.training.masks = true),
            ["v a", "v fast"]
        );
    }
}
