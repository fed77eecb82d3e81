//! One frame to the terminal: images, text and nothing half-done, in a single synchronized update.

use std::io::{self, Write};
use std::time::Duration;

use crossterm::clipboard::CopyToClipboard;
use crossterm::terminal::{BeginSynchronizedUpdate, EndSynchronizedUpdate};
use crossterm::{Command, queue};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::layout::{Rect, Size};

use crate::tui::app::App;
use crate::tui::draw;
use crate::tui::pixels::tmux;

/// How long a frame may wait for the images that it is the first to show: half of the time between two at 18 Hz.
const PATIENCE: Duration = Duration::from_millis(25);

/// What is drawn on.
pub struct Screen<W: Write> {
    terminal: Terminal<CrosstermBackend<W>>,
    tmux: bool,
}

impl<W: Write> Screen<W> {
    /// The whole terminal.
    pub fn whole(out: W) -> io::Result<Self> {
        let terminal = Terminal::new(CrosstermBackend::new(out))?;
        Ok(Self {
            terminal,
            tmux: false,
        })
    }

    /// So many cells of something that is no terminal.
    #[cfg(test)]
    pub fn fixed(out: W, size: Size) -> io::Result<Self> {
        let viewport = ratatui::Viewport::Fixed((ratatui::layout::Position::ORIGIN, size).into());
        let options = ratatui::TerminalOptions { viewport };
        let terminal = Terminal::with_options(CrosstermBackend::new(out), options)?;
        Ok(Self {
            terminal,
            tmux: false,
        })
    }

    /// Has what is copied also go past tmux, which as it is set by default keeps it to itself.
    pub fn copy_through_tmux(&mut self) {
        self.tmux = true;
    }

    /// Has all of it drawn anew: others have drawn on it meanwhile. `clear` of the terminal would ask it where the cursor
    /// is, and wait for an answer that comes among the keys.
    pub fn clear(&mut self) -> io::Result<()> {
        let size = self.terminal.size()?;
        self.terminal.resize(Rect::from(size))
    }

    /// Its cells.
    pub fn size(&self) -> io::Result<Size> {
        self.terminal.size()
    }

    /// Draws the app as it is now. Images go first: a placeholder whose image has not come yet would stay blank.
    pub fn show(&mut self, app: &mut App) -> io::Result<()> {
        let snapshot = app.session.snapshot();
        queue!(self.terminal.backend_mut(), BeginSynchronizedUpdate)?;
        self.terminal.autoresize()?;
        let mut frame = self.terminal.get_frame();
        draw(&mut frame, &snapshot, &app.face);
        let pixels = app.face.pixels.as_mut();
        if pixels.is_some_and(|pixels| pixels.wait(PATIENCE)) {
            frame.buffer_mut().reset();
            draw(&mut frame, &snapshot, &app.face);
        }
        if let Some(pixels) = &mut app.face.pixels {
            self.write(&pixels.to_send())?;
        }
        self.terminal.flush()?;
        self.terminal.swap_buffers();
        let out = self.terminal.backend_mut();
        queue!(out, EndSynchronizedUpdate)?;
        if let Some(state) = app.to_copy.take() {
            let mut sequence = String::new();
            // Writing to a string cannot fail.
            let _ = CopyToClipboard::to_clipboard_from(state).write_ansi(&mut sequence);
            let mut bytes = sequence.clone().into_bytes();
            if self.tmux {
                tmux::pass(&mut bytes, sequence.as_bytes(), true);
            }
            out.write_all(&bytes)?;
        }
        out.flush()
    }

    /// Writes something that moves no cell, to be sent with the next frame at the latest.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.terminal.backend_mut().write_all(bytes)
    }

    /// Sends what was written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.terminal.backend_mut().flush()
    }
}
