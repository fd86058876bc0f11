//! Tests `etendue split`: if its commands are run in any order, they give the bytes of one run.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{SCENE, etendue, files, small};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// A folder with a scene whose name needs quoting and, in `whole`, the result of one run.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("my scene.ron"), SCENE).unwrap();
    let run = ["run", "my scene.ron", "--photons", "200000", "--seed", "7"];
    let run = etendue()
        .current_dir(&folder)
        .args(run)
        .args(["--quiet", "--out", "whole"])
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    folder
}

fn split(folder: &Path, more: &[&str]) -> String {
    let output = etendue()
        .current_dir(folder)
        .args([
            "split",
            "my scene.ron",
            "--photons",
            "200000",
            "--seed",
            "7",
        ])
        .args(["--parts", "5", "--out", "out dir"])
        .args(more)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a shell line or script, with `etendue` on the search path.
fn shell(folder: &Path, text: &str) {
    let programs = Path::new(env!("CARGO_BIN_EXE_etendue")).parent().unwrap();
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{}:{path}", folder.display(), programs.display());
    let mut command = Command::new("sh");
    let command = command.current_dir(folder).args(["-c", text]);
    let output = command.env("PATH", path).output().unwrap();
    assert!(output.status.success(), "{text}: {output:?}");
}

fn is_whole(folder: &Path) {
    let summary = |out: &str| fs::read(folder.join(out).join("summary.json")).unwrap();
    assert!(summary("out dir") == summary("whole"));
    let arrays = |out: &str| {
        let mut files = files(&folder.join(out));
        files.retain(|name, _| name.starts_with("light/") || name.starts_with("receiver/"));
        files
    };
    assert!(arrays("out dir") == arrays("whole"));
}

#[test]
fn parts_in_any_order_are_one_run() {
    let folder = folder();
    let path = folder.path();
    let commands = split(path, &[]);
    let lines: Vec<&str> = commands.lines().collect();
    let (parts, after) = lines.split_at(5);
    for i in [3, 0, 4, 1, 2] {
        shell(path, parts[i]);
    }
    after.iter().for_each(|line| shell(path, line));
    is_whole(path);
}

#[test]
fn the_script_for_slurm_is_one_run() {
    let folder = folder();
    let path = folder.path();
    // A fake `sbatch` that runs its script once for each element of the array, and ignores
    // dependencies.
    let sbatch = r#"#!/bin/sh
set -eu
last=0
for word; do case $word in --array=0-*) last=${word#--array=0-} ;; esac; done
script=$(cat)
i=$last
while [ "$i" -ge 0 ]; do
    SLURM_ARRAY_TASK_ID=$i SLURM_CPUS_PER_TASK=1 sh -c "$script" >/dev/null
    i=$((i - 1))
done
echo 42
"#;
    let program = path.join("sbatch");
    fs::write(&program, sbatch).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    shell(path, &split(path, &["--slurm"]));
    is_whole(path);
}

#[test]
fn more_parts_than_batches_are_refused() {
    let folder = small();
    let output = etendue()
        .current_dir(&folder)
        .args(["split", "small.ron", "--parts", "65"])
        .output()
        .unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("has 64 batches"), "{message}");
}

/// A line break in a path could end a line of the script, or a here-document in it.
#[test]
fn control_characters_do_not_enter_scripts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let name = "a\nEND\ntouch pwned\n.ron";
    for name in ["small.ron", name] {
        fs::write(path.join(name), SCENE).unwrap();
    }
    for (scene, out) in [
        ("small.ron", "out\nEND\ntouch pwned\n"),
        ("small.ron", "out\r"),
        (name, "out"),
    ] {
        for more in [&["--slurm"][..], &[]] {
            let output = etendue()
                .current_dir(path)
                .args(["split", scene, "--parts", "2", "--out", out])
                .args(more)
                .output()
                .unwrap();
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(output.stdout.is_empty(), "{scene:?} {out:?}");
        }
    }
}
