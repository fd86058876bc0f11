//! `etendue sweep`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{fails, files, json, loud, passes, refused, small};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

const PITCH: &str = "sweep small.ron --photons 4096 --out s --set blockers.0.pitch=0.05..0.2:4";

/// The rows of a table, each by column name.
fn rows(file: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(file).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

#[test]
fn the_table_has_what_a_run_says_of_each_point() {
    let folder = small();
    let path = folder.path();
    passes(path, PITCH);
    let rows = rows(&path.join("s/sweep.csv"));
    let seed = |pitch: &str| -> u64 {
        let row = rows.iter().find(|row| row["blockers.0.pitch"] == pitch);
        row.unwrap()["seed"].parse().unwrap()
    };
    let run = format!(
        "run small.ron --photons 4096 --out r --set blockers.0.pitch=0.15 --seed {}",
        seed("0.15")
    );
    passes(path, &run);
    let summary = json(&path.join("r/summary.json"));
    for plane in summary["planes"].as_array().unwrap() {
        let mut at = rows.iter().filter(|row| {
            row["blockers.0.pitch"] == "0.15" && *row["plane"] == *plane["name"].as_str().unwrap()
        });
        let nu = at.find(|row| row["quantity"] == "bandwidth_95_nu").unwrap();
        let expected = &plane["bandwidth_95"]["nu"];
        for name in ["measured", "predicted", "error"] {
            assert_eq!(
                nu[name].parse::<f64>().ok(),
                expected[name].as_f64(),
                "{name}"
            );
        }
        assert_eq!(nu["p_value"].parse::<f64>().ok(), plane["p_value"].as_f64());
    }
    let points: Vec<&String> = rows.iter().map(|row| &row["blockers.0.pitch"]).collect();
    let mut distinct = points.clone();
    distinct.dedup();
    assert_eq!(distinct, ["0.05", "0.1", "0.15", "0.2"]);
    let seeds: BTreeSet<u64> = distinct.iter().map(|pitch| seed(pitch)).collect();
    assert_eq!(seeds.len(), 4, "each point has a seed of its own");
}

#[test]
fn points_have_one_seed_where_that_is_asked_for() {
    let folder = small();
    let path = folder.path();
    let seeds = |arguments: &str| -> BTreeSet<String> {
        let line = PITCH.replace("--out s", &format!("--out s --force {arguments}"));
        passes(path, &line);
        let rows = rows(&path.join("s/sweep.csv"));
        rows.iter().map(|row| row["seed"].clone()).collect()
    };
    let own = seeds("--seed 7");
    assert_eq!(own.len(), 4);
    assert!(
        own.is_disjoint(&seeds("--seed 8")),
        "they depend on the seed of the sweep"
    );
    assert_eq!(seeds("--seed 7"), own);
    assert_eq!(seeds("--seed 7 --common-seed"), ["7".to_owned()].into());
    // Points of one seed are compared in pairs, as `diff` compares them.
    let differences = rows(&path.join("s/differences.csv"));
    let first = &differences[0];
    let output = loud(
        path,
        &format!("diff s/{} s/{} --json", first["from"], first["to"]),
    );
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["pairs"], true, "{found}");
    assert_eq!(
        differences
            .iter()
            .filter(|row| row["plane"] == "light")
            .count()
            % 3,
        0
    );
    let receiver = differences.iter().find(|row| row["plane"] == "receiver");
    for key in ["p_value", "noise", "unpaired_noise"] {
        let (own, of_diff) = (&receiver.unwrap()[key], &found["planes"][1][key]);
        assert_eq!(own.parse::<f64>().ok(), of_diff.as_f64(), "{key}");
    }
    // The light has no blocker before it, so it is the same at all points.
    assert_eq!(first["noise"], "0.0");
    // Spectra at other frequencies are no pairs.
    passes(
        path,
        "sweep small.ron --photons 4096 --out f --common-seed --set frequencies.rho.max=5,6",
    );
    let unlike = rows(&path.join("f/differences.csv"));
    assert!(unlike.len() == 2 && unlike.iter().all(|row| row["change"].is_empty()));
    // If the seed is swept, the values of the sweep are the seeds of the points.
    let line = "sweep small.ron --photons 4096 --out t --set run.seed=3,4";
    passes(path, line);
    let seeds: BTreeSet<String> = rows(&path.join("t/sweep.csv"))
        .iter()
        .map(|row| row["seed"].clone())
        .collect();
    assert_eq!(seeds, ["3", "4"].map(str::to_owned).into());
}

#[test]
fn a_derivative_is_that_of_theory_over_the_largest_step_without_bias() {
    let folder = small();
    let path = folder.path();
    // The spectrum is linear in the radiance, and periodic in the position of a grating.
    let line = |field: &str| {
        let line = format!("sweep small.ron --photons 65536 --out d --force --derivative {field}");
        passes(path, &line);
        let rows = rows(&path.join("d/derivative.csv"));
        let at = rows.into_iter().filter(|row| row["plane"] == "receiver");
        let at: Vec<_> = at.collect();
        assert_eq!(at.len(), 3, "{at:?}");
        at
    };
    let number = |row: &BTreeMap<String, String>, key: &str| row[key].parse::<f64>().unwrap();
    let chosen = |rows: &[BTreeMap<String, String>]| {
        rows.iter().position(|row| row["chosen"] == "true").unwrap()
    };
    let radiance = line("light.radiance");
    assert_eq!(chosen(&radiance), 0, "no step has a bias");
    let size = number(&radiance[0], "size");
    assert!((size - 1.0).abs() < 1e-9, "of one per unit: {size}"); // rounding
    let place = line("blockers.0.center.0=0.08");
    let at = chosen(&place);
    assert!(at > 0, "a step of most of a period has a bias: {place:?}");
    assert!(number(&place[at], "bias") <= number(&place[at], "noise"));
    for row in [&radiance[0], &place[at]] {
        let [share, error] = ["share_of_theory", "error_of_share"].map(|key| number(row, key));
        // Five errors: with a fixed seed, the test cannot fail by chance.
        assert!((share - 1.0).abs() < 5.0 * error && error < 0.1, "{row:?}");
    }
    let message = fails(
        path,
        "sweep small.ron --derivative light.radiance --set light.radiance=1,2",
        2,
    );
    let allowed = "allowed beside --derivative light.radiance: one value";
    assert!(message.contains(allowed), "{message}");
    // At the end of a range there is no central difference; --set states the value.
    let line = "sweep small.ron --derivative surfaces.0.albedo --set surfaces.0.albedo=1";
    let message = fails(path, line, 2);
    assert!(
        message.contains("FIELD=STEP states a smaller step"),
        "{message}"
    );
    let message = fails(path, "sweep small.ron --derivative run.photons", 2);
    assert!(message.contains("whole number"), "{message}");
}

/// If the folder of points is a link, points are not written through it.
#[test]
fn points_go_through_no_link() {
    for name in ["s/points", "s/points/POINT"] {
        let folder = small();
        let path = folder.path();
        passes(path, PITCH);
        let point = json(&path.join("s/sweep.json"))["points"][0]
            .as_str()
            .unwrap()
            .to_owned();
        let linked = path.join(name.replace("points/POINT", &point));
        fs::remove_dir_all(&linked).unwrap();
        fs::create_dir(path.join("elsewhere")).unwrap();
        std::os::unix::fs::symlink(path.join("elsewhere"), &linked).unwrap();
        let message = fails(path, PITCH, 3);
        assert!(
            message.contains("a link or a file is in the place of"),
            "{message}"
        );
        assert_eq!(fs::read_dir(path.join("elsewhere")).unwrap().count(), 0);
    }
}

#[test]
fn a_sweep_goes_on_from_what_is_there() {
    let folder = small();
    let path = folder.path();
    passes(path, PITCH);
    let whole = files(&path.join("s"));
    let points = json(&path.join("s/sweep.json"))["points"].clone();
    let summary = |i: usize| {
        path.join("s")
            .join(points[i].as_str().unwrap())
            .join("summary.json")
    };
    let made = |i: usize| fs::metadata(summary(i)).unwrap().ino();
    let before = [0, 1, 3].map(made);
    // One summary was removed, and another summary was changed by hand.
    fs::remove_file(summary(2)).unwrap();
    fs::write(summary(3), "{}").unwrap();
    fails(path, PITCH, 3);
    fs::remove_file(summary(3)).unwrap();
    passes(path, PITCH);
    assert_eq!([0, 1].map(made), before[..2], "not run again");
    assert!(files(&path.join("s")) == whole, "the same bytes");
    // If values are added to a sweep, only the new points are run.
    let more = PITCH.replace(":4", ":7");
    passes(path, &more);
    assert_eq!([0, 1].map(made), before[..2]);
    assert_eq!(fs::read_dir(path.join("s/points")).unwrap().count(), 7);
}

#[test]
fn a_grid_and_fields_in_step() {
    let folder = small();
    let path = folder.path();
    let both = "sweep small.ron --photons 4096 --set blockers.0.pitch=0.1,0.2 --set blockers.0.fill=0.3..0.6:2";
    passes(path, format!("{both} --out grid"));
    passes(path, format!("{both} --together --out step"));
    let points = |name: &str| json(&path.join(name))["points"].as_array().unwrap().clone();
    let (grid, step) = (points("grid/sweep.json"), points("step/sweep.json"));
    assert_eq!(grid.len(), 4);
    assert_eq!(step, [grid[0].clone(), grid[3].clone()]);
    // The curves of a sweep over two fields have a panel for each plane and each value of `fill`.
    let curves = rows(&path.join("grid/slope.csv"));
    let panels: BTreeSet<&String> = curves.iter().map(|r| &r["panel"]).collect();
    assert_eq!(panels.len(), 4, "{panels:?}");
    assert!(panels.contains(&"receiver, fill=0.6".to_owned()));
}

#[test]
fn bad_sweeps_are_refused() {
    let folder = small();
    let path = folder.path();
    let set = "sweep small.ron --out out --set";
    for (arguments, parts) in [
        (
            "sweep small.ron --out out".to_owned(),
            &["nothing is swept"][..],
        ),
        (
            format!("{set} blockers.0.pith=1,2"),
            &["pith=1", "did you mean pitch"],
        ),
        (
            format!("{set} blockers.0.fill=0.5,2"),
            &["blockers.0.fill=2", "allowed"],
        ),
        (
            format!("{set} blockers.0.fill=0.1..0.9:500 --set blockers.0.pitch=1..2:3"),
            &["1000"],
        ),
        (
            format!("{set} blockers.0.fill=0.1..0.9:5 --together --set blockers.0.pitch=1..2:3"),
            &["same number"],
        ),
    ] {
        refused(path, &arguments, parts);
    }
    let message = fails(path, format!("{set} blockers.0.fill=0.1..0.9"), 2);
    assert!(message.contains("PATH=A..B:N"), "{message}");
    for (twice, field) in [
        (
            "blockers.0.pitch=0.1,0.2 --set blockers.0.pitch=0.3",
            "blockers.0.pitch is given twice",
        ),
        (
            "run.photons=1024,2048 --photons 4096",
            "run.photons is given twice",
        ),
        (
            "blockers.0.pitch=0.05-0.4:3",
            "pitch=0.05-0.4:3 is one value",
        ),
    ] {
        let message = fails(path, format!("{set} {twice}"), 2);
        assert!(message.contains(field), "{message}");
    }
    // A sweep of another scene, or of other fields, does not replace this sweep.
    passes(path, PITCH);
    let other = format!("{PITCH} --set blockers.0.fill=0.3");
    let message = fails(path, &other, 3);
    assert!(message.contains("in which blockers[0].fill is"));
    let fields = "sweep small.ron --photons 4096 --out s --set blockers.0.fill=0.3,0.5";
    let message = fails(path, fields, 3);
    assert!(
        message.contains("holds a sweep of blockers.0.pitch"),
        "{message}"
    );
    passes(path, format!("{other} --force"));
}
