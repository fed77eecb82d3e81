//! The paper's figures, into the folder of the tables.

use std::path::Path;

use super::Scored;
use crate::episode::EpisodeSource;
use crate::eval::prediction::open_loop;
use crate::eval::score::Contest;
use crate::eval::setting::Setting;
use crate::eval::summary::{Summary, extremes};
use crate::export::figures::{self, Frames, Strip};
use crate::train::metrics::METRICS;

/// Episodes of either side in the strips.
const STRIPS: usize = 3;

/// Writes them all.
pub fn write(scored: &Scored<'_>, summary: &Summary, out: &Path) -> anyhow::Result<()> {
    let Scored { contest, all, .. } = *scored;
    let labels = contest.candidates.iter().map(|c| c.label.clone());
    let curves = labels.zip(scored.folders.iter().map(|folder| curve(folder)));
    if let Some(plot) = figures::training(curves.collect()) {
        plot.save(out, "training")?;
    }
    figures::horizons(summary).save(out, "horizons")?;
    if let Some(plot) = figures::ellipses(summary) {
        plot.save(out, "ellipses")?;
    }
    if let Some(plot) = figures::contact(summary) {
        plot.save(out, "contact")?;
    }
    let Some([first, second]) = rivals(contest) else {
        return Ok(());
    };
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
            strips.push(strip(scored, index, [first, second], &against)?);
        }
    }
    if strips.is_empty() {
        return Ok(());
    }
    let side = contest.candidates[0].inspector.model().config.frame_size;
    figures::strips(&title, &strips, side).save(out, "strips")?;
    Ok(())
}

/// Updates and validation PSNR of the run that made a checkpoint, as far as it left them.
fn curve(folder: &Path) -> Vec<[f64; 2]> {
    let metrics = std::fs::read_to_string(folder.join(METRICS)).unwrap_or_default();
    let point = |line: &str| -> Option<[f64; 2]> {
        let line: serde_json::Value = serde_json::from_str(line).ok()?;
        let horizons = line["val"]["psnr_db"].as_array()?;
        let sum: f64 = horizons.iter().filter_map(serde_json::Value::as_f64).sum();
        Some([line["update"].as_f64()?, sum / horizons.len() as f64])
    };
    metrics.lines().filter_map(point).collect()
}

/// The rows the strips compare: `v` and `vhp` of one recipe as the paper does, else the first two models as trained.
fn rivals(contest: &Contest) -> Option<[usize; 2]> {
    let trained: Vec<usize> = (0..contest.subjects.len())
        .filter(|&i| contest.subjects[i].setting == Setting::default())
        .collect();
    let candidate = |i: usize| contest.candidate(&contest.subjects[i]);
    let of = |name: &'static str| {
        let is = move |&i: &usize| candidate(i).model() == name;
        trained.iter().copied().filter(is)
    };
    let alike = of("v").find_map(|v| {
        let is = |&vhp: &usize| candidate(vhp).recipe == candidate(v).recipe;
        Some([v, of("vhp").find(is)?])
    });
    alike.or(Some([*trained.first()?, *trained.get(1)?]))
}

/// Truth and both rivals of the episode at `place` among the scores.
fn strip(
    scored: &Scored<'_>,
    place: usize,
    rivals: [usize; 2],
    against: &str,
) -> anyhow::Result<Strip> {
    let Scored {
        contest, dataset, ..
    } = *scored;
    let scores = &scored.all[place];
    let protocol = contest.protocol;
    let layout = contest.candidates[0].inspector.model().config.layout();
    let episode = dataset.load(scored.indices[place], layout)?;
    let mut rows = vec![Frames {
        label: "truth".to_owned(),
        frames: episode.frames[protocol.context..protocol.images()]
            .iter()
            .map(|frame| frame.pixels.clone())
            .collect(),
    }];
    let mut errors = Vec::new();
    for place in rivals {
        let subject = &contest.subjects[place];
        let pixels = open_loop(&contest.candidate(subject).inspector, &episode, protocol)?;
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
