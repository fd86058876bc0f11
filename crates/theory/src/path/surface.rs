//! One surface of the path: intersection and reflection.

use super::{Interaction, PatchExtent, PathSurface};
use crate::obstacle::{LegRay, normal};
use crate::parameter::Parameter;
use crate::path::rays::bent;
use crate::path::scattering::{brdf, kernel, narrowest};
use etendue_field::{Brdf, Fresnel, Lobe, Specular};
use glam::DVec3;
use std::f64::consts::FRAC_1_SQRT_2;

impl PathSurface {
    /// The event at a specular surface.
    #[must_use]
    pub fn event(&self) -> Option<Specular> {
        match self.interaction {
            Interaction::Specular(event) => Some(event),
            Interaction::Reflects(_) | Interaction::Diffuse { .. } => None,
        }
    }

    /// Checks whether the surface scatters light in a sampled direction.
    #[must_use]
    pub fn scatters(&self) -> bool {
        self.event().is_none()
    }

    /// The parameters of the rim of surface `i`. A patch that osculates a mesh has no rim.
    pub(super) fn rim(&self, i: usize) -> impl Iterator<Item = Parameter> + use<> {
        let [sizes, positions] = match self.extent {
            PatchExtent::Rectangle(_) => [2, 2],
            PatchExtent::Whole if self.occludes => [1, 2],
            PatchExtent::Whole => [0, 0],
        };
        let sizes = (0..sizes).map(move |axis| Parameter::SurfaceSize(i, axis));
        sizes.chain((0..positions).map(move |axis| Parameter::SurfacePosition(i, axis)))
    }

    /// The distances beyond `start` at which a ray meets the surface.
    pub(crate) fn distances(&self, ray: &LegRay, start: f64) -> impl Iterator<Item = f64> {
        let ray = *ray;
        let inside = move |t: &f64| *t > start && self.holds(ray.at(*t));
        ray.hits(&self.patch).filter(inside)
    }

    /// The first distance beyond `start` at which a ray meets the surface.
    pub(crate) fn first(&self, ray: &LegRay, start: f64) -> Option<f64> {
        self.distances(ray, start).min_by(f64::total_cmp)
    }

    /// Checks whether a point of the patch lies within the extent.
    fn holds(&self, point: DVec3) -> bool {
        let PatchExtent::Rectangle(size) = self.extent else {
            return true;
        };
        let at = self.patch.frame.to_local(point);
        2.0 * at.x.abs() <= size[0] && 2.0 * at.y.abs() <= size[1]
    }

    /// The first point where a ray meets the surface.
    pub(crate) fn met(&self, ray: &LegRay) -> Option<DVec3> {
        Some(ray.at(self.first(ray, ray.start())?))
    }

    /// The continuation of a ray after the surface; `None` if the ray is lost.
    pub(crate) fn follow(&self, ray: &LegRay) -> Option<LegRay> {
        self.turned(ray, self.met(ray)?)
    }

    /// The continuation of a ray that meets a specular surface at a point; `None` if the
    /// surface scatters light, or if a refracting surface totally reflects the ray.
    pub(crate) fn turned(&self, ray: &LegRay, point: DVec3) -> Option<LegRay> {
        let event = self.event()?;
        let normal = normal(&self.patch, point)?;
        let direction = bent(event, &self.patch.frame, [ray.direction, point, normal])?;
        Some(LegRay { point, direction })
    }

    /// The normal on the side where light arrives along a direction and is scattered.
    /// Returns `None` if this side is black.
    pub(crate) fn lit_side(&self, point: DVec3, direction: DVec3) -> Option<DVec3> {
        let normal = normal(&self.patch, point)?;
        let faces = normal.dot(direction) < 0.0;
        match self.interaction {
            Interaction::Diffuse { .. } => Some(if faces { normal } else { -normal }),
            _ => faces.then_some(normal),
        }
    }

    /// The sum of the function `of` over the BRDFs of a scattering surface. Each BRDF is
    /// multiplied by its weight at a point.
    fn sum(&self, point: DVec3, of: impl Fn(&Brdf) -> f64) -> f64 {
        match &self.interaction {
            Interaction::Specular(_) => 0.0,
            Interaction::Diffuse { albedo } => of(&diffuse(*albedo)),
            Interaction::Reflects(reflectance) => {
                let at = self.patch.frame.to_local(point);
                let mixture = reflectance.at(at.x, at.y);
                let terms = mixture.weighted();
                terms.map(|(weight, brdf)| weight * of(brdf)).sum()
            }
        }
    }

    /// Returns the BRDF in sr⁻¹ for light that arrives from `from` and leaves towards `to`. Both
    /// are unit vectors away from the surface.
    pub(crate) fn value(&self, point: DVec3, normal: DVec3, [from, to]: [DVec3; 2]) -> f64 {
        self.sum(point, |brdf| brdf::value(brdf, normal, from, to))
    }

    /// The BRDF that the chain uses. `angles` contains the longitude and latitude of two
    /// directions: first of the direction from which light arrives, then of the direction towards
    /// which it leaves.
    pub(crate) fn kernel(&self, point: DVec3, incidence: f64, angles: [[f64; 2]; 2]) -> f64 {
        let [from, to] = angles;
        self.sum(point, |brdf| kernel(brdf, incidence, from, to))
    }

    /// The standard deviation of the narrowest lobe at a point, in radians; `None` for a
    /// diffuse surface.
    pub(crate) fn width(&self, point: DVec3) -> Option<f64> {
        let Interaction::Reflects(reflectance) = &self.interaction else {
            return None;
        };
        let at = self.patch.frame.to_local(point);
        let mixture = reflectance.at(at.x, at.y);
        let width = narrowest(mixture.weighted().map(|(_, brdf)| brdf));
        width.map(|width| width * FRAC_1_SQRT_2)
    }
}

fn diffuse(albedo: f64) -> Brdf {
    Brdf::new(Lobe::Lambertian, albedo, Fresnel::White)
}
