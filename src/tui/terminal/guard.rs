//! Gives the terminal back as it was: when dropped, and before a panic is told.

use std::io::{self, stdout};
use std::panic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, ThreadId};

use crossterm::event::{DisableMouseCapture, EnableMouseCapture};
use crossterm::execute;
use crossterm::terminal::{
    EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode,
    enable_raw_mode,
};
use crossterm::{cursor, style};
use signal_hook::consts::SIGTSTP;

/// Whether there is a terminal to give back.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// The terminal in raw mode on its other screen, for as long as this lives.
pub struct Guard(());

impl Guard {
    /// Takes the terminal over.
    pub fn enter() -> io::Result<Self> {
        tell_panics_on_the_usual_screen(thread::current().id());
        // Also if it is taken by half only, there is something to give back.
        let guard = Self(());
        take_over()?;
        Ok(guard)
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        give_back();
        // A thread that is panicking may not change the hook, and the process is about to end.
        if !thread::panicking() {
            let _ = panic::take_hook();
        }
    }
}

/// Gives the terminal back, stops the process as Ctrl-Z would, and takes the terminal over again when it goes on.
pub fn suspend() -> io::Result<()> {
    give_back();
    signal_hook::low_level::emulate_default_handler(SIGTSTP)?;
    take_over()
}

fn take_over() -> io::Result<()> {
    enable_raw_mode()?;
    TAKEN.store(true, Ordering::SeqCst);
    execute!(
        stdout(),
        EnterAlternateScreen,
        EnableMouseCapture,
        cursor::Hide
    )
}

/// Once only: leaving the other screen a second time would move the cursor over what was printed since. Every step
/// is tried: a terminal that refuses one of them may still take the next.
fn give_back() {
    if !TAKEN.swap(false, Ordering::SeqCst) {
        return;
    }
    let _ = execute!(stdout(), EndSynchronizedUpdate, DisableMouseCapture);
    let _ = execute!(
        stdout(),
        style::ResetColor,
        LeaveAlternateScreen,
        cursor::Show
    );
    let _ = disable_raw_mode();
}

/// A panic of the face ends it, so it is told once the screen is the usual one again. One on another thread is
/// caught there and becomes a message; printing it would only tear the picture.
fn tell_panics_on_the_usual_screen(face: ThreadId) {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if thread::current().id() == face {
            give_back();
            usual(panic);
        }
    }));
}
