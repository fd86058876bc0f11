//! Tests parts of the command line: methods of measurement, export to other programs, meshes and
//! the 4D light field.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{SCENE, array, fails, files, json, passes, refused, scene, told, untimed};
use ndarray::{Array2, Array4};
use ndarray_npy::ReadNpyExt;
use std::fs::{self, File};

/// A folder with the small scene, in which some text is replaced.
fn folder(edits: &[(&str, &str)]) -> tempfile::TempDir {
    let mut text = SCENE.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in the scene");
        text = text.replacen(from, to, 1);
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("small.ron"), text).unwrap();
    folder
}

const LIGHT: &str =
    "Rectangle(center: (0.1, 0.2, 0.30000000000000004), size: (0.2, 0.17320508075688773))";
const POINT: &str = "Point(center: (0.1, 0.2, 0.30000000000000004))";
const LAYER: &str = "blockers: [";
/// Two meshes as blockers. The first mesh is read from a file. The second mesh has too many
/// triangles for the exact prediction, so the other tracer checks the measurement.
const MESH: &str = r#"blockers: [Mesh(name: "tetra", center: (0.1, 0.2, 1), mesh: File("meshes/tetra.obj"), scale: 0.1),
    Mesh(name: "ball", center: (-0.1, 0.1, 1), mesh: Star(radius: 0.03, relief: 0, lobes: 0, rings: 20)), "#;
const TETRA: &str =
    "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

#[test]
fn backward_rays_agree_and_keep_no_ledger() {
    let folder = folder(&[]);
    passes(
        folder.path(),
        "run small.ron --method backward --photons 100000 --out out",
    );
    let summary = json(&folder.path().join("out/summary.json"));
    assert_eq!(summary["method"], "backward");
    assert!(summary["ledger"].is_null());
    assert!(summary["planes"][1]["in_window"].as_u64().unwrap() > 1000);
}

/// Backward rays find a point light if nothing deflects its light. Behind a mirror, they do not
/// find it.
#[test]
fn a_point_is_found_backwards_unless_a_mirror_turns_its_light() {
    let beyond = ("at: Emission", "at: Distance(0.5)");
    let found = folder(&[(LIGHT, POINT), beyond]);
    let run = "run small.ron --method backward --photons 100000 --out out";
    passes(found.path(), run);
    let at_light = folder(&[(LIGHT, POINT)]);
    refused(at_light.path(), run, &["the plane lies at a point light"]);
    let mirror = scene("wild/ball_beyond_its_patch.ron");
    let arguments = format!("run {} --method backward --out other", mirror.display());
    refused(
        at_light.path(),
        &arguments,
        &["no ray traced back from p finds the light"],
    );
}

#[test]
fn a_mesh_goes_through_all_stages() {
    let folder = folder(&[(LAYER, MESH)]);
    let path = folder.path();
    fs::create_dir(path.join("meshes")).unwrap();
    fs::write(path.join("meshes/tetra.obj"), TETRA).unwrap();
    for arguments in [
        "run small.ron --photons 60000 --out run",
        "measure small.ron --photons 60000 --out m",
        "predict small.ron --photons 60000 --out p",
    ] {
        passes(path, arguments);
    }
    // The files of the stages contain all inputs, so the original meshes are not needed.
    fs::remove_dir_all(path.join("meshes")).unwrap();
    passes(path, "compare --measured m --predicted p --out compared");
    let [run, compared] = ["run", "compared"].map(|result| untimed(&path.join(result)));
    assert!(run == compared);
    let summary = json(&path.join("run/summary.json"));
    assert_eq!(summary["planes"][1]["class"], "reference");
    assert!(fails(path, "predict small.ron --out out", 2).contains("tetra.obj"));
}

#[test]
fn the_light_field_is_written_on_its_grid() {
    let folder = folder(&[]);
    let path = folder.path();
    fails(
        path,
        "run small.ron --save field --out out --set window.y=0.5",
        2,
    );
    passes(path, "run small.ron --save field --out out");
    let plane = path.join("out/receiver");
    let field: Array4<f64> =
        Array4::read_npy(File::open(plane.join("field.npy")).unwrap()).unwrap();
    let index = json(&plane.join("field.json"));
    let cells: Vec<usize> = serde_json::from_value(index["cells"].clone()).unwrap();
    assert_eq!(field.shape(), cells.as_slice());
    let width: Vec<f64> = serde_json::from_value(index["width"].clone()).unwrap();
    // The sum over the light field is ∫ L W, which equals the value of the slices at zero
    // frequency.
    let sum: f64 = field.sum() * width.iter().product::<f64>();
    let slices: ndarray::Array3<etendue_field::Complex> =
        array(&plane.join("slices.npz"), "measured");
    let [_, rho, nu] = [0, slices.shape()[1] / 2, slices.shape()[2] / 2];
    assert!((sum / slices[[0, rho, nu]].re - 1.0).abs() < 1e-6); // relative errors are 2e-7
    let [power, predicted]: [Array2<f64>; 2] =
        ["power", "predicted_power"].map(|name| array(&plane.join("full_radial.npz"), name));
    let sigma: Array2<f64> = array(&plane.join("full_radial.npz"), "sigma");
    let zero = [0, 0];
    // The tolerance is five jackknife errors, which contain the noise of 20,000 photons.
    assert!(
        (power[zero] - predicted[zero]).abs() < 5.0 * sigma[zero],
        "{} {}",
        power[zero],
        predicted[zero]
    );
}

#[test]
fn a_grid_beyond_memory_is_refused_before_work() {
    let folder = folder(&[("rho: (max: 6)", "rho: (max: 4000)")]);
    let message = fails(folder.path(), "run small.ron --save field --out out", 3);
    assert!(
        message.contains("GB") && message.contains("cells"),
        "{message}"
    );
    assert!(!folder.path().join("out/summary.json").exists());
}

#[test]
fn scenes_are_exported_or_refused() {
    let scene = folder(&[]);
    told(scene.path(), "export --to mitsuba small.ron --out mi", 0);
    let written = files(&scene.path().join("mi"));
    assert!(written.contains_key("scene.xml") && written.contains_key("planes.json"));
    let spot = "Spot(center: (0.1, 0.2, 0.30000000000000004), bulb: Square(0.1), exponent: 3)";
    let scene = folder(&[(LIGHT, spot)]);
    told(scene.path(), "export --to mitsuba small.ron --out out", 2);
    assert!(!scene.path().join("out").exists());
}
