//! Sentences and legends on a pane of some width.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::paint::{text, width};
use super::theme::dim;
use crate::session::snapshot::Snapshot;

/// The words on lines of at most so many columns; a word that is longer than a line begins where it stands and goes on
/// in the next, so that nothing is lost.
pub fn wrap(sentence: &str, columns: u16) -> Vec<String> {
    let columns = columns.max(1);
    let mut lines: Vec<String> = Vec::new();
    for word in sentence.split_whitespace() {
        let room = lines
            .last()
            .map_or(0, |line| columns.saturating_sub(width(line)));
        let wanted = if width(word) > columns {
            2
        } else {
            1 + width(word)
        };
        let mut line = match lines.pop() {
            Some(line) if wanted <= room => line + " ",
            line => {
                lines.extend(line);
                String::new()
            }
        };
        for c in word.chars() {
            if width(&line) + width(c.encode_utf8(&mut [0; 4])) > columns {
                lines.push(std::mem::take(&mut line));
            }
            line.push(c);
        }
        lines.push(line);
    }
    lines
}

/// Writes a sentence from a row on; returns the row after it.
pub fn sentence(buf: &mut Buffer, pane: Rect, row: u16, content: &str, style: Style) -> u16 {
    let mut row = row;
    for line in wrap(content, pane.width) {
        text(buf, pane, 0, row, &line, style);
        row = row.saturating_add(1);
    }
    row
}

/// What stands as the prediction, in full and in short: one of its samples, where that is shown.
pub fn prediction(snapshot: &Snapshot) -> (&'static str, &'static str) {
    if snapshot.sampling.shown {
        ("sample 1", "sample")
    } else {
        ("prediction", "pred")
    }
}

/// A glyph in its style, and what it stands for.
pub type Entry<'a> = (&'a str, Style, &'a str);

/// Writes as many entries as fit a row, the first ones first.
pub fn legend(buf: &mut Buffer, pane: Rect, row: u16, entries: &[Entry]) {
    let mut at = 0;
    for &(glyph, style, name) in entries {
        let start = if at == 0 { 0 } else { at + 2 };
        if start + width(glyph) + 1 + width(name) > pane.width {
            return;
        }
        at = text(buf, pane, start, row, glyph, style);
        let gap = u16::from(!glyph.is_empty());
        at = text(buf, pane, at + gap, row, name, dim());
    }
}

/// Divides entries among rows of so many columns, in order.
pub fn legend_rows<'a, 'b>(entries: &'b [Entry<'a>], columns: u16) -> Vec<&'b [Entry<'a>]> {
    let mut rows = Vec::new();
    let (mut from, mut at) = (0, 0);
    for (i, (glyph, _, name)) in entries.iter().enumerate() {
        let length = width(glyph) + 1 + width(name);
        if i > from && at + 2 + length > columns {
            rows.push(&entries[from..i]);
            (from, at) = (i, length);
        } else {
            at += length + if i > from { 2 } else { 0 };
        }
    }
    if from < entries.len() {
        rows.push(&entries[from..]);
    }
    rows
}

/// Writes a legend on the last rows of a pane, one row where it is low; returns the rows above it.
pub fn legend_below(buf: &mut Buffer, pane: Rect, entries: &[Entry]) -> Rect {
    let rows = legend_rows(entries, pane.width);
    let most = match pane.height {
        0..=4 => 0,
        5..=8 => 1,
        height => height / 4,
    };
    let shown = (rows.len() as u16).min(most);
    let above = Rect {
        height: pane.height - shown,
        ..pane
    };
    for (i, row) in rows.into_iter().take(usize::from(shown)).enumerate() {
        legend(buf, pane, above.height + i as u16, row);
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_never_too_long_and_words_cut_only_where_no_line_holds_them() {
        assert_eq!(
            wrap("claims 95 %, holds 71 %", 12),
            ["claims 95 %,", "holds 71 %"]
        );
        assert_eq!(wrap("  ", 5), Vec::<String>::new());
        assert_eq!(
            wrap("copied: v=1;episode=ep00000;step=3", 10),
            ["copied: v=", "1;episode=", "ep00000;st", "ep=3"]
        );
        assert_eq!(wrap("ab", 0), ["a", "b"]);
    }

    #[test]
    fn a_legend_breaks_between_its_entries() {
        let entry = |name| ("─", Style::new(), name);
        let entries = [entry("truth"), entry("belief"), entry("tip")];
        let rows = legend_rows(&entries, 17);
        assert_eq!(rows.iter().map(|row| row.len()).collect::<Vec<_>>(), [2, 1]);
        assert!(legend_rows(&[], 9).is_empty());
    }
}
