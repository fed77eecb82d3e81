//! A recording that was exported with notes beside it is still that recording.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Command;

use poescope::data::{Annotated, Dataset, Note, Value};
use poescope::episode::{EpisodeSource, Layout};

use crate::common::{answer, poescope, python};

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_data/episodes.mcap")
}

/// Topic, log time, publish time, sequence, schema and payload of every message, in the order of the file.
type Message = (String, u64, u64, u32, String, Vec<u8>);

fn messages(bytes: &[u8]) -> Vec<Message> {
    mcap::MessageStream::new(bytes)
        .unwrap()
        .map(|message| {
            let message = message.unwrap();
            let schema = message.channel.schema.as_ref().unwrap();
            (
                message.channel.topic.clone(),
                message.log_time,
                message.publish_time,
                message.sequence,
                schema.name.clone(),
                message.data.to_vec(),
            )
        })
        .collect()
}

fn export(out: &Path, data: &Path, options: &[&str]) {
    let mut command = poescope();
    command.arg("export").arg("--out").arg(out).arg("--data");
    answer(command.arg(data).args(options));
}

#[test]
fn opened_again_it_is_the_same_dataset_with_every_message_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a.mcap");
    let named = ["--episode", "ep00004", "--episode", "ep00001"];
    export(&out, &sample(), &named);
    let (original, again) = (
        Dataset::open(&sample()).unwrap(),
        Dataset::open(&out).unwrap(),
    );
    assert_eq!(again.metas().len(), 2);
    assert!(again.left_out().is_empty(), "{:?}", again.left_out());
    for (index, before) in [(0, 4), (1, 1)] {
        let [before, after] = [(&original, before), (&again, index)]
            .map(|(dataset, index)| dataset.load(index, Layout::default()).unwrap());
        assert!(before == after, "{}", before.meta.id);
    }
    let meta = &original.metas()[4];
    let bytes = std::fs::read(sample()).unwrap();
    let within =
        |message: &Message| (meta.start_nanos as u64..=meta.end_nanos as u64).contains(&message.1);
    let recorded: Vec<_> = messages(&bytes).into_iter().filter(within).collect();
    let bytes = std::fs::read(&out).unwrap();
    let (notes, copied): (Vec<_>, Vec<_>) = messages(&bytes)
        .into_iter()
        .filter(within)
        .partition(|message| message.0.starts_with("/poescope/"));
    assert!(recorded.len() > 2000);
    assert!(recorded == copied, "to the byte, and in order");
    let steps = original.load(4, Layout::default()).unwrap().steps_nanos;
    let at = |topic: &str| -> Vec<u64> {
        let found = notes.iter().filter(|note| note.0 == topic);
        found.map(|note| note.1).collect()
    };
    let nanos: Vec<u64> = steps.iter().map(|&nanos| nanos as u64).collect();
    assert_eq!(at("/poescope/v_h_p/belief/image"), nanos[1..]);
    assert_eq!(at("/poescope/v_h_p/position/prediction"), nanos[4..15]);

    // Exported again, the notes are the new ones alone.
    let twice = folder.path().join("b.mcap");
    let state = ["--state", "v=1;alpha=vision:0", "--episode", "ep00004"];
    export(&twice, &out, &state);
    let again = std::fs::read(&twice).unwrap();
    let again = messages(&again);
    let alphas = again
        .iter()
        .filter(|m| m.0 == "/poescope/v_h_p/vision/alpha");
    let alphas: Vec<&[u8]> = alphas.map(|message| &message.5[4..]).collect();
    assert_eq!(alphas.len(), 16);
    assert!(alphas.iter().all(|alpha| *alpha == 0.0_f64.to_le_bytes()));
    let is_recorded = |message: &&Message| !message.0.starts_with("/poescope/");
    assert_eq!(again.iter().filter(is_recorded).count(), recorded.len());
}

/// In this one the camera's stamps are 20 ms before they were logged, and both episodes lie in one chunk.
#[test]
fn notes_are_logged_with_the_image_they_are_about_and_stay_in_their_episode() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/python_written.mcap");
    let dataset = Dataset::open(&path).unwrap();
    let out = Path::new("a.mcap");
    let mut file = Annotated::create(Cursor::new(Vec::new()), out).unwrap();
    for index in [0, 1] {
        let episode = dataset.load(index, Layout::default()).unwrap();
        let note = |stamp_nanos: i64| Note {
            topic: "/poescope/m/nees".to_owned(),
            stamp_nanos,
            value: Value::Number(stamp_nanos as f64),
        };
        let mut notes: Vec<Note<'_>> = episode.steps_nanos.iter().copied().map(note).collect();
        // One of no image, and before everything.
        notes.push(note(0));
        file.episode(&dataset, index, &notes, "/poescope/").unwrap();
    }
    let again = file.episode(&dataset, 0, &[], "/poescope/").unwrap_err();
    let told = again.to_string();
    assert!(
        told.contains("ep0000") && told.contains("files of their own"),
        "{told}"
    );
    let bytes = file.finish().unwrap().into_inner();
    let copied = messages(&bytes);
    let logged = |topic: &str, shift: u64| -> Vec<(u64, u64)> {
        let found = copied.iter().filter(|message| message.0 == topic);
        found.map(|m| (m.1, m.2 + shift)).collect()
    };
    let images = logged("/camera/image_raw", 0);
    let mut notes = logged("/poescope/m/nees", 0);
    let metas = dataset.metas();
    let strays: Vec<u64> = notes
        .extract_if(.., |note| note.1 == 0)
        .map(|n| n.0)
        .collect();
    assert_eq!(
        strays,
        metas
            .iter()
            .map(|m| m.start_nanos as u64)
            .collect::<Vec<_>>()
    );
    assert_eq!(notes, images, "logged and stamped alike");
    assert!(
        images
            .iter()
            .all(|(log, stamp)| log == &(stamp + 20_000_000))
    );
    let order: Vec<u64> = copied.iter().map(|message| message.1).collect();
    assert!(
        order.is_sorted(),
        "each episode by log time, and here they follow each other"
    );

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    std::fs::write(&path, &bytes).unwrap();
    let again = Dataset::open(&path).unwrap();
    assert_eq!(again.metas(), metas);
    for index in [0, 1] {
        let [before, after] =
            [&dataset, &again].map(|dataset| dataset.load(index, Layout::default()).unwrap());
        assert!(before == after);
    }
}

#[test]
fn the_python_reader_finds_the_same_numbers() {
    let Some(python) = python("mcap, mcap_ros2") else {
        eprintln!(
            "left out: no python3 with mcap and mcap-ros2-support; POESCOPE_PYTHON names one"
        );
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (recording, lines) = (folder.path().join("a.mcap"), folder.path().join("a.jsonl"));
    let options = ["--episode", "ep00002", "--episode", "ep00006", "--state"];
    let state = "v=1;alpha=haptic:0.25@5-,prior:0@9;context=6";
    for out in [&recording, &lines] {
        export(out, &sample(), &[&options[..], &[state]].concat());
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/read_exported.py");
    let mut command = Command::new(python);
    let said = answer(command.arg(script).args([recording, lines]));
    let (count, rest) = said.split_once(' ').unwrap();
    assert!(count.parse::<usize>().unwrap() > 5000, "{said}");
    assert_eq!(rest.trim(), "numbers of 32 steps agree");
}
