//! The bytes that a terminal sends, as keys, mouse events and answers.
//!
//! Read here and not by a library, because answers about images come in the middle of what the user types: a reader
//! that does not know them would take them for keys, and one that waits for them would hold the keys back. No key is
//! bound to Alt, so an ESC that begins no sequence is the key Esc, whatever follows it.

use ratatui::layout::Position;

use crate::session::keys::Key;
use crate::tui::app::Pointer;
use crate::tui::pixels::ask::Answer;

/// Bytes after which a sequence that does not end is given up.
const LONGEST: usize = 256;

/// What has come from the terminal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// A key that has a name.
    Key(Key),
    /// The mouse did something at a cell.
    Pointer(Pointer, Position),
    /// The terminal answers what it can do.
    Answer(Answer),
}

/// The start of a byte string: how many bytes it takes and what they mean, or that more are needed.
enum Start {
    Incomplete,
    Taken(usize, Option<Input>),
}

/// Puts together what comes in pieces.
#[derive(Default)]
pub struct Decoder {
    bytes: Vec<u8>,
}

impl Decoder {
    /// Takes what one read has given, `more` if there may be more to read at once. A sequence may be cut anywhere but
    /// after its ESC: without more to read that is the key.
    pub fn push(&mut self, read: &[u8], more: bool) -> Vec<Input> {
        self.bytes.extend_from_slice(read);
        let mut inputs = Vec::new();
        let mut at = 0;
        while at < self.bytes.len() {
            match start(&self.bytes[at..], more) {
                Start::Taken(length, input) => {
                    inputs.extend(input);
                    at += length.max(1);
                }
                Start::Incomplete if self.bytes.len() - at > LONGEST => at += 1,
                Start::Incomplete => break,
            }
        }
        self.bytes.drain(..at);
        inputs
    }
}

fn start(bytes: &[u8], more: bool) -> Start {
    let key = |name: &str| Start::Taken(1, named(name));
    match *bytes {
        [b'\x1b'] if more => Start::Incomplete,
        [b'\x1b', b'[', ..] => control_sequence(bytes),
        [] | [b'\x1b', b'O' | b'_'] => Start::Incomplete,
        [b'\x1b', b'O', last, ..] => match letter(last, false) {
            Some(input) => Start::Taken(3, Some(input)),
            None => key("esc"),
        },
        [b'\x1b', b'_', b'G', ..] => graphics_answer(bytes),
        [b'\x1b', ..] => key("esc"),
        [b'\r', ..] => key("enter"),
        [b'\t', ..] => key("tab"),
        [0x7F, ..] => key("backspace"),
        [0, ..] => key("c- "),
        [byte @ 1..=26, ..] => key(&format!("c-{}", char::from(byte - 1 + b'a'))),
        [0..0x20, ..] => Start::Taken(1, None),
        _ => character(bytes),
    }
}

/// One character in UTF-8.
fn character(bytes: &[u8]) -> Start {
    let length = match bytes[0] {
        0xC0..=0xDF => 2,
        0xE0..=0xEF => 3,
        0xF0..=0xF7 => 4,
        _ => 1,
    };
    let Some(encoded) = bytes.get(..length) else {
        return Start::Incomplete;
    };
    match std::str::from_utf8(encoded).map(|text| text.chars().next()) {
        Ok(Some(c)) if !c.is_control() => Start::Taken(length, Some(Input::Key(Key::of_char(c)))),
        Ok(_) => Start::Taken(length, None),
        Err(_) => Start::Taken(1, None),
    }
}

/// `ESC [ parameters letter`, and the two older forms of which the parameters come after the letter.
fn control_sequence(bytes: &[u8]) -> Start {
    match bytes.get(2) {
        None => return Start::Incomplete,
        // The Linux console's first five function keys.
        Some(b'[') => {
            return match bytes.get(3) {
                None => Start::Incomplete,
                Some(last @ b'A'..=b'E') => {
                    Start::Taken(4, named(&format!("f{}", last - b'A' + 1)))
                }
                Some(_) => Start::Taken(3, None),
            };
        }
        Some(b'M') => {
            return match bytes.get(3..6) {
                None => Start::Incomplete,
                Some(mouse) => {
                    let [button, x, y] = [0, 1, 2].map(|i| u16::from(mouse[i]).saturating_sub(32));
                    Start::Taken(
                        6,
                        pointer(button, x, y, button & 3 == 3 && button & 32 == 0),
                    )
                }
            };
        }
        Some(_) => {}
    }
    let end = bytes[2..]
        .iter()
        .position(|byte| !(0x20..0x40).contains(byte));
    let Some(end) = end.map(|end| end + 2) else {
        return Start::Incomplete;
    };
    let last = bytes[end];
    if !(0x40..0x7F).contains(&last) {
        // Something else begins within it.
        return Start::Taken(end, None);
    }
    let parameters = std::str::from_utf8(&bytes[2..end]).unwrap_or_default();
    Start::Taken(end + 1, sequence(parameters, last))
}

fn sequence(parameters: &str, last: u8) -> Option<Input> {
    let private = parameters.chars().next().filter(|c| "<=>?".contains(*c));
    let numbers: Vec<u16> = parameters
        .trim_start_matches(['<', '=', '>', '?'])
        .split(';')
        .map(|number| number.parse().unwrap_or(0))
        .collect();
    let shift = numbers
        .get(1)
        .is_some_and(|held| held.saturating_sub(1) & 1 == 1);
    match (private, last, &numbers[..]) {
        (Some('<'), b'M' | b'm', &[button, x, y]) => pointer(button, x, y, last == b'm'),
        (None, b'M', &[button, x, y]) => {
            let button = button.saturating_sub(32);
            pointer(button, x, y, button & 3 == 3 && button & 32 == 0)
        }
        (Some('?'), b'c', attributes) => {
            // The first is the terminal's class.
            let sixel = attributes.iter().skip(1).any(|&attribute| attribute == 4);
            Some(Input::Answer(Answer::Attributes { sixel }))
        }
        (None, b't', &[6, height, width]) if width > 0 && height > 0 => {
            Some(Input::Answer(Answer::Cell((width, height))))
        }
        (None, b'~', &[key, ..]) => numbered(key, shift),
        (None, _, [..=1] | [1, _]) => letter(last, shift),
        _ => None,
    }
}

/// Keys of which the sequence ends in a letter.
fn letter(last: u8, shift: bool) -> Option<Input> {
    let name = match last {
        b'A' => "up",
        b'B' => "down",
        b'C' => "right",
        b'D' => "left",
        b'H' => "home",
        b'F' => "end",
        b'P'..=b'S' => return named(&format!("f{}", last - b'P' + 1)),
        b'Z' => return named("s-tab"),
        _ => return None,
    };
    held(name, shift)
}

/// Keys of which the sequence is a number and `~`.
fn numbered(key: u16, shift: bool) -> Option<Input> {
    let name = match key {
        1 | 7 => "home",
        4 | 8 => "end",
        3 => "delete",
        5 => "pageup",
        6 => "pagedown",
        11..=15 => return named(&format!("f{}", key - 10)),
        17..=21 => return named(&format!("f{}", key - 11)),
        23 | 24 => return named(&format!("f{}", key - 12)),
        _ => return None,
    };
    held(name, shift)
}

fn held(name: &str, shift: bool) -> Option<Input> {
    let prefix = if shift { "s-" } else { "" };
    named(&format!("{prefix}{name}"))
}

fn named(name: &str) -> Option<Input> {
    Key::named(name).ok().map(Input::Key)
}

/// A mouse report: the button's low bits, 32 for a movement, 64 for the wheel; cells count from 1.
fn pointer(button: u16, x: u16, y: u16, up: bool) -> Option<Input> {
    // Shift, Alt and Control change nothing.
    let pointer = match (button & !0b1_1100, up) {
        (0 | 3, true) => Pointer::Release,
        (0, false) => Pointer::Press,
        (32, false) => Pointer::Drag,
        (64, false) => Pointer::Wheel(-1),
        (65, false) => Pointer::Wheel(1),
        _ => return None,
    };
    let at = Position::new(x.checked_sub(1)?, y.checked_sub(1)?);
    Some(Input::Pointer(pointer, at))
}

/// `ESC _ G i=31;OK ESC \`: whether the terminal takes images, and deflated ones under the id 32.
fn graphics_answer(bytes: &[u8]) -> Start {
    let Some(end) = bytes.windows(2).position(|pair| pair == b"\x1b\\") else {
        return Start::Incomplete;
    };
    let answer = match &bytes[3..end] {
        b"i=31;OK" => Some(Input::Answer(Answer::Kitty)),
        b"i=32;OK" => Some(Input::Answer(Answer::KittyZlib)),
        _ => None,
    };
    Start::Taken(end + 2, answer)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn decoded(bytes: &[u8]) -> Vec<Input> {
        Decoder::default().push(bytes, false)
    }

    /// Names of the keys that the bytes are, if they are nothing but keys.
    fn keys(bytes: &[u8]) -> String {
        let name = |input: Input| match input {
            Input::Key(key) => key.to_string(),
            other => format!("{other:?}"),
        };
        decoded(bytes).into_iter().map(name).collect()
    }

    #[test]
    fn keys_have_the_names_of_the_keymap() {
        assert_eq!(keys(b"lG <\xC3\xA4"), "lG<space><ä");
        assert_eq!(
            keys(b"\r\t\x7F\x12\x0B"),
            "<enter><tab><backspace><c-r><c-k>"
        );
        assert_eq!(keys(b"\x1b[A\x1b[B\x1bOC\x1b[D"), "<up><down><right><left>");
        assert_eq!(
            keys(b"\x1b[1;2D\x1b[1;2C\x1b[Z"),
            "<s-left><s-right><s-tab>"
        );
        // With control they are what they are without.
        assert_eq!(keys(b"\x1b[1;5D\x1b[1;6C"), "<left><s-right>");
        assert_eq!(
            keys(b"\x1b[H\x1b[4~\x1b[7~\x1bOF"),
            "<home><end><home><end>"
        );
        assert_eq!(
            keys(b"\x1b[3~\x1b[5~\x1b[6;2~"),
            "<delete><pageup><s-pagedown>"
        );
        assert_eq!(keys(b"\x1bOP\x1b[[A\x1b[11~\x1b[15~"), "<f1><f1><f1><f5>");
        assert_eq!(keys(b"\x1b[17~\x1b[24~\x1b[1;2R"), "<f6><f12><f3>");
    }

    #[test]
    fn an_escape_that_begins_nothing_is_the_key() {
        assert_eq!(keys(b"\x1b"), "<esc>");
        assert_eq!(keys(b"\x1bq"), "<esc>q");
        assert_eq!(keys(b"\x1b\x1b[A"), "<esc><up>");
        let mut decoder = Decoder::default();
        assert_eq!(decoder.push(b"\x1b", true), []);
        assert_eq!(decoder.push(b"[A", false).len(), 1);
    }

    #[test]
    fn what_no_key_has_is_passed_over() {
        assert_eq!(keys(b"a\x1b[2~b\x1b[99;99;99xc\x1b[200~d"), "abcd");
        assert_eq!(keys(b"a\xFFb\x1b[1\x1b[Ac"), "ab<up>c");
        // A sequence that never ends holds nothing back for long.
        let mut endless = b"\x1b_G".to_vec();
        endless.extend([b'1'; LONGEST]);
        let mut decoder = Decoder::default();
        decoder.push(&endless, false);
        assert_eq!(decoder.push(b"q", false).len(), 1);
    }

    #[test]
    fn the_mouse_presses_drags_lets_go_and_turns() {
        let at = Position::new(4, 2);
        for (bytes, pointer) in [
            (&b"\x1b[<0;5;3M"[..], Pointer::Press),
            (b"\x1b[<32;5;3M", Pointer::Drag),
            (b"\x1b[<0;5;3m", Pointer::Release),
            (b"\x1b[<64;5;3M", Pointer::Wheel(-1)),
            (b"\x1b[<65;5;3M", Pointer::Wheel(1)),
            (b"\x1b[<4;5;3M", Pointer::Press),
            (b"\x1b[M \x25\x23", Pointer::Press),
            (b"\x1b[M#\x25\x23", Pointer::Release),
            (b"\x1b[32;5;3M", Pointer::Press),
            (b"\x1b[35;5;3M", Pointer::Release),
        ] {
            assert_eq!(decoded(bytes), [Input::Pointer(pointer, at)], "{bytes:?}");
        }
        // Other buttons, and movements without one.
        assert_eq!(decoded(b"\x1b[<2;5;3M\x1b[<35;5;3M\x1b[<0;0;0M"), []);
    }

    #[test]
    fn answers_are_found_among_keys() {
        let typed = b"a\x1b_Gi=31;OK\x1b\\b\x1b[6;20;10tc\x1b[?62;4;22cd";
        let (answers, keys): (Vec<Input>, Vec<Input>) = decoded(typed)
            .into_iter()
            .partition(|input| matches!(input, Input::Answer(_)));
        let expected = [
            Answer::Kitty,
            Answer::Cell((10, 20)),
            Answer::Attributes { sixel: true },
        ];
        assert_eq!(answers, expected.map(Input::Answer));
        assert_eq!(keys.len(), 4);
        let plain = [Input::Answer(Answer::Attributes { sixel: false })];
        assert_eq!(decoded(b"\x1b[?1;2c"), plain);
        assert_eq!(decoded(b"\x1b[?4;6c"), plain);
        assert_eq!(decoded(b"\x1b_Gi=31;ENOTSUPPORTED:no\x1b\\"), []);
    }

    proptest! {
        #[test]
        fn cutting_a_sequence_anywhere_but_after_its_escape_changes_nothing(cut in 0..60_usize) {
            let typed = b"a\x1b_Gi=31;OK\x1b\\\xC3\xA4\x1b[1;2D\x1b[<0;5;3Mz\x1b[?62;4c".to_vec();
            let cut = cut.min(typed.len());
            let mut decoder = Decoder::default();
            let mut pieces = decoder.push(&typed[..cut], true);
            pieces.extend(decoder.push(&typed[cut..], false));
            prop_assert_eq!(pieces, decoded(&typed));
        }

        #[test]
        fn any_bytes_are_taken(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            let mut decoder = Decoder::default();
            decoder.push(&bytes, false);
            prop_assert!(decoder.bytes.len() <= LONGEST);
        }
    }
}
