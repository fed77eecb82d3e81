//! A step in the terminal until a browser has it, and one in a browser until the terminal has drawn it, of one session:
//! `view --serve` in a terminal of its own, made by `script`, and a viewer over its websocket.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench may stop, and prints"
)]

use std::io::{Read, Write};
use std::net::TcpListener;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};
use tokio::time::{sleep, timeout};
use tokio_tungstenite::tungstenite::Message;

use self::viewer::{connect, step_in};

#[path = "viewer.rs"]
mod viewer;

const ROWS: u16 = 30;
const COLUMNS: u16 = 100;
const ROUNDS: usize = 200;

fn main() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let program = env!("CARGO_BIN_EXE_poescope");
    let line = format!(
        "stty rows {ROWS} cols {COLUMNS}; exec {program} view --images halfblocks --serve 127.0.0.1:{port}"
    );
    let mut terminal = Command::new("script")
        .args(["-qec", &line, "/dev/null"])
        .env("TERM", "xterm-256color")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut keys, mut drawn) = (
        terminal.stdin.take().unwrap(),
        terminal.stdout.take().unwrap(),
    );
    let (sender, screens) = unbounded_channel();
    std::thread::spawn(move || {
        let mut parser = vt100::Parser::new(ROWS, COLUMNS, 0);
        let mut bytes = vec![0; 1 << 16];
        while let Ok(count @ 1..) = drawn.read(&mut bytes) {
            parser.process(&bytes[..count]);
            let _ = sender.send((parser.screen().contents(), Instant::now()));
        }
    });
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(measure(port, &mut keys, screens));
    keys.write_all(b"q").unwrap();
    terminal.wait().unwrap();
}

async fn measure(
    port: u16,
    keys: &mut impl Write,
    mut screens: UnboundedReceiver<(String, Instant)>,
) {
    sleep(Duration::from_secs(3)).await;
    // What a viewer uses is not sent back to it at once, so one drives and another one looks.
    let (mut browser, mut own) = connect(port).await.split();
    tokio::spawn(async move { while own.next().await.is_some() {} });
    let (_looks, mut frames) = connect(port).await.split();
    let (sender, mut steps) = unbounded_channel();
    tokio::spawn(async move {
        while let Some(Ok(message)) = frames.next().await {
            let at = Instant::now();
            if let Message::Binary(frame) = message
                && let Some(step) = step_in(&frame)
            {
                let _ = sender.send((step, at));
            }
        }
    });
    sleep(Duration::from_secs(1)).await;
    let (mut to_browser, mut to_terminal) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        // Both begin at step 2 and go to step 3.
        set(&mut browser, 2).await;
        sleep(Duration::from_millis(120)).await;
        while screens.try_recv().is_ok() || steps.try_recv().is_ok() {}
        let asked = Instant::now();
        if round % 2 == 0 {
            keys.write_all(b"l").unwrap();
            keys.flush().unwrap();
            let found = until(&mut steps, |step: &f64| (step - 3.0).abs() < 0.5).await;
            to_browser.push(found - asked);
        } else {
            set(&mut browser, 3).await;
            let found = until(&mut screens, |screen: &String| {
                screen.contains("step  3/16")
            })
            .await;
            to_terminal.push(found - asked);
        }
    }
    println!(
        "key in the terminal, step at the browser: {}",
        told(to_browser)
    );
    println!(
        "step of the browser, on the terminal: {}",
        told(to_terminal)
    );
}

async fn set(browser: &mut (impl SinkExt<Message, Error: std::fmt::Debug> + Unpin), step: u64) {
    let update = serde_json::json!({
        "type": "GuiUpdateMessage", "uuid": "poescope-step", "updates": { "value": step }
    });
    let bytes = rmp_serde::to_vec_named(&update).unwrap();
    browser.send(Message::Binary(bytes.into())).await.unwrap();
}

/// When something was seen that holds.
async fn until<T>(
    seen: &mut UnboundedReceiver<(T, Instant)>,
    holds: impl Fn(&T) -> bool,
) -> Instant {
    let wait = async {
        loop {
            let (what, at) = seen.recv().await.unwrap();
            if holds(&what) {
                return at;
            }
        }
    };
    timeout(Duration::from_secs(5), wait).await.unwrap()
}

fn told(mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize].as_secs_f64() * 1e3;
    format!(
        "p50 {:.1} ms, p95 {:.1} ms, most {:.1} ms",
        at(0.5),
        at(0.95),
        at(1.0)
    )
}
