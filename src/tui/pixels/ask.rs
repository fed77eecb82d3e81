//! What a terminal can show, asked of it and told by the environment.
//!
//! The question goes out before the first frame and nobody waits: frames are half-blocks until the answers have come,
//! among the keys. The last question is one that every terminal answers, so after it nothing more is to come, but from
//! behind tmux.

use ratatui_image::picker::ProtocolType;

use super::tmux;

/// Width and height of a cell in pixels.
pub type CellSize = (u16, u16);

/// Taken where the terminal does not tell; kitty fits an image into its cells whatever their size.
const USUAL_CELL: CellSize = (10, 20);

/// One answer of the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It takes kitty's images.
    Kitty,
    /// Also deflated.
    KittyZlib,
    /// A cell has so many pixels.
    Cell(CellSize),
    /// Its attributes, with sixel among them or not: the last answer.
    Attributes {
        /// Whether it draws sixels.
        sixel: bool,
    },
}

/// How images are to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Graphics {
    /// The protocol; never half-blocks.
    pub protocol: ProtocolType,
    /// Pixels of a cell.
    pub cell: CellSize,
    /// Whether kitty's images may be deflated.
    pub zlib: bool,
    /// Whether tmux has to pass the images on.
    pub tmux: bool,
}

/// What the environment tells of the terminal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Host {
    /// tmux is in between.
    pub tmux: bool,
    /// It is one that takes iTerm2's images but cannot be asked whether it does.
    pub iterm2: bool,
    /// It answers as if it had kitty's placeholders or sixel, but draws them wrongly.
    pub boasts: bool,
    /// Pixels of a cell, where the system knows.
    pub cell: Option<CellSize>,
}

impl Host {
    /// Reads the environment.
    pub fn of(variable: impl Fn(&str) -> Option<String>, cell: Option<CellSize>) -> Self {
        const ITERM2: [&str; 9] = [
            "iTerm", "WezTerm", "mintty", "vscode", "Tabby", "Hyper", "rio", "Bobcat", "Warp",
        ];
        let set = |name: &str| variable(name).filter(|value| !value.is_empty());
        let program = set("TERM_PROGRAM").unwrap_or_default();
        let tmux = tmux::is_inside(&variable);
        let wezterm = set("WEZTERM_EXECUTABLE").is_some();
        Self {
            tmux,
            iterm2: ITERM2.iter().any(|name| program.contains(name))
                || set("LC_TERMINAL").is_some_and(|name| name.contains("iTerm"))
                || tmux && (set("ITERM_SESSION_ID").is_some() || wezterm),
            boasts: wezterm || set("KONSOLE_VERSION").is_some(),
            cell,
        }
    }

    /// A protocol that was asked for by name; none for half-blocks.
    pub fn forced(self, protocol: ProtocolType) -> Option<Graphics> {
        (protocol != ProtocolType::Halfblocks).then(|| Graphics {
            protocol,
            cell: self.cell.unwrap_or(USUAL_CELL),
            zlib: true,
            tmux: self.tmux,
        })
    }

    /// The questions: the size of a cell, kitty's images (deflated and not, a pixel each that is not shown), and the
    /// attributes. These are asked of tmux itself: it keeps the answer of the terminal behind it.
    pub fn question(self) -> Vec<u8> {
        let mut questions = b"\x1b[16t".to_vec();
        if !self.boasts {
            questions
                .extend_from_slice(b"\x1b_Gi=32,s=1,v=1,a=q,t=d,f=24,o=z;eJxjYGAAAAADAAE=\x1b\\");
            questions.extend_from_slice(b"\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\");
        }
        let mut out = Vec::new();
        tmux::pass(&mut out, &questions, self.tmux);
        out.extend_from_slice(b"\x1b[c");
        out
    }
}

/// The answers so far.
#[derive(Clone, Copy, Debug)]
pub struct Asking {
    host: Host,
    kitty: bool,
    zlib: bool,
    cell: Option<CellSize>,
    sixel: Option<bool>,
    decided: Option<Graphics>,
}

impl Asking {
    /// Before the first of them.
    pub fn new(host: Host) -> Self {
        Self {
            host,
            kitty: false,
            zlib: false,
            cell: host.cell,
            sixel: None,
            decided: None,
        }
    }

    /// Takes an answer; what is to be used from now on, once that is known or when it changes. Kitty's images are
    /// preferred, since they alone need not be sent again, then sixel, which more terminals draw well than iTerm2's.
    pub fn take(&mut self, answer: Answer) -> Option<Graphics> {
        match answer {
            Answer::Kitty => self.kitty = true,
            Answer::KittyZlib => self.zlib = true,
            Answer::Cell(cell) => self.cell = Some(cell),
            Answer::Attributes { sixel } => self.sixel = Some(sixel),
        }
        // Both others are drawn pixel by pixel, and only once it is known that kitty's images will not be.
        let others = self.sixel.filter(|_| self.cell.is_some());
        let protocol = match others {
            _ if self.kitty && !self.host.boasts => ProtocolType::Kitty,
            Some(true) if !self.host.boasts && !self.host.tmux => ProtocolType::Sixel,
            Some(_) if self.host.iterm2 => ProtocolType::Iterm2,
            _ => return None,
        };
        let graphics = Graphics {
            protocol,
            cell: self.cell.unwrap_or(USUAL_CELL),
            zlib: self.zlib,
            tmux: self.host.tmux,
        };
        (self.decided.replace(graphics) != Some(graphics)).then_some(graphics)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATTRIBUTES: Answer = Answer::Attributes { sixel: false };

    fn taken(host: Host, answers: &[Answer]) -> Option<Graphics> {
        let mut asking = Asking::new(host);
        answers
            .iter()
            .filter_map(|&answer| asking.take(answer))
            .last()
    }

    fn protocol(host: Host, answers: &[Answer]) -> Option<ProtocolType> {
        taken(host, answers).map(|graphics| graphics.protocol)
    }

    #[test]
    fn kitty_comes_before_sixel_before_iterm2_before_nothing() {
        let plain = Host::default();
        let sixel = Answer::Attributes { sixel: true };
        let cell = Answer::Cell((9, 18));
        let graphics = taken(plain, &[Answer::Kitty, Answer::KittyZlib, cell, sixel]);
        let expected = Graphics {
            protocol: ProtocolType::Kitty,
            cell: (9, 18),
            zlib: true,
            tmux: false,
        };
        assert_eq!(graphics, Some(expected));
        assert_eq!(protocol(plain, &[cell, sixel]), Some(ProtocolType::Sixel));
        assert_eq!(protocol(plain, &[cell, ATTRIBUTES]), None);
        let iterm2 = Host {
            iterm2: true,
            ..plain
        };
        assert_eq!(
            protocol(iterm2, &[cell, ATTRIBUTES]),
            Some(ProtocolType::Iterm2)
        );
        // Pixels that no cell is known to hold cannot be drawn.
        assert_eq!(protocol(plain, &[sixel]), None);
    }

    #[test]
    fn an_answer_after_the_last_one_still_counts_once() {
        // tmux gives its attributes before the terminal behind it has answered anything.
        let tmux = Host {
            tmux: true,
            iterm2: true,
            cell: Some((8, 16)),
            ..Host::default()
        };
        let mut asking = Asking::new(tmux);
        let mut protocol = |answer| asking.take(answer).map(|graphics| graphics.protocol);
        let sixel = Answer::Attributes { sixel: true };
        assert_eq!(protocol(sixel), Some(ProtocolType::Iterm2));
        assert_eq!(protocol(Answer::Kitty), Some(ProtocolType::Kitty));
        assert_eq!(protocol(Answer::Kitty), None);
    }

    #[test]
    fn answers_in_another_order_come_to_the_same() {
        let answers = [
            Answer::Kitty,
            Answer::KittyZlib,
            Answer::Cell((9, 18)),
            ATTRIBUTES,
        ];
        let mut backwards = answers;
        backwards.reverse();
        let host = Host::default();
        assert_eq!(taken(host, &answers), taken(host, &backwards));
        assert!(taken(host, &answers).is_some_and(|graphics| graphics.zlib));
    }

    #[test]
    fn who_boasts_is_not_believed() {
        let konsole = Host::of(
            |name| (name == "KONSOLE_VERSION").then(|| "230805".to_owned()),
            Some((8, 16)),
        );
        assert!(konsole.boasts);
        let answers = [Answer::Kitty, Answer::Attributes { sixel: true }];
        assert_eq!(protocol(konsole, &answers), None);
        assert!(!konsole.question().windows(2).any(|pair| pair == b"_G"));
    }

    #[test]
    fn every_terminal_has_something_to_answer_at_the_end() {
        assert!(Host::default().question().ends_with(b"\x1b[c"));
        let tmux = Host {
            tmux: true,
            ..Host::default()
        };
        assert!(tmux.question().starts_with(b"\x1bPtmux;\x1b\x1b[16t"));
        assert!(tmux.question().ends_with(b"\x1b\x1b\\\x1b\\\x1b[c"));
    }

    #[test]
    fn a_protocol_can_be_forced() {
        let host = Host::default();
        let forced = host.forced(ProtocolType::Kitty);
        assert_eq!(forced.map(|it| it.cell), Some(USUAL_CELL));
        assert_eq!(host.forced(ProtocolType::Halfblocks), None);
    }
}
