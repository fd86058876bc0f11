//! Tests further lights: the scenes to which they resolve, and which lights are refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Light, Shape};
use etendue_scene::{Scene, SceneFile, resolve};

const FIRST: &str = "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))";
const NEAR: &str = r#"Grating(name: "near", center: (0, 0, 0.2), axis: X, frequency: 2),"#;
const FAR: &str = r#"Grating(name: "far", center: (0, 0, 1.25), axis: X, frequency: 3),"#;

/// A scene with a rectangle, a mirror and a mesh. `light` has the fields of the lights.
fn text(light: &str, blockers: &str, at: &str) -> String {
    format!(
        r#"(
            {light},
            blockers: [{blockers} {FAR}
                Mesh(name: "star", center: (0.5, 0, 1.5), mesh: Star(radius: 0.2, relief: 0.1, lobes: 3, rings: 10))],
            surfaces: [
                Smooth(name: "mirror", center: (0, 0, 2), facing: (0.5, 0, -1), form: Sphere(-0.3), aperture: 0.5, event: Mirror),
                Rectangle(name: "wall", center: (0.8, 0, 1.4), size: (1, 1), facing: (-1, 0, 0)),
            ],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["mirror", "wall"]),
            planes: [{at} (name: "mirror", at: Before("mirror")), (name: "wall", at: After("wall"))],
            window: (x: Hann(0.5), u: Hann(0.5)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
        )"#
    )
}

fn resolved(text: &str) -> Scene {
    let file = SceneFile::parse(text).unwrap();
    resolve("lights", file, ".".as_ref(), u64::MAX).unwrap()
}

/// All distances and positions of a scene as one list, without blockers behind the light.
fn numbers(scene: &Scene) -> Vec<f64> {
    let mut all = Vec::new();
    for leg in &scene.path.legs {
        all.extend([leg.start, leg.length]);
        all.extend(leg.frame.origin.to_array());
        all.extend(leg.leaves.iter().flat_map(|hit| hit.point.to_array()));
    }
    all.extend(scene.path.frame.origin.to_array());
    let distances = scene.blockers.iter().map(|layer| layer.distance);
    all.extend(distances.filter(|distance| *distance > 0.0));
    for surface in &scene.surfaces {
        all.extend(surface.frame.origin.to_array());
    }
    for object in &scene.patches {
        all.extend(object.patch.frame.origin.to_array());
    }
    for mesh in &scene.meshes {
        all.extend(mesh.extent);
        all.extend(mesh.center.to_array());
        let corners = mesh.triangles.as_flattened().iter();
        all.extend(corners.flat_map(|corner| corner.to_array()));
    }
    for plane in &scene.planes {
        all.push(plane.distance);
        all.extend(plane.frame.origin.to_array());
    }
    all
}

/// A further light has the scene that the file has if the light is its only light, without the
/// blockers and planes behind the light.
#[test]
fn a_further_light_is_a_scene_of_its_own() {
    let at = r#"(name: "near", at: Distance(0.1)),"#;
    for (depth, blockers, at_alone) in [
        (-0.5, NEAR, r#"(name: "near", at: Distance(0.6)),"#),
        (0.0, NEAR, at),
        (0.5, "", ""),
    ] {
        let other = format!("Disc(center: (0, 0, {depth}), radius: 0.1)");
        let both = format!("light: {FIRST}, other_lights: [{other}]");
        let both = resolved(&text(&both, NEAR, at));
        let alone = resolved(&text(&format!("light: {other}"), blockers, at_alone));
        let [found] = &both.other_lights[..] else {
            panic!("one further light");
        };
        assert_eq!(found.light, alone.light);
        // Light that a surface sends back meets the blockers behind its light.
        assert_eq!(found.blockers.len(), both.blockers.len());
        assert!((found.blockers[0].distance - (0.2 - depth)).abs() < 1e-12);
        let [found, alone] = [found, &alone].map(numbers);
        assert_eq!(found.len(), alone.len(), "{depth}");
        for (a, b) in found.into_iter().zip(alone) {
            assert!((a - b).abs() < 1e-12, "{depth}: {a}, {b}");
        }
    }
}

#[test]
fn a_flat_light_may_stand_aside() {
    let both = format!("light: {FIRST}, other_lights: [Disc(center: (0.3, -0.1, 0), radius: 0.1)]");
    let both = resolved(&text(&both, NEAR, ""));
    let Light::Area {
        shape: Shape::Disc(disc),
        ..
    } = both.other_lights[0].light
    else {
        panic!("a disc");
    };
    let [x, y] = disc.center;
    assert!((x - 0.3).abs() < 1e-15 && (y + 0.1).abs() < 1e-15);
    let kept = both.seen_at(&[1]);
    assert_eq!(kept.other_lights[0].planes.len(), 1);
    assert_eq!(kept.lights().count(), 2);
}

#[test]
fn impossible_lights_are_refused() {
    for (light, says) in [
        (
            "Point(center: (0.1, 0, 0))",
            "other_lights[0].center is (0.1, 0, 0); allowed: a place on the central ray",
        ),
        (
            "Disc(center: (0, 0, 1.9), radius: 0.1)",
            "allowed: in front of star",
        ),
        (
            "Disc(center: (0, 0, 0.2), radius: 0.1)",
            "allowed: another depth than that of near",
        ),
        (
            "Disc(center: (0, 0, 0), radius: -1)",
            "other_lights[0].radius is -1",
        ),
        (
            "Environment(center: (0, 0, 0), map: Lobes([]))",
            "other_lights[0].map is no lobe",
        ),
        (
            "Rays(center: (0, 0, 0), file: \"no.npy\")",
            "other_lights[0].file",
        ),
    ] {
        let both = format!("light: {FIRST}, other_lights: [{light}]");
        let file = SceneFile::parse(&text(&both, NEAR, "")).unwrap();
        let error = resolve("lights", file, ".".as_ref(), u64::MAX).unwrap_err();
        assert!(error.to_string().contains(says), "{light}: {error}");
    }
}
