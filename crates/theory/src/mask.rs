//! Masks between the light and the plane, and other occluders.

use crate::barrier::Barrier;
use crate::obstacle::{Obstacle, PreparedObstacles};
use etendue_field::Mask;
use glam::DVec3;

/// Masks between the light and the plane, and other occluders.
#[derive(Debug)]
pub(crate) struct Masks<'a> {
    first_leg: Vec<Barrier<'a>>,
    pub(crate) obstacles: PreparedObstacles<'a>,
}

impl<'a> Masks<'a> {
    /// Prepares masks and obstacles. Each mask is given with its distance from the light in metres.
    pub(crate) fn new(layers: &'a [(f64, Mask)], obstacles: &'a [Obstacle]) -> Self {
        let barriers = layers.iter();
        Self {
            first_leg: barriers.map(|(at, mask)| Barrier::new(*at, mask)).collect(),
            obstacles: PreparedObstacles::new(obstacles),
        }
    }

    /// Returns the fraction of radiance that passes the masks of the first leg, for the ray with
    /// slopes (u, v) through a point.
    pub(crate) fn transmittance(&self, point: DVec3, [u, v]: [f64; 2]) -> f64 {
        let mut passes = 1.0;
        for barrier in &self.first_leg {
            let back = barrier.distance - point.z;
            passes *= barrier.transmittance(point.x + back * u, point.y + back * v);
            if passes == 0.0 {
                break;
            }
        }
        passes
    }
}
