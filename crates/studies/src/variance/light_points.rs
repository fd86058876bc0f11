//! Points on the light instead of slopes as coordinates of rays.
//!
//! A renderer that samples lights chooses a point (x, y) of the window and a point (s, t) of the
//! light. At the distance d from the light, the ray has the slopes u = (x − s)/d and v = (y − t)/d.
//! Studies of variance hold s and t in the places of u and v.

use crate::variance::measured_power::box_window;
use crate::variance::radiance::RayRadiance;
use crate::variance::{VarianceError, WindowRadiance};
use etendue_field::{
    Crossing, Orientation, PhotonSource, Profile, Quantity, Side, TwoPlane, VirtualPlane,
};
use etendue_scene::Scene;
use etendue_spectrum::mapped_photons;

/// The rays from points of the light to points of a plane.
#[derive(Clone, Debug)]
pub struct LightPoints {
    /// The plane as the scene describes it, whose window holds the slopes of all these rays.
    pub seen: VirtualPlane,
    /// The plane with points on the light in the places of slopes.
    pub plane: VirtualPlane,
}

/// The radiance along rays that are given by points on the light.
#[derive(Debug)]
struct RadianceFromPoints<'a> {
    rays: Box<dyn RayRadiance + 'a>,
    points: LightPoints,
}

impl LightPoints {
    /// The rays to the only plane of a scene, which has a Box window. `max` is the largest
    /// measured frequency.
    ///
    /// # Errors
    ///
    /// Fails if the light has no area, or if the plane does not lie across the first leg, beyond the
    /// light.
    pub fn new(scene: &Scene, max: usize) -> Result<Self, VarianceError> {
        let seen = &scene.planes[0];
        let half = [0, 1].map(|axis| {
            let [low, high] = scene.light.extent(axis);
            low.abs().max(high.abs())
        });
        let is_before = seen.side == Side::Before || scene.path.first_hit() > seen.distance;
        let refused = |because| {
            let plane = seen.name.clone();
            Err(VarianceError::NoLightPoints { plane, because })
        };
        if !half.iter().all(|half| *half > 0.0 && half.is_finite()) {
            return refused("the light has no area; allowed: a Rectangle, a Disc or a Spot");
        }
        if seen.leg > 0 || !is_before {
            return refused("light there comes from a surface; allowed: a plane on the first leg");
        }
        if seen.distance <= 0.0 || seen.orientation != Orientation::Orthogonal {
            return refused("the plane does not lie across the path, beyond the light");
        }
        let mut points = Self {
            seen: seen.clone(),
            plane: seen.clone(),
        };
        let of_light = half.map(Profile::Box);
        (points.plane.window.u, points.plane.window.v) = of_light.into();
        // Photons carry the factor of the quantity.
        points.plane.quantity = Quantity::Radiance;
        points.plane = box_window(&points.plane, max);
        let slope =
            |place: Profile, half: f64| Profile::Box((place.half_width() + half) / seen.distance);
        points.seen.window.u = slope(seen.window.x, half[0]);
        points.seen.window.v = slope(seen.window.y, half[1]);
        Ok(points)
    }

    /// Photons that have points on the light in the places of slopes.
    #[must_use]
    pub fn photons<'a>(&self, source: Box<dyn PhotonSource + 'a>) -> Box<dyn PhotonSource + 'a> {
        let points = self.clone();
        mapped_photons(source, move |crossing| points.crossing(crossing))
    }

    /// The radiance at points of the window, which has points on the light in the places of
    /// slopes.
    #[must_use]
    pub fn radiance<'a>(&self, of_slopes: WindowRadiance<'a>) -> WindowRadiance<'a> {
        let rays = Box::new(RadianceFromPoints {
            rays: of_slopes.into_rays(),
            points: self.clone(),
        });
        WindowRadiance::of(self.plane.window, rays)
    }

    /// A photon with a point on the light. Its weight grows with ds dt = d² du dv, so the
    /// radiance of the light stays the same.
    pub(crate) fn crossing(&self, Crossing { ray, weight }: &Crossing) -> Crossing {
        let d = self.seen.distance;
        Crossing {
            ray: TwoPlane {
                u: ray.x - d * ray.u,
                v: ray.y - d * ray.v,
                ..*ray
            },
            weight: weight * self.seen.factor(ray) * d * d,
        }
    }

    /// The ray from a point on the light.
    pub(crate) fn ray(&self, point: &TwoPlane) -> TwoPlane {
        let d = self.seen.distance;
        TwoPlane {
            u: (point.x - point.u) / d,
            v: (point.y - point.v) / d,
            ..*point
        }
    }
}

impl RayRadiance for RadianceFromPoints<'_> {
    fn along(&self, point: &TwoPlane, index: u64) -> f64 {
        self.rays.along(&self.points.ray(point), index)
    }
}
