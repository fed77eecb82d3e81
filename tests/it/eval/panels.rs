//! The curves over the horizon of models of several recipes.

use std::fs;
use std::path::Path;

use crate::common::{answer, poescope};

/// What is written in the SVG, in drawing order.
fn texts(svg: &str) -> Vec<&str> {
    let marks = svg.split("<text").skip(1);
    let inner = marks.map(|mark| mark.split_once('>').unwrap().1);
    inner.map(|text| text.split_once('<').unwrap().0).collect()
}

#[test]
fn each_recipe_has_its_panels_over_the_same_axes() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let scores = docs.join("results/pybullet/scores");
    let out = tempfile::tempdir().unwrap();
    let mut eval = poescope();
    eval.arg("eval").arg("--out").arg(out.path());
    for model in ["released-v-1", "fast-v-2"] {
        let file = scores.join(model).with_extension("jsonl.zst");
        eval.arg("--model").arg(file);
    }
    answer(&mut eval);
    let svg = fs::read_to_string(out.path().join("horizons.svg")).unwrap();
    let texts = texts(&svg);
    // Under the panels of a recipe stand its models and, in every row, the trivial predictors.
    let rows: Vec<_> = texts
        .split_inclusive(|&text| text == "mean frame")
        .collect();
    let [released, fast] = rows.as_slice() else {
        panic!("not two rows: {texts:?}");
    };
    // Every other text, the ticks of each axis among them, is the same in both.
    assert_eq!(released.len(), fast.len());
    for (a, b) in released.iter().zip(fast.iter()) {
        assert_eq!(a.replace("released", "fast"), b.replace(" seed 2", ""));
    }
    for title in ["Squared error", "SSIM", "PSNR"] {
        let titles = ["released", "fast"].map(|recipe| format!("{title}, {recipe}"));
        assert!(released.contains(&&*titles[0]) && fast.contains(&&*titles[1]));
    }
}
