//! Tests a light that is a ray file: photons agree with the sum over its rays, planted faults are
//! detected, and unsuitable planes are refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{array, fails, json, loud, passes, scene};
use etendue_compare::{Verdict, compare};
use etendue_field::{Complex, Light};
use etendue_predict::{Applicability, predict, test_of};
use etendue_rayfile::{Format, PowerUnit, RayFile, RaySet, Wavelengths, convert};
use etendue_scene::{Scene, SceneError, SceneFile, resolve};
use etendue_spectrum::measure;
use etendue_trace::Tracer;
use ndarray::{Array3, Array4, Axis};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Rays from a chip of 2 mm. Each ray starts at its own height with its own power, and a
/// third of the rays go sideways or back.
fn rays(unit: PowerUnit) -> RaySet {
    let count = 3000;
    let wave = |i: usize, step: f64| 2.0 * (i as f64 * step).fract() - 1.0;
    let direction = |i: usize| {
        let d = [
            wave(i, 0.414_213_562),
            wave(i, 0.236_067_977),
            0.5 + wave(i, 0.732_050_808),
        ];
        let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
        d.map(|c| c / length)
    };
    RaySet {
        positions: (0..count)
            .map(|i| {
                [
                    1e-3 * wave(i, 0.618_033_989),
                    1e-3 * wave(i, 0.570_795),
                    1e-4 * wave(i, 0.303_03),
                ]
            })
            .collect(),
        directions: (0..count).map(direction).collect(),
        powers: (0..count).map(|i| 1e-4 * (1.0 + (i % 7) as f64)).collect(),
        unit,
        wavelengths: Wavelengths::One(500e-9),
    }
}

/// A folder with the rays as a file of each format.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, format, unit) in [
        ("led.tm25ray", Format::Tm25, PowerUnit::Watt),
        ("led.mcpl.gz", Format::McplGz, PowerUnit::Watt),
        ("lumens.tm25ray", Format::Tm25, PowerUnit::Lumen),
        ("led.npy", Format::Npy, PowerUnit::Weight),
    ] {
        let bytes = convert(&RayFile::Npy(rays(unit)), format).unwrap().bytes;
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    fs::write(folder.path().join("none.mcpl"), "MCPL003L").unwrap();
    folder
}

/// The scene of the repository with some of its text replaced. The scene has so many
/// photons that the noise is a few per cent.
fn text(edits: &[(&str, &str)]) -> String {
    let mut text = fs::read_to_string(scene("ray_file.ron")).unwrap();
    let edits = [
        &[
            ("rays/led.tm25ray", "led.tm25ray"),
            ("photons: 4_194_304", "photons: 400_000"),
        ],
        edits,
    ]
    .concat();
    for (from, to) in edits {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text
}

fn resolved(folder: &Path, edits: &[(&str, &str)]) -> Result<Scene, SceneError> {
    resolve(
        "test",
        SceneFile::parse(&text(edits)).unwrap(),
        folder,
        u64::MAX,
    )
}

/// The sum over all rays of a measured file, each once, and its prediction, which is a plain sum.
#[test]
fn a_spectrum_counts_each_ray_once() {
    let folder = folder();
    let folder = folder.path();
    let spectrum = |out: &str, file: &str, distance: f64| {
        let window =
            "--set window.x=Hann(0.01) --set window.u=Hann(0.5) --set frequencies.nu.max=9";
        let at = format!("--set planes.0.at=Distance({distance}) --set frequencies.rho.max=200");
        passes(folder, format!("spectrum {file} {window} {at} --out {out}"))
    };
    let said = spectrum("a", "led.tm25ray", 0.02);
    assert!(String::from_utf8_lossy(&said.stdout).contains("in the window"));
    let measured = |out: &str| -> Array4<Complex> {
        array(&folder.join(out).join("rays/batches.npz"), "slices")
    };
    let scene = &json(&folder.join("a/measurement.json"))["scene_file"];
    fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    passes(folder, "predict scene.json --npz --out b");
    let predicted: Array3<Complex> = array(&folder.join("b/predictions.npz"), "rays/slices");
    let apart = |out: &str| {
        let mean = measured(out).mean_axis(Axis(0)).unwrap();
        let norm = |of: &Array3<Complex>| of.iter().map(|c| c.norm_sqr()).sum::<f64>().sqrt();
        norm(&(mean - &predicted)) / norm(&predicted)
    };
    // The error of the fast transform is 3·10⁻⁷ of the largest value.
    assert!(apart("a") < 1e-6);
    spectrum("c", "led.tm25ray", 0.021);
    assert!(apart("c") > 1e-2);
    fails(folder, "spectrum led.npy --out d", 2);
    passes(folder, "spectrum led.npy --flux 1 --out d");
    fails(folder, "spectrum none.mcpl --out e", 2);
    assert!(!folder.join("e").exists());
}

/// Compares the photons of the scene `traced` with the prediction of the scene `predicted`; returns
/// the verdicts.
fn verdicts(traced: &Scene, predicted: &Scene) -> Vec<Verdict> {
    let measurement = measure(
        &Tracer::new(traced),
        &traced.planes,
        0..traced.run.batches,
        &|_| (),
    );
    let planes = predicted.planes.iter().enumerate();
    planes
        .map(|(i, plane)| {
            let theory = Applicability::new(predicted, plane);
            let prediction = predict(predicted, plane, &theory);
            let compared = compare(&measurement, i, &prediction, &test_of(traced));
            compared.unwrap().report.verdict
        })
        .collect()
}

#[test]
fn photons_agree_with_the_sum_over_rays() {
    let folder = folder();
    for edits in [
        vec![],
        vec![("run: (", "run: (sampling: Random, ")],
        // The light of this scene is turned and shines through a grating.
        vec![
            (
                "file: \"led.tm25ray\"",
                "file: \"led.tm25ray\", front: (0.3, -0.2, 1), up: (0.2, 1, 0)",
            ),
            (
                "blockers: [",
                "blockers: [Grating(name: \"grating\", center: (0, 0, 0.03), axis: Y, frequency: 60),",
            ),
        ],
        vec![(
            "(name: \"arrival\", at: Before(\"screen\"))",
            "(name: \"arrival\", at: Before(\"screen\"), quantity: DifferentialIrradiance)",
        )],
    ] {
        let scene = resolved(folder.path(), &edits).unwrap();
        assert_eq!(verdicts(&scene, &scene), [Verdict::Pass; 4], "{edits:?}");
    }
}

/// Each planted fault is detected at the planes behind it, and at no other plane.
#[test]
fn planted_faults_are_seen() {
    let folder = folder();
    let sound = resolved(folder.path(), &[]).unwrap();
    let [pass, fail] = [Verdict::Pass, Verdict::Fail];
    for (edits, expected) in [
        // A bar of 3 mm is made 1 mm wider.
        (
            [(
                "center: (0, 0), size: (0.003, 0.06)",
                "center: (0, 0), size: (0.004, 0.06)",
            )],
            [pass, pass, fail, fail],
        ),
        // The screen is moved away by 0.5 mm.
        (
            [("center: (0, 0, 0.05)", "center: (0, 0, 0.0505)")],
            [pass, pass, pass, fail],
        ),
        // The power is one per cent larger.
        (
            [("file: \"led.tm25ray\"", "file: \"led.tm25ray\", flux: 0.8")],
            [fail; 4],
        ),
        // The light is turned by six thousandths of a radian.
        (
            [(
                "file: \"led.tm25ray\"",
                "file: \"led.tm25ray\", up: (0.006, 1, 0)",
            )],
            [fail; 4],
        ),
    ] {
        let faulty = resolved(folder.path(), &edits).unwrap();
        assert_eq!(verdicts(&faulty, &sound), expected, "{edits:?}");
    }
}

/// The power of the rays is converted to W even if the file states another unit; rays that go
/// back are omitted.
#[test]
fn power_is_in_watts() {
    let folder = folder();
    let flux = |edits: &[(&str, &str)]| match resolved(folder.path(), edits).unwrap().light {
        Light::Rays { rays } => [rays.flux(), rays.behind()],
        other => panic!("{other:?}"),
    };
    let set = rays(PowerUnit::Watt);
    let forward = set
        .directions
        .iter()
        .zip(&set.powers)
        .filter(|(d, _)| d[2] > 0.0);
    let forward: f64 = forward.map(|(_, power)| power).sum();
    let total = set.total_power();
    let near = |[a, b]: [f64; 2], factor: f64| {
        // Conversion to f32 rounds each power by a relative error of 6e-8.
        assert!((a / (factor * forward) - 1.0).abs() < 1e-6, "{a} {forward}");
        assert!((b / (factor * (total - forward)) - 1.0).abs() < 1e-6, "{b}");
    };
    near(flux(&[]), 1.0);
    near(flux(&[("led.tm25ray", "led.mcpl.gz")]), 1.0);
    near(
        flux(&[("\"led.tm25ray\"", "\"led.npy\", flux: 3")]),
        3.0 / total,
    );
    near(
        flux(&[("\"led.tm25ray\"", "\"lumens.tm25ray\", flux: 3")]),
        3.0 / total,
    );
}

#[test]
fn what_makes_no_light_is_refused() {
    let folder = folder();
    for (edits, parts) in [
        ([("led.tm25ray", "none.mcpl")], ["light.file", "byte 8"]),
        (
            [("led.tm25ray", "missing.mcpl")],
            ["light.file", "regular file"],
        ),
        (
            [("led.tm25ray", "lumens.tm25ray")],
            ["power in lm", "`flux`"],
        ),
        ([("led.tm25ray", "led.npy")], ["weight", "`flux`"]),
        (
            [("\"led.tm25ray\"", "\"led.tm25ray\", flux: -1")],
            ["light.flux", "-1"],
        ),
        (
            [("\"led.tm25ray\"", "\"led.tm25ray\", front: (0, 1, 0)")],
            ["light.front and light.up", "not parallel"],
        ),
    ] {
        let error = resolved(folder.path(), &edits).unwrap_err().to_string();
        assert!(
            parts.iter().all(|part| error.contains(part)),
            "{edits:?}: {error}"
        );
    }
}

/// The command refuses planes that can have no verdict, and warns of rays that go back. It writes
/// the same bytes on any number of threads.
#[test]
fn the_command_knows_what_it_can_judge() {
    let folder = folder();
    let write = |name: &str, edits: &[(&str, &str)]| {
        fs::write(folder.path().join(name), text(edits)).unwrap();
    };
    write("led.ron", &[]);
    write(
        "beyond.ron",
        &[(
            "(name: \"after\"",
            "(name: \"left\", at: After(\"screen\")), (name: \"after\"",
        )],
    );
    for (arguments, part) in [
        (
            "check beyond.ron",
            "plane left: the light is a ray file, and there is no prediction at this plane",
        ),
        (
            "run beyond.ron --out out",
            "plane left: the light is a ray file",
        ),
        ("run led.ron --method backward --out out", ""),
    ] {
        let output = loud(folder.path(), arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        assert!(message.contains(part), "{arguments}: {message}");
    }
    let output = loud(folder.path(), "check led.ron");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("do not go forward"), "{message}");
    for threads in 1..=2 {
        let run = "run led.ron --photons 20000 --set run.resolution=1 --save mcpl";
        passes(
            folder.path(),
            format!("{run} --threads {threads} --out out{threads}"),
        );
    }
    let of = |out: &str| fs::read(folder.path().join(out).join("arrival/photons.mcpl")).unwrap();
    assert!(of("out1") == of("out2"));
}
