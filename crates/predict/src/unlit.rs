//! Finds planes that no light reaches, because of objects on the first leg or black surfaces.

use crate::chain::stands_before;
use crate::theories::Theory;
use etendue_field::{Mask, Orientation, Profile, Shape, VirtualPlane, Window};
use etendue_scene::{BlockerLayer, Event, Object, Scene};
use glam::DVec3;

/// The lowest and highest coordinate of a rectangle along each of two axes.
type Extent = [[f64; 2]; 2];

/// No limits.
const UNLIMITED: Extent = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
/// The largest slope of light that is considered.
const MAX_SLOPE: f64 = 1e3;
/// If at most this share of the rays of a section remains, the remainder is attributed to rounding
/// errors.
const ROUNDING: f64 = 1e-12;
/// A layer is assumed to have holes if its shapes leave more open parts than this number.
const MOST_PARTS: usize = 4096;

/// The reason why no light reaches a plane, in words; `None` where light may reach the
/// plane.
///
/// The rays of a section are points (position at the light, slope). Half-planes and holes cut the
/// set of these rays to a convex polygon, which is empty if no ray passes. No ray passes either if a
/// layer covers every place where rays cross its plane.
pub(crate) fn reason(scene: &Scene, plane: &VirtualPlane, theory: &Theory) -> Option<String> {
    let visited = scene.path.legs[1..=plane.leg].iter();
    let mut visited = visited.filter_map(|leg| Some(leg.leaves.as_ref()?.object));
    if let Some(black) = visited.find(|object| is_black(scene, *object)) {
        return Some(format!("{} reflects no light", scene.name_of(black)));
    }
    let layers = scene.blockers.iter();
    let layers = layers.filter(|layer| {
        stands_before(layer.distance, scene, plane) && is_met_by_all(scene, plane, theory, layer)
    });
    let layers: Vec<&BlockerLayer> = layers.collect();
    let mut sections = [0, 1].map(|axis| RaySection::new(scene, plane, axis));
    for (axis, section) in sections.iter_mut().enumerate() {
        let whole = section.measure();
        let mut cuts: Vec<&str> = Vec::new();
        for layer in &layers {
            for [side, edge] in ends(&layer.mask, axis) {
                section.clip([side, side * layer.distance, -side * edge]);
                cuts.push(&layer.name);
            }
        }
        cuts.dedup();
        if whole > 0.0 && section.measure() <= ROUNDING * whole {
            let block = if cuts.len() == 1 {
                "blocks"
            } else {
                "together block"
            };
            let layers = cuts.join(" and ");
            return Some(format!("{layers} {block} all paths of light"));
        }
    }
    let covering = layers
        .into_iter()
        .find(|layer| covers(layer, &sections, scene, plane));
    covering.map(|layer| format!("{} blocks all paths of light", layer.name))
}

/// Checks whether all light of a path meets a layer before it meets a surface or the plane.
fn is_met_by_all(
    scene: &Scene,
    plane: &VirtualPlane,
    theory: &Theory,
    layer: &BlockerLayer,
) -> bool {
    let is_straight = plane.leg == 0 && plane.orientation == Orientation::Orthogonal;
    let ends = || ends_of_first_leg(scene, plane);
    theory.path().is_none() || is_straight || ends().iter().all(|end| end.z > layer.distance)
}

/// Returns points around all places at which light for a plane ends its first leg.
fn ends_of_first_leg(scene: &Scene, plane: &VirtualPlane) -> Vec<DVec3> {
    let Some(hit) = scene.path.ends_at(0) else {
        return vec![DVec3::ZERO];
    };
    let (flat, whole) = match hit.object {
        Object::Surface(i) => (true, scene.surfaces[i].corners().to_vec()),
        Object::Mesh(i) => (false, scene.meshes[i].triangles.bounds().to_vec()),
        Object::Patch(i) => {
            let patch = &scene.patches[i].patch;
            let is_flat = patch.curvature.iter().all(|k| *k == 0.0);
            (is_flat, patch.corners().to_vec())
        }
    };
    let Window { x, y, u, v } = &plane.window;
    let [position, slope] =
        [[x, y], [u, v]].map(|[a, b]| libm::hypot(a.half_width(), b.half_width()));
    let normal = hit.normal;
    let radius = match plane.leg {
        0 => position,
        1 => {
            // At a distance r from the central hit, the surface is at most r sin θ farther from the
            // plane, and r cos θ or more away from the central ray.
            let cos = scene.path.legs[1].frame.d.dot(normal).abs();
            let room = cos - slope * (1.0 - cos * cos).max(0.0).sqrt();
            (position + scene.path.along(plane) * slope) / room
        }
        _ => f64::INFINITY,
    };
    let reach = whole.iter().map(|corner| corner.distance(hit.point));
    let is_narrow = radius > 0.0 && radius < reach.fold(0.0, f64::max);
    if !(flat && is_narrow) {
        return whole;
    }
    let (s, t) = normal.any_orthonormal_pair();
    [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]]
        .map(|[a, b]| hit.point + radius * (a * s + b * t))
        .to_vec()
}

/// Checks whether a surface reflects no light because each of its albedos is 0.
fn is_black(scene: &Scene, object: Object) -> bool {
    match object {
        Object::Surface(i) => scene.surfaces[i].albedo <= 0.0,
        Object::Mesh(i) => scene.meshes[i].albedo.is_some_and(|albedo| albedo <= 0.0),
        Object::Patch(i) => match &scene.patches[i].event {
            Event::Reflects(sum) => sum.terms.iter().all(|term| term.brdf.albedo <= 0.0),
            Event::Specular(_) => false,
        },
    }
}

/// The edges across an axis beyond which a mask is opaque: the edges of half-planes, or the
/// ends of the hole of an aperture. Each edge is given as a sign and a coordinate. The mask is open
/// only where the sign times the coordinate less the edge is positive.
fn ends(mask: &Mask, axis: usize) -> Vec<[f64; 2]> {
    match mask {
        Mask::Opaque { half_planes, .. } => {
            let across = half_planes.iter().filter(|half| half.axis == axis);
            let side = |above| if above { -1.0 } else { 1.0 };
            across.map(|half| [side(half.above), half.edge]).collect()
        }
        Mask::Aperture(hole) => {
            let [low, high] = hole.bounds().extent(axis);
            vec![[1.0, low], [-1.0, high]]
        }
        Mask::Grating(_) => Vec::new(),
    }
}

/// The rays of a section along X or Y: a convex polygon of (position at the light, slope), or a
/// segment.
struct RaySection(Vec<[f64; 2]>);

impl RaySection {
    fn new(scene: &Scene, plane: &VirtualPlane, axis: usize) -> Self {
        let window = &plane.window;
        let [position, slope] =
            [[&window.x, &window.u], [&window.y, &window.v]][axis].map(Profile::half_width);
        // Light from positions beyond this limit arrives only at slopes larger than `MAX_SLOPE`.
        let far = MAX_SLOPE * (plane.distance + position);
        let ends = scene.light.extent(axis);
        let [low, high] = ends.map(|x| if x.is_finite() { x } else { far.copysign(x) });
        let most = scene.light.steepest(axis).min(MAX_SLOPE);
        let corners = [[low, -most], [high, -most], [high, most], [low, most]];
        let mut section = Self(corners.to_vec());
        // A plane on a surface has other coordinates than a plane across the leg.
        if plane.leg == 0 && plane.orientation == Orientation::Orthogonal {
            for side in [-1.0, 1.0] {
                section.clip([side, side * plane.distance, position]);
                section.clip([0.0, side, slope]);
            }
        }
        section
    }

    /// Keeps the part with a·position + b·slope + c ≥ 0.
    fn clip(&mut self, [a, b, c]: [f64; 3]) {
        let value = |[s, u]: [f64; 2]| a * s + b * u + c;
        let corners = std::mem::take(&mut self.0);
        for (i, &p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % corners.len()];
            let [at_p, at_q] = [value(p), value(q)];
            if at_p >= 0.0 {
                self.0.push(p);
            }
            if (at_p < 0.0) != (at_q < 0.0) {
                let t = at_p / (at_p - at_q);
                self.0.push([0, 1].map(|k| p[k] + t * (q[k] - p[k])));
            }
        }
    }

    /// Twice the area, or the length of a degenerate polygon.
    fn measure(&self) -> f64 {
        let [positions, slopes] = [0, 1].map(|k| {
            let [low, high] = extent(self.0.iter().map(|corner| corner[k]));
            (high - low).max(0.0)
        });
        if positions <= 0.0 || slopes <= 0.0 {
            return positions + slopes;
        }
        let pairs = self.0.iter().zip(self.0.iter().cycle().skip(1));
        pairs
            .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
            .sum::<f64>()
            .abs()
    }

    /// The interval where the rays cross a plane at a distance from the light.
    fn at(&self, distance: f64) -> [f64; 2] {
        extent(self.0.iter().map(|[s, u]| s + distance * u))
    }
}

fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    })
}

/// Checks whether a layer stops all rays of both sections on their way to the first surface.
fn covers(
    layer: &BlockerLayer,
    sections: &[RaySection; 2],
    scene: &Scene,
    plane: &VirtualPlane,
) -> bool {
    let Mask::Opaque { shapes, .. } = &layer.mask else {
        return false;
    };
    // A plane before the surface also sees light that passes beside the surface.
    let is_beyond = plane.leg > 0 || plane.orientation.is_local();
    let towards = if is_beyond {
        towards_surface(scene, sections, layer.distance)
    } else {
        UNLIMITED
    };
    let crossed = [0, 1].map(|axis| {
        let [low, high] = sections[axis].at(layer.distance);
        [low.max(towards[axis][0]), high.min(towards[axis][1])]
    });
    let mut open = vec![crossed];
    for shape in shapes {
        open = open.iter().flat_map(|part| without(part, shape)).collect();
        if open.len() > MOST_PARTS {
            return false;
        }
    }
    open.is_empty()
}

/// The region of a plane that lines from the light to the first surface cross, if this
/// surface is smooth.
fn towards_surface(scene: &Scene, sections: &[RaySection; 2], distance: f64) -> Extent {
    let Some(Object::Patch(i)) = scene.path.ends_at(0).map(|hit| hit.object) else {
        return UNLIMITED;
    };
    let corners = scene.patches[i].patch.corners();
    if corners.iter().any(|corner| corner.z <= distance) {
        return UNLIMITED;
    }
    [0, 1].map(|axis| {
        let from = sections[axis].at(0.0);
        extent(
            corners
                .iter()
                .flat_map(|to| from.map(|from| from + distance / to.z * (to[axis] - from))),
        )
    })
}

/// The parts of a rectangle that a shape leaves uncovered.
fn without(part: &Extent, shape: &Shape) -> Vec<Extent> {
    let [[x0, x1], [y0, y1]] = *part;
    match shape {
        Shape::Disc(disc) => {
            let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
            let covered = corners.iter().all(|[x, y]| disc.contains(*x, *y));
            if covered { Vec::new() } else { vec![*part] }
        }
        Shape::Rectangle(rectangle) => {
            let [[a0, a1], [b0, b1]] = [0, 1].map(|axis| rectangle.extent(axis));
            if a0 >= x1 || a1 <= x0 || b0 >= y1 || b1 <= y0 {
                return vec![*part];
            }
            let [left, right] = [a0.max(x0), a1.min(x1)];
            let parts = [
                [[x0, left], [y0, y1]],
                [[right, x1], [y0, y1]],
                [[left, right], [y0, b0]],
                [[left, right], [b1, y1]],
            ];
            let parts = parts.into_iter();
            parts
                .filter(|[[x0, x1], [y0, y1]]| x0 < x1 && y0 < y1)
                .collect()
        }
    }
}
