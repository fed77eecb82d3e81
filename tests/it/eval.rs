//! The paper's tables from one command: whole, in shards, taken up again, and under switches.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

mod fairness;
mod panels;
mod scores;
mod sensors;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use candle_core::{DType, Device};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use poescope::model::Model;
use poescope::model::checkpoint;
use poescope::model::config::Config;
use serde_json::Value;

use crate::common::{answer, poescope, simulated, three_experts, untrained};

const EPISODES: usize = 20;
const TABLES: [&str; 8] = [
    "comparisons",
    "contact",
    "frames",
    "horizons",
    "models",
    "regression",
    "seeds",
    "shapley",
];

/// Simulated test episodes, and `v`, `vhp` and `v-h-p` before training.
struct Bench {
    folder: tempfile::TempDir,
    data: PathBuf,
    models: Vec<PathBuf>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let data = simulated(
            folder.path().join("test.mcap"),
            EPISODES,
            &["--steps", "9", "--split", "test"],
        );
        let named = |name: &str| {
            let mut config = Config::named(name).unwrap();
            config.step_secs = three_experts().step_secs;
            untrained(folder.path().join(name), config)
        };
        let models = ["v", "vhp"].map(named).into_iter();
        let models = models.chain([untrained(folder.path().join("v-h-p"), three_experts())]);
        Self {
            models: models.collect(),
            data,
            folder,
        }
    }

    fn eval(&self, options: &[&str]) -> Command {
        let mut eval = poescope();
        eval.args(["eval", "--horizon", "5"])
            .args(options)
            .arg("--data")
            .arg(&self.data);
        for model in &self.models {
            eval.arg("--model").arg(model);
        }
        eval
    }

    fn out(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

/// Files of a result, without the scores they were made from.
fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| {
            (
                path.file_name().unwrap().to_string_lossy().into_owned(),
                fs::read(&path).unwrap(),
            )
        })
        .collect();
    files.sort();
    files
}

/// The score files of a run, in the order of the models' names.
fn score_files(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out.join("scores")).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// The first of a model.
fn score_file(out: &Path, model: &str) -> PathBuf {
    let start = format!("{model}-");
    let of = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        // After the model there is the hash, sixteen digits long.
        let hash = name
            .strip_prefix(&start)
            .and_then(|rest| rest.split_once(['-', '.']));
        hash.is_some_and(|(hash, _)| hash.len() == 16)
    };
    score_files(out).into_iter().find(of).unwrap()
}

/// What a command that must fail complains of.
fn complaint(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{said}");
    said
}

#[test]
fn shards_and_interrupted_runs_come_to_the_same_bytes() {
    let bench = Bench::new();
    let [whole, shards, torn] = ["whole", "shards", "torn"].map(|name| bench.out(name));
    let said = answer(bench.eval(&[]).arg("--out").arg(&whole));
    for shard in ["1/2", "2/2"] {
        let options = ["--shard", shard];
        // Half of it cannot be summed up yet.
        assert_eq!(answer(bench.eval(&options).arg("--out").arg(&shards)), "");
        let merged = bench
            .eval(&["--merge"])
            .arg("--out")
            .arg(&shards)
            .output()
            .unwrap();
        assert_eq!(merged.status.success(), shard == "2/2");
        let complaint = String::from_utf8(merged.stderr).unwrap();
        assert!(
            shard == "2/2" || complaint.contains("10 of 20 episodes are not scored yet"),
            "{complaint}"
        );
    }
    let expected = results(&whole);
    let names: Vec<&str> = expected.iter().map(|(name, _)| name.as_str()).collect();
    for name in TABLES {
        assert!(
            names.contains(&&*format!("{name}.csv"))
                && names.contains(&&*format!("{name}.parquet"))
        );
    }
    for figure in ["contact", "ellipses", "horizons", "strips"] {
        assert!(
            names.contains(&&*format!("{figure}.svg"))
                && names.contains(&&*format!("{figure}.png"))
        );
    }
    assert_eq!(fs::read_to_string(whole.join("tables.md")).unwrap(), said);
    assert!(results(&shards) == expected);
    // What shards have left is in one file, for whom it is handed to.
    let merged = fs::read_to_string(
        shards
            .join("scores")
            .join(score_file(&whole, "vhp").file_name().unwrap()),
    );
    assert_eq!(
        merged.unwrap(),
        fs::read_to_string(score_file(&whole, "vhp")).unwrap()
    );

    // A run that was killed while it wrote: one model done, of another the head, some lines, and half of one.
    let of_vhp = score_file(&whole, "vhp");
    let scores = fs::read_to_string(&of_vhp).unwrap();
    let lines: Vec<&str> = scores.split_inclusive('\n').collect();
    assert_eq!(lines.len(), 1 + EPISODES);
    fs::create_dir_all(torn.join("scores")).unwrap();
    let place = |path: &Path| torn.join("scores").join(path.file_name().unwrap());
    let half = lines[..8].concat() + &lines[8][..lines[8].len() / 2];
    fs::write(place(&of_vhp), half).unwrap();
    let done = score_file(&whole, "v");
    fs::copy(&done, place(&done)).unwrap();
    answer(bench.eval(&[]).arg("--out").arg(&torn));
    assert!(results(&torn) == expected);
    assert_eq!(fs::read_to_string(place(&of_vhp)).unwrap(), scores);

    // Scores of another protocol or under other settings do not mix with these.
    for (options, why) in [
        (
            ["--context", "3"],
            "holds scores of 4 images seen and 5 predicted; give --context 4 --horizon 5",
        ),
        (
            ["--state", "alpha=vision:0.5"],
            "holds scores under other settings; give the same --state, or choose another --out",
        ),
    ] {
        let said = complaint(bench.eval(&options).arg("--out").arg(&whole));
        assert!(said.contains(why), "{said}");
    }
    // Nor do two runs write to one file.
    let file = fs::File::open(score_file(&whole, "v")).unwrap();
    file.lock().unwrap();
    let said = complaint(bench.eval(&[]).arg("--out").arg(&whole));
    assert!(said.contains("another run writes to it"), "{said}");
    drop(file);
    // A model that was trained further is scored anew, and nothing of what it was before stays in the tables.
    let model = Model::new(three_experts(), 8, &Device::Cpu).unwrap();
    checkpoint::save(&model, &bench.models[2], DType::F16, None).unwrap();
    answer(bench.eval(&[]).arg("--out").arg(&whole));
    let anew = bench.out("anew");
    answer(bench.eval(&[]).arg("--out").arg(&anew));
    assert_eq!(
        [score_files(&whole).len(), score_files(&anew).len()],
        [4, 3]
    );
    assert!(results(&whole) == results(&anew) && results(&anew) != expected);
}

/// Head and rows of a table, as they are written.
fn csv(out: &Path, name: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(out.join(format!("{name}.csv"))).unwrap();
    let row = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().map(row).collect()
}

/// The same of its Parquet file, numbers as CSV has them.
fn parquet(out: &Path, name: &str) -> Vec<Vec<String>> {
    let file = fs::File::open(out.join(format!("{name}.parquet"))).unwrap();
    let file = SerializedFileReader::new(file).unwrap();
    let schema = file.metadata().file_metadata().schema_descr();
    let head = schema.columns().iter().map(|c| c.name().to_owned());
    let mut rows = vec![head.collect()];
    for row in file.get_row_iter(None).unwrap() {
        let cell = |(_, field): (String, Field)| match field {
            Field::Null => String::new(),
            Field::Str(text) => text,
            Field::Long(number) => number.to_string(),
            Field::Double(number) => format!("{number:?}"),
            other => panic!("{other:?}"),
        };
        rows.push(row.unwrap().into_columns().into_iter().map(cell).collect());
    }
    rows
}

#[test]
fn tables_say_the_same_in_every_format() {
    let bench = Bench::new();
    let out = bench.out("out");
    let report: Value =
        serde_json::from_str(&answer(bench.eval(&["--json"]).arg("--out").arg(&out))).unwrap();
    for name in TABLES {
        let [csv, parquet] = [csv(&out, name), parquet(&out, name)];
        assert!(csv.len() == parquet.len(), "{name}: rows");
        assert!(csv == parquet, "{name}");
    }
    let frames = csv(&out, "frames");
    let head = "index,episode,model,horizon,squared_error,ssim,psnr_db";
    assert_eq!(frames[0].join(","), head);
    // Three models, two of them products that stand without their prior as well, and the two trivial predictors.
    assert_eq!(frames.len() - 1, EPISODES * 5 * 7);
    let of_vhp = frames.iter().filter(|row| row[2] == "vhp");
    let sum: f64 = of_vhp.map(|row| row[4].parse::<f64>().unwrap()).sum();
    let rmse = (sum / (EPISODES * 5) as f64).sqrt();
    let mut rows = report["quality"].as_array().unwrap().iter();
    let row = rows.find(|row| row["subject"] == "vhp").unwrap();
    assert!((row["rmse"].as_f64().unwrap() - rmse).abs() < 1e-9);
    let models = csv(&out, "models");
    assert_eq!(models.len(), 1 + 7);
    let row = models.iter().find(|row| row[0] == "vhp").unwrap();
    let hash = report["scope"]["data_hash"].as_str().unwrap();
    assert_eq!(row[1..5], ["test.mcap", hash, "test", "20"]);
    assert!((row[5].parse::<f64>().unwrap() - rmse).abs() < 1e-9);
    let [ours, _, context, horizon] = &row[row.len() - 4..] else {
        panic!("{row:?}");
    };
    assert_eq!((context.as_str(), horizon.as_str()), ("4", "5"));
    // The tables as text say the same of where they come from.
    let tables = fs::read_to_string(out.join("tables.md")).unwrap();
    for hash in [ours.as_str(), hash] {
        assert!(hash.len() == 16 && tables.contains(&format!("| {hash} |")));
    }
    // Around contact the experts' shares of a belief add up to one.
    let contact = csv(&out, "contact");
    let after = contact
        .iter()
        .filter(|row| row[0] == "v-h-p" && row[2] == "1");
    let shares: Vec<f64> = after.map(|row| row[4].parse().unwrap()).collect();
    assert_eq!(shares.len(), 4, "{contact:?}");
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-5);
    // Shapley values add up to what all sensors save over none, episode by episode.
    let credits = |model: &str| -> Vec<Value> {
        let scores = fs::read_to_string(score_file(&out, model)).unwrap();
        let credit = |line: &str| {
            let episode: Value = serde_json::from_str(line).unwrap();
            episode["outcome"]["scores"]["subjects"][0]["credit"].clone()
        };
        scores.lines().skip(1).map(credit).collect()
    };
    for credit in credits("v-h-p") {
        let parts = credit["squared_error"].as_array().unwrap().iter();
        let sum: f64 = parts.map(|part| part.as_f64().unwrap()).sum();
        assert!((sum - credit["squared_error_gain"].as_f64().unwrap()).abs() < 1e-9);
    }
    assert!(credits("v").iter().all(Value::is_null));
}

#[test]
fn switches_and_damage_stand_beside_the_models_as_trained() {
    let bench = Bench::new();
    let states = [
        "--json",
        "--state",
        "alpha=haptic:0",
        "--state",
        "corrupt=vision:noise:0.5",
    ];
    let report: Value = serde_json::from_str(&answer(&mut bench.eval(&states))).unwrap();
    let psnr = |subject: &str| {
        let mut rows = report["quality"].as_array().unwrap().iter();
        let row = rows.find(|row| row["subject"] == subject);
        row.map(|row| row["psnr_db"]["mean"].as_f64().unwrap())
    };
    assert_ne!(psnr("vhp"), psnr("vhp (prior off)"));
    // Only one model has a haptic expert; all of them see.
    assert!(psnr("v-h-p (alpha=haptic:0)").is_some() && psnr("vhp (alpha=haptic:0)").is_none());
    for model in ["v", "vhp", "v-h-p"] {
        let (own, damaged) = (
            psnr(model),
            psnr(&format!("{model} (corrupt=vision:noise:0.5)")),
        );
        assert!(
            own.is_some() && damaged.is_some() && own != damaged,
            "{model}: {own:?} {damaged:?}"
        );
    }
    // A row is named by what counts, once.
    let pasted = "v=1;episode=x;step=3;alpha=haptic:0@1-;context=2";
    let states = ["--json", "--state", pasted, "--state", "alpha=haptic:0"];
    let report: Value = serde_json::from_str(&answer(&mut bench.eval(&states))).unwrap();
    let rows = report["quality"].as_array().unwrap().iter();
    let switched = rows.filter(|row| row["subject"] == "v-h-p (alpha=haptic:0)");
    assert_eq!(switched.count(), 1);
    for (state, what) in [
        ("alpha=haptic:2000", "is not like vision:0"),
        (
            "alpha=haptic:0;damage=vision:noise:1",
            "damage: no such key",
        ),
        (
            "alpha=haptic:0;controls=from:2,mirror",
            "controls: a prediction from other",
        ),
        (
            "alpha=vision:0@12-,joint:0@99999999999-,prior:0@12-",
            "leaves no expert of model `vhp` on",
        ),
        ("episode=x", "switches and damages nothing"),
        ("alpha=concat:0", "no model multiplies these experts"),
        (
            "alpha=vision:0,joint:0,prior:0",
            "leaves no expert of model `vhp` on",
        ),
    ] {
        let output = bench.eval(&["--state", state]).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            !output.status.success() && said.contains(what),
            "{state}: {said}"
        );
    }
}

#[test]
fn episodes_of_one_name_stay_apart_and_short_ones_are_left_out_once() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    fs::create_dir(&data).unwrap();
    for (file, steps, seed) in [
        ("a.mcap", "9", "1"),
        ("b.mcap", "9", "2"),
        ("c.mcap", "7", "3"),
    ] {
        let options = ["--steps", steps, "--seed", seed, "--split", "test"];
        simulated(data.join(file), 2, &options);
    }
    let model = untrained(folder.path().join("model"), three_experts());
    let out = folder.path().join("out");
    let eval = |options: &[&str]| {
        let mut eval = poescope();
        eval.args(["eval", "--json", "--horizon", "5"])
            .args(options);
        eval.arg("--data").arg(&data).arg("--model").arg(&model);
        eval.arg("--out").arg(&out).output().unwrap()
    };
    let episodes = |output: &std::process::Output| {
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        report["episodes"].as_u64().unwrap()
    };
    let first = eval(&[]);
    let said = String::from_utf8_lossy(&first.stderr).into_owned();
    assert_eq!(said.matches("has 7 images of 9").count(), 2, "{said}");
    assert_eq!(episodes(&first), 4);
    let merged = eval(&["--merge"]);
    let said = String::from_utf8_lossy(&merged.stderr).into_owned();
    assert!(
        !said.contains("left out") && episodes(&merged) == 4,
        "{said}"
    );
}

#[test]
fn the_mit_protocol_stands_beside_the_papers_numbers_which_are_marked() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--steps", "42", "--split", "val"];
    let data = simulated(folder.path().join("val.mcap"), 2, &options);
    let model = untrained(folder.path().join("model"), three_experts());
    let mut eval = poescope();
    eval.args(["eval", "--preset", "mit"])
        .arg("--data")
        .arg(&data);
    let said = answer(eval.arg("--model").arg(&model));
    assert!(
        said.starts_with("2 episodes of split `val`, 5 images seen, 37 predicted"),
        "{said}"
    );
    assert!(said.contains("Quoted from the paper: Table 2") && said.contains("Table 3"));
    for quoted in [
        "| vhp (quoted) | 1.734 |",
        "| EKF, supervised, filtered (quoted) | 1.33 |",
    ] {
        assert!(said.contains(quoted), "{said}");
    }
}

#[test]
fn seeds_stand_together_and_regressors_can_be_fitted_anew() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--steps", "9", "--split", "test"];
    let test = simulated(folder.path().join("test.mcap"), 4, &options);
    let options = ["--steps", "9", "--split", "train", "--seed", "5"];
    let train = simulated(folder.path().join("train.mcap"), 12, &options);
    let mut eval = poescope();
    eval.args(["eval", "--json", "--horizon", "5"])
        .arg("--data")
        .arg(&test);
    // One of them twice: it counts once.
    for (place, seed) in ["2", "1", "2"].into_iter().enumerate() {
        let model = untrained(folder.path().join(place.to_string()), three_experts());
        fs::write(model.join("report.json"), format!("{{\"seed\": {seed}}}")).unwrap();
        eval.arg("--model").arg(&model);
    }
    let report: Value = serde_json::from_str(&answer(eval.arg("--fit").arg(&train))).unwrap();
    let labels = report["quality"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| &row["subject"]);
    let labels: Vec<&str> = labels.map(|label| label.as_str().unwrap()).collect();
    assert_eq!(
        labels[..3],
        ["v-h-p seed 2", "v-h-p seed 1", "v-h-p seed 2#3"]
    );
    assert_eq!(report["seeds"][0]["label"], "v-h-p");
    assert_eq!(report["seeds"][0]["seeds"], 2);
    let found = &report["comparisons"][0];
    assert_eq!(
        [&found["first"], &found["second"]],
        ["v-h-p", "v-h-p (prior off)"]
    );
    assert_eq!(found["seeds"][1], 2);
    let regression = report["regression"].as_array().unwrap().iter();
    assert_eq!(
        regression.filter(|row| row["fitted_on"] == "train").count(),
        4 * 6
    );
}
