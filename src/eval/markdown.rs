//! The tables as Markdown.

use std::fmt::Write as _;

use super::protocol::Protocol;
use super::quoted;
use super::regression::FittedOn;
use super::spread::Spread;
use super::summary::{Quality, Refit, Scope, Summary};
use crate::measure::bootstrap::Interval;

/// Every table of a summary.
pub fn markdown(summary: &Summary) -> String {
    let Protocol { context, horizon } = summary.protocol;
    let Scope {
        split, left_out, ..
    } = &summary.scope;
    let left_out = match left_out.len() {
        0 => String::new(),
        count => format!(" ({count} left out)"),
    };
    let mut text = format!(
        "{} episodes of split `{split}`{left_out}, {context} images seen, {horizon} predicted. ± is one standard deviation \
         over episodes, brackets are 95 % bootstrap intervals over the same episodes.\n",
        summary.episodes
    );
    quality(&mut text, summary);
    horizons(&mut text, &summary.quality);
    comparisons(&mut text, summary);
    regression(&mut text, summary);
    credit(&mut text, summary);
    contact(&mut text, summary);
    origin(&mut text, summary);
    text
}

/// What was scored, on what, and by what.
fn origin(text: &mut String, summary: &Summary) {
    head(text, "Made from", &["what", "seed", "hash of its files"]);
    for model in &summary.models {
        let seed = model.seed.map_or_else(String::new, |seed| seed.to_string());
        row(text, &[model.label.clone(), seed, model.hash.clone()]);
    }
    // By its hash alone: what a dataset is called says nothing of what it holds.
    let data = summary.scope.data_hash.clone();
    row(text, &["the dataset".to_owned(), String::new(), data]);
    if let Some(Refit { data_hash, .. }) = &summary.scope.refit {
        let what = "what regressors were fitted on".to_owned();
        row(text, &[what, String::new(), data_hash.clone()]);
    }
    let version = env!("CARGO_PKG_VERSION");
    let _ = writeln!(text, "\npoescope {version}");
}

/// A title and the head of a table; the first column is text.
fn head(text: &mut String, title: &str, columns: &[&str]) {
    let rules: String = columns.iter().skip(1).map(|_| " --: |").collect();
    // Writing to a string cannot fail, here and below.
    let _ = write!(
        text,
        "\n## {title}\n\n| {} |\n| --- |{rules}\n",
        columns.join(" | ")
    );
}

fn row(text: &mut String, cells: &[String]) {
    let _ = writeln!(text, "| {} |", cells.join(" | "));
}

fn pm(spread: Spread, digits: usize) -> String {
    format!("{:.digits$} ± {:.digits$}", spread.mean, spread.sd)
}

fn interval(of: Interval, digits: usize) -> String {
    format!(
        "{:+.digits$} [{:+.digits$}, {:+.digits$}]",
        of.mean, of.low, of.high
    )
}

fn quality(text: &mut String, summary: &Summary) {
    head(
        text,
        "Image prediction",
        &["model", "RMSE", "SSIM", "PSNR, dB"],
    );
    for q in &summary.quality {
        row(
            text,
            &[
                q.subject.clone(),
                format!("{:.3}", q.rmse),
                pm(q.ssim, 3),
                pm(q.psnr_db, 2),
            ],
        );
    }
    if !summary.seeds.is_empty() {
        head(
            text,
            "Seeds (± over seeds)",
            &["model", "seeds", "PSNR, dB"],
        );
        for seeds in &summary.seeds {
            row(
                text,
                &[
                    seeds.label.clone(),
                    seeds.seeds.to_string(),
                    pm(seeds.psnr_db, 2),
                ],
            );
        }
    }
    if let Some((name, rows)) = quoted::quality(summary.protocol) {
        let title = format!("Quoted from the paper: {name}");
        head(text, &title, &["model", "RMSE", "SSIM", "PSNR, dB"]);
        for (model, rmse, [ssim, ssim_sd], [psnr, psnr_sd]) in rows {
            row(
                text,
                &[
                    format!("{model} (quoted)"),
                    format!("{rmse:.3}"),
                    format!("{ssim:.3} ± {ssim_sd:.2}"),
                    format!("{psnr:.2} ± {psnr_sd:.2}"),
                ],
            );
        }
    }
}

fn horizons(text: &mut String, rows: &[Quality]) {
    let count = rows.first().map_or(0, |q| q.horizons.len());
    // As many columns as a page holds.
    let shown: Vec<usize> = (0..count).step_by(count.div_ceil(12).max(1)).collect();
    let mut columns = vec!["PSNR in dB at horizon".to_owned()];
    columns.extend(shown.iter().map(|h| (h + 1).to_string()));
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    head(text, "By horizon", &columns);
    for q in rows {
        let mut cells = vec![q.subject.clone()];
        cells.extend(
            shown
                .iter()
                .map(|&h| format!("{:.1}", q.horizons[h][2].mean)),
        );
        row(text, &cells);
    }
}

fn comparisons(text: &mut String, summary: &Summary) {
    head(
        text,
        "Paired differences",
        &[
            "first less second",
            "PSNR, dB",
            "SSIM",
            "squared error",
            "won",
            "finding",
        ],
    );
    for c in &summary.comparisons {
        let cells = [
            format!("{} − {}", c.first, c.second),
            interval(c.psnr_db, 2),
            interval(c.ssim, 4),
            interval(c.squared_error, 2),
            format!("{:.0} %", 100.0 * c.won),
            c.finding.name().to_owned(),
        ];
        row(text, &cells);
    }
    text.push('\n');
    for c in &summary.comparisons {
        let _ = writeln!(text, "- {}.", c.sentence());
    }
    if summary.seeds.is_empty() {
        let _ = writeln!(
            text,
            "- All of this is of one training a model: another seed may say otherwise."
        );
    } else if !summary.once.is_empty() {
        let _ = writeln!(
            text,
            "- Of one training alone, of which another seed may say otherwise: {}.",
            summary.once.join(", ")
        );
    }
    for [better, worse] in &summary.unasked {
        let _ = writeln!(
            text,
            "- Whether `{better}` predicts better than `{worse}` is not asked: no pair of them shares recipe, data and \
             updates."
        );
    }
}

fn regression(text: &mut String, summary: &Summary) {
    let train = match &summary.scope.refit {
        Some(Refit { data, .. }) => format!("fitted anew on the training split of {data}"),
        None if summary.protocol == Protocol::SYNTHETIC => {
            "fitted on the training split".to_owned()
        }
        None => {
            let Protocol { context, horizon } = Protocol::SYNTHETIC;
            format!(
                "fitted on the training split under {context} and {horizon}, as training does (--fit for anew)"
            )
        }
    };
    let scored =
        "the released notebook's way: fitted on the very episodes that are scored".to_owned();
    for (fitted_on, how) in [(FittedOn::Train, train), (FittedOn::Scored, scored)] {
        let rows: Vec<_> = summary
            .regression
            .iter()
            .filter(|r| r.fitted_on == fitted_on)
            .collect();
        if rows.is_empty() {
            continue;
        }
        let columns = [
            "model",
            "beliefs",
            "regressor",
            "RMSE, cm",
            "x, cm",
            "y, cm",
            "yaw, °",
        ];
        let title = format!("Pose from beliefs, {how} (± over beliefs)");
        head(text, &title, &columns);
        for r in rows {
            let cells = [
                r.subject.clone(),
                r.beliefs.name().to_owned(),
                r.regressor.name().to_owned(),
                format!("{:.2}", r.rmse_cm),
                pm(r.absolute_cm[0], 2),
                pm(r.absolute_cm[1], 2),
                r.yaw_deg.map_or_else(String::new, |yaw| pm(yaw, 1)),
            ];
            row(text, &cells);
        }
    }
    if summary.protocol == Protocol::MIT {
        head(
            text,
            "Quoted from the paper: Table 3, the MIT pushing set",
            &["estimate", "RMSE, cm"],
        );
        for (name, rmse) in quoted::POSITION_MIT {
            row(text, &[format!("{name} (quoted)"), format!("{rmse:.2}")]);
        }
    }
}

fn credit(text: &mut String, summary: &Summary) {
    if summary.credit.is_empty() {
        return;
    }
    head(
        text,
        "What each sensor contributes (Shapley values over the sets of sensors the model was trained on)",
        &[
            "model",
            "expert",
            "squared error saved",
            "nats of position gained",
        ],
    );
    for c in &summary.credit {
        let cells = [
            c.subject.clone(),
            c.expert.name().to_owned(),
            pm(c.squared_error, 2),
            c.nll.map_or_else(String::new, |nll| pm(nll, 2)),
        ];
        row(text, &cells);
    }
}

fn contact(text: &mut String, summary: &Summary) {
    if summary.aligned.is_empty() {
        return;
    }
    let offsets = [-2, -1, 0, 1, 2, 4, 6];
    let title = format!(
        "Precision shares around contact (force over {:.1} N), in percent (contacts)",
        summary.contact_newtons
    );
    let mut columns = vec!["model: expert".to_owned()];
    columns.extend(offsets.map(|o: i64| format!("{o:+}")));
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    head(text, &title, &columns);
    let mut keys: Vec<(&str, crate::modality::Expert)> = Vec::new();
    for a in &summary.aligned {
        if !keys.contains(&(&a.subject, a.expert)) {
            keys.push((&a.subject, a.expert));
        }
    }
    for (subject, expert) in keys {
        let at = |offset: i64| {
            let mut rows = summary.aligned.iter();
            rows.find(|a| a.subject == subject && a.expert == expert && a.offset == offset)
        };
        let mut cells = vec![format!("{subject}: {}", expert.name())];
        cells.extend(offsets.map(|o| {
            at(o).map_or_else(String::new, |a| {
                let [mean, low, high] =
                    [a.share.mean, a.share.low, a.share.high].map(|s| 100.0 * s);
                format!("{mean:.0} [{low:.0}, {high:.0}] ({})", a.contacts)
            })
        }));
        row(text, &cells);
    }
}
