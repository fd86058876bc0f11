//! Chains and windows for the tests of this crate.

use crate::path::PathMask;
use crate::{Chain, Operator, Source};
use etendue_field::{
    ConvexPolygon, Disc, Grating, HalfPlane, Hole, Light, Mask, Profile, Rectangle, Shape, Window,
};

/// Builds a square light of unit radiance on the central ray, followed by alternating travel and
/// blockers; the planes are named a, b, c, …
pub(crate) fn chain(light: f64, steps: &[(f64, Vec<Rectangle>)]) -> Chain {
    let steps = steps.iter().map(|(distance, blockers)| {
        let mask = (!blockers.is_empty()).then(|| rectangles(blockers));
        (*distance, mask)
    });
    chain_of(lambertian(square([0.0, 0.0], light)), steps)
}

/// Builds a light followed by alternating travel and masks; the planes are named a, b, c, …
pub(crate) fn chain_of(
    light: Light,
    steps: impl IntoIterator<Item = (f64, Option<Mask>)>,
) -> Chain {
    let mut names = ('a'..='z').map(String::from);
    let mut from = names.next().unwrap();
    let mut operators = Vec::new();
    for (distance, mask) in steps {
        let to = names.next().unwrap();
        operators.push(Operator::Travel {
            from: std::mem::replace(&mut from, to.clone()),
            to: to.clone(),
            distance,
        });
        operators.extend(mask.map(|mask| Operator::Visibility { name: to, mask }));
    }
    Chain {
        source: Source {
            name: "light".into(),
            light,
        },
        operators,
    }
}

/// Builds a mask of a path. Its name is that of the first mask of [`chain_of`].
pub(crate) fn mask_at(distance: f64, mask: Mask) -> PathMask {
    PathMask {
        name: "b".into(),
        distance,
        mask,
    }
}

/// Builds a light of unit radiance.
pub(crate) fn lambertian(rectangle: Rectangle) -> Light {
    spot(Shape::Rectangle(rectangle), 0.0)
}

pub(crate) fn spot(shape: Shape, exponent: f64) -> Light {
    Light::Area {
        shape,
        radiance: 1.0,
        exponent,
    }
}

pub(crate) fn rectangles(rectangles: &[Rectangle]) -> Mask {
    opaque(rectangles.iter().copied().map(Shape::Rectangle).collect())
}

pub(crate) fn opaque(shapes: Vec<Shape>) -> Mask {
    Mask::Opaque {
        shapes,
        half_planes: vec![],
    }
}

pub(crate) fn half_plane(axis: usize, edge: f64, above: bool) -> Mask {
    Mask::Opaque {
        shapes: vec![],
        half_planes: vec![HalfPlane { axis, edge, above }],
    }
}

/// Builds an opaque screen with one hole.
pub(crate) fn aperture(shape: Shape) -> Mask {
    Mask::Aperture(Hole::Shape(shape))
}

/// Builds an opaque screen with a convex polygon as its hole.
pub(crate) fn polygon_aperture(corners: &[[f64; 2]]) -> Mask {
    let polygon = ConvexPolygon::new(corners.to_vec()).unwrap();
    Mask::Aperture(Hole::Polygon(polygon))
}

pub(crate) fn grating(axis: usize, frequency: f64, phase: f64) -> Mask {
    Mask::Grating(Grating {
        axis,
        frequency,
        modulation: 0.9,
        phase,
    })
}

pub(crate) fn disc(center: [f64; 2], radius: f64) -> Shape {
    Shape::Disc(Disc { center, radius })
}

pub(crate) fn cosine() -> Operator {
    Operator::Cosine {
        name: "floor".into(),
    }
}

pub(crate) fn square(center: [f64; 2], side: f64) -> Rectangle {
    Rectangle {
        center,
        size: [side, side],
    }
}

/// Builds `count` × `count` squares, displaced from a grid by a fixed pattern.
pub(crate) fn blockers(count: u32, pitch: f64, side: f64) -> Vec<Rectangle> {
    let cells = (0..count).flat_map(|i| (0..count).map(move |j| (f64::from(i), f64::from(j))));
    let middle = 0.5 * (f64::from(count) - 1.0);
    let slack = 0.5 * (pitch - side);
    cells
        .map(|(i, j)| {
            let jitter = [libm::sin(3.1 * i + 7.7 * j), libm::cos(5.3 * i - 2.9 * j)];
            let center = [i - middle, j - middle];
            square([0, 1].map(|k| center[k] * pitch + jitter[k] * slack), side)
        })
        .collect()
}

/// Builds a window with the same profiles along both axes.
pub(crate) fn window(position: Profile, slope: Profile) -> Window {
    Window {
        x: position,
        y: position,
        u: slope,
        v: slope,
    }
}
