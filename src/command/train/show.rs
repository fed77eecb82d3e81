//! Progress of a run on standard error: a bar in a terminal, a line an epoch elsewhere.

use std::fmt::Write as _;

use indicatif::ProgressBar;

use crate::command::note;
use crate::train::Progress;
use crate::train::step::Losses;

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
    bar.set_position((progress.fraction * 1000.0) as u64);
    bar.set_message(line.clone());
    if progress.epoch_ended {
        let mut line = line;
        match &progress.validation {
            None => line += "  | no episode to validate on",
            Some(validation) => {
                let Losses { vision, kl, .. } = validation.losses;
                // Writing to a string cannot fail.
                let _ = write!(line, "  | val vision {vision:.2} KL {kl:.2}");
                if let Some(mean) = validation.mean_psnr_db() {
                    let _ = write!(line, " open loop {mean:.2} dB");
                }
            }
        }
        if bar.is_hidden() {
            note(&line);
        } else {
            bar.println(line);
        }
    }
}
