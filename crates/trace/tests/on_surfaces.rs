//! Tests virtual planes in the coordinates of surfaces that the central ray meets obliquely, by
//! photons and by backward rays.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::estimates;
use etendue_scene::{SceneFile, resolve};
use etendue_trace::{Backward, Tracer};

/// The direction from the surface towards the arriving light, rotated out of the plane of X and
/// the central ray.
const FACING: &str = "(0.3, -0.5, -0.8)";

fn smooth(event: &str) -> String {
    format!(
        r#"Smooth(name: "s", center: (0, 0, 1), facing: {FACING}, form: Sphere(0.2), aperture: 0.5, event: {event})"#
    )
}

/// Checks that the forward and the backward tracer find the same light at every given virtual
/// plane.
fn agree(surface: &str, planes: &[&str]) {
    agree_along("\"s\"", surface, planes);
}

fn agree_along(visits: &str, surface: &str, planes: &[&str]) {
    let window = "(x: Hann(0.15), y: Box(0.1), u: Hann(0.3), v: Hann(0.2))";
    agree_in(window, visits, surface, planes);
}

fn agree_in(window: &str, visits: &str, surface: &str, planes: &[&str]) {
    let planes: Vec<String> = planes.iter().enumerate().map(named).collect();
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (0.9, 0.7)),
            surfaces: [{surface}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [{visits}]),
            planes: [{}],
            window: {window},
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: 1_000_000),
        )"#,
        planes.join(", ")
    );
    let file = SceneFile::parse(&text).unwrap();
    let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
    let (photons, _) = estimates(&Tracer::new(&scene), &scene);
    let (rays, _) = estimates(&Backward::new(&scene).unwrap(), &scene);
    for (plane, (a, b)) in planes.iter().zip(photons.iter().zip(&rays)) {
        // Noise must be so small that missing light would be detected.
        assert!(a[0][1] < 0.02 * b[0][0], "{surface}, {plane}: {a:?}");
        for (a, b) in a.iter().zip(b) {
            let z = (a[0] - b[0]) / a[1].hypot(b[1]);
            // In one of 2,000 runs, at least one of some 70 tests exceeds 4.5 standard errors by
            // chance.
            assert!(z.abs() < 4.5, "{surface}, {plane}: {a:?} and {b:?}");
        }
    }
}

fn named((i, plane): (usize, &&str)) -> String {
    format!("(name: \"p{i}\", {plane})")
}

/// For every kind of surface, a virtual plane records all light that arrives.
#[test]
fn arriving() {
    let tangent = r#"at: Before("s"), orientation: Tangent"#;
    let local = r#"at: Before("s"), orientation: LocalNormals"#;
    let mirrored = r#"at: Before("s"), orientation: Mirrored"#;
    for event in ["Mirror", "Refraction(front: 1, back: 1.5)"] {
        agree(&smooth(event), &[tangent]);
        agree(&smooth(event), &[local]);
        agree(&smooth(event), &[mirrored]);
    }
    let wall =
        format!(r#"Rectangle(name: "s", center: (0, 0, 1), size: (3, 3), facing: {FACING})"#);
    agree(&wall, &[tangent]);
}

/// If a surface extends back beside the light, the part of the surface beside the light is dark.
#[test]
fn arriving_behind_the_light() {
    let near = smooth("Mirror").replace("(0, 0, 1)", "(0, 0, 0.04)");
    for orientation in ["Tangent", "LocalNormals"] {
        let plane = format!(r#"at: Before("s"), orientation: {orientation}"#);
        agree(&near.replace("Sphere(0.2)", "Plane"), &[&plane]);
        agree(&near, &[&plane]);
    }
}

/// A curved surface may extend before or behind blockers that stand near its tangent plane. Blockers
/// before the tangent plane shade it, and all others do not.
#[test]
fn arriving_at_blockers_beside_a_curved_surface() {
    for (facing, form) in [("-1", "Sphere(0.2)"), ("1", "Sphere(0.2)"), ("1", "Plane")] {
        let surface = format!(
            r#"Smooth(name: "s", center: (0, 0, 1), facing: (0.1, 0, {facing}), form: {form}, aperture: 0.3, event: Mirror)"#
        );
        for place in [0.98, 0.999] {
            let bars = format!(
                r#"Bars(name: "bars", center: (0.02, 0, {place}), axis: X, count: 7, pitch: 0.07, fill: 0.5)"#
            );
            let both = format!("{surface}], blockers: [{bars}");
            agree(&both, &[r#"at: Before("s"), orientation: Tangent"#]);
        }
    }
}

/// If a tangent plane extends beyond its surface, it also records light that passes beside the
/// surface.
#[test]
fn arriving_beside() {
    for event in ["Mirror", "Reflects(brdf: (lobe: Lambertian))"] {
        let small = smooth(event).replace("aperture: 0.5", "aperture: 0.05");
        agree(&small, &[r#"at: Before("s"), orientation: Tangent"#]);
    }
}

/// Directions of light that leaves a wall are measured from the wall's normal, and not from the
/// central ray.
#[test]
fn leaving() {
    let wall =
        format!(r#"Rectangle(name: "s", center: (0, 0, 1), size: (3, 3), facing: {FACING})"#);
    let after = r#"at: After("s"), orientation: Tangent"#;
    agree(&wall, &[after]);
    // The axes of the wall's surface differ from the axes of the leg.
    agree_in(
        "(x: Hann(0.4), y: Box(0.05), u: Hann(0.3))",
        "\"s\"",
        &wall,
        &[after],
    );
}

/// Some slopes of a window may point along a tilted wall or at the wall's back. The window then
/// sees an unbounded part of the wall.
#[test]
fn leaving_along_the_wall() {
    let wall = r#"Smooth(name: "s", center: (0, 0, 1.5), facing: (0.93, 0, -0.36), form: Plane, aperture: 4.2, event: Reflects(brdf: (lobe: Lambertian)))"#;
    let window = "(x: Box(0.2), u: Hann(2.1))";
    agree_in(window, "\"s\"", wall, &["at: Distance(1.6)"]);
}

/// If slopes are narrow, backward rays still find light from every part of a large light.
#[test]
fn narrow_slopes() {
    let window = "(x: Hann(0.1), u: Box(0.001))";
    for event in ["Mirror", "Reflects(brdf: (lobe: Lambertian))"] {
        for orientation in ["Tangent", "LocalNormals"] {
            let plane = format!(r#"at: Before("s"), orientation: {orientation}"#);
            let flat = smooth(event).replace("Sphere(0.2)", "Plane");
            agree_in(window, "\"s\"", &flat, &[&plane]);
            let wide = "(x: Hann(0.1), u: Box(0.05))";
            agree_in(wide, "\"s\"", &smooth(event), &[&plane]);
        }
    }
}

/// Light that reaches a virtual plane on the second surface comes from all points of the first
/// surface.
#[test]
fn arriving_from_a_wall() {
    let wall =
        r#"Rectangle(name: "wall", center: (0, 0, 1), size: (0.6, 0.8), facing: (1, 0.2, -1))"#;
    for what in [
        r#"Rectangle(name: "s", center: (1, 0.1, 0.9), size: (0.7, 0.7), facing: (-1, 0.4, 0.2))"#,
        r#"Smooth(name: "s", center: (1, 0.1, 0.9), facing: (-1, 0.4, 0.2), form: Plane, aperture: 0.4, event: Mirror)"#,
    ] {
        let plane = r#"at: Before("s"), orientation: Tangent"#;
        agree_along(r#""wall", "s""#, &format!("{wall}, {what}"), &[plane]);
    }
}
