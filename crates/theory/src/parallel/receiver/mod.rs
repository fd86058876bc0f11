//! Diffuse reflection by quadrature. This module computes the irradiance of a Lambertian receiver
//! and the light that leaves the receiver.
//!
//! The light, the masks and the receiver are in parallel planes perpendicular to the central ray. A
//! ray that arrives at (x, y) with slopes (u, v) was at (x − h u, y − h v) at the distance h before
//! the receiver. Therefore the slopes at (x, y) of the rays through a shape form a scaled copy of
//! this shape. The irradiance E(x, y) = ∫ L(u, v) (1 + u² + v²)⁻² du dv is a signed sum of
//! integrals over rectangles and discs. These rectangles and discs are the scaled copies of the
//! light and of the blockers (docs/theory.md, section 4b).

mod density;
mod exitant;
mod kernel;
mod region;
mod slopes;
#[cfg(test)]
mod tests;
mod work;

use crate::barrier::Barrier;
use crate::light::ParallelEmitter;
use crate::parallel::chain::{ChainSegment, MaskLayer};
use density::{Integrator, ReceiverDensity};
use etendue_field::Rectangle;
use region::ReceiverRegion;
use slopes::SlopeProjection;
use std::f64::consts::PI;

/// A Lambertian receiver, with the light and the masks in front of the receiver. After the
/// reflection, light travels to the plane where it is observed.
#[derive(Debug)]
pub(crate) struct Receiver<'a> {
    light: ParallelEmitter,
    barriers: Vec<Barrier<'a>>,
    /// Distance from the light to the receiver.
    distance: f64,
    /// The integrator of the light's radiance.
    integrator: Integrator,
    /// Distance that reflected light travels to the plane where it is observed.
    after: f64,
    albedo: f64,
}

impl<'a> Receiver<'a> {
    /// Builds a receiver with an albedo, at `distance` from the light, with `layers` between them.
    /// The reflected light travels the distance `after`. All lengths are in metres.
    ///
    /// If `cosine` is false, radiance is integrated over slopes without the factor (1 + u² + v²)⁻².
    /// The result is then wrong, which tests use.
    pub(crate) fn new(
        light: ParallelEmitter,
        layers: &[MaskLayer<'a>],
        distance: f64,
        cosine: bool,
        after: f64,
        albedo: f64,
    ) -> Self {
        let shading = if cosine { 2.0 } else { 0.0 };
        let bundle = match light.shape {
            Some(_) => SlopeProjection::At([0.0; 2]),
            // The radiance of a point light has the factor δ(x − D u) δ(y − D v).
            None => SlopeProjection::From(distance),
        };
        let barriers: Vec<_> = layers
            .iter()
            .map(|layer| Barrier::new(layer.distance, layer.mask))
            .collect();
        let frequency = |axis: usize| {
            let gratings = barriers
                .iter()
                .filter_map(|b| b.mask.grating().map(|g| bundle.grating(g, b.distance)));
            let along = gratings.filter(|g| g.axis == axis);
            along.map(|g| g.frequency.abs()).sum()
        };
        let integrator = Integrator::new(shading - light.power, [frequency(0), frequency(1)]);
        Self {
            light,
            barriers,
            distance,
            integrator,
            after,
            albedo,
        }
    }

    /// The mean irradiance over a rectangle of the receiver if the light is a point, and
    /// the irradiance at the rectangle's centre for other lights, in the frame of the arriving
    /// light, W m⁻². Shadows of a point light have sharp edges, so a value at the centre of a cell
    /// would not represent the cell.
    ///
    /// The result is accurate to 10⁻¹² of the irradiance without blockers.
    fn cell(&self, center: [f64; 2], size: [f64; 2]) -> f64 {
        let (bundle, region) = self.lit(center, size);
        let received = self.light.brightness * self.received(&bundle, region);
        if self.light.shape.is_some() {
            return received;
        }
        // dx dy = D² du dv cancels the square of the distance.
        received / Rectangle { center, size }.area()
    }

    /// The slopes of the light that arrives in a cell, without barriers: at its centre, or,
    /// if the light is a point, in the whole cell.
    fn lit(&self, center: [f64; 2], size: [f64; 2]) -> (SlopeProjection, ReceiverRegion) {
        if let Some(shape) = &self.light.shape {
            let bundle = SlopeProjection::At(center);
            let region = ReceiverRegion::shape(&bundle.seen(shape, self.distance));
            return (bundle, region);
        }
        let bundle = SlopeProjection::From(self.distance);
        let sides = Rectangle { center, size };
        let sides = bundle.slopes([sides.extent(0), sides.extent(1)], 0.0);
        (bundle, ReceiverRegion::rectangle(sides))
    }

    /// The integral over those slopes of a region for which no blocker stops the light.
    fn received(&self, bundle: &SlopeProjection, region: ReceiverRegion) -> f64 {
        self.passed(
            bundle,
            region,
            &self.barriers,
            &self.density(bundle, &self.barriers),
        )
    }

    /// The light of a region of slopes that passes several barriers: the light without
    /// barriers, minus the light that each blocking shape stops.
    fn passed(
        &self,
        bundle: &SlopeProjection,
        region: ReceiverRegion,
        barriers: &[Barrier<'_>],
        density: &ReceiverDensity<'_>,
    ) -> f64 {
        let Some((barrier, rest)) = barriers.split_first() else {
            return region.integral(density);
        };
        let before = barrier.distance;
        let Some(open) = region.open(bundle, barrier) else {
            return 0.0;
        };
        let mut stopped = 0.0;
        let place = bundle.positions(open.bounds(), before);
        barrier.shapes.meeting(place, |shape| {
            if let Some(part) = open.cut(&bundle.seen(shape, before)) {
                stopped += self.passed(bundle, part, rest, density);
            }
        });
        self.passed(bundle, open, rest, density) - stopped
    }

    /// The integrand over slopes that includes the gratings among the given barriers.
    fn density(&self, bundle: &SlopeProjection, barriers: &[Barrier<'_>]) -> ReceiverDensity<'_> {
        let gratings = barriers
            .iter()
            .filter_map(|b| b.mask.grating().map(|g| bundle.grating(g, b.distance)));
        ReceiverDensity {
            integrator: &self.integrator,
            gratings: gratings.collect(),
        }
    }

    /// The radiance that leaves the receiver, albedo / π · E, which is the same in all
    /// directions. (In the paper's Eq. 6, ρ is the BRDF, albedo / π.)
    fn exitance(&self) -> f64 {
        self.albedo / PI
    }
}

impl<'a> ChainSegment<'a> {
    /// The diffuse surface at the end of the path, if there is one, with the light and
    /// masks before it.
    ///
    /// # Panics
    /// Panics if there is more than one factor G.
    pub(crate) fn receiver(&self) -> Option<Receiver<'a>> {
        let reflection = self.reflection?;
        assert!(self.cosines < 2, "a receiver has one cosine");
        Some(Receiver::new(
            self.light,
            &self.layers,
            self.distance,
            self.cosines == 1,
            reflection.after,
            reflection.albedo,
        ))
    }
}
