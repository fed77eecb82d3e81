//! Which images stand in the row, left to right, with their labels.
//!
//! ```text
//! one model      truth   belief   prediction   error
//! damaged input  truth   input    belief|pred  error
//! two models     truth   A        B            error of A
//! both           truth   input    A            B
//! ```
//! The one that is compared (the prediction where there is one, else the belief; with two models, A's) also shows its
//! difference from B, B by turns, or B right of a border.

use std::sync::Arc;

use ratatui::style::Style;

use crate::episode::Frame;
use crate::measure::frame::ERROR_RANGE;
use crate::modality::Expert;
use crate::session::model_key;
use crate::session::snapshot::{Badge, ErrorOf, FrameRow, SignedFrame, Snapshot, StepPsnr};
use crate::tui::compare::{Compare, wiped};
use crate::tui::experts::damage_badge;
use crate::tui::face::Face;
use crate::tui::image::Raster;
use crate::tui::theme::{PREDICTION, SECOND, WARNING, strong};
use crate::tui::words;

/// One image with its label.
pub struct Slot {
    /// Shown first.
    pub name: String,
    /// Shown after the name as far as there is room.
    pub notes: Vec<String>,
    /// Of the name.
    pub style: Style,
    /// The image, or why there is none.
    pub image: Result<Raster, String>,
    /// Whether it stays when only two have room.
    pub keep: bool,
    /// Whether it is the one that is compared.
    pub compared: bool,
}

/// The row at the cursor.
pub fn slots(snapshot: &Snapshot, face: &Face) -> Vec<Slot> {
    let row = &snapshot.frames;
    let other = snapshot.other.as_deref();
    let input = row.input.as_ref().map(|frame| input(frame, snapshot, face));
    let truth = Slot {
        name: "truth".to_owned(),
        notes: Vec::new(),
        style: strong(),
        image: image(row.truth.as_ref(), || unknown(snapshot)),
        keep: other.is_none(),
        compared: false,
    };
    let error = Slot {
        name: "error".to_owned(),
        notes: vec![format!("±{ERROR_RANGE:.2}"), of(snapshot).to_owned()],
        style: strong(),
        image: row
            .error
            .as_ref()
            .map(|error| Raster::from(&**error))
            .ok_or_else(|| no_belief(snapshot)),
        keep: false,
        compared: false,
    };
    let mut slots = vec![truth];
    if other.is_none() && input.is_none() {
        let predicted = row.error_of == ErrorOf::Prediction;
        let mut pair = [belief(row, snapshot), prediction(row, snapshot, face)];
        let slot = &mut pair[usize::from(predicted)];
        (slot.keep, slot.compared) = (true, true);
        compare(slot, None, snapshot, face);
        slots.extend(pair);
        slots.push(error);
        return slots;
    }
    let both = other.is_some() && input.is_some();
    slots.extend(input);
    let mut a = one(row, snapshot, face);
    (a.keep, a.compared) = (true, true);
    let b = other.map(|other| {
        let mut b = match &other.fault {
            Some(fault) => Slot {
                image: Err(fault.clone()),
                ..one(&other.frames, snapshot, face)
            },
            None => one(&other.frames, snapshot, face),
        };
        let psnr = decibels(&other.psnr_db, snapshot.cursor, other.frames.error_of);
        let mark = match other.badge {
            Badge::Untrained(_) => "!",
            Badge::Trained | Badge::NoProduct => "",
        };
        let name = format!("{}{mark}", model_key(&snapshot.models, other.model));
        name_model(&mut b, "B", &name, psnr);
        b.style = strong().patch(face.depth.ink(SECOND));
        b.keep = true;
        b
    });
    if b.is_some() {
        let psnr = decibels(&snapshot.psnr_db, snapshot.cursor, row.error_of);
        let name = model_key(&snapshot.models, snapshot.model);
        name_model(&mut a, "A", &name, psnr);
    }
    compare(&mut a, b.as_ref(), snapshot, face);
    slots.push(a);
    slots.extend(b);
    if !both {
        slots.push(error);
    }
    slots
}

/// Renames a slot to its letter and model; its notes then say how good it is, and what of the model it shows.
fn name_model(slot: &mut Slot, letter: &str, model: &str, psnr: Option<String>) {
    let what = std::mem::replace(&mut slot.name, format!("{letter} {model}"));
    let what = if what == "prediction" { "pred" } else { &what };
    slot.notes = psnr.into_iter().chain([what.to_owned()]).collect();
}

/// The one image of a model: the prediction where there is one, else the belief.
fn one(row: &FrameRow, snapshot: &Snapshot, face: &Face) -> Slot {
    match row.error_of {
        ErrorOf::Belief => belief(row, snapshot),
        ErrorOf::Prediction => prediction(row, snapshot, face),
    }
}

fn belief(row: &FrameRow, snapshot: &Snapshot) -> Slot {
    let notes = decibels(&snapshot.psnr_db, snapshot.cursor, ErrorOf::Belief);
    Slot {
        name: "belief".to_owned(),
        notes: notes.into_iter().collect(),
        style: strong(),
        image: image(row.belief.as_ref(), || no_belief(snapshot)),
        keep: false,
        compared: false,
    }
}

fn prediction(row: &FrameRow, snapshot: &Snapshot, face: &Face) -> Slot {
    let ahead = ahead(snapshot);
    let why = || match ahead {
        None => format!("from step {}", snapshot.start + 2),
        Some(ahead) if ahead > snapshot.horizon => "past the horizon".to_owned(),
        Some(_) => unknown(snapshot),
    };
    let mut notes = match ahead {
        None => vec!["context".to_owned()],
        Some(ahead) => vec![format!("+{ahead}")],
    };
    let sampled = snapshot.sampling.shown && row.prediction.is_some();
    notes.extend(
        decibels(&snapshot.psnr_db, snapshot.cursor, ErrorOf::Prediction).filter(|_| !sampled),
    );
    let name = if sampled {
        format!("sample 1/{}", snapshot.sampling.count)
    } else {
        "prediction".to_owned()
    };
    Slot {
        name,
        notes,
        style: strong().patch(face.depth.ink(PREDICTION)),
        image: image(row.prediction.as_ref(), why),
        keep: false,
        compared: false,
    }
}

/// What the model sees instead of the truth.
fn input(frame: &Arc<Frame>, snapshot: &Snapshot, face: &Face) -> Slot {
    let damage = snapshot.damage_of(Expert::Vision);
    Slot {
        name: "input".to_owned(),
        // A frame before may be the damaged one: frames are stacked.
        notes: damage
            .map(|(_, corruption)| damage_badge(&corruption))
            .into_iter()
            .collect(),
        style: strong().patch(face.depth.ink(WARNING)),
        image: Ok(Raster::from(&**frame)),
        keep: false,
        compared: false,
    }
}

/// Puts B into A's slot, as the face says; where that cannot be done A stays and a note says why.
fn compare(a: &mut Slot, b: Option<&Slot>, snapshot: &Snapshot, face: &Face) {
    let truth = snapshot.frames.truth.as_ref();
    let b_image = match b {
        Some(b) => b.image.as_ref().ok().cloned(),
        None => truth.map(|frame| Raster::from(&**frame)),
    };
    let b_name = b.map_or("truth", |_| "B");
    match face.compare {
        Compare::Off => {}
        Compare::Difference => {
            let difference: Option<&SignedFrame> = match (&snapshot.other, b) {
                (Some(other), Some(_)) => other.difference.as_deref(),
                _ => snapshot.frames.error.as_deref(),
            };
            if let Some(difference) = difference {
                let short = if b.is_some() { "A" } else { of(snapshot) };
                a.name = format!("{short} − {b_name}");
                a.notes = vec![format!("±{ERROR_RANGE:.2}")];
                a.image = Ok(Raster::from(difference));
            }
        }
        Compare::Blink(false) => a.notes.insert(0, "◐".to_owned()),
        Compare::Blink(true) => {
            if let Some(image) = b_image {
                b_name.clone_into(&mut a.name);
                a.notes = vec!["◑".to_owned()];
                a.style = b.map_or(strong(), |b| b.style);
                a.image = Ok(image);
            }
        }
        Compare::Wipe(border) => {
            let both = match (&a.image, &b_image) {
                (Ok(a), Some(b)) => wiped(a, b, border),
                _ => None,
            };
            if let Some(both) = both {
                a.image = Ok(both);
                let name = if b.is_some() { "A" } else { of(snapshot) };
                a.name = format!("{name} │ {b_name}");
                a.notes.clear();
            }
        }
    }
}

fn image(frame: Option<&Arc<Frame>>, why: impl Fn() -> String) -> Result<Raster, String> {
    frame.map(|frame| Raster::from(&**frame)).ok_or_else(why)
}

/// What the error is of, in short.
fn of(snapshot: &Snapshot) -> &'static str {
    match snapshot.frames.error_of {
        ErrorOf::Belief => "belief",
        ErrorOf::Prediction => words::prediction(snapshot).1,
    }
}

fn decibels(all: &[StepPsnr], cursor: usize, of: ErrorOf) -> Option<String> {
    let psnr = all.get(cursor)?;
    let value = match of {
        ErrorOf::Belief => psnr.belief,
        ErrorOf::Prediction => psnr.prediction,
    };
    value.map(|db| format!("{db:.1} dB"))
}

fn ahead(snapshot: &Snapshot) -> Option<usize> {
    let ahead = snapshot.cursor.checked_sub(snapshot.start)?;
    (ahead > 0).then_some(ahead)
}

fn unknown(snapshot: &Snapshot) -> String {
    let unknown = if snapshot.busy {
        "computing…"
    } else {
        "none"
    };
    unknown.to_owned()
}

fn no_belief(snapshot: &Snapshot) -> String {
    let first = snapshot.first_belief();
    if snapshot.cursor < first {
        format!("from step {}", first + 1)
    } else {
        unknown(snapshot)
    }
}
