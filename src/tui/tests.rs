//! Whole screens, as text with a hash of each row's styles.

use std::fmt::Write;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;

use super::face::{Face, Focus};
use super::fixture;
use super::print::to_text;
use super::theme::Depth;
use crate::session::snapshot::Snapshot;

pub(super) fn screen(snapshot: &Snapshot, face: &Face, (columns, rows): (u16, u16)) -> Buffer {
    let Ok(mut terminal) = Terminal::new(TestBackend::new(columns, rows));
    let Ok(_) = terminal.draw(|frame| super::draw(frame, snapshot, face));
    terminal.backend().buffer().clone()
}

/// The text, then eight hashes a line of what the rows look like besides it.
pub(super) fn described(buf: &Buffer) -> String {
    let mut out = to_text(buf, false);
    for row in 0..buf.area.height {
        let mut styles = String::new();
        for column in 0..buf.area.width {
            let cell = &buf[(column, row)];
            let _ = write!(styles, "{}/{}/{:?};", cell.fg, cell.bg, cell.modifier);
        }
        let end = if row % 8 == 7 { '\n' } else { ' ' };
        let _ = write!(out, "{:08x}{end}", crc32fast::hash(styles.as_bytes()));
    }
    out
}

#[test]
fn overview_at_three_sizes() {
    let snapshot = fixture::snapshot(8, 16);
    for size in [(80, 24), (120, 40), (200, 60)] {
        let name = format!("overview_{}x{}", size.0, size.1);
        insta::assert_snapshot!(name, described(&screen(&snapshot, &Face::default(), size)));
    }
}

#[test]
fn nothing_panics_at_any_size() {
    let mut snapshots = vec![
        fixture::snapshot(8, 16),
        fixture::snapshot(0, 48),
        fixture::snapshot(3, 300),
    ];
    let mut bare = fixture::snapshot(0, 16);
    bare.episode = None;
    bare.position = None;
    bare.experts.clear();
    snapshots.push(bare);
    let mut face = Face::default();
    for (i, snapshot) in snapshots.iter().enumerate() {
        for (width, height) in (1..=200)
            .step_by(7)
            .flat_map(|w| (1..=60).step_by(4).map(move |h| (w, h)))
        {
            face.focus = Focus::ALL[usize::from(width + height) % 5];
            face.zoomed = (width + i as u16).is_multiple_of(3);
            face.depth = if height % 2 == 0 {
                Depth::Plain
            } else {
                Depth::Indexed
            };
            screen(snapshot, &face, (width, height));
        }
    }
}
