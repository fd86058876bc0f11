//! Tests that backward rays invert forward rays and that their density is correct.

use super::super::backward::Back;
use super::*;
use crate::geometry::{AffineMap, from_fn};
use etendue_field::Side;

/// Builds an area light, and surfaces at oblique incidence.
fn bent(surfaces: &[(&str, Specular, f64, [f64; 3])]) -> PathSystem {
    let light = Light::Area {
        shape: Shape::Rectangle(Rectangle {
            center: [0.0; 2],
            size: [1.0; 2],
        }),
        radiance: 1.0,
        exponent: 0.0,
    };
    let mut system = PathSystem::new(light, vec![]);
    for (name, event, theta0, curvature) in surfaces {
        let leg = after(&system, 0.0).frame;
        let patch = Patch {
            aperture: 1.0,
            ..placed(&leg, 0.8, *theta0, [0.3, 0.2], *curvature)
        };
        visit(&mut system, element(name, patch, *event));
    }
    system
}

const GLASS: (&str, Specular, f64, [f64; 3]) = (
    "glass",
    Specular::Refraction {
        front: 1.0,
        back: 1.5,
    },
    0.6,
    [0.3, 0.1, 0.05],
);
const MIRROR: (&str, Specular, f64, [f64; 3]) =
    ("mirror", Specular::Mirror, 0.4, [-0.2, -0.3, -0.1]);

/// Checks that rays followed forward land where they were sampled, and that |∂z/∂ray| agrees with
/// finite differences.
fn come_back(system: &PathSystem, plane: &Plane) {
    let back = Back::new(system, plane);
    for z in [
        [0.0; 4],
        [0.02, -0.01, 0.03, 0.05],
        [-0.05, 0.03, -0.04, 0.1],
    ] {
        let (ray, spread) = back.ray(z).unwrap();
        let lands = |ray| plane.coordinates(&system.follow(ray).unwrap()).unwrap().0;
        for (found, drawn) in lands(ray).into_iter().zip(z) {
            assert!((found - drawn).abs() < 1e-12, "{found} for {drawn}"); // rounding
        }
        let step = 1e-5;
        let beside = |column: usize, side: f64| {
            let mut ray = ray;
            ray[column] += side * step;
            lands(ray)
        };
        let differences = from_fn(|row, column| {
            (beside(column, 1.0)[row] - beside(column, -1.0)[row]) / (2.0 * step)
        });
        let expected = AffineMap::<4>::linear(differences).det().abs();
        // Finite differences have an error of step² times third derivatives.
        assert!(
            (spread / expected - 1.0).abs() < 1e-7,
            "{plane:?}: {spread} {expected}"
        );
    }
}

/// Tests backward rays from planes behind oblique glass, a concave mirror and a lens.
#[test]
fn rays_come_back_to_where_they_were_drawn() {
    let lens = Specular::ThinLens { focal_length: 0.7 };
    let system = bent(&[GLASS, MIRROR, ("lens", lens, 0.2, [0.0; 3])]);
    come_back(&system, &after(&system, 0.5));
}

/// Tests planes on surfaces, for light that leaves the plane's surface and for light that arrives
/// at it.
#[test]
fn rays_come_back_from_surfaces() {
    let through = bent(&[MIRROR, GLASS]);
    let before = bent(&[MIRROR]);
    for arriving in [false, true] {
        let incidence = through.hits().unwrap()[1].incidence;
        let patch = through.surfaces[1].patch;
        let side = if arriving { 1.0 } else { -1.0 };
        let normal = side * patch.frame.d;
        let origin = patch.frame.origin;
        for orientation in [
            Orientation::Tangent,
            Orientation::LocalNormals,
            Orientation::Mirrored,
        ] {
            let is_local = orientation != Orientation::Tangent;
            let mut plane = Plane {
                frame: Frame::new(origin, normal, incidence.b.cross(normal)).unwrap(),
                orientation,
                longitude: 0.0,
                patch: is_local.then_some(patch),
                side: if arriving { Side::Before } else { Side::After },
                quantity: Quantity::Radiance,
            };
            let system = if arriving { &before } else { &through };
            let central = system.follow([0.0; 4]).unwrap();
            plane.longitude = plane.coordinates(&central).unwrap().0[2];
            come_back(system, &plane);
        }
    }
}
