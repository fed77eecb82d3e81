//! Damaged files: what is whole opens, the rest is a sentence that says where, and nothing panics.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::fs;
use std::path::Path;

use poescope::data::{DataError, Dataset};
use poescope::episode::{EpisodeSource, Layout};
use poescope::model::observation::suits;

use crate::data::{recordings, sample};

/// Opens and loads everything; errors must name the file.
fn survive(path: &Path) -> usize {
    let name = path.display().to_string();
    let dataset = match Dataset::open(path) {
        Ok(dataset) => dataset,
        Err(error) => {
            assert!(error.to_string().starts_with(&name), "{error}");
            return 0;
        }
    };
    dataset.files();
    dataset.image_counts();
    (0..dataset.metas().len())
        .filter(|&index| match dataset.load(index, Layout::default()) {
            Ok(_) => true,
            Err(error) => {
                assert!(error.to_string().starts_with(&name), "{error}");
                false
            }
        })
        .count()
}

#[test]
fn a_cut_file_opens_up_to_the_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.mcap");
    let bytes = fs::read(sample()).unwrap();
    for length in (0..bytes.len())
        .step_by(1499)
        .chain(bytes.len() - 40..bytes.len())
    {
        fs::write(&path, &bytes[..length]).unwrap();
        survive(&path);
    }

    let length = bytes.len() * 6 / 10;
    fs::write(&path, &bytes[..length]).unwrap();
    let dataset = Dataset::open(&path).unwrap();
    let report = &dataset.files()[0];
    assert_eq!(report.messages, 1356);
    let notes = report.notes.join("\n");
    assert!(
        notes.contains("cut off at byte") && notes.contains("1356 messages"),
        "{notes}"
    );
    let warnings = dataset.warnings();
    assert!(
        warnings.len() == 1 && warnings[0].contains("cut.mcap: cut off at byte"),
        "{warnings:?}"
    );
    let whole = recordings(&sample());
    assert_eq!(dataset.recording(0).unwrap(), whole[0]);
    // The second episode's record is behind the cut, its first messages are not.
    assert_eq!(dataset.metas()[1].id, "unfinished");
    let part = dataset.recording(1).unwrap();
    assert_eq!(part.frames[..], whole[1].frames[..part.frames.len()]);
    assert_eq!(
        part.wrench.values[..],
        whole[1].wrench.values[..part.wrench.values.len()]
    );
}

#[test]
fn an_attachment_too_short_to_be_one_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("attached.mcap");
    let mut bytes = fs::read(sample()).unwrap();
    // Without its end the file is read through.
    bytes.truncate(bytes.len() - 40);
    let header = u64::from_le_bytes(bytes[9..17].try_into().unwrap());
    let mut record = vec![0x09];
    record.extend(32_u64.to_le_bytes());
    record.extend([0; 32]);
    let at = 17 + header as usize;
    bytes.splice(at..at, record);
    fs::write(&path, &bytes).unwrap();
    assert_eq!(survive(&path), 2);
}

#[test]
fn flipped_bits_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flipped.mcap");
    let bytes = fs::read(sample()).unwrap();
    for position in (0..bytes.len())
        .step_by(611)
        .chain(bytes.len() - 200..bytes.len())
    {
        let mut damaged = bytes.clone();
        damaged[position] ^= 1 << (position % 8);
        fs::write(&path, &damaged).unwrap();
        survive(&path);
    }
}

#[test]
fn a_bit_in_a_chunk_is_an_error_that_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flipped.mcap");
    let mut bytes = fs::read(sample()).unwrap();
    // In the middle of the last chunk.
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let chunk = summary
        .chunk_indexes
        .iter()
        .max_by_key(|chunk| chunk.chunk_start_offset)
        .unwrap();
    bytes[(chunk.chunk_start_offset + chunk.chunk_length / 2) as usize] ^= 4;
    fs::write(&path, &bytes).unwrap();
    let dataset = Dataset::open(&path).unwrap();
    assert!(
        dataset.recording(0).is_ok(),
        "the first episode does not touch that chunk"
    );
    let error = dataset.recording(1).map(|_| ()).unwrap_err();
    let DataError::Damaged { offset, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(*offset, chunk.chunk_start_offset);
    let said = error.to_string();
    assert!(
        said.contains("flipped.mcap") && said.contains(&format!("byte {offset}")),
        "{said}"
    );
}

#[test]
fn what_is_no_recording_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let said = |path: &Path| Dataset::open(path).unwrap_err().to_string();
    assert!(said(&path).contains("No such file"));
    assert!(said(folder.path()).contains("no .mcap file"));
    for (content, word) in [
        (&b""[..], "empty"),
        (b"#ROSBAG V2.0\n", "ROS 1"),
        (b"SQLite format 3\0", "ros2 bag convert"),
        (b"something else altogether", "not an MCAP file"),
        (mcap::MAGIC, "no episode"),
    ] {
        fs::write(&path, content).unwrap();
        let said = said(&path);
        assert!(said.contains(word) && said.lines().count() == 1, "{said}");
    }
    // In a folder, the others open.
    fs::copy(sample(), folder.path().join("b.mcap")).unwrap();
    fs::write(&path, b"something else").unwrap();
    let dataset = Dataset::open(folder.path()).unwrap();
    assert_eq!(dataset.metas().len(), 2);
    assert_eq!(dataset.left_out().len(), 1);
}

#[test]
fn a_channel_that_is_no_number_is_named_as_such() {
    let dataset = Dataset::open(&sample()).unwrap();
    let config = crate::common::three_experts();
    let mut episode = dataset.episode_aligned(0, config.layout()).unwrap();
    assert!(suits(&config, &episode).is_ok());
    episode.haptic.as_mut().unwrap()[6] = f32::NAN;
    let said = suits(&config, &episode).unwrap_err().to_string();
    assert!(
        said.contains("channel `fx`") && said.contains("not finite"),
        "{said}"
    );
    episode.haptic.as_mut().unwrap().fill(1e6);
    let said = suits(&config, &episode).unwrap_err().to_string();
    assert!(said.contains("other units"), "{said}");
}

/// A file without chunks and without its end, in which something large stands between two runs of messages.
#[test]
fn what_is_passed_over_belongs_to_no_run_of_messages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("attached.mcap");
    let mut writer = mcap::WriteOptions::new()
        .use_chunks(false)
        .create(fs::File::create(&path).unwrap())
        .unwrap();
    let bytes = fs::read(sample()).unwrap();
    let messages: Vec<_> = mcap::MessageStream::new(&bytes).unwrap().collect();
    for (i, message) in messages.iter().enumerate() {
        if i == messages.len() / 2 {
            writer
                .attach(&mcap::Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: "map.pgm".to_owned(),
                    media_type: "image/x-portable-graymap".to_owned(),
                    data: vec![0; 140 << 20].into(),
                })
                .unwrap();
        }
        writer.write(message.as_ref().unwrap()).unwrap();
    }
    writer.finish().unwrap();
    let file = fs::File::options().write(true).open(&path).unwrap();
    file.set_len(file.metadata().unwrap().len() - 40).unwrap();
    let dataset = Dataset::open(&path).unwrap();
    let frames = dataset.recording(0).unwrap().frames.len();
    let recorded: usize = recordings(&sample()).iter().map(|r| r.frames.len()).sum();
    assert_eq!(frames, recorded);
}
