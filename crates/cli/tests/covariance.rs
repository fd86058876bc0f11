//! Tests `etendue covariance` and `probe --covariance`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{call, files, json, passes, refused, told};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// The lamp fills the window of the first plane. The window of the second plane cuts off a part of
/// its light.
const LAMP: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (4, 4)),
    blockers: [Shapes(name: "edge", center: (0, 0, 0.5), shapes: [HalfPlane(axis: X, edge: 0.02, opaque: Above)])],
    surfaces: [Rectangle(name: "floor", center: (0, 0, 1), size: (6, 6), albedo: 0)],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "full", at: Before("edge")), (name: "cut", at: After("edge"))],
    window: (x: Hann(0.1), u: Hann(0.2)),
    frequencies: (azimuths: 1, rho: (max: 30), nu: (max: 15)),
    run: (photons: 1048576, seed: 1),
)"#;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lamp.ron"), LAMP).unwrap();
    folder
}

fn entry(plane: &Value, matrix: &str, i: usize, j: usize) -> f64 {
    plane[matrix][i][j].as_f64().unwrap()
}

#[test]
fn light_that_fills_the_window_has_its_covariance_and_edges_are_told() {
    let folder = folder();
    passes(folder.path(), "covariance lamp.ron --out out");
    let index = json(&folder.path().join("out/covariance.json"));
    let full = &index["planes"][0];
    // The variance of a Hann window of half-width h is 1/12h².
    for (i, h) in [0.1, 0.1, 0.2, 0.2].into_iter().enumerate() {
        let expected = 1.0 / (12.0 * h * h);
        let traced = entry(full, "traced", i, i);
        // After travel of half a metre, the variance of the lamp is 1/(8π² · 4/3).
        assert!((traced / expected - 1.0).abs() < 2e-3, "{i}: {traced}");
        let exact = entry(full, "exact", i, i);
        // The spectrum of the window has three frequencies on its own grid, and all three
        // frequencies are within the band.
        assert!((exact / expected - 1.0).abs() < 2e-3, "{i}: {exact}");
        let off = entry(full, "measured", i, i) - exact;
        assert!(off.abs() < 4.0 * entry(full, "error", i, i), "{i}: {off}");
    }
    let said = |plane: &Value| plane["remarks"].to_string();
    assert!(!said(full).contains("edges"), "{}", said(full));
    // The edge of the half-plane lies along x, and gives the spectrum an infinite tail.
    let cut = &index["planes"][1];
    assert!(said(cut).contains("edges"), "{}", said(cut));
    assert!(cut["growth"][0].as_f64().unwrap() > 1.3);
    assert!(cut["growth"][1].as_f64().unwrap() < 1.15);
    for i in 0..4 {
        let off = entry(cut, "measured", i, i) - entry(cut, "exact", i, i);
        assert!(off.abs() < 4.0 * entry(cut, "error", i, i), "{i}: {off}");
    }
    let names = ["covariance.csv", "covariance.png", "covariance.svg"];
    for plane in ["full", "cut"] {
        for name in names {
            assert!(folder.path().join("out").join(plane).join(name).is_file());
        }
    }
}

#[test]
fn covariances_have_the_same_bytes_on_any_threads() {
    let folder = folder();
    for threads in [1, 2] {
        let line = format!(
            "covariance lamp.ron --plane cut --photons 20000 --threads {threads} --out c{threads}"
        );
        passes(folder.path(), &line);
    }
    let of = |name: &str| files(&folder.path().join(name));
    assert_eq!(of("c1"), of("c2"));
}

#[test]
fn planes_are_chosen_by_their_names() {
    let folder = folder();
    refused(
        folder.path(),
        "covariance lamp.ron --plane none --out out",
        &["--plane none", "full, cut"],
    );
    let line = "covariance lamp.ron --plane full --photons 2^14 --out out";
    let said = told(folder.path(), line, 0);
    assert!(
        said.contains("νu νu") && said.contains("full: |ρ| ≤ 30"),
        "{said}"
    );
    assert!(!folder.path().join("out/cut").exists());
}

const ROOM: &str = r#"<scene version="3.0.0">
  <sensor type="perspective" id="front">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, -4, 2" target="0, 0, 0" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/><rfilter type="box"/></film>
  </sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="30"/></transform></shape>
  <emitter type="point"><point name="position" x="1" y="-2" z="3"/><float name="intensity" value="9"/></emitter>
</scene>
"#;

/// The scene is a diffuse floor that is lit evenly. The light that leaves the floor has the
/// spectrum of the window, and travel to the camera shears this spectrum.
#[test]
fn a_probe_propagates_the_covariance_to_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("room.xml"), ROOM).unwrap();
    let line =
        "probe room.xml --pixel 12,8 --window 4 --rays 2^20 --photons 2^16 --covariance --out out";
    let output = call(folder.path(), line);
    assert!(
        matches!(output.status.code(), Some(0 | 1 | 4)),
        "{output:?}"
    );
    let probe = json(&folder.path().join("out/probe.json"));
    let camera = &probe["planes"][0]["spectral_covariance"];
    let number = |of: &str, key: &str, i: usize, j: usize| camera[of][key][i][j].as_f64().unwrap();
    for (i, j) in [(0, 0), (0, 2), (2, 2), (1, 1), (1, 3), (3, 3)] {
        let [a, b] = ["measured", "propagated"].map(|of| number(of, "value", i, j));
        let error = ["measured", "propagated"].map(|of| number(of, "error", i, j));
        let both = error[0].hypot(error[1]);
        // Travel shears the tails of the window's spectrum beyond the band; the tails contain a
        // few thousandths of the spectrum's second moment.
        let scale = (number("measured", "value", i, i) * number("measured", "value", j, j)).sqrt();
        assert!(
            (a - b).abs() < 4.0 * both + 0.01 * scale,
            "{i} {j}: {a} {b} ± {both}"
        );
    }
}
