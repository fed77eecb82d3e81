//! Every set of experts at once, and entering one.

use super::*;
use crate::session::wants::Wants;

const LATTICE: Wants = Wants {
    lattice: true,
    spread: false,
    response: false,
    board: false,
};

#[test]
fn a_cell_says_what_its_set_says_when_it_is_entered() {
    let mut session = session();
    run(&mut session, [SeekTo(7)]);
    assert!(session.snapshot().lattice.is_none(), "nobody asked");
    session.want(LATTICE);
    let lattice = run(&mut session, []).lattice.unwrap();
    assert_eq!((lattice.step, lattice.cells.len()), (6, 15));
    assert_eq!(lattice.cells[0].name, "VHPD");
    assert!(lattice.cells[0].current && lattice.cells[0].trained);
    for cell in &lattice.cells {
        let entered = run(&mut session, [UseSet(cell.active.clone())]);
        let position = entered.position.unwrap();
        assert_eq!(position.belief[6], cell.position, "{}", cell.name);
        assert_eq!(position.belief_error_m, cell.position_error_m);
        assert_eq!(entered.frames.belief, cell.frame);
        let now = entered.lattice.unwrap();
        let current: Vec<&str> = now
            .cells
            .iter()
            .filter(|cell| cell.current)
            .map(|cell| cell.name.as_str())
            .collect();
        assert_eq!(current, [cell.name.as_str()]);
        assert_eq!(
            cell.trained, cell.active[3],
            "the prior is always trained in"
        );
        assert_eq!(
            entered.badge == Badge::Trained,
            cell.trained,
            "{}",
            cell.name
        );
    }
}

#[test]
fn the_lattice_follows_the_cursor_without_filtering_again() {
    let model = FakePredictor::three();
    let calls = model.calls();
    let mut session = session_of(vec![Arc::new(model)]);
    session.want(LATTICE);
    run(&mut session, [SeekTo(4)]);
    let filtered = calls.filtered();
    let snapshot = run(&mut session, [Step(3), Step(1)]);
    assert_eq!(snapshot.lattice.unwrap().step, 7);
    assert_eq!(calls.filtered(), filtered);
}

#[test]
fn a_model_without_a_product_has_no_lattice_and_no_set_to_enter() {
    let mut session = session_of(vec![Arc::new(FakePredictor::vision())]);
    session.want(LATTICE);
    let snapshot = run(&mut session, [SeekTo(5), UseSet(vec![true, false])]);
    assert!(snapshot.lattice.is_none() && is_refusal(&snapshot));
    assert!(snapshot.fusion.is_none());
    // How honest it is can be read all the same, beside the models that do multiply.
    let series = snapshot.series.unwrap();
    assert!(series.nees[5].is_finite() && series.surprise[5].is_finite());
    assert!(series.conflict.iter().all(|conflict| conflict.is_nan()));
}

#[test]
fn switches_that_are_no_set_are_none_of_the_cells() {
    let mut session = session();
    session.want(LATTICE);
    let half = Temper {
        expert: 0,
        tenths: -5,
    };
    let here = [SeekTo(7), CycleScope, CycleScope, ToggleExpert(0)];
    for switches in [vec![SeekTo(7), half], here.to_vec()] {
        let lattice = run(&mut session, switches).lattice.unwrap();
        assert!(lattice.cells.iter().all(|cell| !cell.current));
        run(&mut session, [Undo]);
    }
}

#[test]
fn an_empty_set_is_refused() {
    let mut session = session();
    let before = session.snapshot().state;
    let snapshot = run(&mut session, [UseSet(vec![false; 4])]);
    assert!(is_refusal(&snapshot));
    assert_eq!(snapshot.state, before);
}
