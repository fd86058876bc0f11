//! Tests `etendue fit`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{array, fails, json, passes, refused, told};
use etendue_field::Complex;
use ndarray::{Array3, Array4};
use ndarray_npy::NpzWriter;
use std::fs::{self, File};
use std::path::Path;
use tempfile::TempDir;

/// A lamp, a grating and a floor, with a plane before the floor and a plane where light leaves it.
const SCENE: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: 1.0),
    blockers: [Grating(name: "bars", center: (0, 0, 1), axis: X, frequency: 5)],
    surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6), albedo: 0.5)],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "before", at: Before("floor")), (name: "leaving", at: After("floor"))],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (azimuths: 2, rho: (max: 6), nu: (max: 12)),
    run: (photons: 100000, seed: 3, batches: 64),
)"#;

/// A folder with the scene, and its measurement `m`.
fn measured() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.ron"), SCENE).unwrap();
    passes(folder.path(), "measure s.ron --out m");
    folder
}

/// The field number `i` of a fit, as [value, error, bound].
fn field(folder: &Path, i: usize) -> [f64; 3] {
    let field = &json(&folder.join("out/fit.json"))["fields"][i];
    ["value", "error", "bound"].map(|name| field[name].as_f64().unwrap_or(f64::NAN))
}

#[track_caller]
fn is_near(folder: &Path, i: usize, truth: f64) {
    let [value, error, _] = field(folder, i);
    assert!(
        (value - truth).abs() < 4.0 * error,
        "{value} ± {error}, not {truth}"
    );
}

#[test]
fn a_fit_finds_the_scene_from_afar() {
    let folder = measured();
    let line = "fit s.ron --to m --free blockers.0.center.2,surfaces.0.center.2 \
                --set blockers.0.center.2=1.3 --set surfaces.0.center.2=2.6 --plane before --out out";
    let said = told(folder.path(), line, 0);
    is_near(folder.path(), 0, 1.0);
    is_near(folder.path(), 1, 2.0);
    let index = json(&folder.path().join("out/fit.json"));
    assert_eq!(index["planes"], serde_json::json!(["before"]));
    assert!(index["p_value"].as_f64().unwrap() > 0.01 && index["groups"] == 64);
    assert!(field(folder.path(), 0)[2] > 0.0);
    for name in ["fit.png", "fit.svg", "fit.csv"] {
        assert_eq!(index["files"][name].as_str().unwrap().len(), 64, "{name}");
    }
    assert!(
        said.contains("correlation") && said.contains("pass, p = "),
        "{said}"
    );
    // The planted fault: a grating with another frequency agrees with no distances.
    let line = line.replace("--plane", "--force --set blockers.0.frequency=5.5 --plane");
    assert!(told(folder.path(), line, 1).contains("fail, p = "));
}

/// Radiance and albedo multiply each other where light leaves the floor.
#[test]
fn fields_that_are_not_told_apart_are_named() {
    let folder = measured();
    let line = "fit s.ron --to m --free light.radiance,surfaces.0.albedo --out out";
    // The plane before the floor tells the radiance.
    passes(folder.path(), line);
    is_near(folder.path(), 1, 0.5);
    let said = told(folder.path(), format!("{line} --plane leaving"), 4);
    let words = "a rise of light.radiance by 1 % from a rise of surfaces.0.albedo by 1 %";
    let other = "a rise of surfaces.0.albedo by 1 % from a rise of light.radiance by 1 %";
    assert!(said.contains(words) || said.contains(other), "{said}");
    let plan = "fit s.ron --plan --photons 20000 --free light.radiance,surfaces.0.albedo";
    let said = told(folder.path(), plan, 0);
    assert!(
        said.contains("leaving: hard to tell apart") && said.contains("before"),
        "{said}"
    );
}

/// A run has no batches, and arrays of other programs have replicates, or errors alone.
#[test]
fn runs_and_arrays_are_fitted_too() {
    let folder = measured();
    let free = "--free light.radiance,surfaces.0.center.2 --plane before --out out";
    passes(folder.path(), "run s.ron --out bare");
    let parts = &["bare/summary.json", "--save batches"];
    refused(folder.path(), &format!("fit s.ron --to bare {free}"), parts);
    // A run with its batches is a measurement.
    passes(folder.path(), "run s.ron --save batches --out r");
    passes(folder.path(), format!("fit s.ron --to m {free}"));
    let of_batches = field(folder.path(), 1);
    let free = format!("{free} --force");
    passes(folder.path(), format!("fit s.ron --to r {free}"));
    assert_eq!(
        field(folder.path(), 1).map(f64::to_bits),
        of_batches.map(f64::to_bits)
    );

    // Errors alone, which take the noise as independent.
    let path = folder.path().join("r/before/slices.npz");
    let slices: Array3<Complex> = array(&path, "measured");
    let sigma: Array3<f64> = array(&path, "sigma");
    let mut file = NpzWriter::new(File::create(folder.path().join("e.npz")).unwrap());
    file.add_array("before/slices", &slices).unwrap();
    file.add_array("before/sigma", &sigma).unwrap();
    file.finish().unwrap();
    told(folder.path(), format!("fit s.ron --to e.npz {free}"), 0);
    let of_errors = field(folder.path(), 1);
    is_near(folder.path(), 1, 2.0);
    // The window correlates the noise of neighbouring frequencies, which these errors leave out.
    let ratio = of_errors[1] / of_batches[1];
    assert!((0.1..1.0).contains(&ratio), "{ratio}");

    // A planted change: light that is brighter by a fifth.
    let batches: Array4<Complex> = array(&folder.path().join("m/before/batches.npz"), "slices");
    let brighter = batches.mapv(|value| value * 1.2);
    let mut file = NpzWriter::new(File::create(folder.path().join("a.npz")).unwrap());
    file.add_array("before/replicates", &brighter).unwrap();
    file.finish().unwrap();
    passes(folder.path(), format!("fit s.ron --to a.npz {free}"));
    is_near(folder.path(), 0, 1.2);
    is_near(folder.path(), 1, 2.0);
}

/// Two lights of the same kind may change places.
#[test]
fn two_minima_are_undecided() {
    let folder = tempfile::tempdir().unwrap();
    let disc = |x: f64| format!("Disc(center: ({x:?}, 0, 0), radius: 0.05, radiance: 1.0)");
    let (start, end) = SCENE.split_once("    blockers").unwrap();
    let end = end.split_once('\n').unwrap().1;
    let others = format!("    other_lights: [{}, {}],\n", disc(0.15), disc(0.3));
    fs::write(folder.path().join("s.ron"), [start, &others, end].concat()).unwrap();
    passes(folder.path(), "measure s.ron --out m");
    let fields = [0, 1].map(|i| format!("other_lights.{i}.center.0"));
    let [a, b] = &fields;
    let line = format!(
        "fit s.ron --to m --plane before --free {a},{b} --range {a}=0..0.5 --range {b}=0..0.5 --out out"
    );
    let said = told(folder.path(), line, 4);
    assert!(said.contains("2 distinct minima agree"), "{said}");
    let minima = json(&folder.path().join("out/fit.json"))["minima"].clone();
    for (minimum, truth) in [[0.15, 0.3], [0.3, 0.15]].iter().map(|truth| {
        let nearest =
            |m: &&serde_json::Value| (m["values"][0].as_f64().unwrap() - truth[0]).abs() < 0.01;
        (
            minima.as_array().unwrap().iter().find(nearest).unwrap(),
            truth,
        )
    }) {
        assert!(
            (minimum["values"][1].as_f64().unwrap() - truth[1]).abs() < 0.01,
            "{minima}"
        );
    }
}

#[test]
fn faults_of_requests_are_named() {
    let folder = measured();
    for (line, parts) in [
        ("--to m --free blockers.0.hight", &["hight", "allowed"][..]),
        ("--to m --free light", &["real numbers"]),
        ("--to m --free run.photons", &["whole number"]),
        (
            "--to m --free window.x.Hann",
            &["window", "cannot be fitted"],
        ),
        ("--to m --free run.alpha", &["do not depend on run.alpha"]),
        (
            "--to m --free light.radiance,light.radiance",
            &["given twice"],
        ),
        (
            "--to m --free light.radiance --plane other",
            &["--plane other", "before, leaving"],
        ),
        (
            "--to m --free light.radiance --range light.size=1..2",
            &["--range light.size is not a free field"],
        ),
        (
            "--to none --free light.radiance",
            &["none is no measurement", "`run --save batches`"],
        ),
        (
            "--to m --set window.x=Hann(0.4) --free light.radiance",
            &["another window"],
        ),
    ] {
        refused(folder.path(), &format!("fit s.ron {line} --out out"), parts);
    }
    let unread = fails(folder.path(), "fit s.ron --free light.radiance", 2);
    assert!(unread.contains("--to"), "{unread}");
}
