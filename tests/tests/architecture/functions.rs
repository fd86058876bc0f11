//! Checks that each function of more than sixty lines has a reason, which the source states. If no
//! reason is stated, clippy reports the function.

use super::{crates, root};
use std::fs;
use std::process::Command;

/// The length of a planted function, in lines, which is above the threshold in clippy.toml.
const PLANTED: usize = 70;

/// Every crate uses the lints of the workspace, which require a reason beside each long function.
#[test]
fn crates_take_the_lints_of_the_workspace() {
    let read = |path: &str| fs::read_to_string(root().join(path)).unwrap();
    assert!(read("Cargo.toml").contains("\ntoo_many_lines = \"warn\""));
    for folder in crates().into_iter().chain(["tests".to_owned()]) {
        let manifest = read(&format!("{folder}/Cargo.toml"));
        assert!(manifest.contains("[lints]\nworkspace = true"), "{folder}");
    }
}

/// clippy reports a long function, unless a reason is stated.
#[test]
fn a_planted_function_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let body = "    a += 1;\n".repeat(PLANTED);
    let reason = "#[expect(clippy::too_many_lines, reason = \"planted\")]\n";
    for (attribute, is_found) in [("", true), (reason, false)] {
        let file = folder.path().join("planted.rs");
        let text = format!("{attribute}pub fn planted(mut a: u64) -> u64 {{\n{body}    a\n}}\n");
        fs::write(&file, text).unwrap();
        let found = Command::new("clippy-driver")
            .env("CLIPPY_CONF_DIR", root())
            .args([
                "--crate-type",
                "lib",
                "--edition",
                "2024",
                "--emit=metadata",
            ])
            .args(["-W", "clippy::too_many_lines", "--out-dir"])
            .args([folder.path(), &file])
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&found.stderr);
        assert!(found.status.success(), "{words}");
        assert_eq!(words.contains("too many lines"), is_found, "{words}");
    }
}
