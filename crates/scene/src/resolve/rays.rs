//! Checks ray files that are used as lights.

use super::Resolver;
use super::faults::{show, vector};
use etendue_field::{FluxRay, Frame, Light, RayLight, TwoPlane};
use etendue_rayfile::{PowerUnit, RayFile, RaySet};
use glam::DVec3;
use std::sync::Arc;

impl Resolver<'_> {
    /// The rays of a file. `front` and `up` are the directions of the file's Z and Y axes
    /// in the world, and `light` is the frame at the light.
    pub(super) fn rays(
        &mut self,
        name: &str,
        axes: [Option<[f64; 3]>; 2],
        flux: Option<f64>,
        light: &Frame,
    ) -> Light {
        let axes = self.axes_of_rays(axes, light);
        let rays = self.ray_light(name, &axes, flux);
        // After a fault, this light is a placeholder that is never used.
        let dark = || RayLight::new(vec![of_flux(1.0)], 0.0);
        match rays.or_else(dark) {
            Some(rays) => Light::Rays {
                rays: Arc::new(rays),
            },
            None => Light::Point { intensity: 1.0 },
        }
    }

    /// The axes of the file, in the frame at the light.
    fn axes_of_rays(&mut self, [front, up]: [Option<[f64; 3]>; 2], light: &Frame) -> Frame {
        let axis = |given: Option<[f64; 3]>, default: DVec3| {
            given.map_or(default, |v| light.vector_to_local(DVec3::from(v)))
        };
        let [d, y] = [axis(front, DVec3::Z), axis(up, DVec3::Y)];
        // X is Y × D, and Y is made orthogonal to D.
        let frame = Frame::new(DVec3::ZERO, d, y.cross(d));
        if frame.is_none() && d.is_finite() && y.is_finite() {
            let shown = [d, y].map(|v| vector(&light.vector_to_world(v).to_array()));
            let allowed = "two directions that are not parallel, neither of length 0";
            self.faults
                .add("light.front and light.up", shown.join(" and "), allowed);
        }
        frame.unwrap_or(Frame::IDENTITY)
    }

    fn ray_light(&mut self, name: &str, axes: &Frame, flux: Option<f64>) -> Option<RayLight> {
        let bytes = self.named_file("light.file", name)?;
        let mut refused = |why: String, allowed: &str| {
            self.faults
                .add("light.file", format!("{} ({why})", show(name)), allowed);
            None
        };
        let file = match RayFile::read(&bytes) {
            Ok(file) => file,
            Err(fault) => {
                let allowed = "a ray file of IES TM-25, MCPL or NPY";
                return refused(fault.to_string(), allowed);
            }
        };
        drop(bytes);
        let set = file.rays();
        if let Some(ray) = set.powers.iter().position(|power| *power < 0.0) {
            let why = format!("ray {ray} has the power {}", set.powers[ray]);
            return refused(why, "rays with power of 0 or more");
        }
        let total = set.total_power();
        let watts = match (flux, set.unit, &file) {
            (Some(flux), ..) => Some(flux / total),
            (None, PowerUnit::Watt, _) => Some(1.0),
            (None, PowerUnit::Lumen, RayFile::Tm25(file)) => file.watts_per_lumen(),
            _ => None,
        };
        let Some(watts) = watts else {
            let why = format!("power in {}", set.unit.symbol());
            return refused(
                why,
                "a file with power in W, or the field `flux` with the power in W",
            );
        };
        let found = through_the_plane(&set, axes, watts);
        if found.is_none() {
            return refused(
                format!("{} rays, of power {total}", set.len()),
                "rays that go forward, along path.direction, and have power",
            );
        }
        found
    }
}

/// The rays that go forward. Each ray is given at the point where it crosses the plane of
/// the light.
fn through_the_plane(set: &RaySet, axes: &Frame, watts: f64) -> Option<RayLight> {
    let mut rays = Vec::with_capacity(set.len());
    let mut behind = 0.0;
    let each = set.positions.iter().zip(&set.directions).zip(&set.powers);
    for ((position, direction), power) in each {
        let point = axes.to_world(DVec3::from(*position));
        let along = axes.vector_to_world(DVec3::from(*direction));
        let flux = watts * power;
        let [u, v] = [along.x / along.z, along.y / along.z];
        let [x, y] = [point.x - point.z * u, point.y - point.z * v];
        let ray = TwoPlane { x, y, u, v };
        // Light that travels parallel to the plane is not recorded, because its slopes are
        // infinite.
        if along.z > LEVEL {
            rays.push(FluxRay { ray, flux });
        } else {
            behind += flux;
        }
    }
    RayLight::new(rays, behind)
}

/// A ray counts as parallel to the plane of the light if the cosine of its angle to the central ray
/// is below this limit.
const LEVEL: f64 = 1e-6;

fn of_flux(flux: f64) -> FluxRay {
    let ray = TwoPlane::default();
    FluxRay { ray, flux }
}
