//! Measures the difference between light that smooth meshes deflect and light deflected by
//! osculating patches.

use super::coordinates::coordinates;
use super::mesh_error::OffPatches;
use super::rays::{CheckRay, RayDraw, bright, density, offset_of};
use super::specular::{Follower, PlaneArrival, on};
use etendue_field::{Complex, Light, Profile, TwoPlane, interpolated_normal};
use etendue_scene::{MeshObject, Object};
use etendue_transform::SliceTransform;
use glam::DVec3;
use ndarray::Array3;

/// The number of rays that are drawn to find rays with light in the window.
const TRIES: u32 = 300_000;
/// The smallest and the largest number of rays that are followed. All of them bring light into the
/// window.
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

/// A ray that brings light into the window: its predicted arrival, and its arrival by triangles, if
/// any.
struct Displaced {
    predicted: TwoPlane,
    by_triangles: Option<TwoPlane>,
    /// The light of the ray before the window's weight is applied.
    before: f64,
}

impl Follower<'_> {
    /// Returns the difference between light that smooth meshes deflect and light deflected by
    /// their patches; `None` without a mesh.
    pub(super) fn off_patches(&self) -> Option<OffPatches> {
        let legs = &self.scene.path.legs[1..=self.plane.leg];
        let objects = legs.iter().filter_map(|leg| Some(leg.leaves?.object));
        let meshes = objects.filter_map(|object| match object {
            Object::Mesh(i) => Some(self.scene.meshes[i].triangles.len()),
            Object::Surface(_) | Object::Patch(_) => None,
        });
        let triangles: usize = meshes.sum();
        if triangles == 0 {
            return None;
        }
        let most = (LOOKED_AT / triangles).clamp(MIN_RAYS, MAX_RAYS);
        let draws = || (0..TRIES).map(RayDraw::new);
        match self.system.light {
            // Rays are uniform in the window, and their volume in phase space does not change on
            // the way.
            Light::Environment { .. } => {
                self.displacement(draws().filter_map(|draw| self.ray_of_window(&draw)), most)
            }
            _ => self.displacement(draws().filter_map(|draw| self.weighted(&draw)), most),
        }
    }

    /// Returns a ray of the light, and the relative amount of light that it represents.
    fn weighted(&self, draw: &RayDraw) -> Option<(CheckRay, f64)> {
        let (ray, strength) = self.ray(draw)?;
        let patch = &self.system.elements.first()?.patch;
        let length = ray.theory_hit(patch)?;
        let [point, normal] = on(patch, ray.at(length));
        let center = patch.frame.to_local(self.scene.path.ends_at(0)?.point);
        let offset = patch.frame.to_local(point) - center;
        let drawn = [offset.x, offset.y].map(|d| d / (2.0 * patch.aperture));
        // A unit area on the tangent plane at the vertex has this apparent area when it is seen
        // along the ray.
        let area = ray.direction.dot(normal) / normal.dot(patch.frame.d);
        let on_surface = strength * area.abs() / density(drawn);
        let squared = length * length;
        Some(match &self.system.light {
            Light::Area { shape, .. } => {
                let (area, offset) = offset_of(shape, ray.point);
                let on_light = area * ray.direction.z / density(offset);
                (ray, on_surface * on_light / squared)
            }
            Light::Beam { .. } => (ray, on_surface),
            _ => (ray, on_surface / squared),
        })
    }

    /// Measures the difference between smooth meshes and their patches for at most a given number
    /// of rays. Returns `None` if no ray brings light into the window.
    fn displacement(
        &self,
        rays: impl Iterator<Item = (CheckRay, f64)>,
        most: usize,
    ) -> Option<OffPatches> {
        let displaced = |(ray, emitted): (CheckRay, f64)| {
            let (predicted, share) = self.theory(ray)?;
            let before = emitted * share;
            let light = before * self.plane.window.value(&predicted);
            (light > 0.0).then(|| {
                let by_triangles = self.by_triangles(ray).map(|(seen, _)| seen);
                let displaced = Displaced {
                    predicted,
                    by_triangles,
                    before,
                };
                (light, displaced)
            })
        };
        let lit = bright(rays.filter_map(displaced), most);
        let [all, squares] = lit.iter().fold([0.0; 2], |[all, squares], (light, ray)| {
            [all + light, squares + light * self.apart(ray).powi(2)]
        });
        (all > 0.0).then(|| OffPatches {
            apart: (squares / all).sqrt(),
            change: self.change(&lit),
        })
    }

    /// Returns the distance between the two arrivals of a ray, in half-widths of the window along
    /// the axis where it is largest.
    fn apart(&self, ray: &Displaced) -> f64 {
        let window = &self.plane.window;
        let half = [window.x, window.y, window.u, window.v].map(|p| Profile::half_width(&p));
        ray.by_triangles.map_or(LOST, |seen| {
            let z = &ray.predicted;
            let apart = [seen.x - z.x, seen.y - z.y, seen.u - z.u, seen.v - z.v];
            let shares = apart.iter().zip(half).map(|(d, half)| (d / half).abs());
            shares.fold(0.0, f64::max).min(LOST)
        })
    }

    /// Returns how much the slices change when triangles deflect the rays instead of patches. The
    /// result is the mean of the changes from two halves of the rays, plus its standard error,
    /// which is half of their difference.
    fn change(&self, lit: &[(f64, Displaced)]) -> f64 {
        let transform = SliceTransform::new(&self.plane.grid);
        let mut sum = transform.accumulator();
        let mut half_of = |first: usize| {
            let mut all = 0.0;
            for (light, ray) in lit.iter().skip(first).step_by(2) {
                all += light;
                sum.deposit(&ray.predicted, -light);
                if let Some(seen) = &ray.by_triangles {
                    sum.deposit(seen, ray.before * self.plane.window.value(seen));
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

    /// Returns the arrival of a ray by the triangles of smooth meshes; `None` if the ray misses a
    /// mesh or meets a mesh again.
    fn by_triangles(&self, light: CheckRay) -> PlaneArrival {
        let mut ray = light;
        let mut share = 1.0;
        for (leg, element) in self.system.elements.iter().enumerate() {
            let object = self.scene.path.legs[leg + 1].leaves?.object;
            let Object::Mesh(i) = object else {
                let t = ray.theory_hit(&element.patch)?;
                share *= self.passed(leg, &ray, t);
                let [point, normal] = on(&element.patch, ray.at(t));
                ray = self.turned(leg, [point, normal], &ray)?;
                continue;
            };
            let mesh = &self.scene.meshes[i];
            let (t, triangle) = hits(mesh, &ray, 0.0).min_by(|(a, _), (b, _)| a.total_cmp(b))?;
            share *= self.passed(leg, &ray, t);
            let (corners, point) = (&mesh.triangles[triangle], ray.at(t));
            let normals = &mesh.smooth.as_ref()?.normals[triangle];
            let normal = interpolated_normal(corners, normals, point);
            let normal = -normal.dot(ray.direction).signum() * normal;
            ray = self.turned(leg, [point, normal], &ray)?;
            let beyond = NEIGHBOURS * longest_edge(corners);
            if hits(mesh, &ray, beyond).next().is_some() {
                return None;
            }
        }
        Some((coordinates(self.at, &ray, self.counted_at(&ray)?)?, share))
    }
}

/// Returns the distances at which a ray meets triangles of a mesh, beyond a given distance, and the
/// triangles' numbers.
fn hits<'a>(
    mesh: &'a MeshObject,
    ray: &'a CheckRay,
    from: f64,
) -> impl Iterator<Item = (f64, usize)> + 'a {
    let triangles = mesh.triangles.iter().enumerate();
    let met = triangles.filter_map(|(i, triangle)| Some((ray.meets_triangle(triangle)?, i)));
    met.filter(move |(t, _)| *t > from)
}

fn longest_edge([a, b, c]: &[DVec3; 3]) -> f64 {
    a.distance(*b).max(b.distance(*c)).max(c.distance(*a))
}
