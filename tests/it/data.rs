//! Datasets on disk: a file that another writer made, our own round trip, files that lack an index.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]
#![expect(clippy::float_cmp, reason = "the values are exact in binary")]

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use poescope::data::{Dataset, DatasetWriter};
use poescope::episode::{EpisodeMeta, EpisodeSource, Frame, Layout, Recording, Split, Track};

/// Start of the sample's first episode (`tests/data/make_python_written.py`).
pub(crate) const BASE: i64 = 1_700_000_000_000_000_000;
const SECOND: i64 = 1_000_000_000;

pub(crate) fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/python_written.mcap")
}

/// All recordings of a dataset.
pub(crate) fn recordings(path: &Path) -> Vec<Recording> {
    let dataset = Dataset::open(path).unwrap();
    (0..dataset.metas().len())
        .map(|index| dataset.recording(index).unwrap())
        .collect()
}

/// Dyadic triangle wave in [-1, 1].
fn tri(i: usize, period: usize) -> f64 {
    let p = i % period;
    let v = p.min(period - p);
    2.0 * v as f64 / (period / 2) as f64 - 1.0
}

/// The sample's recordings, by the formulas of the script that made it.
fn expected(episode: usize) -> Recording {
    let (start, samples, images) = [(BASE, 240, 8), (BASE + 7 * SECOND, 300, 10)][episode];
    let s = [1.0, -1.0][episode];
    let mut recording = Recording::default();
    for i in 0..samples {
        let at = start + i as i64 * SECOND / 120;
        let i_ = i as f64;
        recording.wrench.push(
            at,
            [
                4.0 * s * tri(i, 64),
                -2.0 * tri(i, 128),
                10.0 + i_ / 256.0,
                0.125 * tri(i, 32),
                0.0,
                -0.25 * s,
            ],
        );
        recording
            .ee_position
            .push(at, [0.5 + i_ / 1024.0, -0.25 * s, 0.125]);
        recording.ee_velocity.push(at, [0.0625, 0.0, 0.0]);
        recording
            .object
            .push(at, [0.75 + i_ / 2048.0, 0.5 * tri(i, 256), 0.0]);
    }
    for k in 0..images {
        let at = start + k as i64 * SECOND / 4;
        let k_ = k as f64;
        recording
            .control
            .push(at, [0.03125 * (k_ - 3.0), -0.015_625 * k_]);
        let mut pixels: Vec<u8> = (0..64 * 64)
            .map(|p| ((2 * (p / 64) + p % 64) % 64) as u8)
            .collect();
        let square = k + 5 * episode;
        for r in 10 + 2 * square..18 + 2 * square {
            for c in 4 + 3 * square..12 + 3 * square {
                pixels[r % 64 * 64 + c % 64] = 200;
            }
        }
        recording.frame_stamps_nanos.push(at);
        recording.frames.push(Frame {
            width: 64,
            height: 64,
            pixels,
        });
    }
    recording
}

#[test]
fn the_file_of_the_python_writer_has_the_values_its_facts_list() {
    let dataset = Dataset::open(&sample()).unwrap();
    assert_eq!(dataset.name(), "python_written.mcap");
    let metas = dataset.metas();
    let facts: Vec<_> = metas
        .iter()
        .map(|m| {
            (
                m.id.as_str(),
                m.start_nanos - BASE,
                m.end_nanos - BASE,
                m.split,
            )
        })
        .collect();
    assert_eq!(
        facts,
        [
            ("ep0000", 0, 2 * SECOND, Some(Split::Train)),
            ("ep0001", 7 * SECOND, 19 * SECOND / 2, Some(Split::Test)),
        ]
    );
    for episode in [0, 1] {
        let read = dataset.recording(episode).unwrap();
        let mut expected = expected(episode);
        expected.meta = metas[episode].clone();
        assert_eq!(read, expected);
    }
    // A negative zero stays one; the sums of pixels are the facts'.
    let first = dataset.recording(0).unwrap();
    assert!(first.control.values[0][1].is_sign_negative());
    let sum = |frame: &Frame| frame.pixels.iter().map(|&p| u64::from(p)).sum::<u64>();
    assert_eq!(sum(&first.frames[0]), 139_616);
    assert_eq!(
        sum(dataset.recording(1).unwrap().frames.last().unwrap()),
        140_768
    );

    let files = dataset.files();
    let report = &files[0];
    assert_eq!(
        (report.messages, report.chunks, report.bytes),
        (2196, 10, 79_359)
    );
    assert_eq!(
        (report.profile.as_str(), report.compression.as_slice()),
        ("ros2", &["zstd".to_owned()][..])
    );
    assert_eq!(report.library, "mcap-python/1.6.0 mcap-ros2-support/0.6.0");
    assert_eq!(report.start_nanos, Some((BASE + 100_000) as u64));
    assert_eq!(report.end_nanos, Some((BASE + 9_493_666_666) as u64));
    let counts: Vec<_> = report
        .topics
        .iter()
        .map(|t| (t.topic.as_str(), t.messages))
        .collect();
    assert_eq!(
        counts,
        [
            ("/camera/image_raw", 18),
            ("/control", 18),
            ("/ee/pose", 540),
            ("/ee/twist", 540),
            ("/object/pose", 540),
            ("/wrench", 540)
        ]
    );
    assert!(report.left_out.is_empty() && report.notes.is_empty());
    assert_eq!(dataset.image_counts(), [Some(8), Some(10)]);
}

#[test]
fn the_sample_is_laid_out_on_its_images() {
    let dataset = Dataset::open(&sample()).unwrap();
    let layout = Layout {
        frame_size: 64,
        window: 30,
    };
    let episode = dataset.load(1, layout).unwrap();
    assert_eq!(episode.steps(), 10);
    // 120 Hz and 4 Hz: the window's samples are the recorded ones, its last the one at the image.
    let haptic = episode.haptic.as_ref().unwrap();
    let expected = expected(1);
    for t in 1..10 {
        for k in 1..=30 {
            let fz = f64::from(haptic[((t * 30) + k - 1) * 6 + 2]);
            assert_eq!(
                fz,
                expected.wrench.values[(t - 1) * 30 + k][2],
                "step {t}, sample {k}"
            );
        }
    }
    // Nothing precedes the first image: the first sample is held.
    assert!(haptic[..30 * 6].chunks(6).all(|s| s == &haptic[..6]));
    let controls = episode.controls.as_ref().unwrap();
    assert_eq!(controls.len(), 9);
    for (read, expected) in controls.iter().zip(&expected.control.values) {
        assert_eq!(read.map(f64::from), *expected);
    }
    assert_eq!(episode.frames, expected.frames);
    assert!(episode.flags.is_empty(), "{:?}", episode.flags);
}

/// A small recording, every role recorded, at 10 and 100 Hz.
pub(crate) fn small(id: &str, start: i64, seed: u64) -> Recording {
    let mut recording = Recording {
        meta: EpisodeMeta {
            id: id.to_owned(),
            split: Some(Split::Train),
            object: Some("plate".to_owned()),
            source: Some("a test".to_owned()),
            seed: Some(seed),
            ..EpisodeMeta::default()
        },
        ..Recording::default()
    };
    let wave = |i: usize, n: usize| ((i as f64 + seed as f64) * (n as f64 + 0.37)).sin();
    for i in 0..60 {
        let at = start + i as i64 * 10_000_000;
        recording
            .wrench
            .push(at, std::array::from_fn(|n| wave(i, n)));
        recording
            .ee_position
            .push(at, std::array::from_fn(|n| wave(i, n + 6)));
        recording
            .ee_velocity
            .push(at, std::array::from_fn(|n| wave(i, n + 9)));
        recording
            .object
            .push(at, std::array::from_fn(|n| wave(i, n + 12)));
    }
    for t in 0..6 {
        let at = start + t as i64 * 100_000_000;
        recording
            .control
            .push(at, std::array::from_fn(|n| wave(t, n + 15)));
        recording.frame_stamps_nanos.push(at);
        let pixels = (0..24)
            .map(|p| (p * 7 + t as u8 * 31) ^ seed as u8)
            .collect();
        recording.frames.push(Frame {
            width: 6,
            height: 4,
            pixels,
        });
    }
    recording
}

pub(crate) fn write(path: &Path, recordings: &[Recording]) {
    let mut writer = DatasetWriter::create(fs::File::create(path).unwrap(), path).unwrap();
    for recording in recordings {
        writer.write(recording).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn what_is_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut written = [small("a", BASE, 1), small("b", BASE + SECOND, 2)];
    written[1].object = Track::default();
    written[1].meta.split = None;
    write(&path, &written);
    let mut read = recordings(&path);
    for (read, written) in read.iter_mut().zip(&mut written) {
        // An interval left zero is that of the samples; yaw goes through a quaternion.
        assert_eq!(read.meta.end_nanos - read.meta.start_nanos, 590_000_000);
        written.meta.start_nanos = read.meta.start_nanos;
        written.meta.end_nanos = read.meta.end_nanos;
        for (read, written) in read.object.values.iter_mut().zip(&written.object.values) {
            assert!((read[2] - written[2]).abs() < 1e-15);
            read[2] = written[2];
        }
    }
    assert_eq!(read, written);
}

#[test]
fn the_same_recordings_make_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let written = [small("a", BASE, 1), small("b", BASE + SECOND, 2)];
    let paths = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    let [a, b] = paths.each_ref().map(|path| {
        write(path, &written);
        fs::read(path).unwrap()
    });
    assert_eq!(a, b);
    let mut writer = DatasetWriter::create(Cursor::new(Vec::new()), &paths[0]).unwrap();
    writer.write(&written[0]).unwrap();
    let refused = writer.write(&small("late", BASE, 3)).unwrap_err();
    assert!(refused.to_string().contains("late"), "{refused}");
}

#[test]
fn a_dataset_can_be_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Dataset>();
}

#[test]
fn identity_and_splits_are_stable() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let many: Vec<_> = (0..20)
        .map(|i| small(&format!("{i:02}"), BASE + i * SECOND, i as u64))
        .collect();
    write(&path, &many);
    let [a, b] = [(); 2].map(|()| Dataset::open(&path).unwrap());
    assert_eq!(a.data_hash(), b.data_hash());
    assert_eq!(a.data_hash().len(), 16);
    assert_ne!(a.data_hash(), Dataset::open(&sample()).unwrap().data_hash());
    assert_eq!(a.splits(5), b.splits(5));
    assert_eq!(a.splits(5).iter().filter(|&&s| s == Split::Val).count(), 2);
}
