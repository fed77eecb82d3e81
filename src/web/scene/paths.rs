//! Where the plate went, is believed and was predicted to go, and how sure that is at the cursor.

use super::names::PATH_POINTS;
use super::nodes::{Nodes, Point};
use super::table::{ABOVE, BELIEF, PREDICTION, above};
use crate::measure::ellipse::{Ellipse, SIGMAS_OF_95_PERCENT};
use crate::session::snapshot::{Estimate, PositionView, Snapshot, estimate_at};
use crate::web::protocol::array::Array;
use crate::web::protocol::batched::BatchedProps;
use crate::web::protocol::node::{Binding, Clicks};
use crate::web::protocol::props::Look;

/// Pieces of an ellipse.
const ROUND: usize = 48;
/// The truth's colour.
const TRUTH: [u8; 3] = [110, 110, 110];
/// Corners of the mark of a step, from its middle.
const MARK: [Point; 6] = [
    [0.003, 0.0, 0.0],
    [-0.003, 0.0, 0.0],
    [0.0, 0.003, 0.0],
    [0.0, -0.003, 0.0],
    [0.0, 0.0, 0.003],
    [0.0, 0.0, -0.003],
];
/// Its faces.
const FACES: [[u32; 3]; 8] = [
    [0, 2, 4],
    [2, 1, 4],
    [1, 3, 4],
    [3, 0, 4],
    [2, 0, 5],
    [1, 2, 5],
    [3, 1, 5],
    [0, 3, 5],
];

/// Adds them.
pub fn add(nodes: &mut Nodes, snapshot: &Snapshot) {
    let empty = PositionView::default();
    let position = snapshot.position.as_ref().unwrap_or(&empty);
    let truth: Vec<Point> = position
        .truth
        .iter()
        .map(|pose| [pose.x, pose.y, ABOVE])
        .collect();
    // The three are told apart by their strokes: dashed, whole, dotted.
    nodes.lines("/path/truth", &broken(&truth, 0.6), TRUTH, 2.0);
    nodes.lines(
        "/path/belief",
        &broken(&points(&position.belief), 1.0),
        BELIEF,
        2.0,
    );
    nodes.lines(
        "/path/prediction",
        &broken(&points(&position.prediction), 0.25),
        PREDICTION,
        3.0,
    );
    steps(nodes, &truth);

    let now = estimate_at(&position.belief, snapshot.cursor);
    let outline = |sigmas| now.map(|now| outline(&now, sigmas)).unwrap_or_default();
    nodes.lines("/ellipse/sigma", &broken(&outline(1.0), 1.0), BELIEF, 2.0);
    nodes.lines(
        "/ellipse/most",
        &broken(&outline(SIGMAS_OF_95_PERCENT), 0.5),
        BELIEF,
        1.5,
    );
}

/// The recorded places, one a step: a click on one goes to it.
fn steps(nodes: &mut Nodes, truth: &[Point]) {
    // A client needs at least one.
    let places = if truth.is_empty() { &[[0.0; 3]] } else { truth };
    let props = BatchedProps {
        batched_wxyzs: Array::f32(places.iter().flat_map(|_| [1.0, 0.0, 0.0, 0.0])),
        batched_positions: Array::f32(places.iter().flatten().copied()),
        batched_scales: None,
        lod: "off",
        vertices: Array::f32(MARK.into_iter().flatten()),
        faces: Array::u32(FACES.into_iter().flatten()),
        batched_colors: Array::u8(TRUTH),
        look: Look {
            flat_shading: true,
            cast_shadow: false,
            ..Look::default()
        },
        batched_opacities: None,
        scale: 1.0,
    };
    let here = (!truth.is_empty()).then_some(([0.0; 3], 0.0));
    nodes.put(PATH_POINTS, props, here);
    nodes.add(&Clicks {
        name: PATH_POINTS.to_owned(),
        bindings: vec![Binding {
            button: "left",
            modifier: None,
        }],
        owner: String::new(),
    });
}

fn points(estimates: &[Option<Estimate>]) -> Vec<Point> {
    estimates.iter().flatten().map(above).collect()
}

/// From each point towards the next, as far as this part of the way.
fn broken(path: &[Point], part: f32) -> Vec<[Point; 2]> {
    let pairs = std::iter::zip(path, path.iter().skip(1));
    pairs
        .map(|(from, to)| {
            let end = std::array::from_fn(|axis| from[axis] + part * (to[axis] - from[axis]));
            [*from, end]
        })
        .collect()
}

/// A closed outline.
fn outline(estimate: &Estimate, sigmas: f32) -> Vec<Point> {
    let ellipse = Ellipse::of_covariance(estimate.covariance);
    let outline = ellipse.outline([estimate.x, estimate.y], sigmas, ROUND);
    outline.into_iter().map(|[x, y]| [x, y, ABOVE]).collect()
}
