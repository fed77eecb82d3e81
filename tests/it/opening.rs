//! Files that lack an index, that name their topics otherwise, that hold what cannot be read.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use mcap::{Compression, MessageStream, WriteOptions};
use poescope::data::Dataset;
use poescope::episode::{EpisodeSource, Layout};

use crate::data::{BASE, recordings, sample, small, write};

/// Writes the sample again with other options, each message's last byte changed by `flip`.
fn rewritten(options: WriteOptions, flip: u8, path: &Path) {
    let bytes = fs::read(sample()).unwrap();
    let file = fs::File::create(path).unwrap();
    let mut writer = options.profile("ros2").create(file).unwrap();
    for message in MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        *message.data.to_mut().last_mut().unwrap() ^= flip;
        writer.write(&message).unwrap();
    }
    for meta in Dataset::open(&sample()).unwrap().metas() {
        let entries = [
            ("id", meta.id.clone()),
            ("start_ns", meta.start_nanos.to_string()),
            ("end_ns", meta.end_nanos.to_string()),
            ("split", meta.split.unwrap().name().to_owned()),
        ];
        let metadata: BTreeMap<_, _> = entries
            .into_iter()
            .map(|(k, v)| (k.to_owned(), v))
            .collect();
        let name = "episode".to_owned();
        writer
            .write_metadata(&mcap::records::Metadata { name, metadata })
            .unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn files_that_lack_an_index_open_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let new = || WriteOptions::new().chunk_size(Some(40_000));
    let options: [(&str, WriteOptions, bool); 11] = [
        ("plain", new(), true),
        ("lz4", new().compression(Some(Compression::Lz4)), true),
        ("uncompressed", new().compression(None), true),
        (
            "no message indexes",
            new().emit_message_indexes(false),
            true,
        ),
        ("no chunk indexes", new().emit_chunk_indexes(false), false),
        ("no statistics", new().emit_statistics(false), false),
        ("no channels", new().repeat_channels(false), false),
        ("no schemas", new().repeat_schemas(false), false),
        (
            "no metadata indexes",
            new().emit_metadata_indexes(false),
            false,
        ),
        ("no chunks", new().use_chunks(false), false),
        (
            "no summary",
            new()
                .emit_summary_records(false)
                .emit_summary_offsets(false),
            false,
        ),
    ];
    let expected = recordings(&sample());
    for (name, options, indexed) in options {
        let path = folder.path().join(format!("{name}.mcap"));
        rewritten(options, 0, &path);
        assert_eq!(recordings(&path), expected, "{name}");
        let dataset = Dataset::open(&path).unwrap();
        assert_eq!(dataset.image_counts(), [Some(8), Some(10)], "{name}");
        let report = &dataset.files()[0];
        assert_eq!(report.messages, 2196, "{name}");
        assert_eq!(
            report.notes.is_empty(),
            indexed,
            "{name}: {:?}",
            report.notes
        );
    }
    let all = Dataset::open(folder.path()).unwrap();
    assert_eq!(all.metas().len(), 22);
    assert!(all.load(21, Layout::default()).is_ok());
}

#[test]
fn what_is_not_packed_is_told_apart_by_the_data_hash() {
    let folder = tempfile::tempdir().unwrap();
    let hash = |flip: u8| {
        let path = folder.path().join("a.mcap");
        rewritten(WriteOptions::new().compression(None), flip, &path);
        let dataset = Dataset::open(&path).unwrap();
        assert!(dataset.files()[0].notes.is_empty());
        dataset.data_hash().to_owned()
    };
    assert_eq!(hash(0), hash(0));
    assert_ne!(hash(0), hash(1));
}

#[test]
fn a_mapping_beside_the_files_names_the_roles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    write(&path, &[small("a", BASE, 1)]);
    let mapping = folder.path().join("dataset.toml");
    fs::write(
        &mapping,
        "[topics]\nobject = \"/ee/pose\"\nee_pose = \"/object/pose\"\nhaptic = \"/nowhere\"\n",
    )
    .unwrap();
    let read = &recordings(&path)[0];
    let written = small("a", BASE, 1);
    assert!(read.wrench.is_empty());
    assert_eq!(
        read.object.values[3][..2],
        written.ee_position.values[3][..2]
    );
    let left_out = &Dataset::open(&path).unwrap().files()[0].left_out;
    assert_eq!(left_out[0].what, "/wrench");
    fs::write(
        &mapping,
        "[topics]\nvision = \"/wrench\"\nhaptic = \"/camera/image_raw\"\n",
    )
    .unwrap();
    let said = Dataset::open(&path).unwrap_err().to_string();
    assert!(
        said.contains("WrenchStamped") && said.contains("sensor_msgs/msg/Image"),
        "{said}"
    );
    fs::write(&mapping, "[topics]\nvision = \"/wrench\"\n").unwrap();
    let said = Dataset::open(&path).unwrap_err().to_string();
    assert!(said.contains("/wrench is both haptic and vision"), "{said}");
    fs::write(&mapping, "[topics]\ncamera = \"/wrench\"\n").unwrap();
    let said = Dataset::open(&path).unwrap_err().to_string();
    assert!(
        said.contains("camera") && said.contains("dataset.toml"),
        "{said}"
    );
}

/// The sample with its schemas changed: name, encoding, text.
fn with_schemas(path: &Path, change: impl Fn(&mut (String, String, Vec<u8>))) {
    let bytes = fs::read(sample()).unwrap();
    let file = fs::File::create(path).unwrap();
    let mut writer = WriteOptions::new().profile("ros2").create(file).unwrap();
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        let mut schema = (
            schema.name.clone(),
            schema.encoding.clone(),
            schema.data.to_vec(),
        );
        change(&mut schema);
        let id = writer.add_schema(&schema.0, &schema.1, &schema.2).unwrap();
        let channel = writer
            .add_channel(id, &message.channel.topic, "cdr", &BTreeMap::new())
            .unwrap();
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        writer
            .write_to_known_channel(&header, &message.data)
            .unwrap();
    }
    writer.finish().unwrap();
}

/// A change of a schema's name, encoding, text.
type Change = fn(&mut (String, String, Vec<u8>));

#[test]
fn a_topic_that_cannot_be_read_is_left_out_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let changes: [(Change, &str); 3] = [
        (
            |schema| schema.0 = "my_msgs/msg/Force".to_owned(),
            "my_msgs/msg/Force",
        ),
        (|schema| schema.1 = "ros2idl".to_owned(), "ros2idl"),
        (
            |schema| {
                let text = String::from_utf8(schema.2.clone()).unwrap();
                schema.2 = text.replace("float64 z", "float32 z").into_bytes();
            },
            "float32 wrench.force.z",
        ),
    ];
    for (change, word) in changes {
        with_schemas(&path, |schema| {
            if schema.0.ends_with("WrenchStamped") {
                change(schema);
            }
        });
        let dataset = Dataset::open(&path).unwrap();
        let report = &dataset.files()[0];
        assert_eq!(report.left_out.len(), 1);
        assert_eq!(report.left_out[0].what, "/wrench");
        assert!(
            report.left_out[0].why.contains(word),
            "{}",
            report.left_out[0].why
        );
        // The file names no episode, so it is one.
        let episode = dataset.load(0, Layout::default()).unwrap();
        assert_eq!((episode.steps(), episode.meta.id.as_str()), (18, "a"));
        assert!(episode.haptic.is_none() && episode.proprio.is_some());
    }
    with_schemas(&path, |schema| schema.2.clear());
    let dataset = Dataset::open(&path).unwrap();
    assert_eq!(
        dataset.files()[0].notes.len(),
        6,
        "the built-in definitions, by name"
    );
    assert!(dataset.load(0, Layout::default()).unwrap().haptic.is_some());
}

#[test]
fn an_episode_without_images_is_reported_and_the_others_open() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut blind = small("blind", BASE + 1_000_000_000, 2);
    blind.frames.clear();
    blind.frame_stamps_nanos.clear();
    let mut single = small("single", BASE + 2_000_000_000, 3);
    single.frames.truncate(1);
    single.frame_stamps_nanos.truncate(1);
    write(&path, &[small("a", BASE, 1), blind, single]);
    let dataset = Dataset::open(&path).unwrap();
    let ids: Vec<_> = dataset
        .metas()
        .iter()
        .map(|meta| meta.id.as_str())
        .collect();
    assert_eq!(ids, ["a", "single"]);
    assert!(dataset.files()[0].left_out[0].what.contains("blind"));
    assert_eq!(dataset.image_counts(), [Some(6), Some(1)]);
    assert!(dataset.load(0, Layout::default()).is_ok());
    let said = dataset.load(1, Layout::default()).unwrap_err().to_string();
    assert!(
        said.contains("a.mcap") && said.contains("single") && said.contains("1 image"),
        "{said}"
    );
}
