//! A small object that stops light beside the central ray stops it in the prediction too. The share
//! that it stops is known from plain sums over rays, which are straight in the images of mirrors.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_compare::Class;
use etendue_field::ProjectionGrid;
use etendue_predict::Applicability;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_theory::path::PathSystem;
use etendue_theory::{Model, RayBudget};
use glam::DVec3;

const FACING: DVec3 = DVec3::new(0.382_683_43, 0.0, -0.923_879_53);
const HALF: f64 = 0.2;
const SQUARE: &str = "Rectangle(center: (0, 0, 0), size: (0.1, 0.1))";

/// A mirror that deflects the central ray, a disc in the plane z = 0.7 and a plane at 1.7 m.
fn scene([x, y]: [f64; 2], radius: f64) -> Scene {
    parsed(&format!(
        r#"(
            light: {SQUARE},
            blockers: [Shapes(name: "disc", center: (0, 0, 0.7),
                shapes: [Disc(center: ({x}, {y}), radius: {radius})])],
            surfaces: [Smooth(name: "mirror", center: (0, 0, 1),
                facing: ({}, {}, {}), form: Plane, aperture: 1, event: Mirror)],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["mirror"]),
            planes: [(name: "plane", at: Distance(1.7))],
            window: (x: Box({HALF}), u: Box({HALF})),
            frequencies: (azimuths: 4, rho: (max: 20), nu: (max: 20)),
        )"#,
        FACING.x, FACING.y, FACING.z
    ))
}

fn parsed(text: &str) -> Scene {
    let file = SceneFile::parse(text).unwrap();
    resolve("scene", file, ".".as_ref(), u64::MAX).unwrap()
}

/// The share of the window's light that an occluder stops, by two predictions with the same
/// rays. The second prediction is blind to the occluder.
fn stopped(scene: &Scene, blind: fn(&mut PathSystem)) -> f64 {
    let found = Applicability::new(scene, &scene.planes[0]);
    assert_eq!(found.class(), Class::FirstOrder, "{:?}", found.reasons);
    let (plane, view) = (&scene.planes[0], found.theory.path().unwrap());
    let picture = ProjectionGrid::new(&plane.window, 1);
    let over = (&plane.window, &plane.grid, &picture);
    let mut open = view.clone();
    blind(&mut open.system);
    let budget = RayBudget::new(4e6, 0.0);
    let [all, seen] = [&open, view].map(|view| view.predict(&[], over, budget).slices.at_zero());
    1.0 - seen / all
}

/// Four numbers between −½ and ½ that fill four axes uniformly. They are multiples of
/// powers of the root of x⁵ = x + 1.
fn spread(index: u32) -> [f64; 4] {
    [1.0, 2.0, 3.0, 4.0]
        .map(|k| (f64::from(index) * 1.167_303_978_261_418_7_f64.powf(-k)).fract() - 0.5)
}

/// Number of rays of a plain sum.
const RAYS: u32 = 1_000_000;

/// Light of a square that a mirror has turned meets a disc, which stands anywhere in the window.
#[test]
fn a_small_disc_in_light_that_a_mirror_has_turned() {
    let mirror = [DVec3::Z, FACING.normalize()];
    let far = scene([9.0, 9.0], 0.01);
    let frame = far.path.frame.decompose(&far.planes[0].frame);
    let crossing = |from: DVec3, to: DVec3| {
        let at = from.lerp(to, (0.7 - from.z) / (to.z - from.z));
        DVec3::new(at.x, at.y, 0.0)
    };
    for [x, y, radius] in [
        [-0.995, -0.995, 0.03],
        [0.995, 0.3, 0.02],
        [-0.4, 0.995, 0.02],
        [0.3, -0.4, 0.012],
    ] {
        let to = frame.to_world(HALF * DVec3::new(x, y, 0.0));
        let disc = crossing(reflected(DVec3::ZERO, mirror), to);
        let stops = |at: DVec3| at.distance(disc) <= radius;
        let share = (0..RAYS).filter(|index| {
            let [a, b, c, d] = spread(*index);
            let from = DVec3::new(0.1 * a, 0.1 * b, 0.0);
            let to = frame.to_world(2.0 * HALF * DVec3::new(c, d, 0.0));
            let image = reflected(from, mirror);
            let t = (mirror[0] - image).dot(mirror[1]) / (to - image).dot(mirror[1]);
            stops(crossing(image, to)) || stops(crossing(from, image.lerp(to, t)))
        });
        let share = share.count() as f64 / f64::from(RAYS);
        let found = stopped(&scene([disc.x, disc.y], radius), |system| {
            system.masks.clear();
        });
        // Some thousand rays of each sum are stopped.
        assert!(
            (found / share - 1.0).abs() < 0.05,
            "{x} {y}: {found} {share}"
        );
    }
}

/// The mirror image of a point in a plane.
fn reflected(point: DVec3, [on, normal]: [DVec3; 2]) -> DVec3 {
    point - 2.0 * (point - on).dot(normal) * normal
}

/// The edge of a second mirror reaches into the light on its way to the first mirror.
#[test]
fn the_edge_of_a_mirror_that_is_met_out_of_turn() {
    let [first, second] = [
        [DVec3::Z, DVec3::new(1.0, 0.0, -1.0).normalize()],
        [
            DVec3::new(0.5, 0.0, 1.0),
            DVec3::new(-1.0, 0.0, 1.0).normalize(),
        ],
    ];
    let built = |aperture: f64| {
        parsed(&format!(
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
        ))
    };
    let scene = built(0.3);
    let frame = scene.path.frame.decompose(&scene.planes[0].frame);
    // Returns how far from the middle of the second mirror a ray is reflected there, and how far
    // from it the ray passes before, if it does.
    let passes = |index: u32| {
        let [a, b, c, d] = spread(index);
        let from = DVec3::new(0.1 * a, 0.1 * b, 0.0);
        let to = frame.to_world(DVec3::new(0.3 * c, 0.3 * d, 0.0));
        let at = |from: DVec3, to: DVec3, [on, normal]: [DVec3; 2]| {
            let t = (on - from).dot(normal) / (to - from).dot(normal);
            from.lerp(to, t)
        };
        let image = reflected(from, first);
        let on_second = at(reflected(image, second), to, second);
        let on_first = at(image, on_second, first);
        let crosses = (second[0] - from).dot(second[1]) / (on_first - from).dot(second[1]);
        let is_crossed = (0.0..1.0).contains(&crosses);
        let before = is_crossed.then(|| from.lerp(on_first, crosses).distance(second[0]));
        (on_second.distance(second[0]), before)
    };
    let rays: Vec<_> = (0..RAYS).map(passes).collect();
    let nearest = rays.iter().filter_map(|(_, before)| *before);
    let edge = nearest.fold(f64::INFINITY, f64::min);
    for aperture in [0.95 * edge, 1.1 * edge, 1.2 * edge] {
        let reflected = rays.iter().filter(|(reaches, _)| *reaches <= aperture);
        let is_stopped = |before: &Option<f64>| before.is_some_and(|at| at <= aperture);
        let stops = reflected.clone().filter(|(_, before)| is_stopped(before));
        let share = stops.count() as f64 / reflected.count() as f64;
        let found = stopped(&built(aperture), |system| {
            for surface in &mut system.surfaces {
                surface.occludes = false;
            }
        });
        // The errors of both sums, where thousands of rays are stopped.
        assert!((found - share).abs() <= 0.05 * share, "{found} {share}");
    }
}
