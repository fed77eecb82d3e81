//! What each sensor pulls the belief by, head to tail from the prior's place, and the force that was measured.

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
/// What is less is a sensor's noise, and a millimetre of arrow.
const LEAST_NEWTONS: f32 = 0.1;
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

fn force(nodes: &mut Nodes, snapshot: &Snapshot) {
    let push = push(snapshot);
    nodes.arrow("/force", push.map(|(ends, _)| ends), FORCE);
    let newtons = push.map_or(0.0, |(_, newtons)| newtons);
    nodes.label(
        "/force/label",
        format!("{newtons:.1} N"),
        push.map(|([from, _], _)| [from[0], from[1], TIP_HEIGHT + 0.01]),
    );
}

/// From the tip along the measured force of the pusher on the object, and the size of that force in newtons; none
/// without contact, and where force or tip were not recorded.
fn push(snapshot: &Snapshot) -> Option<([Point; 2], f32)> {
    let cursor = snapshot.cursor;
    let &[fx, fy] = snapshot.episode.as_ref()?.push_newtons.get(cursor)?;
    let &[x, y] = snapshot.position.as_ref()?.tip.get(cursor)?;
    let newtons = fx.hypot(fy);
    if !newtons.is_finite() || newtons < LEAST_NEWTONS {
        return None;
    }
    let per_newton = PER_NEWTON.min(LONGEST / newtons);
    let end = [x + per_newton * fx, y + per_newton * fy, FORCE_HEIGHT];
    let ends = [[x, y, FORCE_HEIGHT], end];
    end.into_iter()
        .all(f32::is_finite)
        .then_some((ends, newtons))
}

fn above([x, y]: [f32; 2]) -> Point {
    [x, y, ABOVE + 0.004]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::*;
    use crate::session::Session;
    use crate::session::command::Command;
    use crate::session::fake::{FakePredictor, FakeSource};

    /// A step of a session, as if this had been felt at each.
    fn felt(push_newtons: Option<[f32; 2]>) -> Snapshot {
        let source = Arc::new(FakeSource::new(1));
        let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
        assert!(session.wait_idle(Duration::from_secs(20)));
        session.apply(Command::SeekTo(7));
        assert!(session.wait_idle(Duration::from_secs(20)));
        let mut snapshot = session.snapshot();
        let episode = snapshot.episode.as_mut().expect("it is open");
        let steps = episode.secs.len();
        Arc::make_mut(episode).push_newtons =
            push_newtons.map_or_else(Vec::new, |push| vec![push; steps]);
        snapshot
    }

    fn is_close(a: Point, b: Point) -> bool {
        a.into_iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
    }

    #[test]
    fn the_force_starts_at_the_tip_and_goes_where_it_was_measured_to_go() {
        for (felt_newtons, newtons, along_m) in [
            ([3.0, -4.0], 5.0, [0.03, -0.04]),
            ([-0.3, 0.4], 0.5, [-0.003, 0.004]),
            ([0.0, 100.0], 100.0, [0.0, LONGEST]),
        ] {
            let snapshot = felt(Some(felt_newtons));
            let tip = snapshot.position.as_ref().expect("there is a probe").tip[snapshot.cursor];
            let ([from, to], size) = push(&snapshot).expect("it is felt");
            assert!((size - newtons).abs() < 1e-4);
            assert!(is_close(from, [tip[0], tip[1], FORCE_HEIGHT]));
            assert!(is_close(
                to,
                [tip[0] + along_m[0], tip[1] + along_m[1], FORCE_HEIGHT]
            ));
        }
    }

    #[test]
    fn a_step_without_force_has_no_arrow() {
        let nothing = [
            [0.0; 2],
            [0.05, -0.05],
            [f32::NAN, 1.0],
            [f32::INFINITY, 0.0],
        ];
        for push_newtons in nothing.map(Some).into_iter().chain([None]) {
            assert_eq!(push(&felt(push_newtons)), None, "{push_newtons:?}");
        }
    }
}
