//! From a key to the picture, as a person at the terminal waits for it: the whole way through session, worker, drawing
//! and escape sequences, on the sample data and on episodes of 48 steps from the simulator.
//!
//! ```sh
//! cargo bench --bench inspection             # a table with p50 and p95
//! cargo bench --bench inspection -- --json   # the same for a script
//! ```

use std::hint::black_box;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use poescope::data::Dataset;
use poescope::episode::{EpisodeSource, Split};
use poescope::model::checkpoint;
use poescope::session::Session;
use poescope::session::keys::{Key, parse_script};
use poescope::session::predict::Predictor;
use poescope::session::snapshot::Snapshot;
use poescope::session::trained::{Origin, Trained};
use poescope::tui;
use poescope::tui::app::App;
use poescope::tui::face::Face;
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::layout::Size;
use serde_json::json;

const SCREEN: Size = Size::new(120, 40);
/// Longer than anything may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// A terminal that takes every byte and keeps none.
struct Nowhere;

impl Write for Nowhere {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(black_box(bytes).len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A session on it.
struct Bench {
    app: App,
    terminal: Terminal<CrosstermBackend<Nowhere>>,
    woken: Receiver<()>,
    before: Instant,
    /// Values of α that were used.
    used: u32,
}

impl Bench {
    fn new(source: Arc<dyn EpisodeSource>, models: Vec<Arc<dyn Predictor>>) -> Self {
        let mut session = Session::new(source, models);
        let (wake, woken) = channel();
        session.set_waker(Box::new(move || {
            let _ = wake.send(());
        }));
        let backend = CrosstermBackend::new(Nowhere);
        let options = ratatui::TerminalOptions {
            viewport: ratatui::Viewport::Fixed(ratatui::layout::Rect::new(
                0,
                0,
                SCREEN.width,
                SCREEN.height,
            )),
        };
        Self {
            app: App::new(session, Face::default(), SCREEN),
            terminal: Terminal::with_options(backend, options).expect("a terminal"),
            woken,
            before: Instant::now(),
            used: 0,
        }
    }

    fn draw(&mut self) -> Snapshot {
        let snapshot = self.app.session.snapshot();
        let face = &self.app.face;
        self.terminal
            .draw(|frame| tui::draw(frame, &snapshot, face))
            .expect("drawn");
        snapshot
    }

    /// Draws as the face does, until a picture shows what is waited for.
    fn until(&mut self, shown: impl Fn(&Snapshot) -> bool) {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let now = Instant::now();
            self.app.tick(now - self.before);
            self.before = now;
            if shown(&self.draw()) {
                return;
            }
            assert!(now < deadline, "nothing came");
            let _ = self.woken.recv_timeout(Duration::from_millis(50));
        }
    }

    fn settle(&mut self) {
        self.until(|snapshot| !snapshot.busy);
    }

    /// Seconds from each key of a script to the picture that shows it; before each key everything is computed.
    fn timed(&mut self, script: &str, times: usize, shown: impl Fn(&Snapshot) -> bool) -> Vec<f64> {
        let keys = parse_script(script).expect("keys");
        let each = keys.iter().cycle().take(keys.len() * times);
        each.map(|key| self.timed_key(key, &shown)).collect()
    }

    fn timed_key(&mut self, key: &Key, shown: impl Fn(&Snapshot) -> bool) -> f64 {
        self.settle();
        let start = Instant::now();
        self.app.press(key);
        self.until(&shown);
        start.elapsed().as_secs_f64()
    }

    /// Seconds from a key to the picture that shows it, with an α of the haptic expert that was never used before, so
    /// that nothing is remembered; `back` undoes the key.
    fn timed_anew(&mut self, key: &str, back: &str, times: usize) -> Vec<f64> {
        let key = &parse_script(key).expect("a key")[0];
        (0..times)
            .map(|_| {
                self.used += 1;
                let alpha = 0.3 + 0.001 * f64::from(self.used);
                self.press(&format!(":alpha<space>haptic<space>{alpha:.3}<enter>"));
                let secs = self.timed_key(key, |snapshot| snapshot.current);
                self.press(back);
                secs
            })
            .collect()
    }

    fn press(&mut self, script: &str) {
        for key in parse_script(script).expect("keys") {
            self.settle();
            self.app.press(&key);
        }
        self.settle();
    }
}

fn json_wanted() -> bool {
    std::env::args().any(|argument| argument == "--json")
}

fn percentile(secs: &mut [f64], part: f64) -> f64 {
    secs.sort_by(f64::total_cmp);
    secs[((secs.len() - 1) as f64 * part).round() as usize] * 1e3
}

#[expect(clippy::print_stdout, reason = "a bench speaks to its user")]
fn report(data: &str, what: &str, target: &str, mut secs: Vec<f64>) {
    let (p50, p95) = (percentile(&mut secs, 0.5), percentile(&mut secs, 0.95));
    if json_wanted() {
        let n = secs.len();
        println!(
            "{}",
            json!({"data": data, "what": what, "p50_ms": p50, "p95_ms": p95, "n": n})
        );
    } else {
        println!("| {data} | {what} | {p50:.2} | {p95:.2} | {target} |");
    }
}

fn model() -> Arc<dyn Predictor> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_data/v-h-p");
    let (model, probe) = checkpoint::load(&folder).expect("the sample model");
    let trained = Trained::new(model, probe, Origin::default()).expect("a model");
    Arc::new(trained)
}

/// Episodes of 48 steps from the simulator.
fn long_episodes(folder: &Path) -> Arc<dyn EpisodeSource> {
    let path = folder.join("long.mcap");
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_poescope"))
        .args([
            "simulate",
            "--episodes",
            "12",
            "--steps",
            "48",
            "--seed",
            "5",
        ])
        .args(["--split", Split::Test.name(), "--out"])
        .arg(&path)
        .status();
    assert!(status.expect("the simulator").success());
    Arc::new(Dataset::open(&path).expect("a dataset"))
}

fn measure(data: &str, source: &Arc<dyn EpisodeSource>) {
    let current = |snapshot: &Snapshot| snapshot.current;
    let mut bench = Bench::new(Arc::clone(source), vec![model()]);
    bench.settle();
    report(
        data,
        "scrub: a step on, overview",
        "16",
        bench.timed("llllhhhh", 25, current),
    );
    bench.press("llllllll");
    report(
        data,
        "switch to picture",
        "16",
        bench.timed_anew("1", "1", 100),
    );
    report(
        data,
        "predict from here",
        "16",
        bench.timed_anew("p", ":context<space>4<enter>", 50),
    );
    bench.press("vvvvv");
    // There is no belief before the second frame: there the lattice is of that one.
    let lattice = |s: &Snapshot| {
        let step = s.cursor.max(1);
        s.current && s.lattice.as_ref().is_some_and(|l| l.step == step)
    };
    let what = "lattice: a step on, its 15 frames";
    let steps = bench.timed("llll llll hhhh hhh l", 1, lattice);
    report(data, what, "16", steps);
    let mut secs = Vec::new();
    for i in 0..20 {
        // Another damage, and nothing of the lattice is known.
        bench.press(&format!(
            ":corrupt<space>haptic<space>noise<space>0.{:02}",
            10 + i
        ));
        let enter = &parse_script("<enter>").expect("a key")[0];
        secs.push(bench.timed_key(enter, |s| lattice(s) && !s.corruptions.is_empty()));
    }
    bench.press(&"u".repeat(20));
    let what = "lattice anew, after damage to an input";
    report(data, what, "", secs);
    bench.press("v");
    for name in [
        "switch to picture, fuse",
        "switch to picture, predict",
        "switch to picture, position",
    ] {
        bench.press("v");
        report(data, name, "16", bench.timed_anew("1", "1", 50));
    }
    let episodes = source.metas().len();
    let mut secs = Vec::new();
    let mut first = Vec::new();
    for _ in 0..4 {
        bench.press("llllllll");
        for _ in 1..episodes.min(12) {
            bench.settle();
            let before = bench.app.session.snapshot().episode_index;
            let start = Instant::now();
            bench.app.press(&parse_script("]").expect("a key")[0]);
            bench.until(|s| s.episode_index != before && s.frames.truth.is_some());
            first.push(start.elapsed().as_secs_f64());
            bench.until(|s| s.episode_index != before && s.current);
            secs.push(start.elapsed().as_secs_f64());
        }
        bench.press("[[[[[[[[[[[[");
        // Other episodes than those that are kept.
        bench = Bench::new(Arc::clone(source), vec![model()]);
        bench.settle();
    }
    report(data, "open an episode: first frame", "5", first);
    report(data, "open an episode: belief at the cursor", "15", secs);
}

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_data/episodes.mcap");
    let sample: Arc<dyn EpisodeSource> = Arc::new(Dataset::open(&sample).expect("sample data"));
    let long = long_episodes(folder.path());
    if !json_wanted() {
        header();
    }
    measure("sample, 16 steps", &sample);
    measure("simulated, 48 steps", &long);
}

#[expect(clippy::print_stdout, reason = "a bench speaks to its user")]
fn header() {
    println!("| data | what | p50, ms | p95, ms | target, ms |\n| --- | --- | --: | --: | --: |");
}
