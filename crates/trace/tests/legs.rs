//! Tests several reflections in a row, oblique surfaces, and light that leaves a mesh. The tests
//! compare aimed photons, plain photons, backward rays and a plain quadrature.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::estimates;
use etendue_field::PhotonSource;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Backward, Tracer};
use etendue_transform::random::{Stream, unit, words};
use glam::DVec3;
use std::f64::consts::PI;

const WALL: &str = r#"Rectangle(name: "wall", center: (0.1, 0, 2), size: (2, 1.6), facing: (1, 0.2, -1), albedo: 0.8)"#;
const STAR: &str = r#"Mesh(name: "wall", center: (0, 0, 2), mesh: Star(radius: 0.5, relief: 0.3, lobes: 4, rings: 30), albedo: 0.8)"#;
const FLOOR: &str = r#"Rectangle(name: "floor", center: (1.5, 0.3, 1.8), size: (2, 2), facing: (-1, 0, 0.1), albedo: 0.5)"#;
const CEILING: &str = r#"Rectangle(name: "ceiling", center: (0.6, 1.2, 3), size: (1.5, 1.5), facing: (0, -1, -0.2), albedo: 0.9)"#;
/// Two blockers: one beside the path of the light, and one in the path of light that leaves the
/// wall.
const BLACK: &str =
    r#"Shapes(name: "black", center: (0.7, 0, 1.6), shapes: [Disc(center: (0, 0), radius: 0.2)])"#;
const GRATING: &str =
    r#"Grating(name: "grating", center: (0, 0, 1), axis: X, frequency: 1.2, modulation: 0.9)"#;

const WINDOW: &str = "(x: Hann(0.4), y: Box(0.3), u: Hann(0.5), v: Hann(0.4))";

fn scene(wall: &str, blockers: &str, visits: &[&str], emission: &str, photons: u32) -> Scene {
    windowed(wall, blockers, visits, emission, photons, WINDOW)
}

fn windowed(
    wall: &str,
    blockers: &str,
    visits: &[&str],
    emission: &str,
    photons: u32,
    window: &str,
) -> Scene {
    let legs = visits.len();
    // The near side of a mesh faces backwards, towards the light.
    let floor = match wall {
        STAR => FLOOR.replace("(1.5, 0.3, 1.8)", "(1.3, 0.3, 0.6)"),
        _ => FLOOR.to_owned(),
    };
    let planes: String = (0..legs)
        .map(|i| {
            let name = visits[i];
            format!(r#"(name: "at_{name}", at: Before("{name}")), (name: "leaving_{name}", at: After("{name}")),"#)
        })
        .collect();
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (0.5, 0.3), radiance: 2),
            blockers: [{blockers}],
            surfaces: [{wall}, {floor}, {CEILING}],
            path: (direction: (0, 0, 1), x_axis: (1, 0.3, 0), visits: {visits:?}),
            planes: [{planes}],
            window: {window},
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: {photons}, emission: {emission}),
        )"#
    );
    resolve(
        "test",
        SceneFile::parse(&text).unwrap(),
        ".".as_ref(),
        u64::MAX,
    )
    .unwrap()
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn all_ways_agree_on_every_leg() {
    let mut tests = 0;
    let nearer = BLACK.replace("1.6)", "1.2)");
    for (wall, blockers) in [
        (WALL, BLACK),
        (WALL, GRATING),
        (STAR, &nearer),
        (STAR, GRATING),
    ] {
        // Light leaves a mesh in all directions, so a photon that is not aimed rarely meets a
        // third surface.
        let visits = &["wall", "floor", "ceiling"][..if wall == STAR { 2 } else { 3 }];
        let aimed = scene(wall, blockers, visits, "Aimed", 800_000);
        let plain = scene(wall, blockers, visits, "Plain", 2_500_000);
        let (backward, _) = estimates(&Backward::new(&aimed).unwrap(), &aimed);
        let (photons, ledger) = estimates(&Tracer::new(&aimed), &aimed);
        // The tolerance is the rounding error of some 10^5 additions.
        assert!(ledger.imbalance().abs() < 1e-12, "{ledger:?}");
        let (plain, _) = estimates(&Tracer::new(&plain), &plain);
        for (way, other) in [("aimed", &photons), ("plain", &plain)] {
            for (plane, (a, b)) in backward.iter().zip(other).enumerate() {
                let name = &aimed.planes[plane].name;
                for (a, b) in a.iter().zip(b) {
                    let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                    tests += 1;
                    // In one of 300 runs, at least one of some 120 tests exceeds 4.2 standard
                    // errors by chance.
                    assert!(
                        z.abs() < 4.2,
                        "{way} at {name}: {a:?} and {b:?}, {wall}, {blockers}"
                    );
                }
                let most = if way == "aimed" { 0.04 } else { 0.3 };
                assert!(
                    b[0][1] < most * b[0][0],
                    "{way} at {name}: {b:?} is too noisy"
                );
            }
        }
    }
    assert!(tests > 100, "{tests} tests");
}

/// Computes ∫ L W at the virtual plane before the floor, for light that left the wall. Every
/// integral is a plain sum in world coordinates.
#[test]
fn light_that_left_an_oblique_wall_is_what_a_plain_sum_says() {
    // The mid-point rule for Hann windows converges faster than any power.
    const N: u32 = 12;
    let wide = WALL.replace("size: (2, 1.6)", "size: (3.2, 3.2)");
    let window = "(x: Hann(0.3), y: Hann(0.2), u: Hann(0.3), v: Hann(0.3))";
    let scene = windowed(&wide, "", &["wall", "floor"], "Aimed", 3_000_000, window);
    let plane = &scene.planes[2];
    let wall = &scene.surfaces[0].frame;
    let middle = |i: u32, half: f64| ((f64::from(i) + 0.5) / f64::from(N) * 2.0 - 1.0) * half;
    let w = &plane.window;
    let half = [w.x, w.y, w.u, w.v].map(|p| p.half_width());
    let cell: f64 = half.iter().map(|h| 2.0 * h / f64::from(N)).product();
    let to_light = |p: DVec3| scene.path.frame.to_local(p);
    let mut sum = 0.0;
    for index in 0..N.pow(4) {
        let [x, y, u, v] =
            [0, 1, 2, 3].map(|axis| middle(index / N.pow(axis) % N, half[axis as usize]));
        let weight = w.value(&etendue_field::TwoPlane { x, y, u, v });
        let at = to_light(plane.frame.to_world(DVec3::new(x, y, 0.0)));
        let along = to_light(plane.frame.to_world(DVec3::new(x + u, y + v, 1.0))) - at;
        let t = (wall.origin - at).dot(wall.d) / along.dot(wall.d);
        let point = at + t * along;
        let local = wall.to_local(point);
        assert!(
            local.x.abs() < 1.6 && local.y.abs() < 1.6,
            "the window sees the wall alone"
        );
        let mut irradiance = 0.0;
        for cell in 0..64 {
            let [x0, y0] = [(cell % 8, 0.5), (cell / 8, 0.3)]
                .map(|(i, side)| ((f64::from(i) + 0.5) / 8.0 - 0.5) * side);
            let way = point - DVec3::new(x0, y0, 0.0);
            let cosines = way.z * -way.dot(wall.d);
            irradiance += 2.0 * (0.5 * 0.3 / 64.0) * cosines / way.length_squared().powi(2);
        }
        sum += weight * 0.8 / PI * irradiance * cell;
    }
    let (photons, _) = estimates(&Tracer::new(&scene), &scene);
    let [mean, error] = photons[2][0];
    assert!(error < 3e-3 * mean, "{mean} ± {error}");
    // The mid-point rule over 8 × 8 points of the light is accurate to 1e-3. The remaining
    // difference is noise.
    assert!(
        (mean - sum).abs() < 4.0 * error + 1e-3 * sum,
        "{mean} ± {error}, {sum}"
    );
}

/// Surfaces that reflect and refract, the path through these surfaces, and the virtual planes on
/// the path.
const SMOOTH: &[(&str, &str, &[&str], &str)] = &[
    (
        "a concave mirror, with planes of every orientation on it, and a floor that what it reflects falls on",
        r#"Smooth(name: "mirror", center: (0, 0, 1), facing: (0.64, 0.1, -0.76), form: Sphere(-0.5), aperture: 0.3, event: Mirror),
           Rectangle(name: "floor", center: (0.9, 0.16, 0.8), size: (1, 1), facing: (-1, 0, 0.2), albedo: 0.7)"#,
        &["mirror", "floor"],
        r#"(name: "a", at: Before("mirror"), orientation: Tangent), (name: "b", at: Before("mirror"), orientation: LocalNormals),
           (name: "c", at: After("mirror"), orientation: LocalNormals), (name: "d", at: After("mirror"), orientation: Tangent),
           (name: "e", at: Before("floor")), (name: "f", at: After("floor"))"#,
    ),
    (
        "a ball lens",
        r#"Smooth(name: "front", center: (0.02, 0, 1), facing: (0, 0, -1), form: Sphere(2.5), aperture: 0.35, event: Refraction(front: 1, back: 1.5)),
           Smooth(name: "back", center: (0.02, 0, 1.8), facing: (0, 0, 1), form: Sphere(2.5), aperture: 0.35, event: Refraction(front: 1, back: 1.5))"#,
        &["front", "back"],
        r#"(name: "a", at: Before("front"), orientation: LocalNormals), (name: "b", at: After("front")), (name: "c", at: Before("back")),
           (name: "d", at: After("back")), (name: "e", at: Distance(2.3))"#,
    ),
    (
        "a thin lens, a twisted saddle and a cylinder",
        r#"Smooth(name: "lens", center: (0, 0, 0.7), facing: (0, 0, -1), form: Plane, aperture: 0.4, event: ThinLens(0.6)),
           Smooth(name: "saddle", center: (0, 0, 1.2), facing: (0.6, 0, -1), along: (1, 0.5, 0.3), form: Paraboloid(0.8, -0.5), aperture: 0.4, event: Mirror),
           Smooth(name: "cylinder", center: (0.7, 0, 0.867), facing: (-1, 0.3, 0), along: (0, 0.3, 1), form: Cylinder(0.7), aperture: 0.5, event: Mirror)"#,
        &["lens", "saddle", "cylinder"],
        r#"(name: "a", at: After("lens")), (name: "b", at: After("saddle")), (name: "c", at: Before("cylinder"), orientation: LocalNormals),
           (name: "d", at: After("cylinder"))"#,
    ),
    (
        "a mesh with interpolated normals as a mirror, inside and outside of it",
        r#"Mesh(name: "ball", center: (0.05, 0, 1.2), mesh: Star(radius: 0.4, relief: 0.1, lobes: 3, rings: 60), event: Mirror)"#,
        &["ball"],
        r#"(name: "a", at: Before("ball"), orientation: Tangent), (name: "b", at: After("ball")), (name: "c", at: Distance(1.1))"#,
    ),
];

#[test]
fn both_ways_agree_behind_smooth_surfaces() {
    for (what, surfaces, visits, planes) in SMOOTH {
        let text = format!(
            r#"(
                light: Disc(center: (0, 0, 0), radius: 0.1, radiance: 2),
                blockers: [Shapes(name: "b", center: (0, 0, 0.5), shapes: [Rectangle(center: (0.05, 0.02), size: (0.08, 0.1))])],
                surfaces: [{surfaces}],
                path: (direction: (0, 0, 1), x_axis: (1, 0.3, 0), visits: {visits:?}),
                planes: [{planes}],
                window: (x: Hann(0.15), u: Hann(0.2), v: Hann(0.25)),
                frequencies: (rho: (max: 4), nu: (max: 4)),
                run: (photons: 1_000_000),
            )"#
        );
        let file = SceneFile::parse(&text).unwrap();
        let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
        let (backward, _) = estimates(&Backward::new(&scene).unwrap(), &scene);
        let (photons, ledger) = estimates(&Tracer::new(&scene), &scene);
        // The tolerance is the rounding error of some 10^5 additions.
        assert!(ledger.imbalance().abs() < 1e-12, "{ledger:?}");
        for (plane, (a, b)) in backward.iter().zip(&photons).enumerate() {
            let name = &scene.planes[plane].name;
            for (a, b) in a.iter().zip(b) {
                let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                // In one of 250 runs, at least one of some 60 tests exceeds 4 standard errors by
                // chance.
                assert!(z.abs() < 4.0, "{what}: {name}: {a:?} and {b:?}");
            }
            for [mean, error] in [a[0], b[0]] {
                assert!(
                    error < 0.03 * mean,
                    "{what}: {name}: {a:?}, {b:?}: too noisy"
                );
            }
        }
    }
}

/// A large wall close to a floor. Light from the wall reaches the floor from all sides, so it
/// travels along the central ray and against it.
const WIDE: &str = r#"Rectangle(name: "wall", center: (-0.5, 0, 1.2), size: (2, 3), facing: (0, 0, -1), albedo: 0.9)"#;
const GLOSSY: &str = r#"Smooth(name: "wall", center: (-0.3, 0, 1.2), facing: (0, 0, -1), form: Plane, aperture: 1, event: Reflects(brdf: (lobe: Phong(2), albedo: 0.9)))"#;
const NEAR: &str = r#"Rectangle(name: "floor", center: (-0.5, 0, 1), size: (0.4, 0.5), facing: (0, 0, 1), albedo: 0.5)"#;
/// A blocker in the path of light that travels backwards.
const CARD: &str = r#"Shapes(name: "card", center: (-0.8, 0, 1.1), shapes: [Rectangle(center: (0, 0), size: (0.15, 0.2))])"#;
const ABOVE: &str = r#"Rectangle(name: "ceiling", center: (-0.9, 0, 1.16), size: (0.3, 0.4), facing: (0, 0, -1), albedo: 0.5)"#;

fn going_back(wall: &str, blockers: &str, visits: &[&str]) -> Scene {
    let last = visits[visits.len() - 1];
    let surfaces = match last {
        "ceiling" => format!("{NEAR}, {ABOVE}"),
        _ => NEAR.to_owned(),
    };
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (0.3, 0.3), radiance: 2),
            blockers: [{blockers}],
            surfaces: [{wall}, {surfaces}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: {visits:?}),
            planes: [
                (name: "leaves", at: After("{last}")),
                (name: "arrives", at: Before("{last}"), orientation: Tangent, window: (x: Hann(0.1), u: Box(1.5))),
            ],
            window: (x: Hann(0.05), u: Hann(0.1)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: 3_000_000),
        )"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn light_that_goes_back_along_a_leg_arrives() {
    for (wall, blockers, visits) in [
        (WIDE, "", &["wall", "floor"][..]),
        (WIDE, CARD, &["wall", "floor"]),
        (GLOSSY, CARD, &["wall", "floor"]),
        (WIDE, "", &["wall", "floor", "ceiling"]),
    ] {
        let scene = going_back(wall, blockers, visits);
        let (backward, _) = estimates(&Backward::new(&scene).unwrap(), &scene);
        let (photons, _) = estimates(&Tracer::new(&scene), &scene);
        for (plane, (a, b)) in backward.iter().zip(&photons).enumerate() {
            let name = &scene.planes[plane].name;
            for (a, b) in a.iter().zip(b) {
                let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                // In one of 600 runs, at least one of 24 tests exceeds 4 standard errors by chance.
                assert!(z.abs() < 4.0, "{name}: {a:?} and {b:?}, {wall}, {blockers}");
            }
            let [mean, error] = b[0];
            assert!(
                error < 0.04 * mean,
                "{name}: {mean} ± {error}, {visits:?} {wall}"
            );
        }
    }
}

/// Computes ∫ L W at the virtual plane after the floor, as a sum over random points of the
/// window, the wall and the light, in world coordinates.
#[test]
fn light_that_went_back_along_a_leg_is_what_a_plain_sum_says() {
    let scene = going_back(WIDE, "", &["wall", "floor"]);
    let plane = &scene.planes[0];
    let [wall, floor] = [0, 1].map(|i| &scene.surfaces[i]);
    let to_light = |p: DVec3| scene.path.frame.to_local(p);
    let is_on_floor = |p: DVec3| {
        let local = floor.frame.to_local(p);
        local.x.abs() < 0.5 * floor.size[0] && local.y.abs() < 0.5 * floor.size[1]
    };
    let meets_floor = |from: DVec3, along: DVec3| {
        let t = (floor.frame.origin - from).dot(floor.frame.d) / along.dot(floor.frame.d);
        from + t * along
    };
    // The form factor cos θ cos θ' / r² between two points.
    let form = |way: DVec3, from: DVec3, to: DVec3| {
        way.dot(from).max(0.0) * (-way.dot(to)).max(0.0) / way.length_squared().powi(2)
    };
    let w = &plane.window;
    let half = [w.x, w.y, w.u, w.v].map(|p| p.half_width());
    let volume: f64 = half.iter().map(|h| 2.0 * h).product();
    let samples = 8_000_000;
    let [mut sum, mut squares, mut back] = [0.0; 3];
    for index in 0..samples {
        let r = [0, 1].map(|block| words(5, Stream::Even, index, block).map(unit));
        let [x, y, u, v] = [0, 1, 2, 3].map(|i| (2.0 * r[0][i] - 1.0) * half[i]);
        let at = to_light(plane.frame.to_world(DVec3::new(x, y, 0.0)));
        let along = to_light(plane.frame.to_world(DVec3::new(x + u, y + v, 1.0))) - at;
        let to = meets_floor(at, along);
        assert!(is_on_floor(to), "the window sees the floor alone");
        let [a, b] = [0, 1].map(|i| (r[1][i] - 0.5) * wall.size[i]);
        let over = wall.frame.to_world(DVec3::new(a, b, 0.0));
        let light = DVec3::new((r[1][2] - 0.5) * 0.3, (r[1][3] - 0.5) * 0.3, 0.0);
        if is_on_floor(meets_floor(light, over - light)) {
            continue;
        }
        let first = form(over - light, DVec3::Z, wall.frame.d) * 2.0 * 0.3 * 0.3;
        let second = form(to - over, wall.frame.d, floor.frame.d) * wall.size[0] * wall.size[1];
        let value = w.value(&etendue_field::TwoPlane { x, y, u, v });
        let found = volume * value * (0.9 / PI) * (0.5 / PI) * first * second;
        sum += found;
        squares += found * found;
        if (to - over).dot(scene.path.legs[1].frame.d) < 0.0 {
            back += found;
        }
    }
    let n = samples as f64;
    assert!(back > 0.1 * sum, "{back} of {sum}");
    let [sum, noise] = [sum / n, (squares / n - (sum / n).powi(2)).sqrt() / n.sqrt()];
    for (source, most) in [
        (&Backward::new(&scene).unwrap() as &dyn PhotonSource, 0.01),
        (&Tracer::new(&scene), 0.03),
    ] {
        let [mean, error] = estimates(source, &scene).0[0][0];
        let sigma = error.hypot(noise);
        assert!(sigma < most * sum, "{mean} ± {sigma}");
        assert!((mean - sum).abs() < 4.0 * sigma, "{mean} ± {sigma}, {sum}");
    }
}
