//! Event files, read back record by record, and compared with what TensorBoard's own writer writes.

use std::path::{Path, PathBuf};

use poescope::train::tensorboard::{EventWriter, PREFIX};

/// The event files of a folder in the order TensorBoard reads them.
fn event_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// The data of each whole record; every checksum must be right.
fn records(mut bytes: &[u8]) -> Vec<&[u8]> {
    let masked = |data: &[u8]| {
        let checksum = crc32c::crc32c(data);
        checksum.rotate_right(15).wrapping_add(0xA282_EAD8)
    };
    let mut records = Vec::new();
    while bytes.len() >= 12 {
        let (header, rest) = bytes.split_at(12);
        let length = u64::from_le_bytes(header[..8].try_into().unwrap()) as usize;
        assert_eq!(header[8..], masked(&header[..8]).to_le_bytes());
        let Some((data, rest)) = rest.split_at_checked(length) else {
            break;
        };
        let Some((checksum, rest)) = rest.split_first_chunk() else {
            break;
        };
        assert_eq!(u32::from_le_bytes(*checksum), masked(data));
        records.push(data);
        bytes = rest;
    }
    records
}

fn bytes(hex: &str) -> Vec<u8> {
    let pair = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(pair).collect()
}

#[test]
fn a_file_is_what_tensorboards_own_writer_writes() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = EventWriter::append(folder.path(), 301).unwrap();
    let values = [("train/kl", 2.0), ("val/loss", -0.25)];
    writer.scalars(300, 1.5, values).unwrap();
    let [path] = &event_files(folder.path())[..] else {
        panic!("one event file");
    };
    let name = path.file_name().unwrap().to_str().unwrap();
    assert!(name.starts_with(PREFIX), "{name}");
    let file = std::fs::read(path).unwrap();
    let read = records(&file);
    // The first nine bytes of an event are its wall time; the first two events are of now.
    // TensorBoard 2.21, tensorboard.summary.writer.record_writer.RecordWriter over a BytesIO:
    //   V = summary_pb2.Summary.Value
    //   event_pb2.Event(wall_time=1.5, file_version="brain.Event:2")
    //   event_pb2.Event(wall_time=1.5, step=301, session_log=event_pb2.SessionLog(status=event_pb2.SessionLog.START))
    //   event_pb2.Event(wall_time=1.5, step=300, summary=summary_pb2.Summary(
    //       value=[V(tag="train/kl", simple_value=2.0), V(tag="val/loss", simple_value=-0.25)]))
    assert_eq!(read[0][9..], bytes("1a0d627261696e2e4576656e743a32"));
    assert_eq!(read[1][9..], bytes("10ad023a020801"));
    let theirs = "300000000000000095f5d05f09000000000000f83f10ac022a220a0f0a08747261696e2f6b6c15000000400a\
                  0f0a0876616c2f6c6f737315000080be8490fce6";
    let at = file.len() - theirs.len() / 2;
    assert_eq!(file[at..], bytes(theirs));
    assert_eq!(read.len(), 3);
}

#[test]
fn a_torn_record_costs_itself_alone_and_a_resumed_run_says_where_it_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = EventWriter::append(folder.path(), 1).unwrap();
    for update in [10, 20, 30] {
        writer.scalars(update, 0.0, [("kl", 1.0)]).unwrap();
    }
    let torn = &event_files(folder.path())[0];
    let file = std::fs::read(torn).unwrap();
    std::fs::write(torn, &file[..file.len() - 7]).unwrap();
    let mut writer = EventWriter::append(folder.path(), 21).unwrap();
    writer.scalars(30, 0.0, [("kl", 2.0)]).unwrap();

    let files = event_files(folder.path()).into_iter();
    let files: Vec<Vec<u8>> = files.map(|path| std::fs::read(path).unwrap()).collect();
    let [older, newer] = &files[..] else {
        panic!("two event files");
    };
    // Field 2 is the step, 7 a session's start, 5 scalars; all numbers here fit one byte.
    let kinds = |file| -> Vec<[u8; 3]> {
        let events = records(file).into_iter().skip(1);
        events
            .map(|event| event[9..12].try_into().unwrap())
            .collect()
    };
    let [step, start, scalars] = [2 << 3, 7 << 3 | 2, 5 << 3 | 2];
    assert_eq!(
        kinds(older),
        [[step, 1, start], [step, 10, scalars], [step, 20, scalars]]
    );
    assert_eq!(kinds(newer), [[step, 21, start], [step, 30, scalars]]);
}
