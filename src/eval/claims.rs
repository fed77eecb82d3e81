//! What is asked of a contest's rows: the paper's claims and one of ours, recipes against each other, every setting
//! against the model as trained, and everything against what anybody could write.

use super::comparison::{Comparison, Means, Side, TRIVIAL, compare};
use super::score::{Contest, EpisodeScores, FrameScores};

/// What the paper claims, the first better than the second; and of ours, that a product survives being switched.
const CLAIMS: [[&str; 2]; 8] = [
    ["vp", "v"],
    ["vh", "v"],
    ["vhp", "v"],
    ["vhp", "vp"],
    ["vhp", "vh"],
    ["vhp", "vhp-c"],
    ["vhp-c", "v"],
    ["v-h-p", "vhp"],
];

/// Every side of a contest: rows of one group and setting together, then the trivial predictors. The same model or seed
/// given twice counts once.
pub fn sides(contest: &Contest, all: &[EpisodeScores]) -> Vec<Side> {
    let candidate = |place: usize| contest.candidate(&contest.subjects[place]);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (place, subject) in contest.subjects.iter().enumerate() {
        let alike = |group: &&mut Vec<usize>| {
            let (first, own) = (candidate(group[0]), candidate(place));
            (first.model(), &first.recipe) == (own.model(), &own.recipe)
                && contest.subjects[group[0]].setting == subject.setting
        };
        match groups.iter_mut().find(alike) {
            Some(group) => group.push(place),
            None => groups.push(vec![place]),
        }
    }
    let means = |place: &usize| {
        let scores = all.iter().filter_map(|e| e.subjects.get(*place));
        scores.map(|scores| Means::of(&scores.frames)).collect()
    };
    let side = |mut group: Vec<usize>| {
        let own = |place: &usize| (candidate(*place).seed, candidate(*place).hash.as_str());
        group.sort_by_key(own);
        group.dedup_by(|a, b| own(a) == own(b) || (own(a).0.is_some() && own(a).0 == own(b).0));
        let first = group[0];
        Side {
            model: candidate(first).model().to_owned(),
            recipe: candidate(first).recipe.clone(),
            setting: contest.subjects[first].setting.name.clone(),
            seeds: group.iter().map(means).collect(),
        }
    };
    let mut sides: Vec<Side> = groups.into_iter().map(side).collect();
    let [held, mean] = TRIVIAL;
    let trivial = |name: &str, scores: fn(&EpisodeScores) -> &FrameScores| Side {
        model: name.to_owned(),
        recipe: String::new(),
        setting: String::new(),
        seeds: vec![all.iter().map(|e| Means::of(scores(e))).collect()],
    };
    sides.push(trivial(held, |e| &e.held));
    sides.push(trivial(mean, |e| &e.mean_frame));
    sides
}

/// The sides that are models.
fn rows(sides: &[Side]) -> Vec<&Side> {
    sides.iter().filter(|side| !side.is_trivial()).collect()
}

/// The paper's claims among the sides of each recipe, and the first recipe against the others model by model; of a model
/// whose name is in none of that, whether it is better than the first. Then each model against itself under every setting, and
/// each row against the trivial predictors.
pub fn comparisons(sides: &[Side]) -> Vec<Comparison> {
    let rows = rows(sides);
    let find = |model: &str, recipe: &str| {
        let is = |side: &&&Side| side.model == model && side.recipe == recipe && side.as_trained();
        rows.iter().find(is).copied()
    };
    let mut recipes: Vec<&str> = Vec::new();
    for side in &rows {
        if !recipes.contains(&side.recipe.as_str()) {
            recipes.push(&side.recipe);
        }
    }
    let claimed = |recipe| {
        let pair = move |[a, b]: &[&str; 2]| find(a, recipe).zip(find(b, recipe));
        CLAIMS.iter().filter_map(pair)
    };
    let mut pairs: Vec<(&Side, &Side)> = recipes.iter().copied().flat_map(claimed).collect();
    let (trained, set): (Vec<&Side>, Vec<&Side>) = rows.iter().partition(|side| side.as_trained());
    for side in &trained {
        let first = recipes.first().and_then(|first| find(&side.model, first));
        let other = first.filter(|first| first.recipe != side.recipe);
        pairs.extend(other.map(|first| (first, *side)));
    }
    let unasked = unasked(sides);
    for &row in trained.iter().skip(1) {
        let is_row = |&(a, b): &(&Side, &Side)| std::ptr::eq(a, row) || std::ptr::eq(b, row);
        if !pairs.iter().any(is_row) && !unasked.iter().flatten().any(|name| *name == row.model) {
            pairs.push((row, trained[0]));
        }
    }
    for &side in &set {
        let trained = find(&side.model, &side.recipe);
        pairs.extend(trained.map(|trained| (trained, side)));
    }
    for trivial in sides.iter().filter(|side| side.is_trivial()) {
        pairs.extend(rows.iter().map(|&row| (row, trivial)));
    }
    let compare = |(first, second)| compare(first, second);
    pairs.into_iter().filter_map(compare).collect()
}

/// Models of a single training, of which another seed may say otherwise.
pub fn once(sides: &[Side]) -> Vec<String> {
    let single = |side: &&Side| side.as_trained() && side.seeds.len() == 1;
    let single = rows(sides).into_iter().filter(single);
    single.map(Side::label).collect()
}

/// Claims whose models are there, but of no common recipe: where a budget in minutes gives one model more
/// updates than another, they are not compared unasked.
pub fn unasked(sides: &[Side]) -> Vec<[&'static str; 2]> {
    let recipes = |model: &str| -> Vec<&str> {
        let own = rows(sides)
            .into_iter()
            .filter(|s| s.model == model && s.as_trained());
        own.map(|side| side.recipe.as_str()).collect()
    };
    let apart = |[a, b]: &[&'static str; 2]| {
        let (a, b) = (recipes(a), recipes(b));
        !a.is_empty() && !b.is_empty() && !a.iter().any(|recipe| b.contains(recipe))
    };
    CLAIMS.into_iter().filter(apart).collect()
}

#[cfg(test)]
mod tests {
    use super::super::comparison::tests::side;
    use super::*;

    type Psnr = fn(usize) -> f64;

    #[test]
    fn the_papers_claims_are_asked_by_name() {
        let flat: Psnr = |_| 20.0;
        let asked = |names: &[&str]| -> Vec<[String; 2]> {
            let sides: Vec<Side> = names.iter().map(|name| side(name, &[flat])).collect();
            let comparisons = comparisons(&sides).into_iter();
            comparisons.map(|c| [c.first, c.second]).collect()
        };
        let [held, mean] = TRIVIAL;
        let of_one = asked(&["v", "vhp", "vhp//prior off", held, mean]);
        assert_eq!(of_one[0], ["vhp", "v"]);
        assert_eq!(of_one[1], ["vhp", "vhp (prior off)"]);
        assert_eq!(of_one.len(), 2 + 2 * 3);
        // Among other names each is asked over the first, whatever else stands in the table.
        assert_eq!(
            asked(&["mine", "yours", "mine//prior off", "yours//prior off", held])[..3],
            [
                ["yours", "mine"],
                ["mine", "mine (prior off)"],
                ["yours", "yours (prior off)"]
            ]
        );
        assert_eq!(asked(&["v", "mine", "vhp"]), [["vhp", "v"], ["mine", "v"]]);
        // Claims are of one recipe; recipes are compared model by model.
        assert_eq!(
            asked(&["v/fast", "vhp/released", "vhp/fast", "v/released"]),
            [
                ["vhp fast", "v fast"],
                ["vhp released", "v released"],
                ["vhp fast", "vhp released"],
                ["v fast", "v released"],
            ]
        );
    }

    #[test]
    fn claims_that_cannot_be_asked_are_known() {
        let flat: Psnr = |_| 20.0;
        let sides = |names: &[&str]| -> Vec<Side> {
            names.iter().map(|name| side(name, &[flat])).collect()
        };
        let of_two = sides(&["v/fast, 12 updates", "vhp/fast, 9 updates"]);
        assert_eq!(unasked(&of_two), [["vhp", "v"]]);
        assert_eq!(comparisons(&of_two), []);
        assert_eq!(unasked(&sides(&["v/a", "vhp/b", "vhp/a"])), [[""; 2]; 0]);
        assert_eq!(unasked(&sides(&["vhp", "vhp-c//prior off"])), [[""; 2]; 0]);
    }
}
