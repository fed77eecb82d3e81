//! Recordings for the Rerun viewer: a file that its own tools take, and a stream that follows the cursor.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use poescope::data::Dataset;
use poescope::export::rerun::live::Live;
use poescope::model::checkpoint;
use poescope::session::Session;
use poescope::session::command::Command as Ask;
use poescope::session::predict::Predictor;
use poescope::session::trained::{Origin, Trained};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use rerun::sink::MemorySinkStorage;

use crate::common::{answer, poescope, python};
use crate::export::namesakes;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("sample_data")
        .join(name)
}

#[test]
fn reruns_own_tools_take_the_file_and_read_the_same_numbers() {
    let Some(python) = python("rerun") else {
        eprintln!("left out: no python3 with rerun-sdk; POESCOPE_PYTHON names one");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let files = ["a.rrd", "a.jsonl"].map(|name| folder.path().join(name));
    for out in &files {
        let mut command = poescope();
        command.args(["export", "--episode", "ep00002", "--episode", "ep00006"]);
        command.args(["--state", "v=1;alpha=haptic:0.25@5-,prior:0@9;context=6"]);
        answer(command.arg("--out").arg(out));
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/read_rrd.py");
    let said = answer(Command::new(python).arg(script).args(files));
    let (count, rest) = said.split_once(' ').unwrap();
    assert!(count.parse::<usize>().unwrap() > 5000, "{said}");
    assert_eq!(rest.trim(), "numbers of 32 steps agree");
}

#[test]
fn with_rerun_switched_off_an_export_says_so_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = poescope();
    command
        .env("RERUN", "off")
        .args(["export", "--out"])
        .arg(folder.path().join("a.rrd"));
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && said.contains("unset it"),
        "{said}"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn episodes_of_one_name_are_recordings_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a.rrd");
    let mut command = poescope();
    command.args(["export", "--split", "test", "--data"]);
    command.arg(namesakes(folder.path()));
    answer(command.arg("--out").arg(&out));
    let messages = DecoderApp::decode_lazy(BufReader::new(File::open(out).unwrap()));
    let begun = messages.filter_map(|message| match message.unwrap() {
        LogMsg::SetStoreInfo(begun) if begun.info.store_id.is_recording() => {
            Some(begun.info.recording_id().as_str().to_owned())
        }
        _ => None,
    });
    let ids: BTreeSet<String> = begun.collect();
    assert_eq!(ids.len(), 2, "{ids:?}");
}

/// A session on the samples, and the stream of it with what it has sent.
struct Scene {
    session: Session,
    live: Live,
    sent: Arc<Mutex<Vec<MemorySinkStorage>>>,
}

impl Scene {
    fn new() -> Self {
        let dataset = Arc::new(Dataset::open(&sample("episodes.mcap")).unwrap());
        let (model, probe, hash) = checkpoint::load_with_hash(&sample("v-h-p")).unwrap();
        let origin = Origin {
            source: "sample".to_owned(),
            hash,
            ..Origin::default()
        };
        let model: Arc<dyn Predictor> = Arc::new(Trained::new(model, probe, origin).unwrap());
        let sent = Arc::new(Mutex::new(Vec::new()));
        let keep = Arc::clone(&sent);
        let open = Box::new(move |builder: rerun::RecordingStreamBuilder| {
            let (stream, storage) = builder.memory()?;
            keep.lock().unwrap().push(storage);
            Ok(stream)
        });
        let live = Live::new(Arc::clone(&dataset), vec![Arc::clone(&model)], open);
        Self {
            session: Session::new(dataset, vec![model]),
            live,
            sent,
        }
    }

    /// Shows what a command makes of the session.
    fn after(&mut self, ask: Ask) {
        self.session.apply(ask);
        assert!(self.session.wait_idle(Duration::from_mins(2)));
        self.live.show(&self.session.snapshot()).unwrap();
    }

    /// For each recording so far the steps, from 1, at which what the model believes was sent since the last look.
    fn believed(&self) -> Vec<Vec<i64>> {
        let storages = self.sent.lock().unwrap();
        storages
            .iter()
            .map(|storage| steps(&storage.take()))
            .collect()
    }
}

/// Steps at which the belief's mean is; what is not static must be on every timeline.
fn steps(messages: &[LogMsg]) -> Vec<i64> {
    let mut steps = Vec::new();
    for message in messages {
        let LogMsg::ArrowMsg(store, message) = message else {
            continue;
        };
        let chunk = Chunk::from_arrow_msg(message).unwrap();
        if chunk.is_static() || !store.is_recording() {
            continue;
        }
        let names: BTreeSet<String> = chunk.timelines().keys().map(ToString::to_string).collect();
        assert!(
            names.iter().eq(["stamp", "step", "t"]),
            "{}: {names:?}",
            chunk.entity_path()
        );
        if chunk.entity_path().to_string() == "/v_h_p/belief/mean" {
            let step = chunk
                .timelines()
                .iter()
                .find(|(name, _)| name.as_str() == "step")
                .unwrap();
            steps.extend(step.1.times_raw());
        }
    }
    steps
}

#[test]
fn each_step_is_sent_once_and_other_switches_begin_another_recording() {
    let mut scene = Scene::new();
    scene.after(Ask::SeekTo(5));
    scene.after(Ask::Step(1));
    assert_eq!(scene.believed(), [vec![5, 6]]);
    // Back again there is nothing new to send.
    scene.after(Ask::Step(-1));
    scene.after(Ask::ToggleMark);
    scene.after(Ask::CycleFailureOrder);
    assert_eq!(scene.believed(), [[0_i64; 0]]);
    scene.after(Ask::ToggleExpert(0));
    assert_eq!(scene.believed(), [vec![], vec![5_i64]]);
    scene.after(Ask::SelectEpisode(3));
    assert_eq!(scene.believed().len(), 3);
}
