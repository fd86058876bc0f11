//! Tests how fast the first-order prediction converges to the exact prediction if the light and
//! the windows shrink and the geometry stays the same.

use super::*;

/// ‖linear − exact‖/‖exact‖ at a size e, where windows and light are e times as wide, and
/// frequencies are 1/e times as high.
fn error(system: &PathSystem, plane: &Plane, widths: [f64; 2], e: f64, print: Edition) -> f64 {
    let window = window(Profile::Hann(widths[0] * e), Profile::Hann(widths[1] * e));
    let grid = grid(3, widths.map(|w| w * e));
    let system = system.shrunk(e, false).unwrap();
    let right = exact(&system, plane, &window, &grid);
    // Most of the error of nets is common to the first-order and the exact prediction.
    assert!(right.error < Some(3e-3), "{:?}", right.error);
    assert!(right.slices.at_zero() > 0.0);
    let map = chain(&view(&system, plane), print).unwrap().map;
    let first = linear(&system, plane, &window, &grid, &map);
    first.slices.relative_difference(&right.slices)
}

/// The power of e with which the error falls.
fn order(system: &PathSystem, plane: &Plane, widths: [f64; 2]) -> f64 {
    let [wide, narrow] = [0.1, 0.05].map(|e| error(system, plane, widths, e, Edition::Corrected));
    assert!(wide < 0.5 && narrow > 0.0, "{wide} {narrow}");
    libm::log2(wide / narrow)
}

#[test]
fn oblique_mirrors_are_of_first_order_and_straight_ones_of_second() {
    let shapes = [[-0.5; 3], [0.4, 0.0, 0.4], [-0.5, -0.2, 0.0]];
    for shape in shapes {
        for turns in [[0.0, 0.0], [0.6, 0.5]] {
            let oblique = mirror(projector([0.4, 0.3]), 0.7, turns, shape);
            let found = order(&oblique, &after(&oblique, 0.4), [0.6, 0.5]);
            // The term of the next power of e is about a tenth of the leading term.
            assert!((found - 1.0).abs() < 0.2, "{found} {shape:?}");
            let straight = mirror(projector([0.4, 0.3]), 0.0, turns, shape);
            let found = order(&straight, &after(&straight, 0.4), [0.6, 0.5]);
            assert!((found - 2.0).abs() < 0.2, "{found} {shape:?}");
        }
    }
}

#[test]
fn beams_refraction_and_two_mirrors_converge() {
    let oblique = mirror(beam([0.4, 0.3]), 0.7, [0.3, 0.2], [-0.5; 3]);
    let mut two = oblique.clone();
    let leg = after(&two, 0.0).frame;
    let patch = placed(&leg, 0.4, -0.5, [1.0, 0.0], [0.3; 3]);
    visit(&mut two, element("second", patch, Specular::Mirror));
    let mut glass = oblique.clone();
    glass.surfaces[0].interaction = Interaction::Specular(Specular::Refraction {
        front: 1.0,
        back: 1.5,
    });
    for system in [oblique, two, glass] {
        let found = order(&system, &after(&system, 0.3), [0.5, 0.5]);
        assert!((found - 1.0).abs() < 0.25, "{found}"); // the next power of e
    }
}

#[test]
fn area_lights_converge() {
    let light = crate::testing::lambertian(crate::testing::square([0.0; 2], 0.3));
    let oblique = mirror(light, 0.7, [0.0, 0.0], [-0.5; 3]);
    let found = order(&oblique, &after(&oblique, 0.4), [0.5, 0.5]);
    assert!((found - 1.0).abs() < 0.25, "{found}");
}

#[test]
fn printed_chains_do_not_converge() {
    let oblique = mirror(projector([0.4, 0.3]), 0.7, [0.0, 0.0], [-0.5, 0.3, 0.0]);
    let plane = after(&oblique, 0.4);
    for print in [Edition::Equations, Edition::Table] {
        let [wide, narrow] = [0.1, 0.05].map(|e| error(&oblique, &plane, [0.6, 0.5], e, print));
        assert!(
            narrow > 0.1 && narrow > 0.8 * wide,
            "{print:?}: {wide} {narrow}"
        );
    }
    assert!(error(&oblique, &plane, [0.6, 0.5], 0.05, Edition::Corrected) < 0.05);
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn planes_on_surfaces_converge() {
    for (system, plane) in read_off::surface_planes() {
        let oblique = plane.longitude.abs() > 0.1;
        let found = order(&system, &plane, [0.5, 0.5]);
        let least = if oblique { 0.75 } else { 1.75 }; // 1 and 2, up to the next power
        assert!(found > least, "{found} {plane:?}");
    }
    for (system, plane) in read_off::surface_planes().into_iter().take(4) {
        for print in [Edition::Equations, Edition::Table] {
            let narrow = error(&system, &plane, [0.5, 0.5], 0.02, print);
            assert!(narrow > 0.1, "{print:?}: {narrow}");
        }
    }
}
