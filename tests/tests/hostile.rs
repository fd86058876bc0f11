//! Attacks the program from outside for a short time, by mutated input of every kind and by kills.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

const VALIDATION: &str = env!("CARGO_BIN_EXE_etendue-validation");

/// Runs an attack on the program, which must pass.
fn attack(arguments: &[&str]) {
    let output = Command::new(VALIDATION)
        .args(arguments)
        .arg("--etendue")
        .arg(program())
        .output()
        .unwrap();
    let [report, message] = [output.stdout, output.stderr];
    let report = String::from_utf8_lossy(&report);
    let message = String::from_utf8_lossy(&message);
    assert_eq!(output.status.code(), Some(0), "{report}\n{message}");
}

/// The path of the program `etendue` in the folder of the program `etendue-validation`.
/// The program belongs to another package, which is not built if only this package is tested.
fn program() -> PathBuf {
    let path = Path::new(VALIDATION).with_file_name("etendue");
    let built = fs::metadata(&path).and_then(|file| file.modified());
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    if built.is_err() || built.unwrap() < changed(&crates) {
        let folder = path.parent().and_then(Path::file_name).unwrap();
        // The folder of a build profile has the name of the profile, except that the folder of
        // `dev` is `debug`.
        let profile = match folder.to_str().unwrap() {
            "debug" => "dev",
            profile => profile,
        };
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--package", "etendue", "--profile", profile]);
        assert!(cargo.status().unwrap().success());
    }
    path
}

/// The time of the last change in a source folder, tests excluded.
fn changed(folder: &Path) -> SystemTime {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let times = entries.map(|path| {
        if path.is_dir() && !path.ends_with("tests") {
            changed(&path)
        } else if path.extension().is_some_and(|e| e == "rs") {
            path.metadata().unwrap().modified().unwrap()
        } else {
            SystemTime::UNIX_EPOCH
        }
    });
    times.max().unwrap_or(SystemTime::UNIX_EPOCH)
}

#[test]
fn mutated_input_is_borne() {
    let kept = tempfile::tempdir().unwrap();
    let keep = kept.path().to_str().unwrap();
    attack(&["hostile", "--count", "300", "--quick", "--keep", keep]);
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn kills_leave_whole_results_or_none() {
    // The simulated disk is not mounted, because an ordinary test must not mount anything.
    attack(&["kills", "--count", "12", "--full-disk", "limit"]);
}
