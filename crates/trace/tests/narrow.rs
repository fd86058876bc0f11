//! Tests lights without extent: compares aimed photons, backward rays drawn towards the light,
//! and photons that are not aimed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::estimates;
use etendue_field::PhotonSource;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Backward, Emitter, PHOTONS_PER_GROUP, Tracer, finds};
use etendue_transform::random::{Stream, words};

const LIGHTS: [&str; 3] = [
    "Point(center: (0, 0, 0), intensity: 2)",
    "Projector(center: (0, 0, 0), intensity: 2, image: (width: (0.5, 0.4),
        grating: (axis: X, frequency: 3, modulation: 0.8, phase: 0.5)))",
    "Beam(center: (0, 0, 0), irradiance: 2, image: (width: (0.5, 0.4)))",
];
/// A blocker in the path of the light, a little to the side of the path's middle.
const BLACK: &str =
    r#"Shapes(name: "black", center: (0.1, 0, 0.4), shapes: [Disc(center: (0, 0), radius: 0.05)])"#;
const BALL: &str = r#"Smooth(name: "s", center: (0, 0, 1), facing: (0.3, -0.5, -0.8),
    form: Sphere(0.2), aperture: 0.5, event: EVENT)"#;
const WALL: &str = r#"Rectangle(name: "s", center: (0, 0, 1), size: (2, 1.6),
    facing: (0.3, -0.5, -0.8), albedo: 0.8)"#;
const STAR: &str = r#"Mesh(name: "s", center: (0, 0, 1),
    mesh: Star(radius: 0.5, relief: 0.3, lobes: 4, rings: 30), albedo: 0.8)"#;
const SPHERE: &str = r#"Mesh(name: "m", center: (0.2, -0.1, 0.5), mesh: Star(radius: 0.08, relief: 0.3, lobes: 4, rings: 10), albedo: 0.8)"#;
/// A mirror that receives light from the wall. The light leaves the wall in the mirror direction or
/// upwards.
const MIRROR: &str = r#"Smooth(name: "mirror", center: (0.5, -0.8, 0), facing: (-0.4, 1, 0.2),
    form: Sphere(-0.1), aperture: 1.5, event: Mirror)"#;

fn scene(light: &str, surfaces: &str, visits: &str, planes: &[&str]) -> Scene {
    let planes = planes.iter().enumerate();
    let planes = planes.map(|(i, plane)| format!("(name: \"p{i}\", {plane}), "));
    let text = format!(
        r#"(
            light: {light}, blockers: [{BLACK}], surfaces: [{surfaces}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [{visits}]),
            planes: [{}],
            window: (x: Hann(0.15), y: Box(0.1), u: Hann(0.4), v: Hann(0.3)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: 600_000),
        )"#,
        planes.collect::<String>()
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

/// Checks that a second source of estimates agrees with the photons.
fn agree(scene: &Scene, other: &dyn PhotonSource, what: &str) {
    let (photons, _) = estimates(&Tracer::new(scene), scene);
    let (others, _) = estimates(other, scene);
    for (plane, (a, b)) in scene.planes.iter().zip(photons.iter().zip(&others)) {
        let what = format!("{what}, {:?} {:?}", plane.orientation, plane.side);
        // Noise must be so small that missing light would be detected.
        for found in [a, b] {
            assert!(found[0][1] < 0.03 * found[0][0], "{what}: {a:?}, {b:?}");
        }
        for (a, b) in a.iter().zip(b) {
            let z = (a[0] - b[0]) / a[1].hypot(b[1]);
            // In one of 600 runs, at least one of some 250 tests exceeds 4.5 standard errors by
            // chance.
            assert!(z.abs() < 4.5, "{what}: {a:?} and {b:?}");
        }
    }
}

/// The path to a virtual plane. It is given by the objects of the scene, the objects that the path
/// visits, and the planes.
type Way<'a> = (String, &'a str, &'a [&'a str]);

#[test]
fn rays_towards_the_light_find_it() {
    let tangent = r#"at: Before("s"), orientation: Tangent"#;
    let local = r#"at: Before("s"), orientation: LocalNormals"#;
    let mirrored = r#"at: Before("s"), orientation: Mirrored"#;
    let across = r#"at: Before("s")"#;
    let after = r#"at: After("s")"#;
    let ball = |event: &str| BALL.replace("EVENT", event);
    let glossy = "Reflects(brdf: (lobe: Phong(20), albedo: 0.6))";
    let ways: [Way<'_>; 5] = [
        (
            format!("{}, {SPHERE}", ball("Mirror")),
            "\"s\"",
            &[tangent, local, mirrored, across],
        ),
        (WALL.into(), "\"s\"", &[across, tangent, after]),
        (STAR.into(), "\"s\"", &[after]),
        (ball(glossy), "\"s\"", &[after]),
        (
            format!("{WALL}, {MIRROR}"),
            "\"s\", \"mirror\"",
            &[r#"at: Before("mirror")"#, r#"at: After("mirror")"#],
        ),
    ];
    for light in LIGHTS {
        for (surfaces, visits, planes) in &ways {
            let scene = scene(light, surfaces, visits, planes);
            assert!(scene.planes.iter().all(|plane| finds(&scene, plane)));
            let backward = Backward::new(&scene).unwrap();
            agree(&scene, &backward, &format!("{light}, {surfaces}"));
        }
    }
}

#[test]
fn what_a_mirror_turns_first_is_sent_evenly() {
    let mirror = BALL.replace("EVENT", "Mirror");
    let floor = r#"Rectangle(name: "floor", center: (0.55, -0.8, 0), size: (2, 2), facing: (-0.4, 1, 0.2))"#;
    for light in LIGHTS {
        let surfaces = format!("{mirror}, {floor}");
        let planes = [r#"at: After("s")"#, r#"at: After("floor")"#];
        let scene = scene(light, &surfaces, r#""s", "floor""#, &planes);
        assert!(!scene.planes.iter().any(|plane| finds(&scene, plane)));
        assert!(Backward::new(&scene).is_err());
        agree(&scene, &Tracer::with_uniform_emission(&scene), light);
    }
}

/// A virtual plane at the light records more light than the light that meets a small mirror.
#[test]
fn windows_before_a_small_mirror_are_sent_evenly() {
    let small = BALL
        .replace("EVENT", "Mirror")
        .replace("aperture: 0.5", "aperture: 0.1");
    for light in &LIGHTS[..2] {
        let planes = ["at: Emission", r#"at: After("s")"#];
        let scene = scene(light, &small, r#""s""#, &planes);
        assert!(!scene.planes.iter().any(|plane| finds(&scene, plane)));
        agree(&scene, &Tracer::with_uniform_emission(&scene), light);
    }
}

/// A point light with uniform emission is not aimed, because the check must be independent of the
/// aiming under test.
#[test]
fn what_is_sent_evenly_has_one_density() {
    let mirror = BALL.replace("EVENT", "Mirror");
    let scene = scene(LIGHTS[0], &mirror, r#""s""#, &[r#"at: After("s")"#]);
    let spread = |emitter: &Emitter| {
        let photons = emitter.emit(|block| {
            let blocks: [_; PHOTONS_PER_GROUP] =
                std::array::from_fn(|i| words(1, Stream::Photon, i as u64, block));
            [0, 1, 2, 3].map(|k| blocks.map(|block| block[k]))
        });
        let densities = photons.weights.iter().enumerate();
        let densities =
            densities.map(|(i, weight)| photons.ray(i).secant_squared().sqrt() / weight);
        let (low, high) = densities.fold((f64::INFINITY, 0.0_f64), |(low, high), density| {
            (low.min(density), high.max(density))
        });
        high / low - 1.0
    };
    assert!(spread(&Emitter::with_uniform_emission(&scene)) < 1e-14); // rounding
    assert!(spread(&Emitter::new(&scene)) > 0.01);
}
