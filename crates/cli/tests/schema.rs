//! Tests `etendue schema`: the pages of the book equal its output, and scenes match the schema.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{etendue, scene};
use std::fs;
use std::path::Path;

fn printed(args: &[&str]) -> String {
    let output = etendue().args(args).output().unwrap();
    assert!(output.status.success(), "{args:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn committed_pages_are_what_the_program_prints() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    for (args, page) in [
        (&["schema", "--page"][..], "scene.md"),
        (&["schema"], "scene.schema.json"),
    ] {
        let committed = fs::read_to_string(docs.join(page)).unwrap();
        assert!(
            committed == printed(args),
            "docs/{page} is old: etendue {} > docs/{page}",
            args.join(" ")
        );
    }
}

/// The scene stored in a result parses to the same scene.
#[test]
fn results_hold_a_scene_that_runs() {
    let folder = tempfile::tempdir().unwrap();
    let run = |scene: &Path, out: &Path| {
        let few = ["--photons", "2^10", "--quiet"];
        let _ = etendue()
            .arg("run")
            .arg(scene)
            .args(few)
            .arg("--out")
            .arg(out)
            .output()
            .unwrap();
        let summary = fs::read_to_string(out.join("summary.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&summary).unwrap()
    };
    let ron = run(&scene("fig8.ron"), &folder.path().join("ron"));
    let again = folder.path().join("fig8.json");
    fs::write(&again, ron["scene_file"].to_string()).unwrap();
    let json = run(&again, &folder.path().join("json"));
    assert_eq!(json, ron);
}
