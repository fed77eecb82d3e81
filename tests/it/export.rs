//! What `export` writes as numbers and pictures, at the program's own boundary.

use std::path::{Path, PathBuf};

use poescope::data::Dataset;
use poescope::episode::{EpisodeSource, Layout};
use poescope::export::color;
use poescope::export::csv::{EPISODE_KEYS, EXPERT_MEANS, MEANS, STEP_KEYS, episodes_path};
use poescope::export::step::{OF_EXPERT, OF_SENSOR, READINGS};
use serde_json::Value;

use crate::common::{answer, poescope, simulated, three_experts, untrained};

/// Touch weaker, vision gone from step 9 on, another protocol than the usual one.
const STATE: &str = "v=1;alpha=vision:0@9-,haptic:0.5;context=5;horizon=6;seed=4";

fn exported(folder: &Path, name: &str, options: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let mut command = poescope();
    answer(command.arg("export").arg("--out").arg(&path).args(options));
    path
}

fn lines(path: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Every field of a table, by its column; nothing here needs quotes but the state string.
fn table(path: &Path) -> Vec<Vec<(String, String)>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    rows.map(|row| {
        assert_eq!(row.len(), head.len());
        let named = head.iter().zip(row);
        named
            .map(|(name, field)| ((*name).to_owned(), field.to_owned()))
            .collect()
    })
    .collect()
}

fn field<'a>(row: &'a [(String, String)], name: &str) -> &'a str {
    let found = row.iter().find(|(column, _)| column == name);
    &found.unwrap_or_else(|| panic!("no column {name}")).1
}

#[test]
fn the_product_and_the_positions_can_be_made_again_from_the_json() {
    let folder = tempfile::tempdir().unwrap();
    let options = [
        "--state",
        STATE,
        "--episode",
        "ep00003",
        "--episode",
        "ep00001",
    ];
    let lines = lines(&exported(folder.path(), "a.jsonl", &options));
    assert_eq!(lines.len(), 32);
    let keys = |line: &Value| {
        let keys = line.as_object().unwrap().keys();
        keys.cloned().collect::<Vec<_>>()
    };
    let mut beliefs = 0;
    for line in &lines {
        assert_eq!(keys(line), keys(&lines[0]), "every line has the same keys");
        let step = line["step"].as_u64().unwrap();
        if line["posterior"]["mean"].is_null() {
            assert_eq!(step, 1, "the first belief is at the second frame");
            continue;
        }
        let mut experts = line["experts"].as_array().unwrap().clone();
        assert_eq!(experts.len(), 3);
        let wanted = [if step < 9 { 1.0 } else { 0.0 }, 0.5, 1.0];
        for (expert, alpha) in experts.iter().zip(wanted) {
            assert_eq!(expert["alpha"].as_f64(), Some(alpha), "step {step}");
        }
        experts.push(line["prior"].clone());
        let [mean, log_var] = ["mean", "log_var"].map(|key| numbers(&line["posterior"][key]));
        for d in 0..16 {
            let (mut precision, mut weighted) = (0.0, 0.0);
            for expert in &experts {
                let alpha = expert["alpha"].as_f64().unwrap();
                let part = alpha * (-numbers(&expert["log_var"])[d]).exp();
                precision += part;
                weighted += part * numbers(&expert["mean"])[d];
            }
            assert!((log_var[d] + precision.ln()).abs() < 1e-5, "step {step}");
            assert!((mean[d] - weighted / precision).abs() < 1e-5, "step {step}");
            let shares = experts.iter().map(|expert| numbers(&expert["share"])[d]);
            assert!((shares.sum::<f64>() - 1.0).abs() < 1e-5);
        }
        let belief = &line["position"]["belief"];
        let probe = &line["probe"];
        let rows = probe["weights"].as_array().unwrap();
        let covariance = numbers(&belief["covariance"]);
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let weights = numbers(&rows[axis]);
            let read = numbers(&probe["bias"])[axis];
            let moved: f64 = weights.iter().zip(&mean).map(|(w, m)| w * m).sum();
            assert!((read + moved - belief[name].as_f64().unwrap()).abs() < 1e-5);
            let spread: f64 = weights
                .iter()
                .zip(&log_var)
                .map(|(w, v)| w * w * v.exp())
                .sum();
            let stated = covariance[2 * axis] - numbers(&probe["residual"])[2 * axis];
            assert!((spread - stated).abs() < 1e-5 * spread.max(1e-3));
        }
        let is_predicted = (6..=11).contains(&step);
        assert_eq!(!line["position"]["prediction"].is_null(), is_predicted);
        beliefs += 1;
    }
    assert_eq!(beliefs, 30);
}

#[test]
fn json_and_tables_say_what_the_screen_says() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--state", STATE, "--episode", "ep00002", "--steps", "3-12"];
    let json = lines(&exported(folder.path(), "a.jsonl", &options));
    let csv = exported(folder.path(), "a.csv", &options);
    let rows = table(&csv);
    assert_eq!((json.len(), rows.len()), (10, 10));
    for step in [3, 10] {
        let state = format!("{STATE};episode=ep00002;step={step}");
        let mut command = poescope();
        let shown = answer(command.args(["view", "--json", "--state", &state]));
        let shown: Value = serde_json::from_str(&shown).unwrap();
        let (line, row) = (&json[step - 3], &rows[step - 3]);
        assert_eq!(line["step"], step);
        assert_eq!(field(row, "step"), step.to_string());
        assert_eq!(line["posterior"]["mean"], shown["belief"]["mean"]);
        assert_eq!(line["posterior"]["log_var"], shown["belief"]["log_var"]);
        let position = &shown["position"];
        assert_eq!(line["position"]["belief"], position["belief"][step - 1]);
        assert_eq!(
            line["position"]["prediction"],
            position["prediction"][step - 1]
        );
        // The text of the table is the float's shortest, like JSON's.
        let same = |column: &str, value: &Value| {
            let text = field(row, column);
            let number = value.as_f64().map(|number| number as f32);
            assert_eq!(text.parse().ok(), number, "{column} at step {step}");
        };
        same("belief_x_m", &position["belief"][step - 1]["x"]);
        same(
            "prediction_yy_m2",
            &position["prediction"][step - 1]["covariance"][2],
        );
        same("prediction_error_m", &position["prediction_error_m"]);
        same("psnr_belief_db", &shown["psnr_db"][step - 1]["belief"]);
        same("nees", &shown["series"]["nees"][step - 1]);
        same("conflict", &shown["series"]["conflict"][step - 1]);
        same("truth_yaw_rad", &position["truth"][step - 1]["yaw"]);
        for (i, name) in ["vision", "haptic", "proprio", "prior"]
            .into_iter()
            .enumerate()
        {
            let (expert, reading) = (&shown["experts"][i], &shown["fusion"]["experts"][i]);
            same(&format!("{name}_share_mean"), &expert["share_mean"]);
            same(&format!("{name}_share_position"), &expert["share_position"]);
            same(&format!("{name}_alpha"), &expert["alpha"]);
            same(
                &format!("{name}_information_nats"),
                &reading["information_nats"],
            );
            if name != "prior" {
                same(
                    &format!("{name}_nis_propagated"),
                    &reading["nis"]["propagated"],
                );
                same(&format!("{name}_pull_x_m"), &reading["pull_m"][0]);
            }
        }
        let active = if step < 9 { "VHPD" } else { "HPD" };
        assert_eq!(field(row, "active"), active);
        assert_eq!(
            field(row, "trained").parse(),
            Ok(0.0),
            "half an α was never trained"
        );
    }
    let [episode] = &table_of_episodes(&csv)[..] else {
        panic!("one episode");
    };
    let mean = |column: &str| {
        let known = rows
            .iter()
            .filter_map(|row| field(row, column).parse::<f64>().ok());
        let values: Vec<f64> = known.collect();
        values.iter().sum::<f64>() / values.len() as f64
    };
    for column in ["nees", "prediction_error_m", "haptic_share_mean"] {
        let stated: f64 = field(episode, &format!("mean_{column}")).parse().unwrap();
        assert!((stated / mean(column) - 1.0).abs() < 1e-5, "{column}");
    }
    assert_eq!(
        (field(episode, "steps"), field(episode, "exported")),
        ("16", "10")
    );
}

/// The state string has commas in it, so it is in quotes; it stands behind all that is looked at here but the means.
fn table_of_episodes(steps: &Path) -> Vec<Vec<(String, String)>> {
    let path = episodes_path(steps);
    let text = std::fs::read_to_string(&path).unwrap();
    let parts: Vec<&str> = text.split('"').collect();
    assert_eq!(parts.len() % 2, 1);
    assert!(parts[1].starts_with("v=1;") && parts[1].contains("haptic:0.5"));
    let plain: Vec<&str> = parts.iter().step_by(2).copied().collect();
    std::fs::write(&path, plain.concat()).unwrap();
    table(&path)
}

#[test]
fn several_models_are_in_one_file_and_one_without_a_probe_has_no_positions() {
    let folder = tempfile::tempdir().unwrap();
    let fresh = untrained(folder.path().join("fresh"), three_experts());
    let fresh = fresh.to_str().unwrap();
    let options = ["--model", fresh, "--model", fresh, "--steps", "2-2"];
    let rows = table(&exported(folder.path(), "a.csv", &options));
    let names: Vec<&str> = rows.iter().map(|row| field(row, "model")).collect();
    assert_eq!(names, ["v-h-p", "v-h-p#2"]);
    for column in ["belief_x_m", "nees", "vision_pull_x_m"] {
        assert_eq!(field(&rows[0], column), "", "{column}");
    }
    assert_ne!(field(&rows[1], "vision_share_mean"), "");
}

#[test]
fn a_figure_has_the_frames_pixel_by_pixel_and_says_where_it_is_from() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--episode", "ep00005", "--every", "5", "--zoom", "2"];
    let path = exported(folder.path(), "a.png", &options);
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/sample_data/episodes.mcap");
    let episode = Dataset::open(Path::new(sample)).unwrap();
    let episode = episode.load(5, Layout::default()).unwrap();

    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    let info = reader.info();
    let texts: Vec<(String, String)> = info
        .uncompressed_latin1_text
        .iter()
        .map(|text| (text.keyword.clone(), text.text.clone()))
        .collect();
    let text = |key: &str| {
        let found = texts.iter().find(|(name, _)| name == key);
        found.unwrap_or_else(|| panic!("no {key}")).1.clone()
    };
    assert_eq!(text("poescope.data_hash"), "b3539a5a8378f6f9");
    assert!(text("poescope.error").contains("127.5") && text("poescope.zoom") == "2");
    assert!(text("poescope.state").starts_with("v=1;"));

    let width = info.width as usize;
    let pixel = |x: usize, y: usize| -> [u8; 3] {
        let at = 3 * (y * width + x);
        bytes[at..at + 3].try_into().unwrap()
    };
    // Steps 1, 6, 11 and 16; labels of five letters at the left, three lines above; gaps of two.
    let (left, top, cell) = (8 + 5 * 8 + 8, 8 + 3 * 12, 2 * 64 + 2);
    let place = |column: usize, row: usize, i: usize| {
        let (x, y) = (i % 64, i / 64);
        [left + column * cell + 2 * x, top + row * cell + 2 * y]
    };
    for (column, step) in [0, 5, 10, 15].into_iter().enumerate() {
        for (i, &grey) in episode.frames[step].pixels.iter().enumerate() {
            let [x, y] = place(column, 0, i);
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                assert_eq!(pixel(x + dx, y + dy), [grey; 3]);
            }
            let [frame, error] = [1, 2].map(|row| {
                let [x, y] = place(column, row, i);
                pixel(x, y)
            });
            if step == 0 {
                assert_eq!(frame, error, "there is no belief yet");
            } else {
                let difference = i16::from(frame[0]) - i16::from(grey);
                assert_eq!(error, color::signed(difference));
            }
        }
    }
    let bar = pixel(left + cell - 2, top + 10);
    assert_eq!(bar, [0; 3], "the context ends before the second column");
    assert_eq!(pixel(left + 2 * cell - 2, top + 10), [255; 3]);
}

#[test]
fn a_contact_sheet_has_two_rows_an_episode() {
    let folder = tempfile::tempdir().unwrap();
    let sheet = |name, options: &[&str]| {
        let all = [&["--figure", "sheet"], options].concat();
        let path = exported(folder.path(), name, &all);
        image::image_dimensions(path).unwrap()
    };
    let (width, one) = sheet("one.png", &["--episode", "ep00000"]);
    let (_, three) = sheet(
        "three.png",
        &[
            "--episode",
            "ep00000",
            "--episode",
            "ep00004",
            "--episode",
            "ep00009",
        ],
    );
    assert_eq!(width, 4 + 16 * 8 + 4 + 16 * 66 + 4);
    assert_eq!((one, three), (16 + 2 * 66 + 4, 16 + 3 * (2 * 66 + 4)));
}

#[test]
fn the_terminal_can_be_had_as_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let state = "v=1;episode=ep00002;step=9";
    let options = ["--figure", "view", "--size", "80x24", "--state", state];
    let draw = |name, keys: &str| {
        let all = [&options[..], &["--keys", keys]].concat();
        image::open(exported(folder.path(), name, &all))
            .unwrap()
            .into_rgb8()
    };
    let [on, off] = [draw("on.png", "l"), draw("off.png", "l1")];
    assert_eq!(on.dimensions(), (80 * 8, 24 * 16));
    let differ = on
        .pixels()
        .zip(off.pixels())
        .filter(|(a, b)| a != b)
        .count();
    assert!((200..80 * 8 * 24 * 16 / 2).contains(&differ), "{differ}");
    // All but the message in the last line.
    let above = |image: &image::RgbImage| image.as_raw()[..80 * 8 * 23 * 16 * 3].to_vec();
    assert!(above(&on) == above(&draw("again.png", "l11")));
}

#[test]
fn what_cannot_be_exported_says_why_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |options: &[&str]| {
        let mut command = poescope();
        let out = folder.path().join(options[0]);
        let output = command
            .arg("export")
            .arg("--out")
            .arg(out)
            .args(&options[1..])
            .output()
            .unwrap();
        assert!(!output.status.success(), "{options:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    for (options, word) in [
        (&["a.txt"][..], "--format"),
        (&["no/a.csv"], "make it first"),
        (&["a.csv", "--episode", "nobody"], "poescope info"),
        (&["a.csv", "--split", "val"], "no episode of split val"),
        (&["a.csv", "--steps", "40-50"], "ep00000 has 16 steps"),
        (&["a.csv", "--steps", "5-4"], "FIRST-LAST"),
        (&["a.csv", "--steps", "0-4"], "FIRST-LAST"),
        (
            &["a.csv", "--state", "v=1;context=many"],
            "--state: context",
        ),
        (&["a.csv", "--state", "v=1;model=vhp"], "--model FOLDER"),
        (&["a.csv", "--state", "v=1;episode=no"], "poescope info"),
        (&["a.png", "--figure", "view", "--steps", "4"], "one moment"),
        (
            &["a.png", "--figure", "view", "--state", "v=1;episode=no"],
            "--state: episode",
        ),
    ] {
        let said = refused(options);
        assert!(said.contains(word), "{options:?}: {said}");
        assert!(!said.contains("panicked"));
        let left = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 0, "{options:?} left something behind");
    }
    let mine = folder.path().join("a.csv");
    std::fs::write(&mine, "mine").unwrap();
    let said = refused(&["a.csv"]);
    assert!(said.contains("--force"), "{said}");
    assert_eq!(std::fs::read(&mine).unwrap(), b"mine");
    let data = folder.path().join("data.mcap");
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/sample_data/episodes.mcap");
    std::fs::copy(sample, &data).unwrap();
    let said = refused(&["data.mcap", "--force", "--data", data.to_str().unwrap()]);
    assert!(said.contains("the recording itself"), "{said}");
    exported(folder.path(), "a.csv", &["--force"]);
    assert_ne!(std::fs::read(&mine).unwrap(), b"mine");
}

#[test]
fn a_state_says_the_episode_and_the_steps_and_the_same_command_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let state =
        "v=1;episode=ep00004;step=2;model=v-h-p;select=4-9;corrupt=vision:noise:0.5@3-7;seed=6";
    let one = exported(folder.path(), "one.jsonl", &["--state", state]);
    let read = lines(&one);
    let steps: Vec<_> = read
        .iter()
        .map(|line| line["step"].as_u64().unwrap())
        .collect();
    assert_eq!(steps, (4..=9).collect::<Vec<_>>());
    assert!(read.iter().all(|line| line["episode"] == "ep00004"));
    let own = read[2]["provenance"]["state"].as_str().unwrap();
    assert!(
        own.contains("step=6") && own.contains("corrupt=vision:noise:0.5@3-7"),
        "{own}"
    );
    let two = exported(folder.path(), "two.jsonl", &["--state", state]);
    assert_eq!(std::fs::read(one).unwrap(), std::fs::read(two).unwrap());
    for name in ["a.mcap", "a.png"] {
        let [one, two] = ["1", "2"].map(|prefix| {
            let name = format!("{prefix}{name}");
            std::fs::read(exported(folder.path(), &name, &["--state", state])).unwrap()
        });
        assert!(one == two, "{name}");
    }
}

/// A folder of two files, each with one episode of the name `ep00000`.
pub(crate) fn namesakes(folder: &Path) -> PathBuf {
    let data = folder.join("namesakes");
    std::fs::create_dir(&data).unwrap();
    for (file, seed) in [("a.mcap", "1"), ("b.mcap", "2")] {
        let options = ["--steps", "6", "--split", "test", "--seed", seed];
        simulated(data.join(file), 1, &options);
    }
    data
}

#[test]
fn episodes_of_one_name_are_found_as_state_strings_call_them() {
    let folder = tempfile::tempdir().unwrap();
    let data = namesakes(folder.path());
    let data = data.to_str().unwrap();
    let named = ["--episode", "ep00000", "--episode", "ep00000#2"];
    let options = [&named[..], &["--data", data]].concat();
    let both = lines(&exported(folder.path(), "both.jsonl", &options));
    assert_eq!(both.len(), 12);
    let (one, two) = (&both[3]["posterior"], &both[9]["posterior"]);
    assert_ne!(one, two);
    let state = both[9]["provenance"]["state"].as_str().unwrap();
    assert!(state.contains("episode=ep00000#2"), "{state}");
    let options = ["--data", data, "--state", state];
    let again = lines(&exported(folder.path(), "again.jsonl", &options));
    assert_eq!(again.len(), 6);
    assert_eq!(&again[3]["posterior"], two);
}

#[test]
fn names_that_differ_only_in_their_ending_have_tables_of_their_own() {
    for (steps, episodes) in [
        ("x/a.csv", "x/a.episodes.csv"),
        ("run.v1", "run.v1.episodes.csv"),
        ("run.v2", "run.v2.episodes.csv"),
    ] {
        assert_eq!(episodes_path(Path::new(steps)), Path::new(episodes));
    }
}

#[test]
fn a_state_that_a_model_refuses_is_said_beside_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    let state = "v=1;alpha=vision:0,haptic:0,proprio:0,prior:0";
    exported(folder.path(), "a.csv", &["--state", state]);
    let episodes = std::fs::read_to_string(folder.path().join("a.episodes.csv")).unwrap();
    assert!(episodes.contains("leaves no active expert"), "{episodes}");
}

#[test]
fn every_column_is_documented() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/export.md");
    let text = std::fs::read_to_string(path).unwrap();
    let keys = STEP_KEYS.iter().chain(&EPISODE_KEYS).copied();
    let of_steps = READINGS.iter().map(|reading| (reading.name, reading.says));
    let of_experts = OF_EXPERT.iter().chain(OF_SENSOR);
    let of_experts = of_experts.map(|reading| (reading.name, reading.says));
    let rows: Vec<_> = keys.chain(of_steps).chain(of_experts).collect();
    assert!(rows.len() > 60);
    for (name, says) in rows {
        let row = format!("| `{name}` | {says} |");
        assert!(text.contains(&row), "docs/export.md has no row {row}");
    }
    for name in MEANS.iter().chain(&EXPERT_MEANS) {
        assert!(text.contains(&format!("`{name}`")), "{name}");
    }
    for name in MEANS {
        assert!(
            READINGS.iter().any(|reading| reading.name == name),
            "{name}"
        );
    }
    for name in EXPERT_MEANS {
        let mut of_experts = OF_EXPERT.iter().chain(OF_SENSOR);
        assert!(of_experts.any(|reading| reading.name == name), "{name}");
    }
}
