//! `etendue bandwidth`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{SCENE, fails, files, passes, refused, scene};
use std::fs;

/// A folder with a scene of the repository as `glossy.ron`, and a scene without a glossy
/// surface as `small.ron`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(scene("bandwidth.ron"), folder.path().join("glossy.ron")).unwrap();
    fs::write(folder.path().join("small.ron"), SCENE).unwrap();
    folder
}

#[test]
fn a_sweep_measures_what_the_criterion_says() {
    let folder = folder();
    let arguments = "bandwidth glossy.ron --measure --photons 300000 --sweep surfaces.0.form.Sphere=0..0.5:2 --csv b.csv";
    let output = passes(folder.path(), arguments);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("B (Eq. 20)") && text.contains("  0.500  eye  "),
        "{text}"
    );
    let csv = fs::read_to_string(folder.path().join("b.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 3);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let at = |name: &str| rows[0].iter().position(|cell| *cell == name).unwrap();
    for row in &rows[1..] {
        let number = |name: &str| row[at(name)].parse::<f64>().unwrap();
        // B is Ω_ρ |1 + 2kd/cos θ₁|, where Ω_ρ is the bandwidth of the lobe, d = 0.5, and tan θ₁ =
        // 0.5.
        let finer = 1.0 + number("k [1/m]") * 1.25_f64.sqrt();
        assert!((number("B (Eq. 20)") / (number("lobe") * finer) - 1.0).abs() < 1e-9); // rounding, and the scene's frames
        assert!((number("exact") / number("B (Eq. 20)") - 1.0).abs() < 0.05); // as validated
        let off = (number("measured") - number("exact")) / number("error");
        assert!(off.abs() < 4.0, "{off}"); // one seed in 16,000 is beyond 4
        assert_eq!(row[at("d' [m]")], "");
    }
}

#[test]
fn a_grid_that_ends_too_soon_is_told() {
    let folder = folder();
    let arguments = "bandwidth glossy.ron --measure --photons 20000 --set frequencies.nu.max=3";
    let output = passes(folder.path(), arguments);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("warning: eye: a bandwidth of"), "{text}");
}

#[test]
fn bad_sweeps_and_scenes_are_refused() {
    let folder = folder();
    let path = folder.path();
    let refusals: [(&str, &[&str]); 4] = [
        (
            "bandwidth glossy.ron --csv out --sweep surfaces.0.from.Sphere=0..1:3",
            &["surfaces.0.from.Sphere=0.0: no field `from`"],
        ),
        (
            "bandwidth glossy.ron --csv out --sweep surfaces.0.form.Sphere=0..1:3 --sweep surfaces.0.facing.0=0..1:2",
            &["vary together", "same number"],
        ),
        (
            "bandwidth small.ron --csv out",
            &["no plane of this scene", "BRDF"],
        ),
        (
            "bandwidth absent.ron --csv out",
            &["cannot read absent.ron"],
        ),
    ];
    for (arguments, parts) in refusals {
        refused(path, arguments, parts);
    }
    for sweep in ["a=0..1", "a=0..1:0", "a=0..x:3", "0..1:3", "a=0..inf:3"] {
        let message = fails(path, format!("bandwidth glossy.ron --sweep {sweep}"), 2);
        assert!(message.contains("PATH=A..B:N"), "{message}");
    }
    assert!(files(path).keys().eq(["glossy.ron", "small.ron"]));
    fails(path, "bandwidth glossy.ron --csv absent/b.csv", 3);
}
