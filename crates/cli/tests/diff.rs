//! Tests `etendue diff`, which compares two results of one scene.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common;
use crate::common::{SCENE, call, json, loud, refused, sealed, small, told};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with the small scene, with enough photons for a verdict, and several runs of
/// this scene, each in its own folder.
fn runs(each: &[&str]) -> TempDir {
    let folder = small();
    for arguments in each {
        let output = call(
            folder.path(),
            &format!("run small.ron --compact {arguments}"),
        );
        assert!(
            matches!(output.status.code(), Some(0 | 4)),
            "{arguments}: {output:?}"
        );
    }
    folder
}

/// The exit code and the text of `etendue diff`.
fn diff(folder: &Path, arguments: &str) -> (Option<i32>, String) {
    let output = loud(folder, &format!("diff {arguments}"));
    assert!(output.stderr.is_empty(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    (output.status.code(), text)
}

#[track_caller]
fn found(folder: &TempDir, arguments: &str, code: i32, parts: &[&str]) {
    let (found, text) = diff(folder.path(), arguments);
    assert_eq!(found, Some(code), "{arguments}: {text}");
    for part in parts {
        assert!(text.contains(part), "{arguments}: no {part} in {text}");
    }
}

#[test]
fn two_results_are_told_apart_when_they_differ() {
    let folder = runs(&[
        "--photons 2^16 --seed 1 --out a",
        "--photons 2^16 --seed 2 --out b",
        "--photons 2^16 --seed 2 --method backward --out backward",
        "--photons 2^16 --seed 1 --threads 1 --out again",
        "--photons 2^15 --seed 1 --out half",
        "--photons 2^16 --seed 3 --set blockers.0.pitch=0.11 --out pitch",
        "--photons 2^16 --seed 3 --set light.radiance=1.1 --out bright",
        "--photons 2^9 --seed 3 --out few",
        "--photons 2^16 --seed 3 --set window.u=Hann(0.2) --out window",
        "--photons 2^16 --seed 3 --set frequencies.rho.max=7 --out grid",
    ]);
    let seeds = ["seed 1, version", "seed 2, version", "run.seed: 1 and 2"];
    let same = "verdict: same: nothing differs beyond noise";
    found(
        &folder,
        "a b",
        0,
        &[&seeds[..], &[same, "the same scene, but"]].concat(),
    );
    found(&folder, "a backward", 0, &["method backward", same]);
    // If two results share photons, either their bytes are identical or the comparison is
    // undecided.
    found(
        &folder,
        "a again",
        0,
        &["scene: the same\n", "the same numbers byte for byte"],
    );
    found(
        &folder,
        "a half",
        4,
        &[
            "both results have seed 1, and share photons",
            "photons are 65536 and 32768",
        ],
    );
    // Other scenes.
    let pitch = [
        "scene: another",
        "blockers[0].pitch: 0.10000000000000002 and 0.11",
        "verdict: different: slices",
        "side of blockers at receiver",
    ];
    found(&folder, "a pitch", 1, &pitch);
    let bright = [
        "light.radiance: 1.0 and 1.1",
        "different: slices at light; slices at receiver",
        "no parameter of both results differs",
    ];
    found(&folder, "a bright", 1, &bright);
    // The two results may differ in noise, windows and frequencies.
    found(&folder, "a few", 4, &["undecided:", "light: noise is"]);
    found(
        &folder,
        "a window",
        4,
        &["the field window.u is Hann(0.30000000000000004) and Hann(0.2)"],
    );
    found(
        &folder,
        "a grid",
        4,
        &["the frequencies ρ differ: 13 up to 6 and 15 up to 7"],
    );
}

/// Blockers whose sides are 60 µm wider: without pairs, noise is ten times the difference.
#[test]
fn pairs_show_changes_below_the_noise() {
    let wide = "--set blockers.0.fill=0.6006 --seed 1";
    let folder = runs(&[
        "--photons 2^16 --save batches --seed 1 --out a",
        "--photons 2^16 --save batches --seed 1 --out again --threads 1",
        "--photons 2^16 --save batches --seed 2 --out other",
        "--photons 2^16 --seed 1 --out plain",
        &format!("--photons 2^16 --save batches {wide} --out b"),
    ]);
    let path = folder.path();
    for arguments in ["--seed 1 --out ma", &format!("{wide} --out mb")] {
        let output = call(
            path,
            &format!("measure small.ron --photons 2^16 {arguments}"),
        );
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    }
    let pairs = "pairs: batches of both results have the same random numbers";
    found(
        &folder,
        "a b",
        1,
        &[pairs, "different: slices, side of blockers at receiver"],
    );
    found(
        &folder,
        "a again",
        0,
        &[pairs, "the same numbers byte for byte"],
    );
    let seeds = "pairs: no, because the seeds are 1 and 2";
    found(
        &folder,
        "a other",
        0,
        &[seeds, "same: nothing differs beyond noise"],
    );
    let refused = loud(path, "diff --pairs a other");
    let message = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        message.contains("because the seeds are 1 and 2"),
        "{message}"
    );
    let none = "pairs: no, because plain has no batches (run it with --save batches)";
    found(
        &folder,
        "plain b",
        4,
        &[none, "share photons; run both with --save batches"],
    );

    found(&folder, "a b --draw d.png", 1, &[pairs]);
    let drawn = fs::read(path.join("d.png")).unwrap();
    assert!(drawn.starts_with(b"\x89PNG") && drawn.len() > 10_000);

    let of = |arguments: &str| -> serde_json::Value {
        let text = diff(path, &format!("{arguments} --json")).1;
        serde_json::from_str(&text).unwrap()
    };
    let (run, measured) = (of("a b"), of("ma mb"));
    let [of_run, of_measured] = [&run, &measured].map(|diff| &diff["planes"][1]);
    // A measurement has the same batches as a run.
    assert_eq!(measured["pairs"], true, "{measured}");
    for key in ["p_value", "chi2_per_dof", "difference", "noise"] {
        assert_eq!(of_run[key], of_measured[key], "{key}");
    }
    let [noise, unpaired] = ["noise", "unpaired_noise"].map(|key| of_run[key].as_f64().unwrap());
    assert!(unpaired > 10.0 * noise, "{of_run}");
    // The predictions of both scenes differ by what the pairs measure.
    assert!(
        of_run["p_value_of_predicted_difference"].as_f64().unwrap() > 1e-3,
        "{of_run}"
    );
    let side = of_run["parameters"].as_array().unwrap();
    let side = side
        .iter()
        .find(|of| of["name"] == "side of blockers")
        .unwrap();
    let [a, b] = [0, 1].map(|i| side["measured"][i]["value"].as_f64().unwrap());
    let error = side["measured"][1]["error"].as_f64().unwrap();
    assert!((b - a - 6e-5).abs() < 4.0 * error && error < 3e-5, "{side}");
    assert!(side["p_value_of_rest"].as_f64().unwrap() > 1e-3, "{side}");
}

/// A scene is measured by its difference from another one, with less noise than alone. A prediction
/// of the other scene that is wrong is not noticed.
#[test]
fn a_scene_is_measured_against_another() {
    let folder = runs(&["--photons 2^16 --seed 1 --out alone"]);
    let path = folder.path();
    let wide = SCENE.replace("0.5999999999999999", "0.603");
    assert_ne!(wide, SCENE);
    fs::write(path.join("wide.ron"), &wide).unwrap();
    let against = |arguments: &str| {
        let output = loud(
            path,
            &format!("run wide.ron --photons 2^16 --seed 1 {arguments}"),
        );
        let message = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), message)
    };
    let (code, message) = against("--against small.ron --out twin --threads 1");
    assert_eq!(code, Some(0), "{message}");
    let (code, message) = against("--against small.ron --out again --threads 2");
    assert_eq!(code, Some(0), "{message}");
    let summary = |name: &str| fs::read(path.join(name).join("summary.json")).unwrap();
    assert_eq!(summary("twin"), summary("again"));
    let (code, message) = against("--against small.ron --out late --time 1ms");
    assert_eq!(code, Some(3), "{message}");
    let (code, message) = against("--against small.ron --out late --resume");
    assert_eq!(code, Some(0), "{message}");
    assert_eq!(summary("twin"), summary("late"));
    // The result of a difference from another scene is another result.
    let (code, message) = against("--against wide.ron --out late --resume");
    assert_eq!(code, Some(0), "{message}");
    assert_ne!(summary("twin"), summary("late"));
    let of = |name: &str| json(&path.join(name).join("summary.json"));
    let (alone, twin) = (of("alone"), of("twin"));
    assert_eq!(twin["method"], "difference");
    let noise = |of: &serde_json::Value| of["planes"][1]["noise_limit"].as_f64().unwrap();
    assert!(noise(&alone) > 4.0 * noise(&twin), "{alone} {twin}");
    // Light that is the same in both scenes has the prediction of the first, without noise.
    assert_eq!(twin["planes"][0]["relative_error"], 0.0);

    // A third scene, whose prediction differs from that of the first by what photons measure.
    let (code, message) = against("--set blockers.0.fill=0.609 --against wide.ron --out third");
    assert_eq!(code, Some(0), "{message}");
    for (other, part) in [
        (
            SCENE.replace("receiver", "elsewhere"),
            "its planes are light, elsewhere",
        ),
        (
            SCENE.replace("x: Hann(0.5)", "x: Hann(0.4)"),
            "plane light has another window",
        ),
    ] {
        fs::write(path.join("other.ron"), other).unwrap();
        let (code, message) = against("--against other.ron --out refused");
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(part), "{message}");
    }
    let (code, message) = against("--method backward --against small.ron --out refused");
    assert_eq!(code, Some(2), "{message}");
    assert!(!path.join("refused").exists());
}

/// Of the edges and sides of a mask, the one that differs is named first.
#[test]
fn the_edge_that_moved_is_named() {
    let slit = concat!(
        "HalfPlane(axis:X,edge:-0.05,opaque:Below),",
        "HalfPlane(axis:X,edge:0.05,opaque:Above)"
    );
    let two = concat!(
        "Rectangle(center:(-0.1,0),size:(0.08,0.1)),",
        "Rectangle(center:(0.1,0),size:(0.08,0.2))"
    );
    let shapes =
        |shapes: &str| format!(r#"Shapes(name:"slit",center:(0.1,0.2,1.3),shapes:[{shapes}])"#);
    let corners = "[(-0.2,-0.2),(-0.2,0.2),(0.2,0.2),(0.2,-0.2)]";
    let polygon =
        format!(r#"Aperture(name:"slit",center:(0.1,0.2,1.3),hole:Polygon(corners:{corners}))"#);
    let mirror = concat!(
        r#" --set path.visits=["m"] --set planes=[(name:"far",at:Distance(2.4))] "#,
        r#"--set window.u=Hann(0.5) --set surfaces=[Smooth(name:"m",center:(0.1,0.2,2.2),"#,
        r#"facing:(0,0.6,-0.8),form:Sphere(-0.25),aperture:0.2,event:Mirror)]"#,
    );
    let of = |mask: &str| format!("--set blockers=[{mask}]");
    let card = concat!(
        r#"--set surfaces=[Rectangle(name:"floor",center:(0.1,0.2,2.236),size:(6,6)),"#,
        r#"Rectangle(name:"card",center:(0.18,0.33,1.3),size:(0.2,0.3),"#,
        r#"facing:(0.3,0,-1))] --set blockers=[]"#
    );
    let lamp = "--set other_lights=[Disc(center:(0.2,0.2,0.6),radius:0.05)]";
    for (options, [from, to], named) in [
        (of(&shapes(slit)), ["e:0.05", "e:0.056"], "edge 2 of slit"),
        (
            of(&shapes(slit)) + mirror,
            ["e:0.05", "e:0.056"],
            "edge 2 of slit",
        ),
        (
            of(&shapes(two)),
            ["0.08,0.2", "0.08,0.215"],
            "side y of shape 2 of slit",
        ),
        (
            of(&shapes(two)) + mirror,
            ["(0.1,0)", "(0.113,0)"],
            "position x of shape 2 of slit",
        ),
        (
            of(&polygon),
            ["(0.2,0.2)", "(0.22,0.2)"],
            "x of corner 3 of slit",
        ),
        (
            of("") + mirror,
            ["aperture:0.2", "aperture:0.21"],
            "aperture of m",
        ),
        (
            of("") + mirror,
            ["center:(0.1,0.2,2.2)", "center:(0.105,0.2,2.2)"],
            "position x of m",
        ),
        (
            card.to_owned(),
            ["(0.18,0.33", "(0.1826,0.3343"],
            "position x of card",
        ),
        (
            card.to_owned(),
            ["(0.2,0.3)", "(0.21,0.3)"],
            "side x of card",
        ),
        (
            card.to_owned(),
            [",1.3),s", ",1.32),s"],
            "position z of card",
        ),
        (
            lamp.to_owned(),
            ["(0.2,0.2", "(0.20315,0.2051"],
            "position x of light (light 2)",
        ),
    ] {
        // If theory follows rays, a run of few photons has no derivatives for all edges.
        let follows_rays = options.ends_with(mirror) || options == card;
        let photons = if follows_rays { 23 } else { 18 };
        let run = |options: &str, more: &str| format!("{options} --photons 2^{photons} {more}");
        let folder = runs(&[
            &run(&options, "--seed 1 --out a"),
            &run(&options.replace(from, to), "--seed 2 --out b"),
        ]);
        let (code, text) = diff(folder.path(), "a b");
        assert_eq!(code, Some(1), "{text}");
        let verdict = text.lines().find(|line| line.starts_with("verdict:"));
        assert!(verdict.unwrap().contains(named), "{verdict:?} {text}");
    }
}

#[test]
fn planes_that_one_result_lacks_are_named() {
    let folder = runs(&["--photons 2^14 --seed 1 --out a"]);
    let lone = SCENE.replace("(name: \"light\", at: Emission), ", "");
    assert_ne!(lone, SCENE);
    fs::write(folder.path().join("small.ron"), &lone).unwrap();
    call(
        folder.path(),
        "run small.ron --photons 2^14 --seed 2 --out lone",
    );
    found(
        &folder,
        "a lone",
        4,
        &["light: only the first result has this plane"],
    );
    found(
        &folder,
        "lone a",
        4,
        &["light: only the second result has this plane"],
    );
    let renamed = lone.replace("receiver", "elsewhere");
    fs::write(folder.path().join("small.ron"), renamed).unwrap();
    call(
        folder.path(),
        "run small.ron --photons 2^14 --seed 2 --out other",
    );
    let output = loud(folder.path(), "diff a other");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("no plane in common"), "{message}");
}

/// Checks that `diff` refuses its input with one line that names the file.
#[track_caller]
fn refuses(folder: &Path, parts: &[&str]) {
    for arguments in ["a b", "b a"] {
        let output = loud(folder, &format!("diff {arguments}"));
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{parts:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        for part in parts {
            assert!(message.contains(part), "no {part} in {message}");
        }
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn damaged_folders_are_refused_by_name() {
    let folder = runs(&[
        "--photons 2^12 --seed 1 --out a",
        "--photons 2^12 --seed 2 --out b",
    ]);
    let path = folder.path();
    let [summary, slices] = ["b/summary.json", "b/light/slices.npz"].map(|name| path.join(name));
    let [index, arrays] = [&summary, &slices].map(|file| fs::read(file).unwrap());

    fs::write(&slices, &arrays[..arrays.len() / 2]).unwrap();
    refuses(path, &["b/light/slices.npz is damaged"]);
    fs::remove_file(&slices).unwrap();
    refuses(path, &["cannot read b/light/slices.npz"]);
    fs::write(&slices, &arrays).unwrap();

    for broken in [
        &b"{"[..],
        b"",
        b"[]",
        b"{\"planes\": []}",
        &index[..index.len() / 2],
    ] {
        fs::write(&summary, broken).unwrap();
        refuses(
            path,
            &["b/summary.json: the file is not a summary of a run"],
        );
    }
    let text = String::from_utf8(index.clone()).unwrap();
    fs::write(&summary, text.replace("\"seed\": 2", "\"seed\": 3")).unwrap();
    refuses(
        path,
        &["b/summary.json: the file was changed after it was written"],
    );
    fs::remove_file(&summary).unwrap();
    refuses(path, &["b holds no result, because it has no summary.json"]);

    // The index is rewritten so that its hashes match the changed files.
    let mut tree: serde_json::Value = serde_json::from_slice(&index).unwrap();
    tree["batches"] = 2.into();
    fs::write(&summary, sealed(tree.clone())).unwrap();
    refuses(path, &["b/summary.json: batches: 2"]);
    tree["batches"] = 64.into();
    tree["format"] = 2.into();
    fs::write(&summary, sealed(tree.clone())).unwrap();
    refuses(
        path,
        &["b/summary.json: format is 2; this version of etendue"],
    );
    tree["format"] = 1.into();
    tree["files"]["light/slices.npz"] = "".into();
    fs::write(&summary, sealed(tree.clone())).unwrap();
    refuses(path, &["b/light/slices.npz is damaged"]);
    tree["files"]
        .as_object_mut()
        .unwrap()
        .remove("light/slices.npz");
    fs::write(&summary, sealed(tree)).unwrap();
    refuses(
        path,
        &["b/summary.json: the field files does not list light/slices.npz"],
    );
}

#[test]
fn arrays_that_do_not_fit_are_refused() {
    let folder = runs(&[
        "--photons 2^12 --seed 1 --out a",
        "--photons 2^12 --seed 2 --out b",
    ]);
    let path = folder.path();
    let mut tree = json(&path.join("b/summary.json"));
    // The arrays of another plane's radial spectrum contain no slices.
    let other = fs::read(path.join("b/light/radial.npz")).unwrap();
    fs::write(path.join("b/light/slices.npz"), &other).unwrap();
    tree["files"]["light/slices.npz"] = blake3::hash(&other).to_hex().as_str().into();
    fs::write(path.join("b/summary.json"), sealed(tree)).unwrap();
    refuses(path, &["b/light/slices.npz: array azimuth"]);
}

#[test]
fn results_of_earlier_versions_are_undecided() {
    let folder = runs(&[
        "--photons 2^14 --seed 1 --out a",
        "--photons 2^14 --seed 2 --out b",
    ]);
    let summary = folder.path().join("b/summary.json");
    let mut tree = json(&summary);
    tree["version"] = "0.0.1".into();
    for plane in tree["planes"].as_array_mut().unwrap() {
        plane.as_object_mut().unwrap().remove("noise_dof");
    }
    fs::write(&summary, sealed(tree)).unwrap();
    let parts = ["version 0.0.1", "b has no noise_dof"];
    found(&folder, "a b", 4, &parts);
}

#[test]
fn the_same_photons_are_compared_number_by_number() {
    let folder = runs(&[
        "--photons 2^16 --seed 1 --out a",
        "--photons 2^16 --seed 1 --set run.alpha=0.02 --out b",
        "--photons 2^16 --seed 1 --set blockers.0.pitch=0.11 --out pitch",
        "--photons 2^16 --seed 1 --set blockers.0.fill=0.601 --out fill",
    ]);
    let parts = ["run.alpha: 0.01 and 0.02", "the same numbers"];
    found(&folder, "a b", 0, &parts);
    // The first plane is before the blockers, so its spectrum does not differ.
    let (code, text) = diff(folder.path(), "a pitch");
    assert_eq!(code, Some(1), "{text}");
    let light = text
        .lines()
        .find(|line| line.starts_with("light "))
        .unwrap();
    assert!(
        light.ends_with("same") && light.contains("0.000 %"),
        "{text}"
    );
    // The difference of the results is far below the noise, but both results have the same noise.
    found(
        &folder,
        "a fill",
        4,
        &["receiver: ", "both results have seed 1, and share photons"],
    );
}

#[test]
fn a_compact_result_is_whole() {
    let folder = runs(&["--photons 2^12 --seed 1 --out a"]);
    let listed = json(&folder.path().join("a/summary.json"));
    let listed: Vec<&String> = listed["files"].as_object().unwrap().keys().collect();
    assert!(
        listed
            .iter()
            .all(|name| folder.path().join("a").join(name).exists())
    );
    assert!(
        !listed
            .iter()
            .any(|name| name.ends_with(".csv") || name.ends_with(".svg"))
    );
    for name in ["report.html", "path.png", "receiver/slices.npz"] {
        assert!(listed.iter().any(|listed| *listed == name), "{name}");
    }
    told(folder.path(), "report a --out page.html", 0);
    refused(
        folder.path(),
        "run nothing.ron --compact --out out",
        &["nothing.ron"],
    );
}

/// The folders in `results/` are complete: each listed file is unchanged and small.
#[test]
fn committed_results_are_whole() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results");
    for name in ["fig9b", "fig10"] {
        let folder = results.join(name);
        let listed = json(&folder.join("summary.json"));
        let mut names: Vec<String> = vec!["summary.json".to_owned()];
        for (file, hash) in listed["files"].as_object().unwrap() {
            let bytes = fs::read(folder.join(file)).unwrap();
            assert_eq!(*hash, *blake3::hash(&bytes).to_hex(), "{name}/{file}");
            let is_array = file.ends_with(".npz") || file.ends_with(".csv");
            assert!(!is_array || bytes.len() < 200_000, "{name}/{file}");
            names.push(file.clone());
        }
        names.sort();
        let found: Vec<String> = common::files(&folder).into_keys().collect();
        assert_eq!(found, names, "{name}");
    }
    let out = tempfile::tempdir().unwrap();
    let page = out.path().join("page.html");
    let report = format!("report fig9b fig10 --out {}", page.display());
    told(&results, report, 0);
    told(&results, "diff fig9b fig9b", 0);
}
