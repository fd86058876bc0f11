//! Surfaces on the central ray of a pixel.

use crate::paths::Paths;
use crate::scatter::Reflects;
use crate::space::{Hit, Ray, SceneGeometry};
use etendue_world::Look;
use glam::DVec3;

/// A surface on the central ray of a pixel.
#[derive(Clone, Debug)]
pub struct Stop {
    /// The index of the shape of the surface.
    pub shape: usize,
    /// The hit point of the ray.
    pub position: DVec3,
    /// The shading normal, on the visible side.
    pub normal: DVec3,
    /// The unit direction in which light leaves towards the camera.
    pub leaving: DVec3,
    /// The unit direction of light that arrives here and that a mirror would send to the camera.
    pub arriving: DVec3,
    /// The distance to the camera, or to the previous surface.
    pub distance: f64,
    /// Curvatures in the plane of incidence and across it, positive if the surface is convex. They
    /// are computed by finite differences over the region that the window sees.
    pub curvature: [f64; 2],
    /// The kind of reflection.
    pub reflects: Reflects,
}

impl Stop {
    /// The cosine of the angle between the normal and the leaving light.
    #[must_use]
    pub fn cosine(&self) -> f64 {
        self.normal.dot(self.leaving)
    }

    /// Rays start at one point, at the distance `travelled` before the surface. Returns the factor
    /// by which the reflection at a mirror spreads their slopes.
    pub(super) fn spreading(&self, travelled: f64) -> f64 {
        let [along, across] = self.curvature;
        let turned = |k: f64, cosine: f64| (1.0 + 2.0 * k * travelled * cosine).abs();
        let cosine = self.cosine();
        turned(along, 1.0 / cosine)
            .max(turned(across, cosine))
            .max(1.0)
    }
}

/// The surfaces along a camera ray that continues by mirror reflection. `half` is half of
/// the angle of the window.
pub(super) fn followed(paths: &Paths, look: &Look, most: usize, half: f64) -> Vec<Stop> {
    let mut stops: Vec<Stop> = Vec::new();
    let mut ray = Ray::new(look.from, look.along);
    let mut seen = look.seen;
    let mut travelled = 0.0;
    while stops.len() < most
        && let Some(hit) = paths.mostly_stopped(&ray, seen)
    {
        travelled += hit.distance;
        let side = if hit.frame.z_axis.dot(ray.along) < 0.0 {
            1.0
        } else {
            -1.0
        };
        let normal = side * hit.frame.z_axis;
        let onward = ray.along.reflect(normal);
        stops.push(Stop {
            shape: hit.shape,
            position: hit.position,
            normal,
            leaving: -ray.along,
            arriving: -onward,
            distance: hit.distance,
            reflects: paths
                .scatter(&hit)
                .kind(&hit.point, hit.frame.transpose() * -ray.along),
            curvature: curvature(&paths.geometry, &hit, normal, -ray.along, half * travelled),
        });
        ray = Ray::new(hit.position, onward);
        seen = [0.0, f64::INFINITY];
    }
    stops
}

/// The surfaces beyond the surface `last` that windows see in mirrors, up to the first
/// surface that is not a mirror.
pub(super) fn visible(last: &Stop, beyond: Vec<Stop>) -> Vec<Stop> {
    let mut is_shown = last.reflects == Reflects::Mirror;
    let shown = beyond.into_iter().take_while(|stop| {
        let this = is_shown;
        is_shown = this && stop.reflects == Reflects::Mirror;
        this
    });
    shown.collect()
}

/// Maximum number of halvings of a curvature's step.
const HALVINGS: i32 = 16;

/// Computes the curvatures from normals at a distance of one step to either side. The step is the
/// largest step that stays on the surface.
fn curvature(
    geometry: &SceneGeometry,
    hit: &Hit,
    normal: DVec3,
    leaving: DVec3,
    largest: f64,
) -> [f64; 2] {
    let tangent = across(leaving, normal).unwrap_or_else(|| normal.any_orthonormal_vector());
    [tangent, normal.cross(tangent)].map(|axis| {
        let steps = (0..HALVINGS).map(|i| largest * 0.5_f64.powi(i));
        let mut found = steps.filter_map(|step| between(geometry, hit, normal, step * axis));
        found.next().unwrap_or(0.0)
    })
}

/// The curvature between two points of a shape, one step to either side. Returns `None` if
/// there is no point of the shape on one of the sides.
fn between(geometry: &SceneGeometry, hit: &Hit, normal: DVec3, step: DVec3) -> Option<f64> {
    let height = 4.0 * step.length();
    let at = |side: f64| {
        let from = hit.position + side * step + height * normal;
        let ray = Ray::new(from, -normal);
        let met = geometry.meets(hit.shape, &ray, [0.0, 2.0 * height])?;
        let facing = met.frame.z_axis.dot(normal).signum();
        Some((met.position, facing * met.frame.z_axis))
    };
    let ((p, m), (q, n)) = (at(1.0)?, at(-1.0)?);
    Some((m - n).dot(step) / (p - q).dot(step))
}

/// The normalised component of a normal perpendicular to a direction. Returns `None` if the
/// normal is parallel to the direction.
pub(super) fn across(normal: DVec3, along: DVec3) -> Option<DVec3> {
    let across = normal.reject_from_normalized(along);
    (across.length() > 1e-6).then(|| across.normalize())
}
