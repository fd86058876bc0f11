//! Tests `etendue run --resume` and `--time`: a run continues from the batches that an earlier
//! run left.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{call, etendue, files, json, passes, small, untimed};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

const RUN: &str = "run small.ron --photons 2^22 --threads 2";

/// A folder with the scene and, in `whole`, the result of an uninterrupted run.
fn folder() -> tempfile::TempDir {
    let folder = small();
    passes(folder.path(), format!("{RUN} --out whole"));
    folder
}

/// Checks that the result equals the result of the uninterrupted run, and that there are no other
/// files in the folder.
fn is_whole(folder: &Path, out: &str) {
    let [found, whole] = [out, "whole"].map(|name| untimed(&folder.join(name)));
    assert_eq!(
        found.keys().collect::<Vec<_>>(),
        whole.keys().collect::<Vec<_>>()
    );
    assert!(found == whole, "the bytes of {out} are those of one run");
}

/// The paths of the batches that a run has stored, or is about to store.
fn batches(folder: &Path, out: &str) -> Vec<PathBuf> {
    left(folder, out, "batch")
}

/// The batch files whose names end in `end`.
fn left(folder: &Path, out: &str, end: &str) -> Vec<PathBuf> {
    let below = |folder: PathBuf| fs::read_dir(folder).into_iter().flatten().flatten();
    let keys = below(folder.join(out).join("batches"));
    let all = keys.flat_map(|key| below(key.path()));
    let paths = all.map(|entry| entry.path());
    let mut paths: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|found| found == end))
        .collect();
    paths.sort();
    paths
}

fn started(folder: &Path, out: &str) -> Child {
    etendue()
        .current_dir(folder)
        .args(RUN.split(' '))
        .args(["--resume", "--quiet", "--out", out])
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn a_run_goes_on_where_its_time_was_up() {
    let folder = folder();
    let path = folder.path();
    let mut held = 0;
    let mut ended = 0;
    // The time grows, so that it is up on a fast machine, and the run ends on a slow one.
    for time in (20..4000).step_by(20) {
        let output = call(path, &format!("{RUN} --out parts --resume --time {time}ms"));
        if output.status.code() == Some(0) {
            break;
        }
        ended += 1;
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{message}");
        assert!(message.contains("time is up: "), "{message}");
        assert!(!path.join("parts/summary.json").exists());
        let now = batches(path, "parts").len();
        assert!(now >= held, "{now} batches after {held}");
        assert!(message.contains(&format!(" {now} of 64")), "{message}");
        held = now;
    }
    assert!(ended > 0, "the time was never up");
    is_whole(path, "parts");
    // A finished run prints its result again and does not change it.
    passes(path, format!("{RUN} --out parts --resume"));
    is_whole(path, "parts");
}

#[test]
fn a_run_goes_on_where_it_was_killed_or_damaged() {
    let folder = folder();
    let path = folder.path();
    for moment in [10, 20, 30, 40] {
        let mut child = started(path, "parts");
        std::thread::sleep(Duration::from_millis(moment));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    // On a slow machine, the runs may be killed before they finish a batch.
    let mut left = batches(path, "parts");
    for time in (20..4000).step_by(20) {
        if !left.is_empty() {
            break;
        }
        call(path, &format!("{RUN} --out parts --resume --time {time}ms"));
        left = batches(path, "parts");
    }
    let cut = fs::read(&left[0]).unwrap();
    fs::write(&left[0], &cut[..cut.len() / 2]).unwrap();
    let beside = left[0].with_file_name("00000063-0123.batch");
    fs::write(beside, "no batch").unwrap();
    let output = call(path, &format!("{RUN} --out parts --resume"));
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(
        message.contains("is damaged: the batch is measured again"),
        "{message}"
    );
    is_whole(path, "parts");
}

#[test]
fn processes_share_a_run() {
    let folder = folder();
    let path = folder.path();
    let mut all: Vec<Child> = (0..3).map(|_| started(path, "parts")).collect();
    // One of the processes dies during the run.
    std::thread::sleep(Duration::from_millis(60));
    all[0].kill().unwrap();
    all[0].wait().unwrap();
    for child in &mut all[1..] {
        assert_eq!(child.wait().unwrap().code(), Some(0));
    }
    is_whole(path, "parts");
}

#[test]
fn batches_of_another_run_are_not_taken() {
    let folder = folder();
    let path = folder.path();
    let other = format!("{RUN} --out parts --resume --time 100ms --seed 9");
    let ended = call(path, &other).status.code();
    assert!(matches!(ended, Some(0 | 3)), "{ended:?}");
    passes(path, format!("{RUN} --out parts --resume"));
    let seed = json(&path.join("parts/summary.json"))["seed"].clone();
    assert_eq!(seed, json(&path.join("whole/summary.json"))["seed"]);
    if ended == Some(3) {
        assert!(!batches(path, "parts").is_empty(), "the other may go on");
    }
}

/// Another process writes the result and removes the stored batches while this process works on a
/// batch.
#[test]
fn what_another_process_ends_is_not_begun_anew() {
    let folder = folder();
    let path = folder.path();
    let mut child = started(path, "parts");
    while batches(path, "parts").is_empty() {
        std::thread::sleep(Duration::from_millis(5));
    }
    for (name, bytes) in files(&path.join("whole")) {
        let to = path.join("parts").join(name);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::write(to, bytes).unwrap();
    }
    // The removal is repeated, because the process may be writing its batch at the same time.
    while fs::remove_dir_all(path.join("parts/batches")).is_err() {}
    assert_eq!(child.wait().unwrap().code(), Some(0));
    is_whole(path, "parts");
}

/// A command for a run whose batches take minutes each.
const LONG: &str = "run small.ron --photons 2^36 --out long";

/// The exit code and the errors of a long run that ends by itself.
fn ended(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let mut child = etendue()
        .current_dir(folder)
        .args(LONG.split(' ').chain(arguments.split(' ')))
        .arg("--quiet")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    // One thread takes about a second for a part of a batch. The limit is higher, because the
    // machine may be busy.
    let mut by_itself = true;
    while by_itself && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(20));
        by_itself = begun.elapsed() < Duration::from_secs(60);
    }
    if !by_itself {
        child.kill().unwrap();
    }
    let output = child.wait_with_output().unwrap();
    assert!(by_itself, "the run did not end");
    let message = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), message)
}

/// The number of stored parts of unfinished batches.
fn parts(folder: &Path) -> u32 {
    let names = left(folder, "long", "begun").into_iter();
    let parts = names.map(|path| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        name.split('-').nth(1).unwrap().parse::<u32>().unwrap()
    });
    parts.sum()
}

#[test]
fn time_is_up_within_a_batch() {
    let folder = small();
    let path = folder.path();
    let mut kept = 0;
    for arguments in ["--time 1s", "--time 1s --resume", "--time 1s --resume"] {
        let (code, message) = ended(path, arguments);
        assert_eq!(code, Some(3), "{message}");
        assert!(
            message.contains("0 of 64 batches and parts of "),
            "{message}"
        );
        assert!(parts(path) > kept, "{arguments}: {message}");
        kept = parts(path);
    }
    let damaged = left(path, "long", "begun").remove(0);
    fs::write(&damaged, "no batch").unwrap();
    let (_, message) = ended(path, "--time 10ms --resume");
    assert!(
        message.contains("is damaged: the batch is measured again"),
        "{message}"
    );
    // The run may have measured the parts of the damaged file again.
    assert_ne!(fs::read(&damaged).unwrap_or_default(), b"no batch");
}

/// If a process dies within a batch, the parts that it stored a few seconds before are used
/// later.
#[test]
fn a_killed_process_leaves_the_beginning_of_its_batch() {
    let folder = small();
    let path = folder.path();
    let mut child = etendue()
        .current_dir(path)
        .args(LONG.split(' '))
        .args(["--resume", "--quiet"])
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while parts(path) < 3 {
        assert!(
            begun.elapsed() < Duration::from_secs(120),
            "nothing is kept"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // A newer file of a partial batch replaces an older file.
    assert_eq!(left(path, "long", "begun").len(), 1);
}

/// A process died just before removing the batches of a finished run.
#[test]
fn batches_of_a_run_that_is_done_are_removed() {
    let folder = folder();
    let path = folder.path();
    let output = call(path, &format!("{RUN} --out parts --resume --time 100ms"));
    if output.status.code() == Some(3) {
        fs::rename(path.join("parts/batches"), path.join("batches")).unwrap();
    } else {
        panic!("the time was not up: {output:?}");
    }
    passes(path, format!("{RUN} --out parts --resume"));
    fs::rename(path.join("batches"), path.join("parts/batches")).unwrap();
    passes(path, format!("{RUN} --out parts --resume"));
    is_whole(path, "parts");
}

/// If the folder of batches is a link, batches are neither written nor removed through it.
#[cfg(unix)]
#[test]
fn batches_go_through_no_link() {
    let folder = folder();
    let path = folder.path();
    for linked in ["parts/batches", "other/batches"] {
        let out = linked.split('/').next().unwrap();
        fs::create_dir_all(path.join(out)).unwrap();
        fs::create_dir_all(path.join("elsewhere/mine")).unwrap();
        fs::write(path.join("elsewhere/mine/file"), "mine").unwrap();
        std::os::unix::fs::symlink(path.join("elsewhere"), path.join(linked)).unwrap();
        let resume = if out == "parts" {
            "--resume"
        } else {
            "--seed 3"
        };
        passes(path, format!("{RUN} --out {out} {resume}"));
        let left = files(&path.join("elsewhere"));
        assert_eq!(left.keys().collect::<Vec<_>>(), ["mine/file"]);
    }
}
