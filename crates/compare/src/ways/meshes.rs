//! How far smooth meshes lead light beside where their osculating patches do.

use super::coordinates::coordinates;
use super::rays::{Draw, Ray, bright};
use super::specular::{Arrival, Follower, on};
use etendue_field::{Profile, interpolated_normal};
use etendue_scene::{MeshObject, Object};
use glam::DVec3;

/// Rays with light in the window that are followed.
const LIT: usize = 300;
/// Triangles looked at for these.
const LOOKED_AT: usize = 30_000_000;
/// Edges of a triangle within which it is around the point that a ray leaves.
const NEIGHBOURS: f64 = 5.0;
/// What light meets again is as far off as can be.
const LOST: f64 = 1.0;

impl Follower<'_> {
    /// How far rays that meet the triangles of smooth meshes arrive from where they do by the
    /// patches that osculate them, in half-widths of the window: the root of the mean square over
    /// light. `None` without a mesh.
    pub(super) fn off_patches(&self) -> Option<f64> {
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
        let tries = u32::try_from(LOOKED_AT / triangles).unwrap_or(u32::MAX);
        let rays = (0..tries).filter_map(|index| self.ray(&Draw::new(index)));
        let of_window = (0..tries).filter_map(|index| self.ray_of_window(&Draw::new(index)));
        self.off_on_average(rays)
            .or_else(|| self.off_on_average(of_window))
    }

    /// The same of given rays; `None` if none brings light into the window.
    fn off_on_average(&self, rays: impl Iterator<Item = (Ray, f64)>) -> Option<f64> {
        let window = &self.plane.window;
        let half = [window.x, window.y, window.u, window.v].map(|p| Profile::half_width(&p));
        let off = |(ray, emitted): (Ray, f64)| {
            let (z, share) = self.theory(ray)?;
            let light = Some(emitted * share * window.value(&z)).filter(|light| *light > 0.0)?;
            let apart = self.by_triangles(ray).map_or(LOST, |(seen, _)| {
                let apart = [seen.x - z.x, seen.y - z.y, seen.u - z.u, seen.v - z.v];
                let shares = apart.iter().zip(half).map(|(d, half)| (d / half).abs());
                shares.fold(0.0, f64::max).min(LOST)
            });
            Some((light, apart))
        };
        let lit = bright(rays.filter_map(off), LIT).into_iter();
        let [light, squares] = lit.fold([0.0; 2], |[all, squares], (light, apart)| {
            [all + light, squares + light * apart * apart]
        });
        (light > 0.0).then(|| (squares / light).sqrt())
    }

    /// Where a ray arrives by the triangles of smooth meshes; nowhere if it misses one or meets it
    /// again.
    fn by_triangles(&self, light: Ray) -> Arrival {
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

/// Distances along a ray, beyond one, at which it meets triangles of a mesh, and their numbers.
fn hits<'a>(
    mesh: &'a MeshObject,
    ray: &'a Ray,
    from: f64,
) -> impl Iterator<Item = (f64, usize)> + 'a {
    let triangles = mesh.triangles.iter().enumerate();
    let met = triangles.filter_map(|(i, triangle)| Some((ray.meets_triangle(triangle)?, i)));
    met.filter(move |(t, _)| *t > from)
}

fn longest_edge([a, b, c]: &[DVec3; 3]) -> f64 {
    a.distance(*b).max(b.distance(*c)).max(c.distance(*a))
}
