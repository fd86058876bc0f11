//! A small object that stops light beside the central ray is found. Theory then treats blockers as
//! obstacles, and does not apply to a plane whose light meets a surface out of turn.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_compare::{Applicability, Class, Theory};
use etendue_scene::{Scene, SceneFile, resolve};
use glam::DVec3;

const FACING: DVec3 = DVec3::new(0.382_683_43, 0.0, -0.923_879_53);
const HALF: f64 = 0.2;
const POINT: &str = "Point(center: (0, 0, 0), intensity: 1)";
const SQUARE: &str = "Rectangle(center: (0, 0, 0), size: (0.1, 0.1))";

/// Returns a surface that deflects the central ray, a disc in the plane z = 0.7 and a plane at 1.7
/// m.
fn scene(light: &str, event: &str, disc: [f64; 2], radius: f64) -> Scene {
    let [x, y] = disc;
    let text = format!(
        r#"(
            light: {light},
            blockers: [Shapes(name: "disc", center: (0, 0, 0.7),
                shapes: [Disc(center: ({x}, {y}), radius: {radius})])],
            surfaces: [Smooth(name: "mirror", center: (0, 0, 1),
                facing: ({}, {}, {}), form: Plane, aperture: 1, event: {event})],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["mirror"]),
            planes: [(name: "plane", at: Distance(1.7))],
            window: (x: Box({HALF}), u: Box({HALF})),
            frequencies: (azimuths: 4, rho: (max: 20), nu: (max: 20)),
        )"#,
        FACING.x, FACING.y, FACING.z
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("scene", file, ".".as_ref(), u64::MAX).unwrap()
}

fn reasons(scene: &Scene) -> Vec<String> {
    let found = Applicability::new(scene, &scene.planes[0]);
    assert_eq!(found.class() == Class::Reference, !found.reasons.is_empty());
    // The theory of several surfaces may replace the theory of one.
    [found.reasons, found.declined].concat()
}

/// Returns the names of the obstacles that theory tests rays against.
fn obstacles(scene: &Scene) -> Vec<String> {
    let obstacles = match Applicability::new(scene, &scene.planes[0]).theory {
        Theory::Specular(view) => view.system.obstacles,
        Theory::Scattering(view) => view.system.obstacles,
        other => panic!("{other:?}"),
    };
    obstacles
        .into_iter()
        .map(|obstacle| obstacle.name)
        .collect()
}

/// Returns the point where the ray from one point towards another crosses z = 0.7.
fn crossing(from: DVec3, to: DVec3) -> [f64; 2] {
    let at = from.lerp(to, (0.7 - from.z) / (to.z - from.z));
    [at.x, at.y]
}

/// Returns the point of the plane with coordinates (x, y), as shares of the window.
fn in_plane(x: f64, y: f64) -> DVec3 {
    let far = scene(POINT, "Mirror", [9.0, 9.0], 0.01);
    let frame = far.planes[0].frame;
    let frame = far.path.frame.decompose(&frame);
    frame.to_world(DVec3::new(HALF * x, HALF * y, 0.0))
}

/// Returns places in the window, as shares of its size: middle, edges and corners.
fn places() -> impl Iterator<Item = [f64; 2]> {
    const SHARES: [f64; 4] = [-0.995, -0.4, 0.3, 0.995];
    SHARES.into_iter().flat_map(|x| SHARES.map(|y| [x, y]))
}

#[test]
fn a_small_disc_in_light_that_a_mirror_has_turned() {
    let image = |p: DVec3| {
        let n = FACING.normalize();
        p - 2.0 * (p - DVec3::Z).dot(n) * n
    };
    for (light, half) in [(POINT, 0.0), (SQUARE, 0.05)] {
        for [x, y] in places() {
            let from = image(half * DVec3::new(x.signum(), -y.signum(), 0.0));
            let disc = crossing(from, in_plane(x, y));
            for radius in [0.012, 0.002, 3e-4] {
                let found = obstacles(&scene(light, "Mirror", disc, radius));
                assert_eq!(found, ["disc"], "{light} {x} {y} {radius}");
            }
            let beyond = crossing(from, in_plane(x.signum() * 1.6, y));
            let found = obstacles(&scene(light, "Mirror", beyond, 3e-4));
            assert_eq!(found, [""; 0], "{light} {x} {y}");
        }
    }
}

/// Light leaves a BRDF in all directions, so the corner of the window is a corner in four axes.
#[test]
fn a_small_disc_in_light_that_a_brdf_has_scattered() {
    let event = "Reflects(brdf: (lobe: Phong(20), albedo: 0.5))";
    let frame = scene(POINT, event, [9.0, 9.0], 0.01).planes[0].frame;
    for [x, y] in places() {
        for [u, v] in [[0.9, -0.9], [-0.95, 0.2]] {
            let to = in_plane(x, y);
            let from = to - frame.vector_to_world(HALF * DVec3::new(u, v, 1.0 / HALF));
            let disc = crossing(from, to);
            for radius in [0.012, 0.002] {
                let found = obstacles(&scene(SQUARE, event, disc, radius));
                assert_eq!(found, ["disc"], "{x} {y} {u} {v} {radius}");
            }
        }
    }
}

/// Returns the mirror image of a point in a plane.
fn reflected(point: DVec3, [on, normal]: [DVec3; 2]) -> DVec3 {
    point - 2.0 * (point - on).dot(normal) * normal
}

/// The edge of a second mirror just reaches into the light on its way to the first mirror. A
/// million random rays, traced by the images of the light in both planes, determine how far the
/// edge may reach.
#[test]
fn the_edge_of_a_mirror_that_is_met_out_of_turn() {
    const RAYS: u32 = 1_000_000;
    let [first, second] = [
        [DVec3::Z, DVec3::new(1.0, 0.0, -1.0).normalize()],
        [
            DVec3::new(0.5, 0.0, 1.0),
            DVec3::new(-1.0, 0.0, 1.0).normalize(),
        ],
    ];
    let text = |aperture: f64| {
        format!(
            r#"(
                light: {SQUARE},
                surfaces: [
                    Smooth(name: "first", center: (0, 0, 1), facing: (1, 0, -1),
                        form: Plane, aperture: 1, event: Mirror),
                    Smooth(name: "second", center: (0.5, 0, 1), facing: (-1, 0, 1),
                        form: Plane, aperture: {aperture}, event: Mirror)],
                path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["first", "second"]),
                planes: [(name: "plane", at: After("second"))],
                window: (x: Box(0.15), u: Box(0.5)),
                frequencies: (azimuths: 2, rho: (max: 8), nu: (max: 8)),
            )"#
        )
    };
    let found = |aperture: f64| {
        let file = SceneFile::parse(&text(aperture)).unwrap();
        reasons(&resolve("scene", file, ".".as_ref(), u64::MAX).unwrap())
    };
    let file = SceneFile::parse(&text(0.3)).unwrap();
    let scene = resolve("scene", file, ".".as_ref(), u64::MAX).unwrap();
    let frame = scene.path.frame.decompose(&scene.planes[0].frame);
    let reach = |index: u32| {
        // Multiples of powers of the root of x⁵ = x + 1 fill four axes uniformly.
        let r = [1.0, 2.0, 3.0, 4.0]
            .map(|k| (f64::from(index) * 1.167_303_978_261_418_7_f64.powf(-k)).fract() - 0.5);
        let from = DVec3::new(0.1 * r[0], 0.1 * r[1], 0.0);
        let to = frame.to_world(DVec3::new(0.3 * r[2], 0.3 * r[3], 0.0));
        let at = |from: DVec3, to: DVec3, [on, normal]: [DVec3; 2]| {
            let t = (on - from).dot(normal) / (to - from).dot(normal);
            from.lerp(to, t)
        };
        let image = reflected(from, first);
        let on_second = at(reflected(image, second), to, second);
        let on_first = at(image, on_second, first);
        let crosses = (second[0] - from).dot(second[1]) / (on_first - from).dot(second[1]);
        let beyond = !(0.0..1.0).contains(&crosses);
        let reaches = on_second.distance(second[0]);
        // The second mirror must be large enough to reflect the ray, and its radius must reach this
        // distance to stop the ray.
        let stops = from.lerp(on_first, crosses).distance(second[0]);
        (!beyond && stops > reaches).then_some(stops)
    };
    let aperture = (0..RAYS).filter_map(reach).fold(f64::INFINITY, f64::min);
    assert!(aperture.is_finite());
    assert_eq!(
        found(1.001 * aperture),
        ["light that meets second out of order"]
    );
    assert_eq!(found(0.95 * aperture), [""; 0]);
}
