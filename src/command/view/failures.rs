//! `view --failures`: the queue of failures for scripts, a line each, the worst first.

use std::fmt::Write;

use crate::episode::Split;
use crate::measure::failure::Order;
use crate::session::Session;

/// A header and a line a failure, separated by tabs: rank, episode, step (from 1), split, value, and the state string
/// that opens the tool there.
pub fn list(session: &Session) -> String {
    let table = session.snapshot().table;
    let mut text = format!(
        "rank\tepisode\tstep\tsplit\t{}\tstate\n",
        column(table.order)
    );
    for (rank, failure) in table.queue.iter().enumerate() {
        let row = &table.rows[failure.episode];
        let split = row.split.map_or("", Split::name);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}\t{}\t{}\t{split}\t{}\t{}",
            rank + 1,
            row.id.replace(char::is_control, " "),
            failure.step + 1,
            failure.value,
            session.state_at(failure.episode, failure.step),
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
