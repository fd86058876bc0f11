//! Faults in the holes of apertures.

use super::{PlantedFaults, chained};
use etendue_field::{ConvexPolygon, Hole, Mask};
use etendue_theory::{Chain, Operator};

/// Returns faults of the scene `iris`.
pub(super) fn faults() -> PlantedFaults {
    vec![
        (
            "hole of the stop 1 % too wide",
            chained(|c| scale_hole(c, "stop", 1.01)),
        ),
        (
            "hole of the iris 1 % too wide",
            chained(|c| scale_hole(c, "iris", 1.01)),
        ),
        (
            "hole of the iris turned by 90 degrees",
            chained(|c| each_hole(c, "iris", turned)),
        ),
    ]
}

/// Changes the hole of the aperture with the given name.
fn each_hole(chain: &mut Chain, aperture: &str, change: impl Fn(&Hole) -> Hole) {
    for operator in &mut chain.operators {
        if let Operator::Visibility {
            name,
            mask: Mask::Aperture(hole),
        } = operator
            && name == aperture
        {
            *hole = change(hole);
        }
    }
}

/// Scales the hole of the aperture with the given name about the central ray.
fn scale_hole(chain: &mut Chain, aperture: &str, factor: f64) {
    each_hole(chain, aperture, |hole| hole.mapped(factor, [0.0; 2]));
}

/// Turns the corners of a polygon by 90 degrees about the central ray.
fn turned(hole: &Hole) -> Hole {
    match hole {
        Hole::Polygon(polygon) => {
            let corners = polygon.corners().iter().map(|[x, y]| [-y, *x]);
            let turned = ConvexPolygon::new(corners.collect());
            Hole::Polygon(turned.expect("a turned polygon is convex"))
        }
        Hole::Shape(_) => hole.clone(),
    }
}
