//! Tests that commands replace and remove only files that they wrote, and never files of other
//! programs.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common;
use crate::common::{etendue, fails, files, json, loud, passes, untimed};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const SCENE: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
    blockers: [Mesh(name: "blocker", center: (0, 0, 1), mesh: File("tri.obj"), scale: 0.1)],
    surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (4, 4))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "light", at: Emission)],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (azimuths: 3, rho: (max: 4), nu: (max: 6)),
    run: (photons: 5000),
)"#;

/// A number of photons that no test could trace to the end.
const ENDLESS: &str = "--photons 1e12";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("s.ron"), SCENE).unwrap();
    fs::write(folder.path().join("tri.obj"), MESH).unwrap();
    folder
}

/// Checks that the command fails with a one-line message that contains `parts`, and that all
/// files stay unchanged.
fn stays(folder: &Path, arguments: &str, parts: &[&str]) {
    let before = files(folder);
    let start = Instant::now();
    let message = fails(folder, arguments, 3);
    for part in parts {
        assert!(message.contains(part), "{arguments}: {part}: {message}");
    }
    assert!(files(folder) == before, "{arguments} changed something");
    // The command is refused before the work begins.
    assert!(start.elapsed() < Duration::from_secs(20), "{arguments}");
}

#[test]
fn a_scene_s_own_folder_may_be_that_of_its_results() {
    let folder = folder();
    for command in ["measure", "predict", "run"] {
        for _ in 0..2 {
            passes(folder.path(), format!("{command} s.ron --out ."));
        }
    }
    let mesh = fs::read_to_string(folder.path().join("tri.obj")).unwrap();
    assert_eq!(mesh, MESH);
    passes(folder.path(), "compare --measured . --predicted . --out .");
}

#[test]
fn inputs_are_never_among_results() {
    let folder = folder();
    let mesh = SCENE.replace("tri.obj", "out/measurement.inputs/tri.obj");
    fs::write(folder.path().join("t.ron"), mesh).unwrap();
    passes(folder.path(), "measure s.ron --out out");
    // The second measurement reuses the copy of the mesh that the first measurement wrote.
    let before = files(folder.path());
    for force in ["", " --force"] {
        let arguments = format!("measure t.ron --out out{force} {ENDLESS}");
        let message = fails(folder.path(), &arguments, 2);
        assert!(message.contains("is read by this command"), "{message}");
        assert!(files(folder.path()) == before);
    }
    passes(folder.path(), "measure t.ron --out other");
}

#[test]
fn files_of_somebody_else_stay() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for name in [
        "light/slices.npz",
        "path.png",
        "timing.json",
        "summary.json",
    ] {
        let file = at("out").join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, "mine").unwrap();
        stays(
            folder.path(),
            &format!("run s.ron --out out {ENDLESS}"),
            &[name, "--force"],
        );
        fs::remove_dir_all(at("out")).unwrap();
    }
    // If a file of an earlier result was changed later, it is also protected. An unrelated file in
    // the folder does not stop the command.
    passes(folder.path(), "run s.ron --out out");
    fs::write(at("out/light/notes.txt"), "mine").unwrap();
    passes(folder.path(), "run s.ron --out out");
    let picture = fs::read(at("out/path.png")).unwrap();
    fs::write(at("out/path.png"), "painted over").unwrap();
    stays(
        folder.path(),
        &format!("run s.ron --out out {ENDLESS}"),
        &["path.png"],
    );
    let output = loud(folder.path(), "run s.ron --out out --force");
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("replaced in out: path.png\n"), "{told}");
    assert_eq!(fs::read(at("out/path.png")).unwrap(), picture);
    assert_eq!(
        fs::read_to_string(at("out/light/notes.txt")).unwrap(),
        "mine"
    );
}

#[test]
fn links_and_folders_in_the_way_are_not_followed() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("elsewhere")).unwrap();
    fs::create_dir_all(at("out")).unwrap();
    fs::write(at("elsewhere/kept.txt"), "mine").unwrap();
    symlink("../elsewhere", at("out/light")).unwrap();
    let run = format!("run s.ron --out out --force {ENDLESS}");
    stays(folder.path(), &run, &["out/light/"]);
    fs::remove_file(at("out/light")).unwrap();
    symlink("../elsewhere/kept.txt", at("out/path.png")).unwrap();
    stays(folder.path(), &run, &["path.png"]);
    fs::remove_file(at("out/path.png")).unwrap();
    fs::create_dir(at("out/path.png")).unwrap();
    stays(folder.path(), &run, &["path.png"]);
    assert_eq!(files(&at("elsewhere")).len(), 1);
}

#[test]
fn an_index_does_not_reach_out_of_its_folder() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    passes(folder.path(), "run s.ron --out out");
    fs::write(at("victim"), "mine").unwrap();
    fs::create_dir(at("away")).unwrap();
    fs::write(at("away/victim"), "mine").unwrap();
    symlink("../away", at("out/away")).unwrap();
    let mut tree = json(&at("out/summary.json"));
    let hash = blake3::hash(b"mine").to_hex();
    for name in ["../victim", "away/victim"] {
        tree["files"][name] = hash.as_str().into();
    }
    fs::write(at("out/summary.json"), common::sealed(tree)).unwrap();
    passes(folder.path(), "run s.ron --out out");
    assert!(at("victim").exists() && at("away/victim").exists());
}

#[test]
fn single_files_replace_nothing_unless_told() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("mine.png"), "mine").unwrap();
    symlink("mine.png", at("link.png")).unwrap();
    fs::create_dir(at("folder.png")).unwrap();
    fs::copy(at("s.ron"), at("s.png")).unwrap();
    let check = |arguments: &str| {
        let output = loud(folder.path(), &format!("check {arguments}"));
        let message = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), message)
    };
    let before = files(folder.path());
    for (arguments, code, part) in [
        ("s.ron --draw mine.png", 3, "--force"),
        ("s.ron --draw link.png", 3, "not a regular file"),
        ("s.ron --draw link.png --force", 3, "not a regular file"),
        ("s.ron --draw folder.png --force", 3, "not a regular file"),
        ("s.png --draw s.png --force", 2, "is read by this command"),
    ] {
        let (found, message) = check(arguments);
        assert_eq!(found, Some(code), "{arguments}: {message}");
        assert!(message.contains(part), "{arguments}: {message}");
        assert!(files(folder.path()) == before, "{arguments}");
    }
    for arguments in ["s.ron --draw new.png", "s.ron --draw mine.png --force"] {
        assert_eq!(check(arguments).0, Some(0), "{arguments}");
    }
    assert!(fs::read(at("new.png")).unwrap() == fs::read(at("mine.png")).unwrap());
    assert!(
        !files(folder.path())
            .keys()
            .any(|name| name.contains("unfinished"))
    );
}

#[test]
fn one_writer_at_a_time() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    passes(folder.path(), "run s.ron --out out");
    let before = files(&at("out"));
    let mut first = etendue()
        .current_dir(folder.path())
        .args(format!("run s.ron --quiet --out out {ENDLESS}").split(' '))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !at("out/.etendue-unfinished").exists() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    for command in ["run s.ron", "measure s.ron", "export --to mitsuba s.ron"] {
        let output = loud(folder.path(), &format!("{command} --out out"));
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains("another etendue process is writing there"));
    }
    // A killed run leaves unfinished files, which the next run removes; until then the earlier
    // result stays complete.
    first.kill().unwrap();
    first.wait().unwrap();
    let mut left = files(&at("out"));
    left.retain(|name, _| !name.starts_with(".etendue"));
    assert!(left == before);
    passes(folder.path(), "run s.ron --out out");
    assert!(
        !files(&at("out"))
            .keys()
            .any(|name| name.starts_with(".etendue"))
    );
}

/// If a process dies at any step while it moves its files, the next process completes the moves.
#[test]
fn a_move_that_was_cut_short_is_ended() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    passes(folder.path(), "run s.ron --out new --seed 2");
    passes(folder.path(), "run s.ron --out again --seed 3");
    let new = files(&at("new"));
    for moved in 0..=new.len() {
        let _ = fs::remove_dir_all(at("out"));
        passes(folder.path(), "run s.ron --out out --seed 1");
        let waiting = at("out/.etendue-unfinished");
        fs::create_dir_all(waiting.join("old/light")).unwrap();
        for aside in ["summary.json", "light/primal.csv"] {
            fs::rename(at("out").join(aside), waiting.join("old").join(aside)).unwrap();
        }
        fs::write(waiting.join("summary.json"), &new["summary.json"]).unwrap();
        let names = new.iter().filter(|(name, _)| *name != "summary.json");
        for (i, (name, bytes)) in names.enumerate() {
            let place = if i < moved {
                at("out")
            } else {
                waiting.join("new")
            }
            .join(name);
            fs::create_dir_all(place.parent().unwrap()).unwrap();
            fs::write(place, bytes).unwrap();
        }
        passes(folder.path(), "run s.ron --out out --seed 3");
        let [found, wanted] = ["out", "again"].map(|out| untimed(&at(out)));
        assert!(found == wanted, "{moved} files had moved");
    }
}

/// The arguments quoted for a shell.
fn quoted(arguments: &str) -> String {
    let words = arguments.split(' ').map(|word| format!("'{word}'"));
    words.collect::<Vec<_>>().join(" ")
}

/// If a move fails, this move and all moves before it are undone.
#[test]
fn a_failed_move_is_undone() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    passes(folder.path(), "run s.ron --out out --seed 1");
    let before = files(&at("out"));
    passes(folder.path(), "run s.ron --out new --seed 2");
    // A dead process had begun to move its files; a file of another program blocks the last move.
    let waiting = at("out/.etendue-unfinished");
    fs::create_dir_all(&waiting).unwrap();
    for (name, bytes) in files(&at("new")) {
        let place = match name.as_str() {
            "summary.json" => waiting.join(&name),
            _ => waiting.join("new").join(&name),
        };
        fs::create_dir_all(place.parent().unwrap()).unwrap();
        fs::write(place, bytes).unwrap();
    }
    fs::write(at("out/path.svg"), "mine").unwrap();
    let message = fails(folder.path(), "run s.ron --out out --seed 3", 3);
    assert!(
        message.contains("path.svg") && message.contains("--force"),
        "{message}"
    );
    let mut left = files(&at("out"));
    left.retain(|name, _| !name.starts_with(".etendue"));
    assert_eq!(left.remove("path.svg").unwrap(), b"mine");
    assert!(left.iter().all(|(name, bytes)| before[name] == *bytes));
    assert_eq!(left.len() + 1, before.len());
    // With `--force`, the command replaces the file and prints its name.
    let output = loud(folder.path(), "run s.ron --out out --seed 3 --force");
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("replaced in out: path.svg\n"), "{told}");
    assert!(!waiting.exists());
}

#[test]
fn a_full_disk_takes_nothing_away() {
    let folder = folder();
    passes(folder.path(), "run s.ron --out out");
    let before = files(folder.path());
    // The limit on file sizes is 8 blocks, so the arrays do not fit.
    let program = env!("CARGO_BIN_EXE_etendue");
    for command in [
        "run s.ron --seed 2 --quiet --out out",
        "export s.ron --to mitsuba --set blockers.0.mesh=Star(radius:0.2,relief:0,lobes:0,rings:40) --out new",
    ] {
        let script = format!("ulimit -f 8; exec {program} {}", quoted(command));
        let limited = std::process::Command::new("sh")
            .current_dir(folder.path())
            .args(["-c", &script])
            .output()
            .unwrap();
        let message = String::from_utf8(limited.stderr).unwrap();
        assert_eq!(limited.status.code(), Some(3), "{message}");
        assert!(message.contains("cannot write"), "{message}");
        assert!(files(folder.path()) == before, "{command}");
        assert!(!folder.path().join("new").exists());
    }
}

#[test]
fn bad_input_leaves_no_folder_behind() {
    let folder = folder();
    fs::write(
        folder.path().join("bad.ron"),
        SCENE.replace("0.1)]", "NaN)]"),
    )
    .unwrap();
    fails(folder.path(), "run bad.ron --out out", 2);
    assert!(!folder.path().join("out").exists());
}

/// The folders of the channels are below the folder that the user names.
#[test]
fn channels_are_not_written_through_links() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("elsewhere")).unwrap();
    fs::create_dir_all(at("out")).unwrap();
    symlink("../elsewhere", at("out/green")).unwrap();
    for more in ["", " --force", " --resume"] {
        stays(
            folder.path(),
            &format!("run s.ron --rgb --out out{more} {ENDLESS}"),
            &["out/green", "a link"],
        );
    }
    assert_eq!(fs::read_dir(at("elsewhere")).unwrap().count(), 0);
}

/// `run --rgb` writes a page where `run` writes its own.
#[test]
fn a_page_that_bears_its_mark_is_replaced_by_a_run() {
    let folder = folder();
    let page = folder.path().join("out/report.html");
    passes(folder.path(), "run s.ron --rgb --out out");
    let channels = fs::read(&page).unwrap();
    fs::write(&page, [&channels[..], b" "].concat()).unwrap();
    stays(folder.path(), "run s.ron --out out", &["report.html"]);
    fs::write(&page, channels).unwrap();
    passes(folder.path(), "run s.ron --out out");
    let listed = json(&folder.path().join("out/summary.json"));
    let hash = blake3::hash(&fs::read(&page).unwrap()).to_hex().to_string();
    assert_eq!(listed["files"]["report.html"], hash);
}
