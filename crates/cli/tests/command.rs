//! Tests the command as users see it: exit codes, messages, files, threads and interruptions.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{etendue, files, json, scene, untimed};
use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

/// Few photons, and frequencies for which predictions take little time. The noise is at most 14 % of
/// the spectrum, which is below the resolution.
const SMALL: [&str; 8] = [
    "--photons",
    "20000",
    "--set",
    "run.resolution=0.2",
    "--set",
    "frequencies.rho.max=4",
    "--set",
    "frequencies.nu.max=8",
];

/// Runs `etendue run fig9b` with results in `out` and with further arguments.
fn run(out: &Path, arguments: &[&str]) -> Output {
    etendue()
        .arg("run")
        .arg(scene("fig9b.ron"))
        .args(SMALL)
        .arg("--out")
        .arg(out)
        .args(arguments)
        .output()
        .unwrap()
}

/// Checks that a folder is a complete result: all files that its summary lists exist and have the
/// listed hashes.
fn is_result(folder: &Path) -> bool {
    let Ok(text) = fs::read(folder.join("summary.json")) else {
        return false;
    };
    let summary: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let listed = summary["files"].as_object().unwrap();
    listed.iter().all(|(name, hash)| {
        let bytes = fs::read(folder.join(name)).unwrap_or_default();
        *hash == blake3::hash(&bytes).to_hex().as_str()
    })
}

/// The exit code and the text of a run of a scene.
fn run_by(name: &str, method: &str) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().unwrap();
    let mut command = etendue();
    command
        .args(["run", "--force", "--method", method])
        .arg(scene(name))
        .arg("--out")
        .arg(folder.path());
    let output = command.output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    (output.status.code(), table)
}

/// Checks that photons leave a scene undecided for the reason `said`, and that backward rays decide.
fn only_backward_rays_decide(name: &str, said: &str) {
    let (code, table) = run_by(name, "photons");
    assert_eq!(code, Some(4), "{table}");
    assert!(table.contains(said), "{table}");
    assert_eq!(run_by(name, "backward").0, Some(0));
}

/// If a plane is crossed only by photons that were aimed at another plane, it does not fail. Such
/// photons cover only a part of its window.
#[test]
fn a_window_seen_in_part_is_undecided() {
    let said = "far: 0 of 100000 photons that are aimed at this window reach it";
    only_backward_rays_decide("wild/seen_in_part.ron", said);
}

/// If no photon of a light reaches a window, the plane does not fail, although the photons of
/// another light fill the window.
#[test]
fn a_light_whose_photons_miss_the_window_is_undecided() {
    let said = "comes from light 2, but 0 photons in the window are from this light";
    only_backward_rays_decide("wild/beam_on_a_tiny_window.ron", said);
}

/// If few photons reach a window and many backward rays do, the command names the other method.
#[test]
fn a_grazing_mirror_is_left_to_backward_rays() {
    let said = "none of 200000 photons reached the window; --method backward has";
    only_backward_rays_decide("wild/grazing_mirror.ron", said);
}

#[test]
fn a_run_passes_and_leaves_a_result() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("verdict: pass"), "{table}");
    assert!(is_result(folder.path()));
    let files = files(folder.path());
    for name in [
        "path.png",
        "path.svg",
        "path.csv",
        "timing.json",
        "receiver/slices.npz",
        "receiver/radial.npz",
        "receiver/radial.exr",
        "receiver/primal.png",
        "receiver/spectrum.png",
    ] {
        assert!(
            files.contains_key(name),
            "{name} is missing from {:?}",
            files.keys()
        );
    }
    // The summary lists only reproducible files.
    let listed = String::from_utf8(files["summary.json"].clone()).unwrap();
    assert!(!listed.contains("timing.json"));
}

#[test]
fn threads_do_not_change_a_byte() {
    let bytes = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        let output = run(
            folder.path(),
            &["--threads", threads, "--save", "photons", "--quiet"],
        );
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        untimed(folder.path())
    };
    let one = bytes("1");
    for threads in ["2", "4"] {
        let more = bytes(threads);
        assert!(one.keys().eq(more.keys()));
        for (name, content) in &one {
            assert!(
                more[name] == *content,
                "{name} differs with {threads} threads"
            );
        }
    }
}

/// If the map of a first-order chain is wrong and an exact prediction holds, `--expect
/// disagreement` succeeds.
#[test]
fn expecting_disagreement_turns_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["--expect", "disagreement", "--quiet"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(output.stdout.is_empty());
    let code = |name: &str, arguments: &[&str]| {
        let out = folder.path().join(name);
        let mut command = etendue();
        command.arg("run").arg(scene("table1/printed_outgoing.ron"));
        command
            .args(["--photons", "1e5", "--quiet", "--out"])
            .arg(out);
        command.args(arguments).output().unwrap().status.code()
    };
    let expect = ["--expect", "disagreement"];
    assert_eq!(code("printed", &[]), Some(1));
    assert_eq!(code("expected", &expect), Some(0));
    let corrected = ["--set", "as_printed=false"];
    assert_eq!(code("corrected", &corrected), Some(0));
    assert_eq!(code("no_fault", &[corrected, expect].concat()), Some(1));
    // A second light beside the first neither hides the fault nor makes one.
    let second = [
        "--set",
        "other_lights=[Disc(center: (0.02, 0, 0.05), radius: 0.03)]",
    ];
    assert_eq!(code("printed_two", &second), Some(1));
    assert_eq!(code("two", &[corrected, second].concat()), Some(0));
    // With too much noise, the photons cannot confirm the exact prediction.
    let few = ["--set", "run.resolution=0.001"];
    assert_eq!(code("few", &[few, expect].concat()), Some(4));
}

/// If only the amplitude of a first-order chain is wrong, the command does not report a wrong map.
/// The picture and the page show that the chain fails.
#[test]
fn a_failing_chain_is_told_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, arguments: &[&str]| {
        let out = folder.path().join(name);
        let mut command = etendue();
        command.arg("run").arg(scene("table1/printed_outgoing.ron"));
        command.args(["--photons", "1e5", "--out"]).arg(&out);
        let told = command.args(arguments).output().unwrap().stdout;
        let read = |file: &str| fs::read_to_string(out.join(file)).unwrap();
        let told = String::from_utf8(told).unwrap();
        (told, read("path.svg"), read("report.html"))
    };
    let (told, picture, page) = run("printed", &[]);
    // The share of the radiance that remains is cos² 37.24°.
    assert!(told.contains("gives the central ray 63.375 %"), "{told}");
    assert!(!told.contains("its rays are off"), "{told}");
    assert!(picture.contains("chain fails by 36.6") && picture.contains("off the chain"));
    assert!(page.contains("chain off by (computed)") && page.contains("gives the central ray"));
    let (told, picture, _) = run("corrected", &["--set", "as_printed=false"]);
    assert!(!told.contains("the first-order chain"), "{told}");
    assert!(!picture.contains("off the chain"));
}

#[test]
fn noise_leaves_a_run_undecided() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["--set", "run.resolution=0.05"]);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.contains("above the resolution of 5.000 %; needs"),
        "{told}"
    );
}

/// The number of photons is doubled until the noise is low enough. The result equals the result of
/// a run with the final number of photons.
#[test]
fn a_target_error_is_reached() {
    let folder = tempfile::tempdir().unwrap();
    let run = |out: &str, arguments: &[&str]| {
        let run = etendue()
            .args(["run", "--out"])
            .arg(folder.path().join(out))
            .arg(scene("bench_peer.ron"))
            .args(arguments)
            .output();
        run.unwrap()
    };
    let output = run("target", &["--target-error", "0.7%"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.contains("the next step traces 2 097 152 photons in about"),
        "{told}"
    );
    assert!(
        told.contains("a run with 100 times as many photons takes about"),
        "{told}"
    );
    let output = run("same", &["--photons", "2^21", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let [reached, same] = ["target", "same"].map(|out| untimed(&folder.path().join(out)));
    assert!(reached == same);

    let too_many = ["--target-error", "0.001", "--photons", "2^20"];
    let output = run("refused", &too_many);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("photons suffice; allowed: 1 048 576"),
        "{told}"
    );
    assert!(!folder.path().join("refused").exists());
}

/// A result of one scene is not replaced by a result of another scene with the same name.
#[test]
fn another_scene_keeps_out_of_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let code = |arguments: &[&str]| {
        let output = run(folder.path(), &[&["--quiet"], arguments].concat());
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    assert_eq!(code(&[]).0, Some(0));
    let other = ["--set", "blockers.0.pitch=0.19"];
    let (refused, told) = code(&other);
    assert_eq!(refused, Some(3));
    assert!(told.contains("pitch is 0.2 and not 0.19"), "{told}");
    // With another seed, the run is another measurement of the same scene.
    assert_eq!(code(&["--seed", "2"]).0, Some(0));
    assert_ne!(code(&[&other[..], &["--force"]].concat()).0, Some(3));
}

#[test]
fn saved_photons_are_the_ones_measured() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["--save", "photons"]);
    let told = String::from_utf8(output.stdout).unwrap();
    // The file has 40 bytes for each crossing of 20,000 photons with five planes.
    assert!(
        told.starts_with("--save photons: at most 4.0 MB on disk, 0.8 MB for each of 5 planes\n")
    );
    let bytes = fs::read(folder.path().join("light/photons.npy")).unwrap();
    let header = String::from_utf8_lossy(&bytes[10..128]).into_owned();
    assert!(header.contains("'shape': (20000, 5)"), "{header}");
    assert_eq!(bytes.len(), 128 + 20_000 * 5 * 8);
    let index = json(&folder.path().join("light/photons.json"));
    assert_eq!(index["batch_offsets"].as_array().unwrap().len(), 65);
    // For the light, ∫ L W is (0.1 + sin(0.2π)/2π)² metres² · (1/2)². Each of the two slopes
    // contributes a factor 1/2.
    let row = |i: usize, column: usize| {
        let at = 128 + (i * 5 + column) * 8;
        f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
    };
    // The window excludes photons that were aimed at other planes, because they leave the light
    // with other slopes.
    let hann = |t: f64| {
        if t.abs() < 0.5 {
            (std::f64::consts::PI * t).cos().powi(2)
        } else {
            0.0
        }
    };
    let integral: f64 = (0..20_000)
        .map(|i| (0..4).map(|c| hann(row(i, c))).product::<f64>() * row(i, 4))
        .sum::<f64>()
        / 20_000.0;
    let pi = std::f64::consts::PI;
    let exact = ((0.1 + (0.2 * pi).sin() / (2.0 * pi)) * 0.5).powi(2);
    assert!(
        (integral / exact - 1.0).abs() < 0.03,
        "{integral}, exact {exact}"
    ); // 20,000 photons: 4 σ is 3 %

    let output = run(folder.path(), &[]);
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("did not save them again: after_blockers/photons.npy, "));
    assert!(!folder.path().join("light/photons.npy").exists());
}

/// `first_scenes.txt` has more mistakes. Bad input leads to one clear message and the correct exit
/// code; no file is written and the program does not panic.
#[test]
fn bad_input_is_refused_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(scene("fig9b.ron")).unwrap();
    let edits: [(&str, String, i32, &[&str]); 9] = [
        (
            "unknown field",
            text.replace("pitch:", "pich:"),
            2,
            &["line", "column", "pich", "pitch"],
        ),
        (
            "truncated",
            text[..text.len() / 2].to_owned(),
            2,
            &["line", "column"],
        ),
        ("empty", String::new(), 2, &["line 1"]),
        ("not a scene", "\u{0}\u{1}binary".to_owned(), 2, &["line 1"]),
        (
            "NaN",
            text.replace("pitch: 0.2", "pitch: NaN"),
            2,
            &["blockers[0].pitch", "NaN", "allowed"],
        ),
        (
            "infinity",
            text.replace("size: (6, 6)", "size: (inf, 6)"),
            2,
            &["surfaces[0].size[0]", "inf"],
        ),
        (
            "plane before the light",
            text.replace("at: Emission", "at: Distance(-1)"),
            2,
            &["planes[0].at", "0 m to the last surface at 2 m"],
        ),
        (
            "too few batches",
            text.replace("batches: 64", "batches: 3"),
            2,
            &["run.batches", "32"],
        ),
        (
            "larger than memory",
            text.replace("max: 16", "max: 1e7"),
            3,
            &["GB", "memory"],
        ),
    ];
    for (name, content, code, parts) in edits {
        assert_ne!(content, text, "{name} changes nothing");
        let file = folder.path().join("bad.ron");
        let out = folder.path().join("out");
        fs::write(&file, content).unwrap();
        for command in ["run", "check"] {
            let mut call = etendue();
            call.arg(command).arg(&file);
            if command == "run" {
                call.args(["--photons", "1e5", "--out"]).arg(&out);
            }
            let output = call.output().unwrap();
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(code), "{name}: {message}");
            assert!(!message.contains("panicked"), "{name}: {message}");
            for part in parts {
                assert!(message.contains(part), "{name}: {part} not in: {message}");
            }
            assert!(!out.exists(), "{name}: something was written");
        }
    }
}

#[test]
fn bad_arguments_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "not a folder").unwrap();
    let below_a_file = file.join("out");
    let below_a_file = below_a_file.to_str().unwrap();
    for (arguments, code, part) in [
        (vec!["--out", below_a_file], 3, "cannot write"),
        (vec!["--photons", "many"], 2, "whole number"),
        (vec!["--photons", "0"], 2, "run.photons"),
        (vec!["--threads", "0"], 2, "a whole number from 1 to 1024"),
        (vec!["--seed", "-1"], 2, "'--seed <N>': allowed: a whole"),
        (vec!["--target-error", "-1%"], 2, "must be a share"),
        (vec!["--time", "5"], 2, "allowed: a number with its unit"),
        (vec!["--set", "blockers.0.fil=1"], 2, "fill"),
        (
            vec!["--set", "blockers[0].fill=2"],
            2,
            "blockers[0].fill is 2",
        ),
        (
            vec!["--set", "light.size=(1,2"],
            2,
            "a bracket is still open",
        ),
        (
            vec!["--set", "surfaces=[]"],
            2,
            "allowed: a surface, but the scene has none",
        ),
        (vec!["--set", "blockers"], 2, "PATH=VALUE"),
        (vec!["--save", "everything"], 2, "photons"),
        (vec!["--expect", "success"], 2, "disagreement"),
    ] {
        let output = etendue()
            .arg("run")
            .arg(scene("fig9b.ron"))
            .args(&arguments)
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(
            message.contains(part),
            "{arguments:?}: {part} not in: {message}"
        );
    }
    for (content, part) in [
        (None, "cannot read"),
        (Some(&b" \n"[..]), "the file is empty; allowed: a scene"),
        (Some(b"\x89PNG\xff"), "it is not text; allowed: a scene"),
    ] {
        let path = folder.path().join("scene.ron");
        if let Some(content) = content {
            fs::write(&path, content).unwrap();
        }
        let output = etendue().arg("run").arg(&path).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(part), "{part} not in: {message}");
    }
    // A negative number is a value, and not an option.
    for (option, value) in [("--pixel", "-3,5"), ("--depth", "99"), ("--window", "-3")] {
        let scene = scene("worlds/glossy.xml");
        let output = etendue()
            .args(["probe", scene.to_str().unwrap(), option, value])
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        let part = format!("invalid value '{value}' for '{option}");
        assert!(message.contains(&part), "{message}");
        assert!(message.contains("allowed: "), "{message}");
    }
}

/// The test kills a run at twenty moments, some of which are later than the run usually takes. Each
/// kill leaves a complete result or no result.
#[test]
fn a_killed_run_leaves_no_half_result() {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    run(&folder.path().join("whole"), &["--quiet"]);
    let whole = start.elapsed();
    let mut complete = 0;
    for i in 0..20u32 {
        // All runs of this test use the same folder. A result must not mix the summary of an
        // earlier run with files of a later run that was killed.
        let out = folder.path().join("killed");
        let mut child = etendue()
            .arg("run")
            .arg(scene("fig9b.ron"))
            .args(SMALL)
            .args(["--quiet", "--seed", &i.to_string(), "--out"])
            .arg(&out)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // The golden ratio spreads the moments of the kills evenly over twice the time of a run.
        // Half of these moments are within the run. Some moments are after its end, even on a
        // machine that has become slower.
        let share = f64::from(i) * 0.618_034 % 1.0 * 2.0;
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * share));
        child.kill().unwrap();
        child.wait().unwrap();
        if out.join("summary.json").exists() {
            assert!(
                is_result(&out),
                "kill {i} left a summary that does not match"
            );
            complete += 1;
        }
    }
    assert!(
        (1..20).contains(&complete),
        "{complete} of 20 complete: the kills do not try it"
    );
}

/// A command fails if its main output cannot be written because standard output is full.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_a_failure() {
    let scene = scene("fig9b.ron");
    let scene = scene.to_str().unwrap();
    for arguments in [
        &["split", scene, "--parts", "4"][..],
        &["split", scene, "--parts", "4", "--slurm"],
        &["check", scene],
        &["schema"],
        &["schema", "--page"],
        &["--help"],
        &["run", "--help"],
        &["--version"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = etendue().args(arguments).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}: {output:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains("standard output"), "{message}");
    }
}

#[test]
fn what_is_saved_twice_is_refused_before_tracing() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["--save", "photons,mcpl,photons"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("--save: photons is given twice"),
        "{message}"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
