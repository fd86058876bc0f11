//! Measures the distance between the path that theory assumes for a ray and the objects that theory
//! ignores.

use super::rays::CheckRay;
use super::surroundings::{Meets, SurroundingForm, Surroundings};
use etendue_field::{Disc, HalfPlane, Mask, Patch, Rectangle, Shape};
use etendue_scene::{Object, Surface};
use glam::DVec3;

/// A straight piece of the path of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathPiece {
    pub(super) leg: usize,
    pub(super) ray: CheckRay,
    /// Distances along the ray at which the piece begins and ends.
    pub(super) extent: [f64; 2],
    /// The surfaces at which the leg of the ray begins (`leaves`) and ends (`ends`).
    pub(super) leaves: Option<Object>,
    pub(super) ends: Option<Object>,
    /// Whether the piece ends at the plane.
    pub(super) is_last: bool,
}

/// An obstacle that a ray may meet on a leg although theory does not expect it there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Suspect {
    pub(super) leg: usize,
    pub(super) what: What,
}

/// The object, or the part of a layer of blockers, that a ray may meet.
#[derive(Clone, Copy, Debug)]
pub(super) enum What {
    /// A shape of a layer; the layer and the shape are given by index.
    Shape { layer: usize, shape: usize },
    /// A half-plane of a layer.
    HalfPlane { layer: usize, half: usize },
    /// The opaque part of an aperture.
    Aperture { layer: usize },
    /// A grating, which has no edge.
    Grating { layer: usize },
    /// A surface of the path, by its index among the objects of the surroundings.
    Object(usize),
}

/// A ray counts as meeting the surface that ends its leg if the two distances differ by less than
/// this share.
const AT_END: f64 = 1e-6;

impl Suspect {
    /// Returns everything that rays may meet on the legs of the given paths. If a layer has many
    /// shapes, only the shapes nearest to the crossings of these rays are returned.
    pub(super) fn all(around: &Surroundings<'_>, paths: &[&[PathPiece]]) -> Vec<Self> {
        let legs = paths.first().map_or(0, |pieces| pieces.len());
        let on_leg = |leg: usize| {
            let layers = 0..around.scene.blockers.len();
            let layers = layers.filter(move |layer| !around.has_taken(*layer, leg));
            let of_layers = layers.flat_map(move |layer| of_layer(around, layer, paths, leg));
            let objects = (0..around.objects.len()).map(What::Object);
            let things: Vec<What> = of_layers.chain(objects).collect();
            things.into_iter().map(move |what| Self { leg, what })
        };
        (0..legs).flat_map(on_leg).collect()
    }

    /// Returns what is reported for a ray that meets the obstacle.
    pub(super) fn meets(&self, around: &Surroundings<'_>, piece: &PathPiece) -> Meets {
        match self.what {
            What::Shape { layer: index, .. }
            | What::HalfPlane { layer: index, .. }
            | What::Aperture { layer: index }
            | What::Grating { layer: index } => Meets::Layer {
                index,
                leg: self.leg,
            },
            What::Object(i) => {
                let object = around.objects[i].0;
                if [piece.leaves, piece.ends].contains(&Some(object)) {
                    Meets::Itself(object)
                } else {
                    Meets::OutOfTurn(object)
                }
            }
        }
    }

    /// Returns the distance, in metres, by which a piece of a path misses the obstacle. The
    /// distance is zero if the piece meets the obstacle unexpectedly, and infinite if the piece
    /// cannot meet the obstacle.
    pub(super) fn gap(&self, around: &Surroundings<'_>, piece: &PathPiece) -> f64 {
        let (layer, outside): (usize, &dyn Fn(DVec3) -> f64) = match self.what {
            What::Object(i) => return object_gap(around, i, piece),
            What::Grating { layer } => (layer, &|_| 0.0),
            What::Shape { layer, shape } => {
                let Mask::Opaque { shapes, .. } = &around.scene.blockers[layer].mask else {
                    return f64::INFINITY;
                };
                let shape = &shapes[shape];
                (layer, &|at| outside_shape(shape, at))
            }
            What::Aperture { layer } => {
                let Mask::Aperture(hole) = &around.scene.blockers[layer].mask else {
                    return f64::INFINITY;
                };
                (layer, &|at| hole.clearance(at.x, at.y))
            }
            What::HalfPlane { layer, half } => {
                let Mask::Opaque { half_planes, .. } = &around.scene.blockers[layer].mask else {
                    return f64::INFINITY;
                };
                let half = &half_planes[half];
                (layer, &|at| outside_half_plane(half, at))
            }
        };
        let Some(t) = around.crossing(&piece.ray, layer) else {
            return f64::INFINITY;
        };
        let [from, to] = piece.extent;
        let off = if piece.leg > 0 || !around.is_known(layer) {
            beyond(t, [from, to])
        } else {
            // Theory expects the ray to meet the layer within the piece, and would be wrong only if
            // the piece ended earlier.
            (to - t).max(0.0)
        };
        libm::hypot(off, outside(piece.ray.at(t)))
    }
}

/// If a layer has at most this many shapes, all of them are considered on a leg.
const MAX_SHAPES: usize = 64;
/// The number of shapes that are considered if a layer has more than [`MAX_SHAPES`]. The number is
/// small because each shape requires thousands of rays.
const NEAREST_SHAPES: usize = 16;
/// The number of rays whose crossings determine the nearest shapes of a layer.
const CROSSINGS: usize = 300;

/// Returns the parts of a layer that rays may meet on a leg.
fn of_layer(
    around: &Surroundings<'_>,
    layer: usize,
    paths: &[&[PathPiece]],
    leg: usize,
) -> Vec<What> {
    let (shapes, half_planes) = match &around.scene.blockers[layer].mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => (shapes, half_planes),
        Mask::Grating(_) => return vec![What::Grating { layer }],
        Mask::Aperture(_) => return vec![What::Aperture { layer }],
    };
    let mut nearest: Vec<usize> = (0..shapes.len()).collect();
    if shapes.len() > MAX_SHAPES {
        let some = paths.iter().step_by(paths.len().div_ceil(CROSSINGS));
        let crossings = some.filter_map(|pieces| {
            let ray = &pieces[leg].ray;
            Some(ray.at(around.crossing(ray, layer)?))
        });
        let crossings: Vec<DVec3> = crossings.collect();
        let far = |shape: &usize| {
            let distances = crossings
                .iter()
                .map(|at| outside_shape(&shapes[*shape], *at));
            distances.fold(f64::INFINITY, f64::min)
        };
        nearest.sort_by_cached_key(|shape| far(shape).to_bits());
        nearest.truncate(NEAREST_SHAPES);
    }
    let shapes = nearest
        .into_iter()
        .map(|shape| What::Shape { layer, shape });
    let halves = (0..half_planes.len()).map(|half| What::HalfPlane { layer, half });
    shapes.chain(halves).collect()
}

/// Returns how far a number lies outside an interval.
fn beyond(t: f64, [from, to]: [f64; 2]) -> f64 {
    (from - t).max(t - to).max(0.0)
}

/// Returns how far a point in the plane of a shape lies outside the shape, metres.
fn outside_shape(shape: &Shape, at: DVec3) -> f64 {
    match *shape {
        Shape::Rectangle(Rectangle { center, size }) => {
            outside_rectangle([at.x - center[0], at.y - center[1]], size)
        }
        Shape::Disc(Disc { center, radius }) => {
            let off = libm::hypot(at.x - center[0], at.y - center[1]);
            (off - radius).max(0.0)
        }
    }
}

/// Returns how far a point lies outside a rectangle around the origin.
fn outside_rectangle(at: [f64; 2], size: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|axis: usize| (at[axis].abs() - 0.5 * size[axis]).max(0.0));
    libm::hypot(x, y)
}

/// Returns how far a point in the plane of a half-plane lies outside the half-plane, metres.
fn outside_half_plane(half: &HalfPlane, at: DVec3) -> f64 {
    let coordinate = if half.axis == 0 { at.x } else { at.y };
    let off = half.edge - coordinate;
    if half.above { off } else { -off }.max(0.0)
}

/// Returns the distance between a piece of a path and a surface of the path. Theory does not expect
/// the surface on this piece.
fn object_gap(around: &Surroundings<'_>, index: usize, piece: &PathPiece) -> f64 {
    let (object, form) = &around.objects[index];
    let [from, to] = piece.extent;
    let own = |which: Option<Object>| which == Some(*object);
    let extent = match (own(piece.ends), own(piece.leaves), piece.is_last) {
        // Theory expects the ray to end at this surface.
        (true, _, true) => return f64::INFINITY,
        (true, _, false) => [from, to * (1.0 - AT_END)],
        // If light returns to the surface that it has left, it is lost for every position of the
        // plane.
        (false, true, true) => [from, f64::INFINITY],
        _ => piece.extent,
    };
    if extent[0] > extent[1] {
        return f64::INFINITY;
    }
    match form {
        SurroundingForm::Flat(surface) => flat_gap(surface, &piece.ray, extent),
        SurroundingForm::Smooth(patch) => patch_gap(patch, &piece.ray, extent),
        SurroundingForm::Around(corners) => box_gap(corners, &piece.ray, extent),
    }
}

/// Returns the distance between a rectangle and the piece of a ray between two distances along the
/// ray.
fn flat_gap(surface: &Surface, ray: &CheckRay, extent: [f64; 2]) -> f64 {
    let local = ray.seen_from(&surface.frame);
    let t = -local.point.z / local.direction.z;
    if !t.is_finite() {
        return f64::INFINITY;
    }
    let at = local.at(t);
    libm::hypot(
        beyond(t, extent),
        outside_rectangle([at.x, at.y], surface.size),
    )
}

/// Returns the distance between a patch and the piece of a ray between two of its points. The ray
/// may meet the quadric outside the patch or outside the piece, or miss the quadric.
fn patch_gap(patch: &Patch, ray: &CheckRay, extent: [f64; 2]) -> f64 {
    let CheckRay { point, direction } = ray.seen_from(&patch.frame);
    let off = |t: f64| {
        let at = point + t * direction;
        let aside = (libm::hypot(at.x, at.y) - patch.aperture).max(0.0);
        // The distance `below` excludes the other half of a sphere or a cylinder.
        let below = patch.aperture * (-patch.gradient(at).z).max(0.0);
        libm::hypot(libm::hypot(beyond(t, extent), aside), below)
    };
    let curved = DVec3::from(patch.curvature) * direction;
    let (a, b) = (curved.dot(direction), curved.dot(point) + direction.z);
    let c = patch.value(point);
    let squared = b * b - a * c;
    if squared < 0.0 {
        let t = -b / a;
        let at = point + t * direction;
        let passes = (0.5 * patch.value(at) / patch.gradient(at).length()).abs();
        return libm::hypot(off(t), passes);
    }
    let q = -(b + squared.sqrt().copysign(b));
    let roots = [q / a, c / q].into_iter().filter(|t| t.is_finite());
    roots.map(off).fold(f64::INFINITY, f64::min)
}

/// Returns the distance between a piece of a ray and a box around a mesh.
fn box_gap([low, high]: &[DVec3; 2], ray: &CheckRay, [from, to]: [f64; 2]) -> f64 {
    let distance = |t: f64| {
        let at = ray.at(t);
        at.distance(at.clamp(*low, *high))
    };
    // The distance to the box is convex along a line, so an unbounded piece is not followed beyond
    // the box.
    let far = (ray.point - 0.5 * (*low + *high)).length() + low.distance(*high);
    let [mut a, mut b] = [from, to.min(from + far)];
    for _ in 0..60 {
        let third = (b - a) / 3.0;
        if distance(a + third) < distance(b - third) {
            b -= third;
        } else {
            a += third;
        }
    }
    distance(0.5 * (a + b))
}
