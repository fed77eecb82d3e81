//! The table with the plate on it, the tip that pushes, and where the plate is believed and predicted to be.

use super::nodes::{Nodes, Point};
use crate::episode::{PLATE_M as PLATE, TIP_HEIGHT_M as TIP_HEIGHT};
use crate::session::snapshot::{Estimate, PositionView, Snapshot, estimate_at};
use crate::web::protocol::camera::{CameraLookAt, CameraPosition};
use crate::web::protocol::grid::GridProps;
use crate::web::protocol::pose::Visibility;
use crate::web::protocol::props::Look;
use crate::web::protocol::shapes::{BallProps, CuboidProps, CylinderProps};

/// The prediction's colour.
pub const PREDICTION: [u8; 3] = [0x56, 0xB4, 0xE9];
/// The belief's.
pub const BELIEF: [u8; 3] = [0x40, 0x40, 0x40];
/// Just above the plate: what is drawn about it is to be seen.
pub const ABOVE: f32 = PLATE[2] + 0.005;
/// The smallest table.
const SIDE: f32 = 0.4;

/// Adds them.
pub fn add(nodes: &mut Nodes, snapshot: &Snapshot) {
    let axes = "/WorldAxes".to_owned();
    nodes.add(&Visibility {
        name: axes,
        visible: false,
        owner: String::new(),
    });
    let (middle, side) = extent(snapshot.position.as_ref());
    let [x, y] = middle;
    nodes.add(&CameraPosition {
        position: [x, y - 0.6 * side, 0.6 * side],
        initial: true,
    });
    nodes.add(&CameraLookAt {
        look_at: [x, y, 0.0],
        initial: true,
    });
    let flat = Look {
        flat_shading: true,
        ..Look::default()
    };
    let table = CuboidProps {
        dimensions: [side, side, 0.01],
        color: [214, 208, 198],
        look: flat.clone(),
        scale: 1.0,
    };
    let place = Some(([x, y, -0.006], 0.0));
    nodes.put("/table", table, place);
    let grid = GridProps {
        width: side,
        height: side,
        cell_size: 0.05,
        section_size: 0.1,
        cell_color: [190; 3],
        ..GridProps::default()
    };
    nodes.put("/table/grid", grid, Some(([0.0, 0.0, 0.006], 0.0)));

    things(nodes, snapshot, flat);
}

/// What stands on it.
fn things(nodes: &mut Nodes, snapshot: &Snapshot, flat: Look) {
    let position = snapshot.position.as_ref();
    let cursor = snapshot.cursor;
    let pose = position.and_then(|position| position.truth.get(cursor));
    let middle = 0.5 * PLATE[2];
    let plate = |color, look| CuboidProps {
        dimensions: PLATE,
        color,
        look,
        scale: 1.0,
    };
    let at = pose.map(|pose| ([pose.x, pose.y, middle], pose.yaw));
    nodes.put("/plate", plate([150, 160, 172], flat.clone()), at);
    // A stripe, so that it is seen how the plate is turned.
    let stripe = CuboidProps {
        dimensions: [0.5 * PLATE[0], 0.006, 0.001],
        color: [90, 98, 110],
        look: flat,
        scale: 1.0,
    };
    let on_top = Some(([0.25 * PLATE[0], 0.0, middle + 0.000_5], 0.0));
    nodes.put("/plate/top", stripe, on_top);

    let tip = position.and_then(|position| position.tip.get(cursor));
    let props = CylinderProps {
        radius: 0.004_75,
        height: TIP_HEIGHT,
        color: [70, 70, 76],
        radial_segments: 24,
        look: Look::default(),
        scale: 1.0,
    };
    nodes.put(
        "/tip",
        props,
        tip.map(|&[x, y]| ([x, y, 0.5 * TIP_HEIGHT], 0.0)),
    );

    // Only its place is predicted; it is turned as the recorded one.
    let predicted = position.and_then(|position| estimate_at(&position.prediction, cursor));
    let yaw = pose.map_or(0.0, |pose| pose.yaw);
    let ghost = Look {
        opacity: Some(0.45),
        cast_shadow: false,
        ..Look::default()
    };
    let at = predicted.map(|estimate| ([estimate.x, estimate.y, middle + 0.001], yaw));
    nodes.put("/predicted", plate(PREDICTION, ghost), at);

    let believed = position.and_then(|position| estimate_at(&position.belief, cursor));
    let props = BallProps {
        radius: 0.005,
        subdivisions: 2,
        color: BELIEF,
        look: Look::default(),
        scale: 1.0,
    };
    nodes.put("/believed", props, believed.map(|it| (above(&it), 0.0)));
}

/// Where an estimate is drawn.
pub fn above(estimate: &Estimate) -> Point {
    [estimate.x, estimate.y, ABOVE]
}

/// The table's middle and side: round numbers around where the plate and the tip go.
fn extent(position: Option<&PositionView>) -> ([f32; 2], f32) {
    let Some(position) = position else {
        return ([0.0; 2], SIDE);
    };
    let truth = position.truth.iter().map(|pose| [pose.x, pose.y]);
    let mut points: Vec<[f32; 2]> = truth.chain(position.tip.iter().copied()).collect();
    points.retain(|point| point.iter().all(|it| it.is_finite()));
    let ends = |axis: usize| {
        let values = points.iter().map(|point| point[axis]);
        let low = values.clone().fold(f32::INFINITY, f32::min);
        (low, values.fold(f32::NEG_INFINITY, f32::max))
    };
    if points.is_empty() {
        return ([0.0; 2], SIDE);
    }
    let ((left, right), (low, high)) = (ends(0), ends(1));
    let round = |value: f32| (value * 10.0).round() / 10.0;
    let side = ((right - left).max(high - low) + 2.0 * PLATE[0] + 0.1).max(SIDE);
    let middle = [round(0.5 * (left + right)), round(0.5 * (low + high))];
    (middle, (side * 10.0).ceil() / 10.0)
}
