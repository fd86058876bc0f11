//! Tests that commands refuse, before they begin, work that would take too long or would not fit
//! in memory.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{etendue, scene};
use std::process::Output;

fn refused(arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let mut command = etendue();
    command.current_dir(folder.path()).args(arguments);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{arguments:?}: {output:?}");
    let none = std::fs::read_dir(folder.path()).unwrap().count() == 0;
    assert!(none, "{arguments:?} left something");
    output
}

/// Settings that make predictions use nets of rays instead of closed forms. Predictions by nets
/// keep the spectra of all replicates in memory.
const FINE: [&str; 6] = [
    "--set",
    "blockers.0.frequency=1e6",
    "--set",
    "frequencies.nu.spacing=0.01",
    "--set",
    "run.batches=32",
];

#[test]
fn a_prediction_that_does_not_fit() {
    let path = scene("grating.ron");
    let path = path.to_str().unwrap();
    for command in [
        &["check", path][..],
        &["run", path, "--photons", "1e4", "--out", "out"],
        &["predict", path, "--out", "out"],
    ] {
        let output = refused(&[command, &FINE].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("the prediction of leaving takes"), "{said}");
        assert!(said.contains("limit"), "{said}");
        let described = command[0] == "check";
        assert_eq!(!output.stdout.is_empty(), described);
    }
}
