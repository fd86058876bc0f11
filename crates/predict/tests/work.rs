//! The work of a prediction is estimated before it begins, so scenes that would take too long are
//! refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_predict::{Applicability, Memory, TooMuchWork, too_much_work};
use etendue_scene::{Scene, SceneFile, resolve};
use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn text(name: &str) -> String {
    fs::read_to_string(folder().join(name)).unwrap()
}

fn scene_of(text: &str, folder: &Path) -> Scene {
    let file = SceneFile::parse(text).unwrap();
    resolve("scene", file, folder, u64::MAX).unwrap()
}

/// A scene of the repository with pieces of its text replaced.
fn edited(name: &str, edits: &[(&str, &str)]) -> Scene {
    let edited = edits.iter().fold(text(name), |text, (old, new)| {
        assert!(text.contains(old), "{name}: {old}");
        text.replace(old, new)
    });
    scene_of(&edited, &folder())
}

/// A square light and a floor, with something between them.
fn below(layers: &str) -> Scene {
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
            {layers} [Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
            planes: [(name: "receiver", at: Before("floor"))],
            window: (x: Hann(0.5), u: Hann(0.5)),
            frequencies: (rho: (max: 16), nu: (max: 32)),
        )"#
    );
    scene_of(&text, &folder())
}

fn too_much(scene: &Scene) -> Option<TooMuchWork> {
    too_much_work(scene, &Applicability::of_planes(scene))
}

/// The message for a scene whose predictions take too long.
fn refusal(scene: &Scene) -> String {
    too_much(scene).expect("too much work").to_string()
}

/// Returns text with `count` opaque layers in place of the scene's own blockers.
fn layers(count: usize, layer: impl Fn(usize) -> String) -> String {
    let layers: Vec<String> = (0..count).map(layer).collect();
    format!("blockers: [{}],\n    surfaces:", layers.join(", "))
}

fn squares(count: u32, pitch: f64) -> String {
    layers(1, |_| {
        format!(
            r#"JitteredSquares(name: "squares", center: (0, 0, 0.55), count: ({count}, {count}),
                pitch: {pitch}, fill: 0.5)"#
        )
    })
}

#[test]
fn scenes_of_the_repository_end() {
    let mut found = 0;
    for sub in ["", "table1", "words"] {
        let folder = folder().join(sub);
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "ron") {
                let scene = scene_of(&fs::read_to_string(&path).unwrap(), &folder);
                assert_eq!(too_much(&scene), None, "{}", path.display());
                found += 1;
            }
        }
    }
    assert!(found > 40, "{found} scenes");
}

/// Nets with a budget replace a quadrature that would take too long, or whose nodes do not resolve
/// the integrand.
#[test]
fn wide_lights_and_fine_gratings_before_a_receiver() {
    for edits in [
        [("size: (0.2, 0.2)", "size: (1e6, 1e6)")],
        [("size: (0.2, 0.2)", "size: (1e9, 1e9)")],
        [("frequency: 5", "frequency: 1e6")],
        [(
            "light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)",
            "light: Disc(center: (0, 0, 0), radius: 1e6",
        )],
    ] {
        assert_eq!(too_much(&edited("grating.ron", &edits)), None, "{edits:?}");
    }
}

#[test]
fn many_layers() {
    let one = |i: usize| {
        let at = 0.1 + 0.01 * i as f64;
        format!(
            r#"Shapes(name: "b{i}", center: (0, 0, {at}),
                shapes: [Rectangle(center: (0, 0), size: (0.05, 0.05))])"#
        )
    };
    let many = layers(30, one);
    assert_eq!(too_much(&below(&many)), None);
    let mirror = [
        ("surfaces:", many.as_str()),
        ("Distance(1.7)", "Distance(1.2)"),
        (
            "Projector(center: (0, 0, 0), image: (width: (0.45, 0.45)))",
            "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))",
        ),
    ];
    let mirror = edited("table1/convex_normal.ron", &mirror);
    assert_eq!(too_much(&mirror), None);
    let glossy = [
        ("surfaces:", many.as_str()),
        ("Distance(1.7)", "Distance(1.2)"),
    ];
    let glossy = edited("table1/ggx_sphere.ron", &glossy);
    assert_eq!(too_much(&glossy), None);
}

#[test]
fn many_gratings() {
    let grating = |i: usize| {
        let at = 0.2 + 0.1 * i as f64;
        format!(r#"Grating(name: "g{i}", center: (0, 0, {at}), axis: X, frequency: 5)"#)
    };
    assert_eq!(too_much(&below(&layers(10, grating))), None);
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn many_squares() {
    let mirror = [
        ("surfaces:", &*squares(300, 0.002)),
        (
            "Projector(center: (0, 0, 0), image: (width: (0.45, 0.45)))",
            "Rectangle(center: (0, 0, 0), size: (0.1, 0.1))",
        ),
        ("Distance(1.7)", "Distance(1.2)"),
    ];
    assert_eq!(too_much(&edited("table1/convex_normal.ron", &mirror)), None);
    let glossy = [
        ("surfaces:", &*squares(300, 0.002)),
        (
            "Projector(center: (0, 0, 0), image: (width: (0.15, 0.15)))",
            "Rectangle(center: (0, 0, 0), size: (0.1, 0.1))",
        ),
    ];
    assert_eq!(
        too_much(&edited("table1/textured_glossy.ron", &glossy)),
        None
    );
    assert_eq!(too_much(&below(&squares(300, 0.002))), None);
}

#[test]
fn a_thousand_lobes() {
    let lobe = "(from: (0.25, 0.1, -1), width: 0.15, radiance: 3),";
    let lobes = lobe.repeat(1000);
    let scene = edited("table1/environment.ron", &[(lobe, &lobes)]);
    assert_eq!(too_much(&scene), None);
}

/// Each plane is within the limit, but the sum of the planes is not. The error names the plane that
/// takes most.
#[test]
fn many_planes() {
    let plane = r#"(name: "on_its_way", at: Distance(2.5)),"#;
    let more: Vec<String> = (1..40)
        .map(|i| {
            format!(
                r#"(name: "p{i}", at: Distance({})),"#,
                2.5 - 0.01 * f64::from(i)
            )
        })
        .collect();
    let scene = edited(
        "diffuse.ron",
        &[
            (plane, &format!("{plane} {}", more.concat())),
            ("azimuths: 8", "azimuths: 200"),
            ("alpha: 0.01", "alpha: 0.1"),
        ],
    );
    let said = refusal(&scene);
    assert!(
        said.contains("steps, out of") && said.contains("the limit is 6e11 for all planes"),
        "{said}"
    );
}

#[test]
fn fine_frequencies() {
    let spacing = [("nu: (max: 32)", "nu: (max: 32, spacing: 1e-3)")];
    let scene = edited("fig9b.ron", &spacing);
    let said = refusal(&scene);
    assert!(
        said.contains("GB on one core") && said.contains("frequencies"),
        "{said}"
    );
}

#[test]
fn memory_grows_with_threads_up_to_batches() {
    let scene = edited("travel.ron", &[]);
    let of = |threads| Memory::new(&scene, &Applicability::of_planes(&scene), threads);
    let [one, many, more] = [1, 64, 256].map(of);
    assert!((many.threads / one.threads - 64.0).abs() < 1e-9); // rounding
    assert_eq!(more.threads.to_bits(), many.threads.to_bits());
    assert_eq!(more.batches.to_bits(), one.batches.to_bits());
    assert!(more.total() >= many.total() && many.total() > one.total());
    // Without meshes, the message must not state "-0.00 GB for meshes".
    assert!(one.meshes.is_sign_positive());
}
