//! `view --serve`: the terminal and a browser are two faces of one session. The program runs in a terminal of its own,
//! made by `script`, and what it draws is read as a screen.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use serde_json::json;

use super::client::{View, run};

/// The longest that anything may take.
const PATIENCE: Duration = Duration::from_secs(30);
const SIZE: (u16, u16) = (30, 100);

struct Terminal {
    child: Child,
    keys: ChildStdin,
    screen: Arc<Mutex<vt100::Parser>>,
}

impl Terminal {
    /// `poescope view` with these options.
    fn view(options: &str) -> Self {
        let program = env!("CARGO_BIN_EXE_poescope");
        let (rows, columns) = SIZE;
        let line = format!(
            "stty rows {rows} cols {columns}; exec {program} view --images halfblocks {options}"
        );
        let mut child = Command::new("script")
            .args(["-qec", &line, "/dev/null"])
            .env("TERM", "xterm-256color")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (keys, mut drawn) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let screen = Arc::new(Mutex::new(vt100::Parser::new(rows, columns, 0)));
        let parser = Arc::clone(&screen);
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = drawn.read(&mut bytes) {
                parser.lock().unwrap().process(&bytes[..count]);
            }
        });
        Self {
            child,
            keys,
            screen,
        }
    }

    fn press(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).unwrap();
        self.keys.flush().unwrap();
    }

    /// Waits until a text is on the screen.
    fn shows(&self, text: &str) {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let screen = self.screen.lock().unwrap().screen().contents();
            if screen.contains(text) {
                return;
            }
            assert!(Instant::now() < deadline, "no {text:?} in:\n{screen}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Where it has ended by itself there is nothing to end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port()
}

fn serving(port: u16) {
    let deadline = Instant::now() + PATIENCE;
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(Instant::now() < deadline, "nobody at port {port}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_switch_in_one_face_shows_in_the_other() {
    let port = free_port();
    let mut terminal = Terminal::view(&format!("--serve 127.0.0.1:{port}"));
    serving(port);
    terminal.shows("vision  ● on");
    // A screen opens on the first predicted step.
    terminal.shows("step  5/16");
    run(async {
        let mut browser = View::come_to(port).await;
        browser.set("poescope-switch-vision", &json!(false)).await;
        terminal.shows("vision  ○ off");
        browser.set("poescope-step", &json!(7)).await;
        terminal.shows("step  7/16");
        terminal.press("1l");
        let back = |view: &View| view.value("poescope-switch-vision") == json!(true);
        browser.until("the terminal's switch", back).await;
        let on = |view: &View| view.value("poescope-step") == json!(8.0);
        browser.until("the terminal's step", on).await;
    });
    terminal.press("?");
    terminal.shows(&format!("in a browser: http://127.0.0.1:{port}/"));
    terminal.press("\u{1b}");
    terminal.press("q");
    assert!(terminal.child.wait().unwrap().success());
}

#[test]
fn who_may_only_look_changes_nothing() {
    let port = free_port();
    let mut terminal = Terminal::view(&format!("--serve 127.0.0.1:{port} --read-only"));
    serving(port);
    run(async {
        let mut browser = View::come_to(port).await;
        browser.set("poescope-switch-vision", &json!(false)).await;
        browser.set("poescope-step", &json!(7)).await;
        terminal.press("l");
        let on = |view: &View| view.meta()["step"] == 5;
        browser.until("the terminal's step", on).await;
        terminal.shows("vision  ● on");
        terminal.shows("step  6/16");
    });
}
