//! Tests scenes with several lights: sound scenes pass, and theory with a changed light fails.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{edited, measured, resolved, verdicts};
use etendue_compare::{Class, Verdict};
use etendue_predict::Applicability;
use etendue_scene::Scene;
use etendue_trace::AllLights;

/// A scene with several lights before a surface. `rest` has the fields after the surface.
fn scene(lights: &str, surface: &str, rest: &str) -> Scene {
    let text = format!(
        "({lights}, surfaces: [{surface}], \
         path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"it\"]), {rest}, \
         window: (x: Hann(0.3), u: Hann(0.4)), \
         frequencies: (azimuths: 4, rho: (max: 10), nu: (max: 10)), run: (photons: 400_000))"
    );
    resolved("lights", &text)
}

#[test]
fn photons_and_backward_rays_agree_with_theory() {
    let planes =
        r#"planes: [(name: "before", at: Before("it")), (name: "after", at: After("it"))]"#;
    let lights = "light: Rectangle(center: (0, 0, 0), size: (0.2, 0.1)), other_lights: [\
        Spot(center: (0.2, -0.1, -0.4), bulb: Square(0.2), exponent: 5), \
        Disc(center: (-0.2, 0, 0.3), radius: 0.1)], \
        blockers: [Grating(name: \"bars\", center: (0, 0, 0.6), axis: X, frequency: 4)]";
    let narrow = "light: Beam(center: (0, 0, 0), image: (width: (0.3, 0.3))), other_lights: [\
        Disc(center: (0.2, 0, 0), radius: 0.1, radiance: 100), Point(center: (0, 0, 0.1))]";
    let floor = r#"Rectangle(name: "it", center: (0, 0, 1), size: (9, 9))"#;
    let mirror = r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.3, 0, -1), form: Sphere(-0.3), aperture: 0.9, event: Mirror)"#;
    let gloss = r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.3, 0, -1), form: Plane, aperture: 2, event: Reflects(brdf: (lobe: Phong(20))))"#;
    let behind = r#"planes: [(name: "behind", at: Distance(1.4))]"#;
    for (name, scene, class) in [
        ("two_lights", edited("two_lights", &[]), Class::Exact),
        ("diffuse", scene(lights, floor, planes), Class::Exact),
        ("mirror", scene(lights, mirror, behind), Class::FirstOrder),
        ("gloss", scene(narrow, gloss, behind), Class::FirstOrder),
    ] {
        for plane in &scene.planes {
            let theory = Applicability::new(&scene, plane);
            assert_eq!(theory.class(), class, "{name}: {:?}", theory.reasons);
        }
        let photons = measured(&scene, &AllLights::photons(&scene));
        let backward = measured(&scene, &AllLights::backward(&scene).unwrap());
        for measurement in [photons, backward] {
            for verdict in verdicts(&scene, &measurement, &scene) {
                assert_eq!(verdict, Verdict::Pass, "{name}");
            }
        }
    }
}

/// Plants faults in the second light of the scene for theory.
#[test]
fn theory_with_a_changed_light_fails() {
    let second = "Disc(center: (0.45, 0.1, -0.3), radius: 0.15, radiance: 2),";
    let traced = edited("two_lights", &[]);
    let photons = measured(&traced, &AllLights::photons(&traced));
    for (fault, part, wrong) in [
        ("offset", "0.45,", "0.453,"),
        ("depth", "-0.3)", "-0.306)"),
        ("power", "radiance: 2", "radiance: 2.04"),
        ("size", "0.15,", "0.151,"),
        ("left out", second, ""),
    ] {
        let changed = second.replace(part, wrong);
        assert_ne!(changed, second);
        let predicted = edited("two_lights", &[(second, &changed)]);
        let found = verdicts(&traced, &photons, &predicted);
        assert!(found.contains(&Verdict::Fail), "{fault}: {found:?}");
    }
}

/// If no theory applies to one light, none applies to the sum, and the reasons name the lights.
#[test]
fn reasons_name_their_lights() {
    let slat = "shapes: [Rectangle(center: (0, 0), size: (0.3, 4))]";
    let star = "mesh: Star(radius: 0.2, relief: 0.3, lobes: 5, rings: 120)";
    let scene = edited("two_lights", &[(slat, star), ("Shapes(", "Mesh(")]);
    let plane = scene.plane_named("leaving").unwrap();
    let theory = Applicability::new(&scene, &scene.planes[plane]);
    assert_eq!(theory.class(), Class::Reference);
    for number in ["light 1: ", "light 2: "] {
        let named = |reason: &String| reason.starts_with(number);
        assert!(theory.reasons.iter().any(named), "{:?}", theory.reasons);
    }
    let steps = theory.steps(&scene, &scene.planes[plane]).join("\n");
    assert!(steps.contains("light 2  source"), "{steps}");
}
