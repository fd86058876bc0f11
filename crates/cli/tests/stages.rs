//! Tests the stages of a run, which exchange files. Together they write the same files as `run`,
//! and they refuse parts that do not fit together.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{
    SCENE, array, call, fails, files, json, passes, refused, small, stages, untimed,
};
use etendue_field::Complex;
use ndarray::{Array0, Array1, Array2, Array3, Array4};
use std::fs;

#[test]
fn stages_write_what_run_writes() {
    let stages = stages();
    let folder = stages.path();
    let run = call(folder, "run small.ron --out run");
    let compared = call(folder, "compare --measured b a --predicted p --out out");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert_eq!(compared.status.code(), Some(0), "{compared:?}");
    let [run, compared] = ["run", "out"].map(|result| untimed(&folder.join(result)));
    assert!(run.len() > 20 && run.keys().eq(compared.keys()));
    for (name, content) in &run {
        assert!(compared[name] == *content, "{name} differs");
    }
}

#[test]
fn one_folder_may_hold_all_stages() {
    let stages = stages();
    let folder = stages.path();
    call(folder, "measure small.ron --out p");
    let compare = "compare --measured p --predicted p --out p";
    passes(folder, compare);
    let first = files(&folder.join("p"));
    fails(folder, format!("{compare} --expect disagreement"), 1);
    assert!(first.keys().eq(files(&folder.join("p")).keys()));
}

#[test]
fn part_of_a_measurement_is_reported_as_what_it_is() {
    let stages = stages();
    let folder = stages.path();
    // A prediction does not depend on the settings of the measurement.
    let predict = "predict small.ron --set run.photons=1000 --set run.seed=3 --out other";
    call(folder, predict);
    passes(
        folder,
        "compare --measured b --predicted other --out out --threads 1",
    );
    let summary = json(&folder.join("out/summary.json"));
    let held = json(&folder.join("b/measurement.json"));
    assert_eq!(summary["batches"], 44);
    assert_eq!(summary["photons"], held["photons"]);
    // All photons cross the plane at the light.
    assert_eq!(summary["planes"][0]["crossed"], held["photons"]);
}

#[test]
fn arrays_are_what_the_conventions_say() {
    let stages = stages();
    let file = stages.path().join("a/receiver/batches.npz");
    let batches: Array1<u32> = array(&file, "batch");
    assert!(batches.into_iter().eq(0..20));
    let emitted: Array1<u64> = array(&file, "emitted");
    let tally: Array2<u64> = array(&file, "tally");
    assert_eq!((emitted.dim(), tally.dim()), (20, (20, 3)));
    let slices: Array4<Complex> = array(&file, "slices");
    let [rho, nu]: [Array1<f64>; 2] = ["rho", "nu"].map(|axis| array(&file, axis));
    assert_eq!(slices.dim(), (20, 3, rho.len(), nu.len()));
    assert!(rho[0].abs() < 1e-15 && nu[nu.len() / 2].abs() < 1e-15); // exact zeros
    let projection: Array3<f64> = array(&file, "projection");
    assert_eq!(projection.dim(), (20, 64, 64));
    let ledger: Array2<f64> = array(&stages.path().join("a/ledger.npz"), "ledger");
    assert_eq!(ledger.dim(), (20, 4));

    let file = stages.path().join("p/receiver/prediction.npz");
    let predicted: Array3<Complex> = array(&file, "slices");
    assert_eq!(predicted.dim(), (3, rho.len(), nu.len()));
    let derivatives: Array4<Complex> = array(&file, "derivatives");
    let values: Array1<f64> = array(&file, "values");
    assert_eq!(derivatives.dim(), (values.len(), 3, rho.len(), nu.len()));
    let unblocked: Array0<f64> = array(&file, "unblocked");
    assert!(unblocked.into_scalar() > predicted[[0, 0, nu.len() / 2]].re);
    let projection: Array2<f64> = array(&file, "projection");
    assert_eq!(projection.dim(), (64, 64));
    let words = json(&stages.path().join("p/prediction.json"));
    let mut names = words["planes"][1]["parameters"].as_array().unwrap().iter();
    let travel = names.position(|words| words[0] == "travel light to blockers");
    assert!((values[travel.unwrap()] - 1.0).abs() < 1e-12); // metres, from 0.3 to 1.3
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let stages = stages();
    let folder = stages.path();
    fs::write(folder.join("same.ron"), SCENE).unwrap();
    for (out, how) in [
        ("few", "small.ron --batches 24..28"),
        ("more", "small.ron --photons 30000 --batches 20..64"),
        ("seed", "small.ron --seed 5 --batches 20..64"),
        (
            "scene",
            "small.ron --set blockers.0.pitch=0.11 --batches 20..64",
        ),
        (
            "planes",
            "small.ron --set planes[1].name=floor --batches 20..64",
        ),
        ("name", "same.ron --batches 20..64"),
    ] {
        passes(folder, format!("measure {how} --out {out}"));
    }
    call(
        folder,
        "predict small.ron --set light.radiance=2 --out bright",
    );
    let cases: [(&str, &str, &[&str]); 13] = [
        ("a b a", "p", &["cannot add a", "batch 0 is in both"]),
        ("few b", "p", &["cannot add b", "batch 24 is in both"]),
        ("a", "p", &["20 batches are too few", "32", "20..64"]),
        ("a few", "p", &["24 batches", "20..24, 28..64"]),
        ("a more", "p", &["run.photons is 20000 and 30000"]),
        ("a seed", "p", &["run.seed is 18446744073709551557 and 5"]),
        (
            "a scene",
            "p",
            &[
                "a/measurement.json",
                "scene/measurement.json",
                "pitch",
                "0.11",
            ],
        ),
        (
            "a planes",
            "p",
            &["planes[1].name", "\"receiver\"", "\"floor\""],
        ),
        ("a name", "p", &["scene is \"small\" and \"same\""]),
        (
            "a b",
            "bright",
            &["bright/prediction.json", "light.radiance is 1.0 and 2.0"],
        ),
        ("a b", "a", &["a/prediction.json", "No such file"]),
        ("p", "p", &["p/measurement.json", "No such file"]),
        ("nothing", "p", &["nothing/measurement.json"]),
    ];
    for (measured, predicted, parts) in cases {
        let arguments = format!("compare --measured {measured} --predicted {predicted} --out out");
        refused(folder, &arguments, parts);
    }
}

#[test]
fn bad_arguments_are_refused() {
    let folder = small();
    let folder = folder.path();
    fs::write(folder.join("file"), "not a folder").unwrap();
    for (arguments, code, part) in [
        ("measure small.ron --out out --batches 0..65", 2, "0..64"),
        ("measure small.ron --out out --batches 5..5", 2, "A..B"),
        ("measure small.ron --out out --batches a..b", 2, "A..B"),
        ("measure small.ron --out out --batches -1..2", 2, "A..B"),
        ("measure small.ron --out out --method magic", 2, "photons"),
        ("measure small.ron --out file/out", 3, "cannot write"),
        ("measure small.ron", 2, "--out"),
        ("measure none.ron --out out", 2, "none.ron"),
        ("predict small.ron --out out --batches 0..5", 2, "--batches"),
        (
            "predict small.ron --out out --set light.radiance=-1",
            2,
            "light.radiance",
        ),
        ("predict small.ron --out file/out", 3, "cannot write"),
        ("compare --predicted p --out out", 2, "--measured"),
    ] {
        let message = fails(folder, arguments, code);
        assert!(message.contains(part), "{arguments}: {message}");
        assert!(!folder.join("out").exists(), "{arguments}");
    }
}

/// If a part of a measurement has fewer photons than its scene requests, the picture states the
/// part's own number of photons.
#[test]
fn the_picture_of_a_part_tells_its_own_photons() {
    let folder = stages();
    let path = folder.path();
    let output = call(path, "compare --measured b --predicted p --out part");
    assert!(output.stderr.is_empty(), "{output:?}");
    assert_eq!(json(&path.join("part/summary.json"))["photons"], 13_750);
    let svg = fs::read_to_string(path.join("part/path.svg")).unwrap();
    assert!(svg.contains("13 750 photons"), "44 of 64 batches of 20 000");
}
