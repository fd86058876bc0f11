//! Rays followed back come from where rays go, with the density of that.

use super::super::back::Back;
use super::*;
use crate::geometry::{Map, from_fn};

/// Through glass aslant, a hollow mirror and a lens: forward again they land where they were drawn,
/// and |∂z/∂ray| is that of differences.
#[test]
fn rays_come_back_to_where_they_were_drawn() {
    let glass = Specular::Refraction {
        front: 1.0,
        back: 1.5,
    };
    let lens = Specular::ThinLens { focal_length: 0.7 };
    let light = Light::Area {
        shape: Shape::Rectangle(Rectangle {
            center: [0.0; 2],
            size: [1.0; 2],
        }),
        radiance: 1.0,
        exponent: 0.0,
    };
    let mut system = system(light, vec![]);
    for (name, event, theta0, curvature) in [
        ("glass", glass, 0.6, [0.3, 0.1, 0.05]),
        ("mirror", Specular::Mirror, 0.4, [-0.2, -0.3, -0.1]),
        ("lens", lens, 0.2, [0.0; 3]),
    ] {
        let leg = after(&system, 0.0).frame;
        let patch = placed(&leg, 0.8, theta0, [0.3, 0.2], curvature);
        system.elements.push(element(name, patch, event));
    }
    let plane = after(&system, 0.5);
    let back = Back::new(&system, &plane).unwrap();
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
        let expected = Map::<4>::linear(differences).det().abs();
        // Differences are good to step² times third derivatives.
        assert!(
            (spread / expected - 1.0).abs() < 1e-7,
            "{spread} {expected}"
        );
    }
}
