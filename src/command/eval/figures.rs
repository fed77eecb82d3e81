//! The paper's figures, into the folder of the tables.

use std::path::Path;

use anyhow::Context;

use super::Scored;
use crate::data::Dataset;
use crate::episode::EpisodeSource;
use crate::eval::prediction::open_loop;
use crate::eval::score::Scorer;
use crate::eval::setting::Setting;
use crate::eval::summary::{Summary, extremes};
use crate::export::figures::{self, Frames, Strip};
use crate::export::plot::Plot;

/// Episodes of either side in the strips.
const STRIPS: usize = 3;

/// Writes them all.
pub fn write(scored: &Scored<'_>, summary: &Summary, out: &Path) -> anyhow::Result<()> {
    let labels = scored.contest.candidates.iter().map(|c| c.label.clone());
    let curves = labels.zip(scored.entrants.iter().map(|e| e.about.curve.clone()));
    for (stem, figure) in [
        ("training", figures::training(curves.collect())),
        ("horizons", Some(figures::horizons(summary))),
        ("ellipses", figures::ellipses(summary)),
        ("contact", figures::contact(summary)),
        ("strips", best_and_worst(scored)?),
    ] {
        match figure {
            Some(figure) => figure.save(out, stem)?,
            // That of an earlier run would stand beside these tables.
            None => {
                for kind in ["svg", "png"] {
                    let _ = std::fs::remove_file(out.join(format!("{stem}.{kind}")));
                }
            }
        }
    }
    Ok(())
}

/// The episodes in which the first of two rivals does worst against the second, and equally many the other way round; none
/// where these cannot be drawn.
fn best_and_worst(scored: &Scored<'_>) -> anyhow::Result<Option<Plot>> {
    let Scored {
        contest, joined, ..
    } = *scored;
    let all = &joined.all;
    let Some((dataset, rivals)) = scored.ground.dataset().zip(rivals(scored)) else {
        return Ok(None);
    };
    let [first, second] = rivals.map(|(place, _)| place);
    let labels = [first, second].map(|place| contest.subjects[place].label.clone());
    let [worst, best] = extremes(all, [first, second], STRIPS);
    let title = format!(
        "The worst of {0} against {1}, then the worst of {1} against {0}",
        labels[0], labels[1]
    );
    let mut strips = Vec::new();
    for (episodes, [worse, other]) in [(worst, [0, 1]), (best, [1, 0])] {
        let against = format!("of {} against {}", labels[worse], labels[other]);
        for index in episodes {
            strips.push(strip(scored, dataset, index, rivals, &against)?);
        }
    }
    let side = contest.candidates[0].config.frame_size;
    Ok((!strips.is_empty()).then(|| figures::strips(&title, &strips, side)))
}

/// The rows the strips compare: `v` and `vhp` of one recipe as the paper does, else the first two models as trained.
/// Their frames are decoded anew, so their weights must be at hand.
fn rivals<'a>(scored: &Scored<'a>) -> Option<[(usize, &'a Scorer); 2]> {
    let Scored {
        contest, entrants, ..
    } = *scored;
    let decodes = |place: usize| {
        let subject = &contest.subjects[place];
        let trained = subject.setting == Setting::default();
        let scorer = entrants[subject.candidate].scorer()?;
        trained.then_some((place, scorer))
    };
    let trained: Vec<_> = (0..contest.subjects.len()).filter_map(decodes).collect();
    let candidate = |place: usize| contest.candidate(&contest.subjects[place]);
    let of = |name: &'static str| {
        let is = move |&(place, _): &(usize, &Scorer)| candidate(place).model() == name;
        trained.iter().copied().filter(is)
    };
    let alike = of("v").find_map(|v| {
        let is = |&vhp: &(usize, &Scorer)| candidate(vhp.0).recipe == candidate(v.0).recipe;
        Some([v, of("vhp").find(is)?])
    });
    alike.or(Some([*trained.first()?, *trained.get(1)?]))
}

/// Truth and both rivals of the episode at `place` among the scores.
fn strip(
    scored: &Scored<'_>,
    dataset: &Dataset,
    place: usize,
    rivals: [(usize, &Scorer); 2],
    against: &str,
) -> anyhow::Result<Strip> {
    let Scored { contest, .. } = *scored;
    let scores = &scored.joined.all[place];
    let protocol = contest.protocol;
    let layout = contest.candidates[0].config.layout();
    let episode = dataset.load(scored.joined.indices[place], layout)?;
    let truth = episode.frames.get(protocol.context..protocol.images());
    let truth = truth.with_context(|| {
        let id = &episode.meta.id;
        format!("episode `{id}` is shorter than its scores say; remove scores from --out")
    })?;
    let mut rows = vec![Frames {
        label: "truth".to_owned(),
        frames: truth.iter().map(|frame| frame.pixels.clone()).collect(),
    }];
    let mut errors = Vec::new();
    for (place, scorer) in rivals {
        let subject = &contest.subjects[place];
        let pixels = open_loop(&scorer.inspector, &episode, protocol)?;
        let grey = |frame: &[f32]| frame.iter().map(|&p| (p * 255.0).round() as u8).collect();
        let size = layout.frame_size * layout.frame_size;
        rows.push(Frames {
            label: subject.label.clone(),
            frames: pixels.chunks_exact(size).map(grey).collect(),
        });
        let error = &scores.subjects[place].frames.squared_error;
        let mean = error.iter().sum::<f64>() / error.len().max(1) as f64;
        errors.push(format!("{} {mean:.1}", subject.label));
    }
    Ok(Strip {
        title: format!(
            "{}, among the worst {against}: squared error a frame {}",
            scores.episode,
            errors.join(", ")
        ),
        rows,
        first: protocol.context + 1,
    })
}
