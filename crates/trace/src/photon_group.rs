//! Photons that leave the light together, as columns of numbers.

use crate::arrival::Arrival;
use crate::lanes::lanes;
use etendue_field::TwoPlane;
use glam::DVec3;

/// The number of photons of a group.
pub const PHOTONS_PER_GROUP: usize = 16;

/// A number for each photon of a group.
pub(crate) type PhotonColumn = [f64; PHOTONS_PER_GROUP];

/// For each photon, the number of the obstacle that the photon meets, from 1 on in the order of a
/// flat leg. The number 0 stands for no obstacle, and the number after the last for a photon that
/// carries no light.
pub(crate) type Hits = [usize; PHOTONS_PER_GROUP];

/// Photons that leave the light together.
#[derive(Clone, Copy, Debug)]
pub struct PhotonGroup {
    /// Columns of x, y, u and v in the plane of the light.
    pub rays: [[f64; PHOTONS_PER_GROUP]; 4],
    /// The contributions to radiance space; zero for a photon that carries no light.
    pub weights: [f64; PHOTONS_PER_GROUP],
    /// The fluxes, W times the number of emitted photons.
    pub fluxes: [f64; PHOTONS_PER_GROUP],
}

impl PhotonGroup {
    /// The ray of a photon.
    #[inline(always)]
    #[must_use]
    pub fn ray(&self, i: usize) -> TwoPlane {
        ray(&self.rays, i)
    }

    /// Returns columns of x and y in the plane at a distance.
    #[inline(always)]
    pub(crate) fn positions(&self, distance: f64) -> [PhotonColumn; 2] {
        let [x, y, u, v] = &self.rays;
        [
            lanes(|i| x[i] + distance * u[i]),
            lanes(|i| y[i] + distance * v[i]),
        ]
    }

    /// The arrival of a photon at a surface across the leg.
    pub(crate) fn arrival(&self, i: usize, distance: f64) -> Arrival {
        Arrival::new(&self.ray(i), distance, |_| DVec3::Z, self.fluxes[i])
    }

    /// Makes all photons except the first `count` carry no light.
    pub(crate) fn end_at(&mut self, count: u64) {
        for i in (0..PHOTONS_PER_GROUP).filter(|i| *i as u64 >= count) {
            (self.weights[i], self.fluxes[i]) = (0.0, 0.0);
        }
    }
}

/// A ray from columns of x, y, u and v.
#[inline(always)]
pub(crate) fn ray([x, y, u, v]: &[PhotonColumn; 4], i: usize) -> TwoPlane {
    let [x, y, u, v] = [x[i], y[i], u[i], v[i]];
    TwoPlane { x, y, u, v }
}
