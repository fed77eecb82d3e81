//! What the fuse view says where there is nothing to take apart.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use crate::modality::Expert;
use crate::session::snapshot::{Badge, ModelInfo, Snapshot};
use crate::tui::paint::text;
use crate::tui::theme::dim;
use crate::tui::words::sentence;

/// Says why there is no reading, in the rows below a pane's title.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot) {
    if snapshot.badge == Badge::NoProduct {
        no_product(buf, pane, snapshot);
    } else {
        text(buf, pane, 0, 0, &why(snapshot), dim());
    }
}

/// Why a model with a product has no reading at this step, in a few words.
pub fn why(snapshot: &Snapshot) -> String {
    let first = snapshot.first_belief();
    if snapshot.cursor < first {
        format!("no belief before step {}", first + 1)
    } else if snapshot.busy {
        "computing…".to_owned()
    } else {
        "nothing to read at this step".to_owned()
    }
}

fn no_product(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot) {
    let model = snapshot.shown_model();
    let Some(model) = model else {
        text(buf, pane, 0, 0, "no model is open", dim());
        return;
    };
    let mut row = sentence(buf, pane, 0, &reason(model), Style::new());
    row += u16::from(pane.height > 8);
    let instead = [
        "Its input can still be damaged (x), and the belief watched for it.",
        "The predict and position views (v) show what it makes of the rest.",
        "A model with a product is opened by a second --model; ( and ) change between them.",
    ];
    for line in instead {
        row = sentence(buf, pane, row, line, dim());
    }
}

fn reason(model: &ModelInfo) -> String {
    let name = &model.name;
    match model.experts.as_slice() {
        [Expert::Concat] => format!(
            "No product: {name} puts the embeddings of all modalities side by side under one head. There is one \
             Gaussian and no expert, so there is nothing to switch and no share to give."
        ),
        [only] => format!(
            "No product: the {} encoder of {name} states the belief alone, and the prior is not multiplied in. With \
             one factor there is nothing to switch and no share to give.",
            only.name()
        ),
        _ => format!("No product: {name} multiplies no experts, so there is nothing to switch."),
    }
}
