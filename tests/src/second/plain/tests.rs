//! Tests of the plain tracer.

use super::*;

/// Scenes in which light crosses a mask on its way back that stands before its lamp.
const MASKS_BEFORE_A_LAMP: [&str; 2] = [
    include_str!("../../../../scenes/wild/ledge_behind_a_light.ron"),
    include_str!("../../../../scenes/wild/hole_behind_a_light.ron"),
];

fn pair(text: &str, fault: Option<&str>) -> Pair {
    let file = SceneFile::parse(text).unwrap();
    let world = PlainWorld::new(&file).unwrap();
    let mut scene = resolve("plain", file, Path::new("."), u64::MAX).unwrap();
    assert!(fault.is_none_or(|fault| planted::plant(fault, &mut scene)));
    judged(world, &scene, 1 << 18)
}

/// Checks that photons find the light of the paths, and could show a difference.
fn agrees(text: &str) {
    let found = pair(text, None);
    assert!(found.is_resolved() && found.deviation().abs() < MAX_DEVIATION);
}

#[test]
fn light_crosses_masks_behind_its_lamp_on_the_way_back() {
    for text in MASKS_BEFORE_A_LAMP {
        let sound = pair(text, None);
        assert!(sound.is_lit() && sound.deviation().abs() < MAX_DEVIATION);
        let forgotten = pair(text, Some(FAULTS[0])).deviation();
        assert!(forgotten > 10.0, "{forgotten}");
        let moved = pair(text, Some(FAULTS[4])).deviation();
        assert!(moved.abs() > 10.0, "{moved}");
    }
}

/// Scenes of two surfaces, whose apertures, tilts and albedos differ: light that is sent to the
/// second surface first arrives at the plane differently, or not at all.
const TWO_SURFACES: [&str; 2] = [
    r#"(light: Rectangle(center: (0, 0, 0), size: (0.2, 0.1), radiance: 1),
        surfaces: [
            Smooth(name: "a", center: (0, 0, 1), facing: (1, 0, -1), form: Plane,
                aperture: 0.3, event: Mirror),
            Smooth(name: "b", center: (1, 0, 1), facing: (-1, 0, 1.2), form: Plane,
                aperture: 0.15, event: Mirror),
        ],
        path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["a", "b"]),
        planes: [(name: "p", at: Distance(2.5))],
        window: (x: Hann(0.3), u: Hann(0.2)),
        frequencies: (azimuths: 1, rho: (max: 1), nu: (max: 1)), run: (photons: 1000))"#,
    r#"(light: Disc(center: (0, 0, 0), radius: 0.2, radiance: 1),
        surfaces: [
            Rectangle(name: "a", center: (0, 0, 1), size: (0.6, 1), facing: (0.3, 0, -1),
                albedo: 0.9),
            Rectangle(name: "b", center: (1, 0, 0.2), size: (1, 0.4), facing: (-1, 0, 0.4),
                albedo: 0.4),
        ],
        path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["a", "b"],
            leaves: (-1, 0, 0.9)),
        planes: [(name: "p", at: Distance(2.8))],
        window: (x: Hann(0.4), u: Hann(0.4)),
        frequencies: (azimuths: 1, rho: (max: 1), nu: (max: 1)), run: (photons: 1000))"#,
];

#[test]
fn two_surfaces_in_the_wrong_order_are_found() {
    for text in TWO_SURFACES {
        agrees(text);
        let swapped = pair(text, Some("two surfaces visited in the wrong order"));
        assert!(swapped.deviation().abs() > 10.0, "{}", swapped.photons);
    }
}

#[test]
fn light_on_one_side_alone_is_a_difference() {
    let lit = Estimate {
        mean: 1.0,
        error: 0.01,
        count: MIN_LIT,
    };
    let [dark, bright] = [Estimate::ZERO, lit].map(|photons| Pair {
        plain: lit,
        photons,
        is_faint: false,
    });
    assert!(dark.deviation().abs() > 99.0 && bright.deviation().abs() < MAX_DEVIATION);
}

#[test]
fn light_along_the_normal_of_glass_goes_on() {
    let text = r#"(light: Disc(center: (0, 0, 0), radius: 0.2, radiance: 1),
        surfaces: [Smooth(name: "glass", center: (0, 0, 1), facing: (0, 0, -1), form: Plane,
            aperture: 1, event: Refraction(front: 1, back: 1.5))],
        path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["glass"]),
        planes: [(name: "p", at: Distance(1.5))],
        window: (x: Hann(0.2), u: Hann(0.1)),
        frequencies: (azimuths: 1, rho: (max: 1), nu: (max: 1)), run: (photons: 1000))"#;
    agrees(text);
}

/// A lens that stands partly behind the plane of the sky receives its light only before this plane.
#[test]
fn light_of_the_sky_goes_forward_from_its_plane() {
    let text = r#"(light: Environment(center: (0, 0, 0), up: (0, 1, 0), front: (0, 0, 1),
            map: Lobes([(from: (-0.4, 0, -1), width: 0.4)])),
        surfaces: [Smooth(name: "lens", center: (0, 0, 0.1), facing: (-0.7, 0, 0.7), form: Plane,
            aperture: 0.4, event: ThinLens(-0.7))],
        path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["lens"]),
        planes: [(name: "p", at: Distance(0.8))],
        window: (x: Hann(0.3), u: Hann(0.3)),
        frequencies: (azimuths: 1, rho: (max: 1), nu: (max: 1)), run: (photons: 1000))"#;
    agrees(text);
}

/// Light of the sky that would come through the surface from behind meets another part of it.
#[test]
fn a_curved_surface_shades_the_part_that_faces_away() {
    let text = r#"(light: Environment(center: (0, 0, -0.1), up: (0, 1, 0), front: (0, 0, 1),
            map: Lobes([(from: (-0.1, -0.8, -0.5), width: 0.6)])),
        surfaces: [Smooth(name: "s", center: (0, 0, 0.8), facing: (-0.2, 0.5, -0.8),
            form: Paraboloid(0.05, 0.7), aperture: 0.7,
            event: Reflects(brdf: (lobe: Lambertian)))],
        path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["s"]),
        planes: [(name: "p", at: Distance(1))],
        window: (x: Box(0.5), u: Hann(0.1)),
        frequencies: (azimuths: 1, rho: (max: 1), nu: (max: 1)), run: (photons: 1000))"#;
    agrees(text);
}

#[test]
fn photons_find_the_light_that_scene_files_describe() {
    let section = plain(&PlainOptions {
        scenes: 24,
        first: 0,
        seed: 5,
        photons: 1 << 16,
        scene: None,
        planted: false,
        out: std::env::temp_dir(),
    });
    let section = section.unwrap();
    assert!(section.passes(), "{}", section.markdown());
}
