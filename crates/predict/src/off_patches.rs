//! The difference between rays that smooth meshes deflect and the same rays deflected by
//! osculating patches.
//!
//! Theory deflects light of a smooth mesh at the patch that osculates the mesh at the central ray's
//! hit. Here the rays that theory follows into the window are traced again, by the triangles.

use etendue_field::{Complex, Profile, TwoPlane, VirtualPlane, interpolated_normal};
use etendue_scene::{MeshObject, Object, Scene};
use etendue_theory::Observed;
use etendue_theory::path::rays::{LightRay, sampled};
use etendue_transform::SliceTransform;
use glam::DVec3;
use ndarray::Array3;

/// The smallest and the largest number of rays that are followed.
const MIN_RAYS: usize = 300;
const MAX_RAYS: usize = 3000;
/// The largest number of triangles that are tested for all rays together. The smallest number of
/// rays is followed in any case.
const LOOKED_AT: usize = 30_000_000;
/// A triangle counts as a neighbour of the point that a ray leaves if it is nearer than this
/// distance, in edges of the triangle.
const NEIGHBOURS: f64 = 5.0;
/// The displacement that is assigned to light that meets a surface again. It is the largest
/// possible displacement.
const LOST: f64 = 1.0;
/// The largest accepted distance between the two arrivals of a ray, in half-widths of the window.
/// A displacement of rays by this distance changes a spectrum by about ten times as much, and the
/// change is reported.
const MAX_APART: f64 = 1e-4;

/// The difference between two ways to trace rays: by the triangles of smooth meshes, and by the
/// osculating patches.
#[derive(Clone, Copy, Debug)]
pub struct OffPatches {
    /// The root mean square distance between the two arrivals of a ray, in half-widths of the
    /// window. Rays are weighted by their light.
    pub apart: f64,
    /// ‖change of the slices‖, as a share of their value at frequency zero. The number is an upper
    /// estimate: the standard error is added to the value that a sample of rays gives.
    pub change: f64,
}

impl OffPatches {
    /// Describes the difference if it is too large for the patches to represent the meshes.
    pub(crate) fn reason(&self) -> Option<String> {
        let percent = 100.0 * self.apart;
        (self.apart > MAX_APART).then(|| format!(
            "a mesh: its light and the light of its osculating patch arrive {percent:.3} % of the window's half-width apart"
        ))
    }
}

/// A ray that brings light into the window: its predicted arrival, and its arrival by triangles, if
/// any.
struct Displaced {
    predicted: TwoPlane,
    by_triangles: Option<TwoPlane>,
    /// The light of the ray before the window's weight is applied, and after.
    before: f64,
    light: f64,
}

/// The difference between light that smooth meshes deflect and light deflected by their
/// patches; `None` without a mesh, or if no ray brings light into the window.
pub(crate) fn off_patches(
    scene: &Scene,
    plane: &VirtualPlane,
    view: &Observed,
) -> Option<OffPatches> {
    let objects = scene.path.legs[1..=plane.leg].iter();
    let objects = objects.map(|leg| Some(leg.leaves?.object));
    let objects: Vec<Object> = objects.collect::<Option<_>>()?;
    let meshes = objects.iter().filter_map(|object| match object {
        Object::Mesh(i) => Some(scene.meshes[*i].triangles.len()),
        Object::Surface(_) | Object::Patch(_) => None,
    });
    let triangles: usize = meshes.sum();
    if triangles == 0 {
        return None;
    }
    let most = (LOOKED_AT / triangles).clamp(MIN_RAYS, MAX_RAYS);
    let rays = sampled(view, (&plane.window, &plane.grid), most);
    let displaced = rays.into_iter().map(|ray| {
        let LightRay {
            start,
            arrival,
            light,
        } = ray;
        let [x, y, u, v] = arrival;
        let predicted = TwoPlane { x, y, u, v };
        Displaced {
            predicted,
            by_triangles: by_triangles(scene, view, &objects, start),
            before: light,
            light: light * plane.window.value(&predicted),
        }
    });
    let lit: Vec<Displaced> = displaced.filter(|ray| ray.light > 0.0).collect();
    let [all, squares] = lit.iter().fold([0.0; 2], |[all, squares], ray| {
        let apart = ray.apart(plane);
        [all + ray.light, squares + ray.light * apart * apart]
    });
    (all > 0.0).then(|| OffPatches {
        apart: (squares / all).sqrt(),
        change: change(plane, &lit),
    })
}

impl Displaced {
    /// The distance between the two arrivals, in half-widths of the window along the axis
    /// where it is largest.
    fn apart(&self, plane: &VirtualPlane) -> f64 {
        let window = &plane.window;
        let half = [window.x, window.y, window.u, window.v].map(|p| Profile::half_width(&p));
        self.by_triangles.map_or(LOST, |seen| {
            let z = &self.predicted;
            let apart = [seen.x - z.x, seen.y - z.y, seen.u - z.u, seen.v - z.v];
            let shares = apart.iter().zip(half).map(|(d, half)| (d / half).abs());
            shares.fold(0.0, f64::max).min(LOST)
        })
    }
}

/// How much the slices change when triangles deflect the rays instead of patches. The
/// result is the mean of the changes from two halves of the rays, plus its standard error, which is
/// half of their difference.
fn change(plane: &VirtualPlane, lit: &[Displaced]) -> f64 {
    let transform = SliceTransform::new(&plane.grid);
    let mut sum = transform.accumulator();
    let mut half_of = |first: usize| {
        let mut all = 0.0;
        for ray in lit.iter().skip(first).step_by(2) {
            all += ray.light;
            sum.deposit(&ray.predicted, -ray.light);
            if let Some(seen) = &ray.by_triangles {
                sum.deposit(seen, ray.before * plane.window.value(seen));
            }
        }
        sum.finish(if all > 0.0 { 1.0 / all } else { 0.0 }).half
    };
    let [a, b] = [0, 1].map(&mut half_of);
    let norm = |slices: Array3<Complex>| {
        let squares: f64 = slices.iter().map(|s| s.norm_sqr()).sum();
        0.5 * squares.sqrt()
    };
    norm(&a + &b) + norm(a - b)
}

/// The arrival of a ray by the triangles of smooth meshes; `None` if the ray misses a mesh
/// or meets a mesh again. `start` has the ray's position and slopes at the light.
fn by_triangles(
    scene: &Scene,
    view: &Observed,
    objects: &[Object],
    [x, y, u, v]: [f64; 4],
) -> Option<TwoPlane> {
    let mut point = DVec3::new(x, y, 0.0);
    let mut direction = DVec3::new(u, v, 1.0).normalize();
    // A mesh also stops light on the legs that neither begin nor end at it.
    let is_stopped = |leg: usize, point: DVec3, direction: DVec3, end: f64| {
        let ends = [leg.checked_sub(1), Some(leg)].map(|i| objects.get(i?));
        let beside = objects
            .iter()
            .filter(|object| !ends.contains(&Some(object)));
        let mut meshes = beside.filter_map(|object| match object {
            Object::Mesh(i) => Some(&scene.meshes[*i]),
            Object::Surface(_) | Object::Patch(_) => None,
        });
        meshes.any(|mesh| hits(mesh, point, direction, 0.0).any(|(t, _)| t < end))
    };
    for (leg, (surface, object)) in view.system.before_plane().iter().zip(objects).enumerate() {
        let (patch, start) = (&surface.patch, point);
        let mut beyond = None;
        let normal = if let Object::Mesh(i) = object {
            let mesh = &scene.meshes[*i];
            let hits = hits(mesh, point, direction, 0.0);
            let (t, triangle) = hits.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
            point += t * direction;
            let corners = &mesh.triangles[triangle];
            let normals = &mesh.smooth.as_ref()?.normals[triangle];
            let normal = interpolated_normal(corners, normals, point);
            beyond = Some((mesh, NEIGHBOURS * longest_edge(corners)));
            -normal.dot(direction).signum() * normal
        } else {
            let local = patch.frame.to_local(point);
            let hits = patch.hits(local, patch.frame.vector_to_local(direction));
            let ahead = hits.into_iter().filter(|t| *t > 0.0);
            point += ahead.min_by(f64::total_cmp)? * direction;
            patch.normal(point)
        };
        if is_stopped(leg, start, direction, start.distance(point)) {
            return None;
        }
        let event = surface.event()?;
        direction = event
            .turned(&patch.frame, normal, point, direction)?
            .normalize();
        if let Some((mesh, from)) = beyond
            && hits(mesh, point, direction, from).next().is_some()
        {
            return None;
        }
    }
    let frame = &view.plane.frame;
    let end = (frame.origin - point).dot(frame.d) / direction.dot(frame.d);
    if is_stopped(objects.len(), point, direction, end) {
        return None;
    }
    let [x, y, u, v] = view.plane.arrival(point, direction)?;
    Some(TwoPlane { x, y, u, v })
}

/// The distances at which a ray meets triangles of a mesh, beyond a given distance, and the
/// triangles' numbers.
fn hits(
    mesh: &MeshObject,
    point: DVec3,
    direction: DVec3,
    from: f64,
) -> impl Iterator<Item = (f64, usize)> + '_ {
    let triangles = mesh.triangles.iter().enumerate();
    let met =
        triangles.filter_map(move |(i, triangle)| Some((met(triangle, point, direction)?, i)));
    met.filter(move |(t, _)| *t > from)
}

/// The distance along a ray at which it meets a triangle (Möller and Trumbore 1997).
fn met([a, b, c]: &[DVec3; 3], point: DVec3, direction: DVec3) -> Option<f64> {
    let [side, other, from] = [*b - *a, *c - *a, point - *a];
    let across = direction.cross(other);
    let whole = side.dot(across);
    let s = from.dot(across) / whole;
    let turned = from.cross(side);
    let t = direction.dot(turned) / whole;
    let at = other.dot(turned) / whole;
    (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then_some(at)
}

fn longest_edge([a, b, c]: &[DVec3; 3]) -> f64 {
    a.distance(*b).max(b.distance(*c)).max(c.distance(*a))
}
