//! Progress of a run on standard error: a bar in a terminal, a line an epoch elsewhere.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use crate::train::Progress;

/// A bar, hidden where standard error is no terminal.
pub fn bar() -> ProgressBar {
    if std::io::stderr().is_terminal() {
        ProgressBar::new(1000)
    } else {
        ProgressBar::hidden()
    }
}

/// Moves the bar; prints a line where an epoch ended.
pub fn progress(bar: &ProgressBar, progress: &Progress) {
    let losses = progress.losses;
    let minutes = progress.elapsed.as_secs_f64() / 60.0;
    let left = minutes / progress.fraction.max(1e-9) * (1.0 - progress.fraction);
    let line = format!(
        "epoch {} update {}  loss {:.2}  vision {:.2}  windows {:.2}  KL {:.2}  {minutes:.1} min, {left:.1} left",
        progress.update / progress.epoch_updates,
        progress.update,
        losses.loss,
        losses.vision,
        losses.windows,
        losses.kl,
    );
    if let Ok(style) = ProgressStyle::with_template("{bar:20} {msg}") {
        bar.set_style(style);
    }
    bar.set_position((progress.fraction * 1000.0) as u64);
    bar.set_message(line.clone());
    if let Some(validation) = &progress.validation {
        let psnr_db = &validation.psnr_db;
        let mean = psnr_db.iter().sum::<f64>() / psnr_db.len().max(1) as f64;
        let line = format!(
            "{line}  | val vision {:.2} KL {:.2} open loop {mean:.2} dB",
            validation.losses.vision, validation.losses.kl
        );
        if bar.is_hidden() {
            eprintln!("{line}");
        } else {
            bar.println(line);
        }
    }
}
