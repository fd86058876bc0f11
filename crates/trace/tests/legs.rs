//! Several reflections in a row, oblique surfaces and light that leaves a mesh: three ways, and a plain quadrature.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod common;

use common::estimates;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Backward, Tracer};
use glam::DVec3;
use std::f64::consts::PI;

const WALL: &str = r#"Rectangle(name: "wall", center: (0.1, 0, 2), size: (2, 1.6), facing: (1, 0.2, -1), albedo: 0.8)"#;
const STAR: &str = r#"Mesh(name: "wall", center: (0, 0, 2), mesh: Star(radius: 0.5, relief: 0.3, lobes: 4, rings: 30), albedo: 0.8)"#;
const FLOOR: &str = r#"Rectangle(name: "floor", center: (1.5, 0.3, 1.8), size: (2, 2), facing: (-1, 0, 0.1), albedo: 0.5)"#;
const CEILING: &str = r#"Rectangle(name: "ceiling", center: (0.6, 1.2, 3), size: (1.5, 1.5), facing: (0, -1, -0.2), albedo: 0.9)"#;
/// Stands beside the light's way, and in that of what leaves the wall.
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
    // The near side of a mesh looks back.
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
fn all_ways_agree_on_every_leg() {
    let mut tests = 0;
    let nearer = BLACK.replace("1.6)", "1.2)");
    for (wall, blockers) in [
        (WALL, BLACK),
        (WALL, GRATING),
        (STAR, &nearer),
        (STAR, GRATING),
    ] {
        // What leaves a mesh goes anywhere: a plain photon seldom finds a third surface.
        let visits = &["wall", "floor", "ceiling"][..if wall == STAR { 2 } else { 3 }];
        let aimed = scene(wall, blockers, visits, "Aimed", 800_000);
        let plain = scene(wall, blockers, visits, "Plain", 2_500_000);
        let (backward, _) = estimates(&Backward::new(&aimed).unwrap(), &aimed);
        let (photons, ledger) = estimates(&Tracer::new(&aimed), &aimed);
        // Rounding of some 10^5 additions.
        assert!(ledger.imbalance().abs() < 1e-12, "{ledger:?}");
        let (plain, _) = estimates(&Tracer::new(&plain), &plain);
        for (way, other) in [("aimed", &photons), ("plain", &plain)] {
            for (plane, (a, b)) in backward.iter().zip(other).enumerate() {
                let name = &aimed.planes[plane].name;
                for (a, b) in a.iter().zip(b) {
                    let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                    tests += 1;
                    // Some 120 tests: 4.2 standard errors are passed in one run of 300.
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

/// ∫ L W at the plane before the floor, whose light left the wall: every integral as a plain sum, in world coordinates.
#[test]
fn light_that_left_an_oblique_wall_is_what_a_plain_sum_says() {
    // Mid-points of Hann windows converge faster than any power.
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
    // Mid-points of the light, 8 × 8 of them, are good to 1e-3; the rest is noise.
    assert!(
        (mean - sum).abs() < 4.0 * error + 1e-3 * sum,
        "{mean} ± {error}, {sum}"
    );
}
