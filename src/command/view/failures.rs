//! `view --failures`: the queue of failures for scripts, a line each, the worst first.

use std::fmt::Write;

use crate::measure::failure::Order;
use crate::session::snapshot::Snapshot;

/// A header and a line a failure, separated by tabs: rank, episode, step (from 1), split, value, and the state string
/// that opens the tool there.
pub fn list(snapshot: &Snapshot) -> String {
    let table = &snapshot.table;
    let model = snapshot.models.get(snapshot.model);
    let name = model.map_or("", |model| model.name.as_str());
    let mut text = format!(
        "rank\tepisode\tstep\tsplit\t{}\tstate\n",
        column(table.order)
    );
    for (rank, failure) in table.queue.iter().enumerate() {
        let row = &table.rows[failure.episode];
        let split = row.split.map_or("", crate::episode::Split::name);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}\t{}\t{}\t{split}\t{}\tv=1;episode={};step={};model={name}",
            rank + 1,
            row.id,
            failure.step + 1,
            failure.value,
            row.id,
            failure.step + 1,
        );
    }
    text
}

/// The quantity and its unit.
fn column(order: Order) -> &'static str {
    match order {
        Order::Error => "squared_error",
        Order::Distance => "distance_m",
        Order::Nees => "nees",
        Order::Conflict => "conflict",
        Order::Gain => "gain_squared_error",
        Order::Escape => "escape_step",
    }
}
