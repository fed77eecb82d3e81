//! tmux between us and the terminal: it keeps to itself what it does not know, unless told to pass it on.

use std::process::{Command, Stdio};

/// Whether the environment says that tmux draws our screen. Over SSH only `TERM` is left of it.
pub fn is_inside(variable: impl Fn(&str) -> Option<String>) -> bool {
    let starts = |name: &str| variable(name).is_some_and(|value| value.starts_with("tmux"));
    let set = |name: &str| variable(name).is_some_and(|value| !value.is_empty());
    starts("TERM") || starts("TERM_PROGRAM") || set("TMUX")
}

/// Asks tmux to let sequences of this pane through, which it does not by itself: what is copied, and images. Where it
/// refuses, or is on another machine, the terminal does not answer what it can do, and no images are sent.
pub fn let_through() {
    let _ = Command::new("tmux")
        .args(["set", "-p", "allow-passthrough", "on"])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
}

/// Appends a sequence, wrapped for the terminal behind tmux if it is there: every ESC doubled.
pub fn pass(out: &mut Vec<u8>, sequence: &[u8], tmux: bool) {
    if !tmux {
        out.extend_from_slice(sequence);
        return;
    }
    out.extend_from_slice(b"\x1bPtmux;");
    for &byte in sequence {
        if byte == b'\x1b' {
            out.push(byte);
        }
        out.push(byte);
    }
    out.extend_from_slice(b"\x1b\\");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_escape_is_doubled_but_those_of_the_wrapping() {
        let mut out = b"before".to_vec();
        pass(&mut out, b"\x1b_Ga=d\x1b\\", true);
        assert_eq!(out, b"before\x1bPtmux;\x1b\x1b_Ga=d\x1b\x1b\\\x1b\\");
        let mut out = Vec::new();
        pass(&mut out, b"\x1b[c", false);
        assert_eq!(out, b"\x1b[c");
    }

    #[test]
    fn tmux_is_known_by_any_of_its_variables() {
        let inside = |name: &'static str, value: &'static str| {
            is_inside(move |asked| (asked == name).then(|| value.to_owned()))
        };
        assert!(inside("TERM", "tmux-256color"));
        assert!(inside("TERM_PROGRAM", "tmux"));
        assert!(inside("TMUX", "/run/tmux,1,0"));
        assert!(!inside("TMUX", "") && !inside("TERM", "xterm-kitty"));
    }
}
