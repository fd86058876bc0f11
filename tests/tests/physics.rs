//! Tests scenes that must pass and scenes that must fail, from the text of the scene to the
//! verdict.

use crate::common::{self, SCENES, edited, photons};
use etendue_compare::{Class, FirstOrderChain, Verdict};
use etendue_field::Window;
use etendue_predict::Applicability;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_theory::geometry::SpectrumMap;
use etendue_theory::path::rays;
use etendue_theory::{ChainStep, PathKind};

/// Photons per run: noise is 2 to 4 % of each spectrum.
const PHOTONS: u64 = 400_000;

/// The scene `fig9b` with parts of its text replaced.
fn scene(edits: &[(&str, &str)]) -> Scene {
    let mut scene = edited("fig9b", edits);
    scene.run.photons = PHOTONS;
    // Photons that are not aimed have noise of 16 %, which is low enough for this test.
    scene.run.resolution = 0.5;
    scene
}

/// Compares photons of the scene `traced` with predictions for the scene `predicted`; returns the
/// verdict on each plane.
fn verdicts(traced: &Scene, predicted: &Scene) -> Vec<Verdict> {
    common::verdicts(traced, &photons(traced), predicted)
}

/// Tests that variants of fig9b pass, as fig9b itself does. Some variants have objects beside or
/// behind the light, and others are large, small, distant, rotated or dark.
#[test]
fn other_scenes_agree() {
    let fin = r#"(name: "floor", center: (0, 0, 2), size: (6, 6), albedo: 0.5),
                 Rectangle(name: "fin", center: (0.25, 0, 1.5), size: (0.3, 0.3)),"#;
    let two_layers = r#"JitteredSquares(name: "more", center: (0.02, 0, 1.4), count: (6, 6), pitch: 0.2, fill: 0.4),
        JitteredSquares("#;
    let floor = r#"(name: "floor", center: (0, 0, 2), size: (6, 6), albedo: 0.5),"#;
    let scenes: [(&str, &[(&str, &str)]); 8] = [
        ("a surface beside the central ray", &[(floor, fin)]),
        (
            "two layers",
            &[
                ("JitteredSquares(", two_layers),
                ("count: (20, 20)", "count: (8, 8)"),
            ],
        ),
        (
            "closed blockers",
            &[("fill: 0.6", "fill: 1"), ("jitter: 0.3", "jitter: 0")],
        ),
        (
            "light wider than the window",
            &[("size: (0.2, 0.2)", "size: (3, 0.1)")],
        ),
        ("plain emission", &[("Aimed", "Plain")]),
        (
            "box and cut Gaussian",
            &[
                (
                    "(x: Hann(0.5), u: Hann(0.5))",
                    "(x: Box(0.4), y: Gaussian(width: 0.3, cut: 0.4), u: Hann(0.5))",
                ),
                ("count: (20, 20)", "count: (4, 4)"),
                (
                    "azimuths: 8, rho: (max: 16), nu: (max: 32)",
                    "azimuths: 3, rho: (max: 6), nu: (max: 8)",
                ),
            ],
        ),
        (
            "millimetres",
            &[
                ("size: (0.2, 0.2)", "size: (2e-4, 2e-4)"),
                ("pitch: 0.2", "pitch: 2e-4"),
                (
                    "(0, 0, 1),\n            count",
                    "(0, 0, 1e-3),\n            count",
                ),
                ("center: (0, 0, 2)", "center: (0, 0, 2e-3)"),
                ("x: Hann(0.5)", "x: Hann(5e-4)"),
                ("x: Hann(1.5)", "x: Hann(1.5e-3)"),
                ("rho: (max: 12)", "rho: (max: 12e3)"),
                ("rho: (max: 16)", "rho: (max: 16e3)"),
                ("nu: (max: 32)", "nu: (max: 32)"),
            ],
        ),
        (
            "a turned world",
            &[
                ("center: (0, 0, 1)", "center: (1, 0, 0)"),
                ("center: (0, 0, 2)", "center: (2, 0, 0)"),
                (
                    "direction: (0, 0, 1), x_axis: (1, 0, 0)",
                    "direction: (1, 0, 0), x_axis: (0, 1, 1)",
                ),
            ],
        ),
    ];
    for (name, edits) in scenes {
        let scene = scene(edits);
        let verdicts = verdicts(&scene, &scene);
        assert!(
            verdicts.iter().all(|v| *v == Verdict::Pass),
            "{name}: {verdicts:?}"
        );
    }
}

/// If a prediction omits the surface beside the ray, photons reject it behind that surface, and at
/// no other plane.
#[test]
fn a_forgotten_surface_is_noticed() {
    let fin = r#"surfaces: [Rectangle(name: "fin", center: (0.25, 0, 1.5), size: (0.3, 0.3)),"#;
    let verdicts = verdicts(&scene(&[("surfaces: [", fin)]), &scene(&[]));
    assert_eq!(
        verdicts,
        [[Verdict::Pass; 3].as_slice(), &[Verdict::Fail; 2]].concat()
    );
}

/// The closed form assumes an infinite receiver. If a window contains the edge of the receiver,
/// the theory of paths predicts the plane.
#[test]
fn the_edge_of_the_receiver_is_left_to_paths() {
    let classes = |size: &str| -> Vec<Class> {
        let scene = scene(&[("size: (6, 6)", size)]);
        scene
            .planes
            .iter()
            .map(|p| Applicability::new(&scene, p).class())
            .collect()
    };
    assert!(classes("size: (3, 3)").iter().all(|c| *c == Class::Exact));
    let small = classes("size: (3, 2.9)");
    assert_eq!(small[4], Class::FirstOrder);
    assert!(small[..4].iter().all(|c| *c == Class::Exact));
}

/// A black receiver reflects no light, as theory predicts.
#[test]
fn a_black_receiver_is_dark() {
    let black = scene(&[("albedo: 0.5", "albedo: 0")]);
    assert_eq!(verdicts(&black, &black), [Verdict::Pass; 5]);
}

/// Every scene file of the repository whose planes lie behind smooth surfaces.
fn scene_files() -> Vec<Scene> {
    let read = |folder: &str| {
        let entries = std::fs::read_dir(folder).expect("the folder of scenes");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        let scenes = paths.filter(|path| path.extension().is_some_and(|e| e == "ron"));
        let mut scenes: Vec<_> = scenes.collect();
        scenes.sort();
        scenes
    };
    let paths = ["", "/table1", "/wild", "/words"].map(|sub| read(&format!("{SCENES}{sub}")));
    let resolved = paths.concat().into_iter().filter_map(|path| {
        let text = std::fs::read_to_string(&path).expect("a scene file");
        let mut file = SceneFile::parse(&text).expect("a scene file");
        file.as_printed = false;
        let folder = path.parent().expect("a folder");
        let name = path.file_stem()?.to_str()?;
        resolve(name, file, folder, u64::MAX).ok()
    });
    resolved.collect()
}

/// If a step of a first-order chain is omitted or doubled and this changes the chain, the chain
/// must fail.
#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn every_step_of_a_chain_counts() {
    let (mut steps, mut changed) = (0, 0);
    for scene in scene_files() {
        for (plane, theory) in scene.planes.iter().zip(Applicability::of_planes(&scene)) {
            let Some(view) = theory.theory.path_of(PathKind::Specular) else {
                continue;
            };
            // The chain to a plane at the light has no affine maps.
            let Some(chain) = theory.affine_chain(&scene) else {
                continue;
            };
            let maps = chain.steps.iter().filter_map(ChainStep::map).copied();
            let maps: Vec<SpectrumMap<4>> = maps.collect();
            if maps.is_empty() {
                continue;
            }
            let verdict = |maps: &[SpectrumMap<4>]| {
                let (first, others) = maps.split_first().expect("travel at least");
                let map = others.iter().fold(*first, |map, next| map.then(next));
                let defect = rays::defect(view, &map, &plane.window).expect("light arrives");
                // Where rays of the window come to lie that are traced back by the right chain and
                // forward by this one, in half-widths of the window. A chain fails from 10⁻⁵ on.
                let back = chain.map.rays().inverse().expect("an inverse");
                let moved = back.then(&map.rays());
                let Window { x, y, u, v } = plane.window;
                let half = [x, y, u, v].map(|profile| profile.half_width());
                let off = (0..4).flat_map(|i| {
                    let identity = move |j| f64::from(u8::from(i == j));
                    let row =
                        (0..4).map(move |j| (moved.matrix[i][j] - identity(j)) * half[j] / half[i]);
                    row.chain([moved.offset[i] / half[i]])
                });
                let off = off.chain([map.factor / chain.map.factor - 1.0]);
                let same = off.into_iter().all(|off| off.abs() < 1e-5);
                let tried = FirstOrderChain {
                    error: 0.0,
                    defect,
                    radiance_defect: 0.0,
                    matrix: map.rays().matrix,
                    covariance: [None; 2],
                    foci: Vec::new(),
                    as_printed: false,
                };
                (tried.verdict(), same)
            };
            assert_eq!(verdict(&maps), (Verdict::Pass, true), "{}", scene.name);
            for i in 0..maps.len() {
                let without = [&maps[..i], &maps[i + 1..]].concat();
                let doubled = [&maps[..=i], &maps[i..]].concat();
                for wrong in [without, doubled] {
                    if wrong.is_empty() {
                        continue;
                    }
                    steps += 1;
                    let (verdict, same) = verdict(&wrong);
                    if !same {
                        changed += 1;
                        assert_eq!(
                            verdict,
                            Verdict::Fail,
                            "{} {}, step {i}",
                            scene.name,
                            plane.name
                        );
                    }
                }
            }
        }
    }
    // The steps that can be omitted or doubled without a change are identities, such as a rotation
    // by zero.
    assert!(
        changed > 1000 && changed > steps * 9 / 10,
        "{changed} of {steps}"
    );
}
