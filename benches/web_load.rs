//! One viewer drives at 30 Hz while 64 watch: how long until a watcher has the step, and what the server needs.
//!
//! ```text
//! cargo bench --bench web_load                      a minute
//! cargo bench --bench web_load -- --seconds 600     the soak: memory minute by minute
//! cargo bench --bench web_load -- --stalled 1       so many viewers more, who take nothing
//! ```
//! Times are from just before the driver's message is written to just after a watcher has read the frame with that
//! step; the first of the watchers tells when the server sent it. Eight watchers look into each frame; the others only
//! read, since all of this shares the machine with the server.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench may stop, and prints"
)]

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use tokio::net::TcpStream;
use tokio::sync::mpsc::{UnboundedSender, unbounded_channel};
use tokio::time::{interval, sleep};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::Message;

use self::viewer::{connect, step_in};

#[path = "viewer.rs"]
mod viewer;

const WATCHERS: usize = 64;
/// Every so many watchers look into their frames.
const LOOKS: usize = 8;
const PERIOD: Duration = Duration::from_nanos(1_000_000_000 / 30);

fn main() {
    let number = |name: &str, default: u64| {
        let mut arguments = std::env::args().skip_while(|argument| argument != name);
        arguments
            .nth(1)
            .map_or(default, |text| text.parse().unwrap())
    };
    let (seconds, stalled) = (number("--seconds", 60), number("--stalled", 0));
    let (mut server, port) = start();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(load(server.id(), port, seconds, stalled));
    server.kill().unwrap();
    server.wait().unwrap();
}

fn start() -> (Child, u16) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poescope"));
    let mut server = command
        .args(["serve", "--port", "0"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(server.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    let port = line
        .trim()
        .trim_end_matches('/')
        .rsplit(':')
        .next()
        .unwrap();
    (server, port.parse().unwrap())
}

/// Kilobytes of a process, by the name of the line.
fn kilobytes(pid: u32, line: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
    let found = status.lines().find_map(|text| text.strip_prefix(line));
    found
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap()
        .parse()
        .unwrap()
}

/// Seconds of processor time of a process.
fn processor(pid: u32) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap();
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap()
        .split_whitespace()
        .collect();
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

async fn load(pid: u32, port: u16, seconds: u64, stalled: u64) {
    let (sender, mut seen) = unbounded_channel();
    for place in 0..WATCHERS {
        let sender = (place % LOOKS == 0).then(|| sender.clone());
        tokio::spawn(watch(connect(port).await, sender));
    }
    let mut asleep = Vec::new();
    for _ in 0..stalled {
        asleep.push(connect(port).await);
    }
    let (mut driver, mut back) = connect(port).await.split();
    tokio::spawn(async move { while back.next().await.is_some() {} });
    sleep(Duration::from_secs(2)).await;

    let (mut first, mut all) = (Vec::new(), Vec::new());
    let mut ticks = interval(PERIOD);
    let start = Instant::now();
    let (mut minute, mut before) = (0, processor(pid));
    let mut round = 0_u64;
    while start.elapsed() < Duration::from_secs(seconds) {
        ticks.tick().await;
        let step = 1 + round % 15;
        round += 1;
        let update = serde_json::json!({
            "type": "GuiUpdateMessage", "uuid": "poescope-step", "updates": { "value": step }
        });
        let asked = Instant::now();
        let bytes = rmp_serde::to_vec_named(&update).unwrap();
        driver.send(Message::Binary(bytes.into())).await.unwrap();
        let mut times = Vec::new();
        let wait = tokio::time::timeout(PERIOD * 9 / 10, async {
            while times.len() < WATCHERS / LOOKS {
                let (value, at): (f64, Instant) = seen.recv().await.unwrap();
                if (value - step as f64).abs() < 0.5 && at >= asked {
                    times.push(at - asked);
                }
            }
        });
        let _ = wait.await;
        times.resize(WATCHERS / LOOKS, PERIOD);
        first.push(*times.iter().min().unwrap());
        all.extend(times);
        if start.elapsed().as_secs() / 60 > minute {
            minute += 1;
            let (now, resident) = (processor(pid), kilobytes(pid, "VmRSS:"));
            println!(
                "minute {minute}: {resident} kB, {:.0} % of a core",
                (now - before) / 0.6
            );
            before = now;
        }
    }
    let gone = start.elapsed().as_secs_f64();
    println!("{round} steps, {WATCHERS} watchers, {stalled} stalled");
    println!("to the first watcher: {}", told(first));
    println!("to all: {}", told(all));
    println!("memory at most {} kB", kilobytes(pid, "VmHWM:"));
    if minute == 0 {
        println!(
            "{:.0} % of a core",
            100.0 * (processor(pid) - before) / gone
        );
    }
}

fn told(mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize].as_secs_f64() * 1e3;
    format!(
        "p50 {:.1} ms, p95 {:.1} ms, p99 {:.1} ms (a late one counts as 33)",
        at(0.5),
        at(0.95),
        at(0.99)
    )
}

async fn watch(
    mut socket: WebSocketStream<TcpStream>,
    seen: Option<UnboundedSender<(f64, Instant)>>,
) {
    while let Some(Ok(message)) = socket.next().await {
        let (Message::Binary(frame), Some(seen)) = (message, &seen) else {
            continue;
        };
        let at = Instant::now();
        if let Some(step) = step_in(&frame) {
            let _ = seen.send((step, at));
        }
    }
}
