//! What each sensor pulls the belief by, head to tail from the prior's place, and the force of contact.

use super::nodes::{Nodes, Point};
use super::table::ABOVE;
use crate::episode::TIP_HEIGHT_M as TIP_HEIGHT;
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;

/// Factors by which pulls are drawn longer than they are.
const FACTORS: [f32; 6] = [50.0, 20.0, 10.0, 5.0, 2.0, 1.0];
/// A chain of this length in metres is easy to see.
const CLEAR: f32 = 0.08;
/// Metres of arrow per newton.
const PER_NEWTON: f32 = 0.01;
/// The longest arrow of a force, in metres.
const LONGEST: f32 = 0.12;
/// Height of the force's arrow above the table.
const FORCE_HEIGHT: f32 = ABOVE + 0.01;
/// The force's colour.
const FORCE: [u8; 3] = [0xCC, 0x33, 0x11];

/// Adds them.
pub fn add(nodes: &mut Nodes, snapshot: &Snapshot) {
    pulls(nodes, snapshot);
    force(nodes, snapshot);
}

fn pulls(nodes: &mut Nodes, snapshot: &Snapshot) {
    let fusion = snapshot.fusion.as_deref();
    let start = fusion.and_then(|fusion| fusion.prior_m);
    let readings = fusion
        .map(|fusion| fusion.experts.as_slice())
        .unwrap_or_default();
    let pulls: Vec<(Expert, Option<[f32; 2]>)> = snapshot
        .experts
        .iter()
        .enumerate()
        .filter(|(_, view)| view.expert != Expert::Prior)
        .map(|(place, view)| {
            (
                view.expert,
                readings.get(place).and_then(|reading| reading.pull_m),
            )
        })
        .collect();
    let length: f32 = pulls
        .iter()
        .filter_map(|(_, pull)| *pull)
        .map(|[x, y]| x.hypot(y))
        .sum();
    let factor = FACTORS
        .into_iter()
        .find(|factor| factor * length <= CLEAR)
        .unwrap_or(1.0);
    let mut at = start;
    for (expert, pull) in pulls {
        let next = at
            .zip(pull)
            .map(|([x, y], [dx, dy])| [x + factor * dx, y + factor * dy]);
        let ends = at.zip(next).map(|(from, to)| [above(from), above(to)]);
        let (r, g, b) = expert.rgb();
        nodes.arrow(&format!("/pull/{}", expert.name()), ends, [r, g, b]);
        at = next.or(at);
    }
    let place = start
        .filter(|_| length > 0.0)
        .map(|[x, y]| [x, y, ABOVE + 0.02]);
    nodes.label("/pull/label", format!("pulls ×{factor}"), place);
}

/// Only the size of the force is recorded here, so its arrow points from the tip to the plate.
fn force(nodes: &mut Nodes, snapshot: &Snapshot) {
    let cursor = snapshot.cursor;
    let newtons = snapshot
        .episode
        .as_ref()
        .and_then(|episode| episode.force_newtons.get(cursor));
    let newtons = newtons
        .copied()
        .filter(|newtons| newtons.is_finite())
        .unwrap_or(0.0);
    let position = snapshot.position.as_ref();
    let tip = position
        .and_then(|position| position.tip.get(cursor))
        .copied();
    let plate = position.and_then(|position| position.truth.get(cursor));
    let ends = tip
        .zip(plate)
        .filter(|_| newtons > 0.05)
        .and_then(|([x, y], plate)| {
            let (dx, dy) = (plate.x - x, plate.y - y);
            let away = dx.hypot(dy);
            let part = (newtons * PER_NEWTON).min(LONGEST) / away;
            part.is_finite().then(|| {
                let end = [x + part * dx, y + part * dy, FORCE_HEIGHT];
                [[x, y, FORCE_HEIGHT], end]
            })
        });
    nodes.arrow("/force", ends, FORCE);
    nodes.label(
        "/force/label",
        format!("{newtons:.1} N"),
        ends.map(|[from, _]| [from[0], from[1], TIP_HEIGHT + 0.01]),
    );
}

fn above([x, y]: [f32; 2]) -> Point {
    [x, y, ABOVE + 0.004]
}
