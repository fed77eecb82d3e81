//! What goes wrong is one line that says what, where, and what to do.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use candle_core::{Device, Tensor, safetensors};
use poescope::model::checkpoint::{CONFIG, WEIGHTS};

use crate::common::{poescope, simulated, three_experts, untrained};
use crate::data::sample;

/// Runs it, and holds its complaint to one plain line with all of `words`.
fn complaint<S: AsRef<OsStr>>(arguments: &[S], words: &[&str]) {
    let mut command = poescope();
    // A caller's wish for backtraces must not make many lines of one.
    let output = command
        .args(arguments)
        .env("RUST_BACKTRACE", "1")
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{command:?}: {said}");
    assert_eq!(said.lines().count(), 1, "{command:?}: {said}");
    assert!(
        said.starts_with("poescope: ") && said.ends_with('\n'),
        "{said}"
    );
    assert!(
        !said.contains('\u{1b}') && !said.contains("panicked"),
        "{said:?}"
    );
    for word in words {
        assert!(said.contains(word), "no {word:?} in {said}");
        assert_eq!(
            said.matches(word).count(),
            1,
            "{word:?} is said twice in {said}"
        );
    }
}

fn view(data: &Path, model: &Path, words: &[&str]) {
    let [data, model] = [data, model].map(Path::as_os_str);
    let arguments = ["view".as_ref(), "--print".as_ref()];
    let arguments = [
        &arguments[..],
        &["--data".as_ref(), data, "--model".as_ref(), model],
    ];
    complaint(&arguments.concat(), words);
}

struct Checkpoint {
    // Holds the folder until the test ends.
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Checkpoint {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = untrained(folder.path().join("model"), three_experts());
        Self {
            _folder: folder,
            path,
        }
    }

    fn weights(&self) -> PathBuf {
        self.path.join(WEIGHTS)
    }

    /// Edits the config as it was at first.
    fn edit_config(&self, edit: impl Fn(&str) -> String) {
        let text = toml::to_string(&three_experts()).unwrap();
        let edited = edit(&text);
        assert_ne!(text, edited);
        fs::write(self.path.join(CONFIG), edited).unwrap();
    }

    fn edit_tensors(&self, edit: impl Fn(&mut HashMap<String, Tensor>)) {
        let path = self.weights();
        let mut tensors = safetensors::load(&path, &Device::Cpu).unwrap();
        edit(&mut tensors);
        safetensors::save(&tensors, path).unwrap();
    }
}

#[test]
fn data_that_is_not_there_or_no_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pushes.mcap");
    let checkpoint = Checkpoint::new();
    let refused = |words: &[&str]| {
        complaint(&["info".as_ref(), path.as_os_str()], words);
        view(&path, &checkpoint.path, words);
    };
    refused(&["pushes.mcap", "No such file", "check the path"]);
    fs::write(&path, "time,fx,fy\n0.0,1.0,2.0\n").unwrap();
    refused(&["pushes.mcap", "not an MCAP file"]);
    let bytes = fs::read(sample()).unwrap();
    fs::write(&path, &bytes[..200]).unwrap();
    view(
        &path,
        &checkpoint.path,
        &["pushes.mcap", "cut off at byte", "record or copy it again"],
    );
}

#[test]
fn a_model_that_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    view(
        &sample(),
        &folder.path().join("nothing"),
        &["nothing/config.toml", "No such file", "`poescope train`"],
    );
    let data = sample();
    let arguments = ["train", "--resume", "--out", "nothing", "--data"];
    let mut arguments: Vec<&OsStr> = arguments.iter().map(AsRef::as_ref).collect();
    arguments.push(data.as_os_str());
    complaint(&arguments, &["nothing to resume", "No such file"]);
    arguments[1] = "--model".as_ref();
    arguments.insert(2, "vph".as_ref());
    complaint(&arguments, &["no model \"vph\"", "vhp-c, v-h-p"]);
}

#[test]
fn a_training_that_cannot_begin() {
    let checkpoint = Checkpoint::new();
    // Its episodes are all to be tested on.
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample_data/episodes.mcap");
    let config = checkpoint.path.join(CONFIG);
    let out = checkpoint.path.join("run");
    let refused = |options: &[&OsStr], words: &[&str]| {
        let common: [&OsStr; 5] = [
            "train".as_ref(),
            "--data".as_ref(),
            data.as_ref(),
            "--out".as_ref(),
            out.as_ref(),
        ];
        complaint(&[&common[..], options].concat(), words);
    };
    refused(
        &[
            "--model".as_ref(),
            "vp".as_ref(),
            "--config".as_ref(),
            config.as_ref(),
        ],
        &["--model vp is not what --config describes", "leave one"],
    );
    refused(
        &[],
        &["0 episodes to train on", "of another split (poescope info)"],
    );
}

#[test]
fn damaged_weights() {
    let checkpoint = Checkpoint::new();
    let whole = fs::read(checkpoint.weights()).unwrap();
    let remedy = "train again, or copy the checkpoint anew";
    let refused = |words: &[&str]| view(&sample(), &checkpoint.path, words);

    let mut flipped = whole.clone();
    flipped[9] ^= 0x40;
    fs::write(checkpoint.weights(), &flipped).unwrap();
    refused(&["weights.safetensors: not safetensors", remedy]);
    flipped[7] = 0xff;
    fs::write(checkpoint.weights(), &flipped).unwrap();
    refused(&["weights.safetensors: not safetensors", remedy]);
    for length in [0, 5, 300, whole.len() / 2] {
        fs::write(checkpoint.weights(), &whole[..length]).unwrap();
        refused(&["weights.safetensors: not safetensors", remedy]);
    }

    fs::write(checkpoint.weights(), &whole).unwrap();
    checkpoint.edit_tensors(|tensors| {
        tensors.remove("dyn.linear.bias").unwrap();
    });
    refused(&["tensor `dyn.linear.bias` is missing", remedy]);
    fs::write(checkpoint.weights(), &whole).unwrap();
    checkpoint.edit_tensors(|tensors| {
        let tensor = tensors.get_mut("dyn.linear.bias").unwrap();
        *tensor = tensor.affine(f64::NAN, 0.0).unwrap();
    });
    refused(&[
        "`dyn.linear.bias` holds numbers that are not finite",
        remedy,
    ]);
    fs::remove_file(checkpoint.weights()).unwrap();
    refused(&["weights.safetensors: No such file", "`poescope train`"]);
}

#[test]
fn a_config_that_is_none() {
    let checkpoint = Checkpoint::new();
    let refused = |from: &str, to: &str, words: &[&str]| {
        checkpoint.edit_config(|text| text.replacen(from, to, 1));
        let remedy = "correct it there";
        view(
            &sample(),
            &checkpoint.path,
            &[&["config.toml", remedy], words].concat(),
        );
    };
    refused(
        "latent =",
        "latnet =",
        &["line 8: ", "unknown field `latnet`"],
    );
    refused(
        "latent = 16",
        "latent = \"16\"",
        &["line 8: ", "expected usize"],
    );
    refused("latent = 16\n", "", &["missing field `latent`"]);
    refused(
        "frame_size = 64",
        "frame_size = 96",
        &["key `frame_size`", "64 pixels"],
    );
    refused("\"fx\"", "\"fq\"", &["key `haptic`", "no channel \"fq\""]);
    refused("latent =", "latent", &["line 8"]);
}

#[test]
fn a_model_of_other_data() {
    let folder = tempfile::tempdir().unwrap();
    let remedy = "choose a model trained on such data";
    let checkpoint = Checkpoint::new();
    let options = ["--rate-hz", "240", "--steps", "6", "--split", "test"];
    let fast = simulated(folder.path().join("fast.mcap"), 1, &options);
    let words = ["fast.mcap", "0.267 s apart", "0.133 s apart", remedy];
    view(&fast, &checkpoint.path, &words);
    let [data, model] = [&fast, &checkpoint.path].map(|path| path.as_os_str());
    let arguments = ["eval", "--data", "--model"].map(OsStr::new);
    let arguments = [arguments[0], arguments[1], data, arguments[2], model];
    complaint(&arguments, &words);

    // Other units.
    checkpoint.edit_config(|text| {
        let scale = "\"tz\"]\nmean = [0, 0, 0, 0, 0, 0]\nscale = [1e-4, 1e-4, 1e-4, 1, 1, 1]\n";
        let at = text.find("[haptic]").unwrap();
        let end = at + text[at..].find("\n\n").unwrap();
        let names = "[haptic]\nnames = [\"fx\", \"fy\", \"fz\", \"tx\", \"ty\", ";
        format!("{}{names}{scale}{}", &text[..at], &text[end..])
    });
    let words = ["python_written.mcap", "channel `fx`", remedy];
    view(&sample(), &checkpoint.path, &words);

    // Other dimensions than its weights'.
    checkpoint.edit_config(|text| text.replacen("\"fx\", \"fy\", ", "", 1));
    let words = [
        "weights.safetensors",
        "haptic_enc.",
        "where the config wants",
    ];
    view(&sample(), &checkpoint.path, &words);
}

#[test]
fn a_state_of_what_is_not_there_is_not_answered_for_something_else() {
    for state in ["v=1;episode=nope;step=3", "v=1;model=nope", "nope"] {
        complaint(
            &["view", "--json", "--state", state],
            &["--state: ", "nope"],
        );
    }
    // What a later version may have written is no fault.
    let known = poescope()
        .args(["view", "--json", "--state", "v=1;step=3;lens=4"])
        .output()
        .unwrap();
    assert!(known.status.success());
}
