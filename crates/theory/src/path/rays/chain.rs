//! The first-order chain of a specular system: the affine maps along its central ray.

use super::central::{CentralHit, Incidence};
use crate::geometry::{AffineMap, Edition, Matrix, SpectrumMap};
use crate::obstacle::LegRay;
use crate::path::{Observed, PathMask, PathSurface, PathSystem};
use crate::plane::Plane;
use crate::step::{ChainAction, ChainStep};
use crate::words::{self, degrees, number};
use etendue_field::{Frame, Orientation, Quantity, Specular};
use glam::DVec3;

/// The chain of first-order maps from the light to a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineChain {
    /// The effect of the chain on spectra of radiance. The factor is the product of |det A| over
    /// all maps and of (n₂/n₁)² over all refractions, because a refraction multiplies radiance by
    /// (n₂/n₁)².
    pub map: SpectrumMap<4>,
    /// The steps in the order of propagation. Steps inside the light and inside the surface of the
    /// plane are omitted.
    pub steps: Vec<ChainStep>,
    /// Distances from the last surface at which rays that left the light parallel to each other
    /// meet, in metres and in ascending order. The distance of a virtual focus behind the surface
    /// is negative. The list has at most two distances. If the plane of incidence is a principal
    /// plane, one distance is for rays in this plane, and the other distance is for rays
    /// perpendicular to this plane.
    pub foci: Vec<f64>,
    /// The length of the first leg, in metres.
    pub(crate) first_leg: f64,
}

/// Derives the chain from the distances, angles and curvatures of the geometry along the central
/// ray. Returns `None` if the ray misses an element or is totally reflected. Also returns `None`
/// for a plane on a lens itself, because no side of a lens is the reference for angles.
///
/// The editions differ in the steps for incidence, curvature and outgoing angle. They do not differ
/// for refraction and lenses, which the paper does not treat.
#[must_use]
pub fn chain(view: &Observed, print: Edition) -> Option<AffineChain> {
    let Observed { system, plane } = view;
    let hits = system.hits()?;
    let mut walk = Walk {
        print,
        steps: Vec::new(),
        frame: Frame::IDENTITY,
        at: "light".into(),
    };
    let elements = system.before_plane();
    let on_last = plane.orientation != Orientation::Orthogonal && !plane.is_arriving();
    let is_lens =
        |element: &PathSurface| matches!(element.event(), Some(Specular::ThinLens { .. }));
    if on_last && elements.last().is_some_and(is_lens) {
        return None;
    }
    let first_leg = match hits.first() {
        Some(hit) => hit.distance,
        None => plane.along(&LegRay::new([0.0; 4]))?,
    };
    let mut travelled = walk.cross(system, first_leg);
    let mut foci = Vec::new();
    for (i, (element, hit)) in elements.iter().zip(&hits).enumerate() {
        walk.travel(hit.distance - travelled, &element.name);
        travelled = 0.0;
        // A plane on the last surface has its coordinates, so light does not travel on.
        let ends_here = on_last && i + 1 == hits.len();
        let across = walk.clone().after(element, hit)?;
        foci = across.foci();
        if ends_here {
            walk.leaving_surface(element, hit, plane)?;
        } else {
            walk = across;
        }
    }
    if !on_last {
        let to = plane.frame.origin - walk.frame.origin;
        let distance = match plane.orientation {
            Orientation::Orthogonal => to.dot(plane.frame.d) / walk.frame.d.dot(plane.frame.d),
            _ => to.dot(walk.frame.d),
        };
        walk.travel(distance - travelled, "plane");
        walk.frame = walk.frame.travelled(distance);
        match plane.orientation {
            Orientation::Orthogonal => walk.reach_frame(&plane.frame),
            _ => walk.arriving_surface(plane),
        }
    }
    let map = walk.map();
    let obstacles = system.obstacles.iter().map(words::obstacle);
    walk.steps
        .extend(obstacles.map(|words| ChainStep::new(words, ChainAction::Other)));
    Some(AffineChain {
        map,
        steps: walk.steps,
        foci,
        first_leg,
    })
}

/// A chain under construction.
#[derive(Clone)]
struct Walk {
    print: Edition,
    steps: Vec<ChainStep>,
    /// The frame of the current leg. Its origin is the start of the leg or the current position
    /// along the leg.
    frame: Frame,
    /// Name of the element that light left last.
    at: String,
}

impl Walk {
    fn map(&self) -> SpectrumMap<4> {
        let all = self.steps.iter().filter_map(ChainStep::map);
        all.fold(identity(), |map, next| map.then(next))
    }

    fn step(&mut self, map: &SpectrumMap<4>, words: String) {
        self.steps
            .push(ChainStep::new(words, ChainAction::Map(*map)));
    }

    fn travel(&mut self, distance: f64, to: &str) {
        if distance != 0.0 {
            let words = words::travel(distance, &self.at, to);
            self.step(&AffineMap::travel(distance).spectrum_map(), words);
        }
        self.at = to.into();
    }

    /// Appends the steps through the masks of the first leg, and returns the distance of the last.
    fn cross(&mut self, system: &PathSystem, first_leg: f64) -> f64 {
        let mut travelled = 0.0;
        for PathMask { distance, mask, .. } in system.masks_before(first_leg) {
            self.travel(distance - travelled, "mask");
            let words = words::mask("", mask);
            self.steps
                .push(ChainStep::new(words, ChainAction::Mask(mask.clone())));
            travelled = *distance;
        }
        travelled
    }

    fn turn(&mut self, angle: f64, into: &str) {
        // A rotation that is only a rounding error is skipped.
        if angle.abs() > 1e-12 {
            self.step(
                &AffineMap::rotation(angle).spectrum_map(),
                words::turn(angle, into),
            );
        }
    }

    /// Appends the steps from a surface to the frame of the leg that leaves it.
    fn after(mut self, element: &PathSurface, hit: &CentralHit) -> Option<Self> {
        if let Some(Specular::ThinLens { focal_length }) = element.event() {
            let map = lens(&element.patch.frame, hit, focal_length)?;
            let name = &element.name;
            let f = number(focal_length);
            let words = format!("map  lens {name}, focal length {f} m: ℓ̂(Ωx − Ωu/f, Ωu)");
            // Flux is conserved. An ideal thin lens at oblique incidence changes radiance, since
            // the determinant of its map is not 1.
            let map = SpectrumMap {
                factor: 1.0,
                ..map.spectrum_map()
            };
            self.step(&map, words);
            self.frame = hit.leaving;
            return Some(self);
        }
        let (shape, theta1) = self.event(element, hit)?;
        self.back(shape, theta1);
        let Incidence { n, t, b, .. } = hit.incidence;
        let (sin, cos) = libm::sincos(theta1);
        let x = if element.event() == Some(Specular::Mirror) {
            let words = format!("map  outgoing angle {}", degrees(theta1));
            self.step(&self.print.outgoing_4d(theta1), words);
            t * cos - n * sin
        } else {
            let words = format!(
                "map  leaving the other side at an angle of {}",
                degrees(theta1)
            );
            let off = AffineMap::<4>::incidence(theta1).inverse()?;
            self.step(&off.spectrum_map(), words);
            -t * cos + n * sin
        };
        let turn = libm::atan2(hit.leaving.x.dot(b), hit.leaving.x.dot(x));
        self.turn(turn, "the frame of the next leg");
        self.frame = hit.leaving;
        Some(self)
    }

    /// Appends the steps onto a surface and into its local normals, and the step of the event at
    /// the surface. Returns the surface's shape operator, and the longitude of the central ray
    /// after the event (for refracted light, directions remain flipped).
    fn event(&mut self, element: &PathSurface, hit: &CentralHit) -> Option<(Matrix<2>, f64)> {
        let incidence = &hit.incidence;
        let theta0 = incidence.theta0;
        self.turn(incidence.turn, "the plane of incidence");
        self.incidence(theta0, &element.name);
        let shape = incidence.shape(&element.patch, hit.arriving.origin);
        self.curvature(shape, theta0);
        if let Some(media) = element.media(incidence) {
            let mut map = AffineMap::<4>::refraction(theta0, &media)?.spectrum_map();
            // Flux is conserved, and radiance is proportional to the square of the refractive
            // index (Nicodemus 1963).
            map.factor /= media.index_ratio().powi(2);
            let theta2 = media.refracted(theta0)?;
            let (before, after) = (number(media.before), number(media.after));
            let words = format!(
                "map  refraction from index {before} to {after}, θ₂ = {}",
                degrees(theta2)
            );
            self.step(&map, words);
            Some((shape, theta2))
        } else {
            self.mirror();
            Some((shape, -theta0))
        }
    }

    fn incidence(&mut self, theta0: f64, name: &str) {
        let words = format!("map  incidence {} onto {name}", degrees(theta0));
        self.step(&self.print.incidence_4d(theta0), words);
    }

    fn curvature(&mut self, shape: Matrix<2>, theta0: f64) {
        let words = format!("map  curvature {}", words::curvature(shape));
        self.step(&self.print.curvature_4d(shape, theta0), words);
    }

    fn mirror(&mut self) {
        let words = "map  mirror: ℓ̂(Ωx, −Ωθ)".into();
        self.step(&AffineMap::mirror().spectrum_map(), words);
    }

    fn back(&mut self, shape: Matrix<2>, theta1: f64) {
        let words = format!("map  back from local normals, {}", words::curvature(shape));
        self.step(&self.print.back_4d(shape, theta1), words);
    }

    /// Appends the steps to a plane on the surface of the last element, for light that leaves it.
    fn leaving_surface(
        &mut self,
        element: &PathSurface,
        hit: &CentralHit,
        plane: &Plane,
    ) -> Option<()> {
        let (shape, theta1) = self.event(element, hit)?;
        if plane.orientation == Orientation::Tangent {
            self.back(shape, theta1);
        }
        let Incidence { n, t, b, .. } = hit.incidence;
        let mut at = Frame {
            x: t,
            y: b,
            d: n,
            ..hit.arriving
        };
        if plane.frame.d.dot(n) < 0.0 {
            // Seen from the other side of the surface, the axes are −T, B and −N. Directions are no
            // longer flipped.
            (at.x, at.d) = (-t, -n);
            let other = crate::geometry::diagonal([-1.0, 1.0, 1.0, -1.0]);
            self.step(
                &AffineMap::linear(other).spectrum_map(),
                "map  seen from the other side".into(),
            );
        }
        let beside = plane.frame.to_local(at.origin).abs().max_element();
        let lean = plane.frame.vector_to_local(at.d).truncate().length();
        if plane.orientation == Orientation::Tangent && beside.max(lean) > 1e-9 {
            // If the surface is a mesh, the plane is tangent to the mesh. The smooth patch that
            // replaces the mesh is slightly tilted relative to this plane.
            let map = onto_leaning(plane, &at, theta1);
            self.step(&map.spectrum_map(), "map  frame of the plane".into());
        } else {
            self.onto_surface(at.x, b, plane);
        }
        Some(())
    }

    /// Appends the steps onto the surface where the leg ends.
    fn arriving_surface(&mut self, plane: &Plane) {
        let incidence = Incidence::new(&self.frame, plane.frame.d);
        self.turn(incidence.turn, "the plane of incidence");
        self.incidence(incidence.theta0, "surface");
        if let Some(patch) = plane
            .patch
            .as_ref()
            .filter(|_| plane.orientation.is_local())
        {
            let shape = incidence.shape(patch, plane.frame.origin);
            self.curvature(shape, incidence.theta0);
        }
        if plane.quantity == Quantity::DifferentialIrradiance {
            let words = "multiply  by the cosine, cos⁺ θ cos² φ";
            self.steps
                .push(ChainStep::new(words, ChainAction::AngleCosine));
        }
        if plane.orientation == Orientation::Mirrored {
            self.mirror();
        }
        self.onto_surface(incidence.t, incidence.b, plane);
    }

    /// Appends the steps from the axes (T, B) to the axes of the plane, with angles measured from
    /// the plane's longitude.
    fn onto_surface(&mut self, t: DVec3, b: DVec3, plane: &Plane) {
        let axis = plane.frame.x;
        let turn = libm::atan2(axis.dot(b), axis.dot(t));
        self.turn(turn, "the plane's axes");
        if plane.longitude != 0.0 {
            let mut map = AffineMap::identity();
            map.offset[2] = -plane.longitude;
            let words = format!("map  angles from {}", degrees(plane.longitude));
            self.step(&map.spectrum_map(), words);
        }
    }

    /// Appends the steps from the leg's frame to the frame of a plane perpendicular to the leg. The
    /// plane may be rotated about D and displaced. Behind a mesh, the plane is slightly tilted,
    /// because the mesh's interpolated normals differ from the normals of the smooth patch that
    /// replaces the mesh.
    fn reach_frame(&mut self, plane: &Frame) {
        let towards = plane.vector_to_local(self.frame.d);
        if libm::hypot(towards.x, towards.y) > 1e-9 {
            let mut map = AffineMap::linear(seen_across(plane, &self.frame));
            let [u, v] = [towards.x, towards.y].map(|t| t / towards.z);
            let moved = plane.to_local(self.frame.origin);
            map.offset = [moved.x, moved.y, u, v];
            self.step(&map.spectrum_map(), "map  frame of the plane".into());
            return;
        }
        let turn = libm::atan2(plane.x.dot(self.frame.y), plane.x.dot(self.frame.x));
        self.turn(turn, "the plane's axes");
        let moved = plane.to_local(self.frame.origin);
        if moved.x.abs().max(moved.y.abs()) > 1e-9 {
            let mut map = AffineMap::identity();
            map.offset = [moved.x, moved.y, 0.0, 0.0];
            self.step(&map.spectrum_map(), "map  origin of the plane".into());
        }
    }

    /// The distances d at which det(P + d Q) = 0. Here x = P x₀ and u = Q x₀ are the
    /// positions and slopes of rays that leave the light parallel to each other, at the positions
    /// x₀.
    fn foci(&self) -> Vec<f64> {
        let map = self.map();
        let at = |i: usize, j: usize| map.matrix[j][i];
        let p = [[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]];
        let q = [[at(2, 0), at(2, 1)], [at(3, 0), at(3, 1)]];
        let det = |m: [[f64; 2]; 2]| m[0][0] * m[1][1] - m[0][1] * m[1][0];
        let (a, c) = (det(q), det(p));
        let b = p[0][0] * q[1][1] + p[1][1] * q[0][0] - p[0][1] * q[1][0] - p[1][0] * q[0][1];
        let size = q.as_flattened().iter().map(|x| x * x).sum::<f64>();
        let mut roots = if a.abs() <= 1e-12 * size {
            vec![-c / b]
        } else {
            let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
            let sum = -0.5 * (b + root.copysign(b));
            vec![sum / a, c / sum]
        };
        roots.retain(|d| d.is_finite() && d.abs() < 1e9);
        roots.sort_by(f64::total_cmp);
        roots
    }
}

/// The map of a thin lens, from the frame of one leg to the frame of the next leg. The map
/// holds to first order about a central ray, which may cross the lens at any point and slope.
///
/// In the lens's own frame positions do not change, and slopes decrease by the position divided by
/// the focal length. If the central ray passes through the lens's centre along its axis, the map
/// is [`AffineMap::thin_lens`].
fn lens(frame: &Frame, hit: &CentralHit, focal_length: f64) -> Option<AffineMap<4>> {
    let [before, after] = [&hit.arriving, &hit.leaving].map(|leg| seen_across(frame, leg));
    let power = AffineMap::<4>::thin_lens(focal_length);
    let map = AffineMap::linear(before).then(&power);
    Some(map.then(&AffineMap::linear(after).inverse()?))
}

/// The derivative of a ray's coordinates in a plane with respect to the ray's coordinates
/// in the frame of a leg. Coordinates are positions and slopes, and the leg meets the plane
/// obliquely.
fn seen_across(plane: &Frame, leg: &Frame) -> Matrix<4> {
    let towards = plane.vector_to_local(leg.d);
    let axes = [leg.x, leg.y].map(|axis| plane.vector_to_local(axis));
    let slopes = [towards.x, towards.y].map(|s| s / towards.z);
    let mut matrix = [[0.0; 4]; 4];
    for (column, axis) in axes.iter().enumerate() {
        for (row, (across, slope)) in [axis.x, axis.y].into_iter().zip(slopes).enumerate() {
            // The position moves along the ray to the plane. The slopes are the slopes of the
            // direction D + u X relative to the plane.
            let moved = across - slope * axis.z;
            matrix[row][column] = moved;
            matrix[row + 2][column + 2] = moved / towards.z.abs();
        }
    }
    matrix
}

/// The map from positions and angles in the plane (X, Y) of a frame to positions and
/// angles at a plane on a surface. The plane may be tilted or displaced relative to the frame;
/// `theta` is the longitude of the central ray.
fn onto_leaning(plane: &Plane, at: &Frame, theta: f64) -> AffineMap<4> {
    let local = |v: DVec3| plane.frame.vector_to_local(v);
    let (sin, cos) = libm::sincos(theta);
    let start = plane.frame.to_local(at.origin);
    let away = local(sin * at.x + cos * at.d);
    // The components are the derivatives of a ray's direction with respect to longitude and
    // latitude.
    let turned = [cos * at.x - sin * at.d, at.y].map(local);
    let slope = [away.x, away.y].map(|w| w / away.z);
    let (flat, up) = (
        libm::hypot(away.x, away.z),
        libm::sqrt(1.0 - away.y * away.y),
    );
    let mut map = AffineMap::identity();
    for (i, axis) in [at.x, at.y].map(local).into_iter().enumerate() {
        for (row, along) in [axis.x, axis.y].into_iter().enumerate() {
            map.matrix[row][i] = along - axis.z * slope[row];
        }
    }
    for (i, w) in turned.into_iter().enumerate() {
        for (row, across) in [w.x, w.y].into_iter().enumerate() {
            map.matrix[row][i + 2] = -start.z * (across - w.z * slope[row]) / away.z;
        }
        map.matrix[2][i + 2] = (away.z * w.x - away.x * w.z) / (flat * flat);
        map.matrix[3][i + 2] = w.y / up;
    }
    let central = [
        start.x - start.z * slope[0],
        start.y - start.z * slope[1],
        libm::atan2(away.x, away.z) - plane.longitude,
        libm::asin(away.y),
    ];
    map.offset = std::array::from_fn(|row| central[row] - theta * map.matrix[row][2]);
    map
}

fn identity() -> SpectrumMap<4> {
    AffineMap::identity().spectrum_map()
}
