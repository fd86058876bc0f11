//! Tests `etendue variance`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{fails, files, json, passes, refused, scene, told};
use ndarray::{Array2, array};
use ndarray_npy::WriteNpyExt;
use serde_json::Value;
use std::fs::{self, File};
use std::path::Path;

fn number(tree: &Value, name: &str) -> f64 {
    tree[name].as_f64().unwrap()
}

fn save(folder: &Path, name: &str, points: &Array2<f64>) {
    let file = File::create(folder.join(name)).unwrap();
    points.write_npy(file).unwrap();
}

/// Points of a rank-1 lattice, which has peaks beyond the measured frequencies.
fn lattice(count: usize) -> Array2<f64> {
    const GENERATOR: [usize; 4] = [1, 182_667, 469_891, 498_753];
    let at = |(i, k)| (i * GENERATOR[k] % count) as f64 / count as f64;
    Array2::from_shape_fn((count, 4), at)
}

#[test]
fn predicted_errors_are_found() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "lattice.npy", &lattice(64));
    save(folder.path(), "long.npy", &lattice(4096));
    let soft = scene("variance/soft_shadow.ron");
    let line = format!(
        "variance {} --photons 2^18 --counts 16,64,256 --unshifted --samplers independent,jitter,lhs,sobol,padded,lattice.npy,long.npy --out out",
        soft.display()
    );
    // The prediction for one of the files is undecided.
    let said = told(folder.path(), line, 4);
    let long: Vec<&str> = said
        .lines()
        .filter(|line| line.chars().count() > 100)
        .collect();
    assert!(long.is_empty(), "{long:?}");
    assert!(said.contains("Box windows |x| < 0.25") && said.contains("undecided"));
    let index = json(&folder.path().join("out/variance.json"));
    assert_eq!(index["axes"], serde_json::json!(["x", "u", "y", "v"]));
    assert_eq!(index["axis_sets"].as_array().unwrap().len(), 15);
    assert!(index["format"].is_number() && index["index_hash"].is_string());
    let mut names = Vec::new();
    for sampler in index["samplers"].as_array().unwrap() {
        names.push(sampler["sampler"].as_str().unwrap());
        let curves = [&sampler["shifted"], &sampler["unshifted"]];
        for curve in curves.into_iter().filter(|curve| !curve.is_null()) {
            for count in curve["counts"].as_array().unwrap() {
                let ratio = &count["ratio"];
                let off = (number(ratio, "value") - 1.0).abs() / number(ratio, "error");
                assert!(
                    off < 4.5 || count["is_undecided"] == true,
                    "{names:?} {count}"
                );
            }
        }
    }
    assert_eq!(
        names,
        [
            "independent",
            "jitter",
            "lhs",
            "sobol",
            "padded xu+yv",
            "padded xy+uv",
            "lattice.npy",
            "long.npy"
        ]
    );
    let last = &index["samplers"][7]["shifted"]["counts"][0];
    assert_eq!(
        [&last["count"], &last["is_undecided"]],
        [&Value::from(4096), &Value::from(true)]
    );
    for name in ["variance.png", "variance.svg", "variance.csv"] {
        assert_eq!(index["files"][name].as_str().unwrap().len(), 64, "{name}");
    }
}

/// The picture shows predicted and found variances, with and without shifts. If each sampler has one
/// number of points, all samplers are in one chart.
#[test]
fn pictures_show_all_answers() {
    let folder = tempfile::tempdir().unwrap();
    let soft = scene("variance/soft_shadow.ron");
    for (counts, names) in [
        ("16,256", ["jitter: ", "padded xy+uv: "]),
        ("16", ["\"jitter, 16\"", "\"padded xy+uv, 16\""]),
    ] {
        let line = format!(
            "variance {} --photons 2^16 --counts {counts} --unshifted --shifts 20 --frequencies 4 --out out",
            soft.display()
        );
        passes(folder.path(), &line);
        let csv = fs::read_to_string(folder.path().join("out/variance.csv")).unwrap();
        for name in names {
            assert!(csv.contains(name), "{name}: {csv}");
        }
        for curve in [
            "independent points",
            "predicted",
            "found",
            "\"predicted, not shifted\"",
            "\"found, not shifted\"",
        ] {
            assert!(csv.contains(&format!(",{curve},")), "{curve}: {csv}");
        }
    }
}

#[test]
fn variances_have_the_same_bytes_on_any_threads() {
    let folder = tempfile::tempdir().unwrap();
    let spot = scene("variance/spot_disc.ron");
    for threads in [1, 2] {
        let line = format!(
            "variance {} --plane leaving --photons 20000 --counts 4..16 --shifts 20 --unshifted --frequencies 4 --threads {threads} --out v{threads}",
            spot.display()
        );
        let output = passes(folder.path(), &line);
        assert!(output.stdout.is_empty() && output.stderr.is_empty());
    }
    let of = |name: &str| files(&folder.path().join(name));
    assert_eq!(of("v1"), of("v2"));
}

/// If the noise hides the last octave, the tail counts as for independent points, and the table says
/// so.
#[test]
fn an_unknown_tail_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let soft = scene("variance/soft_shadow.ron");
    for (photons, is_known) in [(10_000, false), (262_144, true)] {
        let line = format!(
            "variance {} --photons {photons} --counts 4 --shifts 20 --samplers sobol --out v{photons}",
            soft.display()
        );
        let said = told(folder.path(), line, 0);
        assert_eq!(said.contains("use more photons"), !is_known, "{said}");
        let index = json(&folder.path().join(format!("v{photons}/variance.json")));
        assert_eq!(index["has_last_octave"], is_known);
    }
}

#[test]
fn bad_arguments_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let spot = scene("variance/spot_disc.ron");
    let spot = spot.display();
    save(path, "three.npy", &array![[0.5, 0.5, 0.5], [0.1, 0.1, 0.1]]);
    save(
        path,
        "outside.npy",
        &array![[0.5, 0.5, 0.5, 0.5], [0.1, 0.1, 1.0, 0.1]],
    );
    save(path, "one.npy", &array![[0.5, 0.5, 0.5, 0.5]]);
    fs::write(path.join("text.npy"), "no array").unwrap();
    let plane = "--plane receiver --out out";
    for (arguments, parts) in [
        (
            "--out out",
            &["select one with --plane", "receiver, leaving"] as &[&str],
        ),
        (
            "--plane none --out out",
            &["--plane none", "receiver, leaving"],
        ),
        (
            &format!("{plane} --samplers three.npy"),
            &["three.npy", "[N, 4]"],
        ),
        (
            &format!("{plane} --samplers text.npy"),
            &["text.npy", "[N, 4]"],
        ),
        (&format!("{plane} --samplers missing.npy"), &["missing.npy"]),
        (
            &format!("{plane} --samplers outside.npy"),
            &["point 1", "coordinate 1;", "allowed"],
        ),
        (
            &format!("{plane} --samplers one.npy"),
            &["1 points", "allowed: 2 to 65536"],
        ),
    ] {
        refused(path, &format!("variance {spot} {arguments}"), parts);
    }
    for (arguments, part) in [
        ("--samplers halton", "allowed: independent"),
        ("--counts 1..4", "from 2 to 65536"),
        ("--frequencies 40", "from 2 to 16"),
        ("--shifts 1", "from 10 to 1000000"),
    ] {
        let message = fails(path, format!("variance {spot} {plane} {arguments}"), 2);
        assert!(message.contains(part), "{arguments}: {message}");
    }
    refused(
        path,
        &format!("variance {spot} --plane leaving --light-points --out out"),
        &[
            "leaving: points on the light cannot be coordinates",
            "allowed: a plane on the first leg",
        ],
    );
    fs::create_dir(path.join("probed")).unwrap();
    fs::write(path.join("probed/probe.json"), "{}").unwrap();
    refused(
        path,
        "variance probed --out out",
        &[
            "probed: a saved probe has no rays",
            "etendue probe SCENE --pixel X,Y --variance=sobol",
        ],
    );
    let light = "light=Point(center:(0,0,0))";
    let line = format!("variance {spot} {plane} --set {light}");
    refused(
        path,
        &line,
        &["receiver sees a point", "allowed: light with an area"],
    );
}
