//! Score files: handed on, packed, damaged, renamed, and written by several at once.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{Bench, EPISODES, complaint, csv, results, score_file, score_files};
use crate::common::{answer, poescope, simulated};

/// Packs the lines of a score file that `keep` wants.
fn pack(scores: &Path, packed: &Path, keep: fn(usize) -> bool) {
    let scores = fs::read(scores).unwrap();
    let lines = scores.split_inclusive(|&byte| byte == b'\n').enumerate();
    let kept: Vec<&[u8]> = lines
        .filter(|(i, _)| keep(*i))
        .map(|(_, line)| line)
        .collect();
    fs::write(packed, zstd::encode_all(&*kept.concat(), 3).unwrap()).unwrap();
}

#[test]
fn scores_stand_for_models_without_their_weights() {
    let bench = Bench::new();
    let whole = bench.out("whole");
    let said = answer(bench.eval(&[]).arg("--out").arg(&whole));
    let names = ["v", "vhp", "v-h-p"];
    let packed = names.map(|model| {
        let path = bench.out(&format!("{model}.jsonl.zst"));
        pack(&score_file(&whole, model), &path, |_| true);
        path
    });
    let eval = |models: &[&PathBuf], options: &[&str]| {
        let mut eval = poescope();
        // Nothing of the samples is here.
        eval.current_dir(bench.folder.path())
            .arg("eval")
            .args(options);
        eval.args(
            models
                .iter()
                .flat_map(|model| [Path::new("--model"), model]),
        );
        eval
    };
    let [v, vhp, v_h_p] = &packed;
    // One of them from its scores, also where the dataset has another name by now.
    let renamed = bench.out("renamed.mcap");
    fs::copy(&bench.data, &renamed).unwrap();
    let out = bench.out("mixed");
    let mut mixed = eval(
        &[&bench.models[0], &bench.models[1], v_h_p],
        &["--horizon", "5"],
    );
    answer(mixed.arg("--data").arg(&renamed).arg("--out").arg(&out));
    let tables = |out: &Path| fs::read_to_string(out.join("tables.md")).unwrap();
    assert_eq!(tables(&out), said);
    assert_eq!(score_files(&out).len(), 2);
    // A command that fails leaves no scores, which would stand in the way of the next.
    let out = bench.out("failed");
    let mut wrong = eval(&[&bench.models[0], v_h_p], &["--horizon", "4"]);
    let wrong = wrong.arg("--data").arg(&bench.data).arg("--out").arg(&out);
    assert!(
        complaint(wrong).contains("v-h-p.jsonl.zst: scores of 4 images seen and 5 predicted; give")
    );
    assert!(!out.join("scores").exists());

    // The same tables where neither weights nor episodes are at hand; frames cannot be drawn.
    fs::remove_file(&bench.data).unwrap();
    bench
        .models
        .iter()
        .for_each(|model| fs::remove_dir_all(model).unwrap());
    let all = [v, vhp, v_h_p];
    // Strips of an earlier run do not stay beside other tables.
    let out = bench.out("alone");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("strips.png"), "old").unwrap();
    let mut alone = eval(&all, &["--horizon", "5"]);
    assert_eq!(answer(alone.arg("--out").arg(&out)), said);
    let mut expected = results(&whole);
    expected.retain(|(name, _)| !name.starts_with("strips"));
    assert!(results(&out) == expected);
    let other = simulated(
        bench.out("other.mcap"),
        3,
        &["--steps", "9", "--split", "test"],
    );
    let other = other.to_str().unwrap();
    for (options, why) in [
        (
            ["--context", "4"],
            "v.jsonl.zst: scores of 4 images seen and 5 predicted; give --context 4 --horizon 5",
        ),
        (
            ["--state", "alpha=vision:0"],
            "no scores under `alpha=vision:0`; name its checkpoint folder",
        ),
        (["--data", other], "scores of test.mcap ("),
        (
            ["--split", "val"],
            "scores of split `test`, not of `val`; give --split test",
        ),
        (["--shard", "1/2"], "--shard"),
        (["--fit", other], "name the checkpoint folder instead"),
    ] {
        let mut command = eval(&all, &options);
        if options[0] != "--context" {
            command.args(["--horizon", "5"]);
        }
        let said = complaint(&mut command);
        assert!(said.contains(why), "{options:?}: {said}");
    }
    // Nor is half of it the whole, whether it is named first or last.
    pack(&score_file(&whole, "vhp"), vhp, |line| line < 9);
    for models in [[vhp, v], [v, vhp]] {
        let said = complaint(&mut eval(&models, &["--horizon", "5"]));
        assert!(
            said.contains("vhp.jsonl.zst lacks 12 of 20 episodes"),
            "{said}"
        );
    }
}

#[test]
fn the_scores_in_the_results_say_what_the_results_say() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let mut files: Vec<PathBuf> = fs::read_dir(docs.join("results/pybullet/scores"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let mut eval = poescope();
    eval.args(["eval", "--json"]);
    eval.args(files.iter().flat_map(|file| [Path::new("--model"), file]));
    let report: Value = serde_json::from_str(&answer(&mut eval)).unwrap();
    let results = fs::read_to_string(docs.join("results.md")).unwrap();
    let rows = report["quality"].as_array().unwrap();
    assert!(rows.len() >= 5 && report["episodes"] == 80);
    let as_trained = rows.iter().filter(|row| {
        let subject = row["subject"].as_str().unwrap();
        !subject.ends_with(')')
    });
    for row in as_trained {
        let psnr = format!("| {:.2} |", row["psnr_db"]["mean"].as_f64().unwrap());
        assert!(results.contains(&psnr), "{}: {psnr}", row["subject"]);
    }
}

#[test]
fn damaged_score_files_are_refused_by_line() {
    let mut bench = Bench::new();
    bench.models.truncate(2);
    let out = bench.out("out");
    answer(bench.eval(&[]).arg("--out").arg(&out));
    let path = score_file(&out, "vhp");
    let scores = fs::read_to_string(&path).unwrap();
    let damaged = |place: usize, damage: &dyn Fn(&mut Value)| {
        let mut lines: Vec<String> = scores.lines().map(str::to_owned).collect();
        let mut line = serde_json::from_str(&lines[place]).unwrap();
        damage(&mut line);
        lines[place] = line.to_string();
        fs::write(&path, lines.join("\n") + "\n").unwrap();
        let of_out = complaint(bench.eval(&[]).arg("--out").arg(&out));
        let mut alone = poescope();
        let alone = complaint(alone.args(["eval", "--horizon", "5", "--model"]).arg(&path));
        assert_eq!(of_out, alone);
        alone
    };
    let rows = |line: &mut Value| line["outcome"]["scores"]["subjects"].take();
    let row = |change: fn(&mut Value)| {
        move |line: &mut Value| change(&mut line["outcome"]["scores"]["subjects"][1])
    };
    for (place, damage, why) in [
        (
            0,
            &(|head: &mut Value| head["scores"] = 9.into()) as &dyn Fn(&mut Value),
            "of form 9",
        ),
        (
            0,
            &|head: &mut Value| head["model"]["config"]["latent"] = 0.into(),
            "`latent`",
        ),
        (0, &|head: &mut Value| *head = 7.into(), "not a score file"),
        (3, &|line: &mut Value| drop(rows(line)), "line 4 is damaged"),
        (
            3,
            &|line: &mut Value| line["outcome"] = Value::Null,
            "line 4 is damaged",
        ),
        (
            5,
            &row(|row| drop(row["frames"]["ssim"].as_array_mut().unwrap().pop())),
            "line 6 is damaged",
        ),
        (
            5,
            &row(|row| row["filtered"][0] = 1e39.into()),
            "line 6 is damaged",
        ),
        (
            5,
            &row(|row| drop(row["predicted"].as_array_mut().unwrap().pop())),
            "line 6 is damaged",
        ),
    ] {
        let said = damaged(place, damage);
        assert!(
            said.contains(why) && said.contains(path.to_str().unwrap()),
            "{said}"
        );
    }
}

#[test]
fn what_was_left_out_is_looked_at_again() {
    let bench = Bench::new();
    let out = bench.out("out");
    let eval = |options: &[&str]| answer(bench.eval(options).arg("--out").arg(&out));
    let said = eval(&[]);
    let path = score_file(&out, "vhp");
    let scores = fs::read_to_string(&path).unwrap();
    let first = scores.lines().nth(1).unwrap();
    let left_out = r#"{"index":0,"outcome":{"left_out":"it was damaged"}}"#;
    fs::write(&path, scores.replace(first, left_out)).unwrap();
    // To sum up is to take things as they are.
    assert!(eval(&["--merge"]).contains("(1 left out)"));
    assert_eq!(eval(&[]), said);
    assert_eq!(eval(&["--merge"]), said);
}

#[test]
fn the_hash_says_whose_scores_they_are() {
    let mut bench = Bench::new();
    bench.models.truncate(1);
    let out = bench.out("out");
    answer(bench.eval(&[]).arg("--out").arg(&out));
    let expected = fs::read_to_string(out.join("tables.md")).unwrap();
    // The folder has another name now; there is nothing left to score, and no second file.
    let renamed = bench.out("renamed");
    fs::rename(&bench.models[0], &renamed).unwrap();
    bench.models[0] = renamed.clone();
    answer(bench.eval(&["--merge"]).arg("--out").arg(&out));
    assert_eq!(fs::read_to_string(out.join("tables.md")).unwrap(), expected);
    // The same model twice is scored once.
    bench.models.push(renamed);
    let out = bench.out("twice");
    answer(bench.eval(&[]).arg("--out").arg(&out));
    let files = score_files(&out);
    assert_eq!(files.len(), 1);
    let lines = fs::read_to_string(&files[0]).unwrap().lines().count();
    assert_eq!(lines, 1 + EPISODES);
    let frames = csv(&out, "frames");
    let of = |model: &str| -> Vec<String> {
        let own = frames.iter().filter(|row| row[2] == model);
        own.map(|row| row[4].clone()).collect()
    };
    assert!(of("v#1") == of("v#2") && !of("v#1").is_empty());
}

#[test]
fn a_shard_leaves_the_files_of_others_alone() {
    let bench = Bench::new();
    let out = bench.out("out");
    answer(bench.eval(&["--shard", "1/2"]).arg("--out").arg(&out));
    // The other one is writing a line.
    let other = score_file(&out, "vhp");
    let mut text = fs::read_to_string(&other).unwrap();
    text.truncate(text.len() - 40);
    fs::write(&other, &text).unwrap();
    answer(bench.eval(&["--shard", "2/2"]).arg("--out").arg(&out));
    assert!(fs::read_to_string(&other).unwrap() == text);
}
