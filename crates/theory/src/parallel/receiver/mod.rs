//! Diffuse reflection by quadrature: the irradiance of a Lambertian receiver, and the light that
//! leaves it.
//!
//! A light, masks in planes across the central ray, and the receiver are parallel. A ray that
//! arrives at (x, y) with slopes (u, v) was at (x − h u, y − h v) a distance h before, so that
//! whatever stands upstream is seen from a point as the same shape, smaller. The irradiance E(x, y)
//! = ∫ L(u, v) (1 + u² + v²)⁻² du dv is a sum over light and blockers so seen, with signs, of
//! integrals over rectangles and discs (docs/theory.md, section 4b).

mod density;
mod exitant;
mod kernel;
mod reflection;
mod region;
#[cfg(test)]
mod tests;
mod work;

use crate::barrier::{Barrier, Bounds};
use crate::parallel::chain::{MaskLayer, ParallelEmitter};
use density::{Integrator, LobeDensity};
use etendue_field::{Disc, Grating, Rectangle, Shape};
use region::ReceiverRegion;
use std::f64::consts::{PI, TAU};

/// A Lambertian receiver, what shines on it, and how far its light then travels.
#[derive(Debug)]
pub(crate) struct Receiver<'a> {
    light: ParallelEmitter,
    barriers: Vec<Barrier<'a>>,
    /// From the light to the receiver.
    distance: f64,
    /// What the light's radiance is integrated with.
    integrator: Integrator,
    /// How far reflected light travels to where it is looked at.
    after: f64,
    albedo: f64,
}

/// How slopes tell positions upstream: position = origin + b · slope at a distance h before the
/// receiver.
#[derive(Clone, Copy, Debug)]
enum SlopeProjection {
    /// Rays that arrive at a point of the receiver: b = −h.
    At([f64; 2]),
    /// Rays that left a point light at this distance: b = distance − h.
    From(f64),
}

impl SlopeProjection {
    fn origin(&self) -> [f64; 2] {
        match *self {
            Self::At(point) => point,
            Self::From(_) => [0.0; 2],
        }
    }

    /// Change of position per slope.
    fn scale(&self, before: f64) -> f64 {
        match *self {
            Self::At(_) => -before,
            Self::From(distance) => distance - before,
        }
    }

    /// Bounds in a plane, as slopes.
    fn slopes(&self, sides: Bounds, before: f64) -> Bounds {
        let (origin, scale) = (self.origin(), self.scale(before));
        [0, 1].map(|k| {
            let [a, b] = sides[k].map(|c| (c - origin[k]) / scale);
            [a.min(b), a.max(b)]
        })
    }

    /// Bounds in slopes, as positions in a plane.
    fn positions(&self, sides: Bounds, before: f64) -> Bounds {
        let (origin, scale) = (self.origin(), self.scale(before));
        [0, 1].map(|k| {
            let [a, b] = sides[k].map(|c| origin[k] + scale * c);
            [a.min(b), a.max(b)]
        })
    }

    /// A shape in a plane, as slopes.
    fn seen(&self, shape: &Shape, before: f64) -> Shape {
        let (origin, scale) = (self.origin(), self.scale(before));
        let at = |center: [f64; 2]| [0, 1].map(|k| (center[k] - origin[k]) / scale);
        match *shape {
            Shape::Rectangle(Rectangle { center, size }) => Shape::Rectangle(Rectangle {
                center: at(center),
                size: size.map(|s| s / scale.abs()),
            }),
            Shape::Disc(Disc { center, radius }) => Shape::Disc(Disc {
                center: at(center),
                radius: radius / scale.abs(),
            }),
        }
    }

    /// A grating in a plane, as a function of slopes.
    fn grating(&self, grating: &Grating, before: f64) -> Grating {
        let phase = TAU * grating.frequency * self.origin()[grating.axis];
        Grating {
            frequency: grating.frequency * self.scale(before),
            phase: grating.phase + phase,
            ..*grating
        }
    }
}

impl<'a> Receiver<'a> {
    /// A receiver of an albedo `distance` from the light, `layers` between them, whose light
    /// travels `after` more; metres.
    ///
    /// With `cosine` off, radiance is added up over slopes without (1 + u² + v²)⁻²: wrong on
    /// purpose.
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
            // Its radiance has δ(x − D u) δ(y − D v).
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

    /// Irradiance at a point of the receiver, in the frame of the light that arrives, W m⁻².
    ///
    /// To 10⁻¹² of the irradiance without blockers.
    pub(crate) fn irradiance(&self, x: f64, y: f64) -> f64 {
        let brightness = self.light.brightness;
        if let Some(shape) = &self.light.shape {
            let bundle = SlopeProjection::At([x, y]);
            let region = ReceiverRegion::shape(&bundle.seen(shape, self.distance));
            return brightness * self.received(&bundle, region);
        }
        let [u, v] = [x, y].map(|c| c / self.distance);
        let bundle = SlopeProjection::From(self.distance);
        let through = self.barriers.iter().map(|barrier| {
            let scale = bundle.scale(barrier.distance);
            barrier.transmittance(scale * u, scale * v)
        });
        let lobe = self.density(&bundle, &[]).value(u, v);
        through.product::<f64>() * brightness * lobe / self.distance.powi(2)
    }

    /// Mean irradiance over a rectangle of the receiver around a point, if the light is a point;
    /// else the irradiance at the middle. Shadows of a point light end abruptly, and a value in the
    /// middle of a cell would say nothing of the rest.
    fn cell(&self, center: [f64; 2], size: [f64; 2]) -> f64 {
        if self.light.shape.is_some() {
            return self.irradiance(center[0], center[1]);
        }
        // dx dy = D² du dv cancels the square of the distance.
        let bundle = SlopeProjection::From(self.distance);
        let sides = Rectangle { center, size };
        let region =
            ReceiverRegion::rectangle(bundle.slopes([sides.extent(0), sides.extent(1)], 0.0));
        self.light.brightness * self.received(&bundle, region) / sides.area()
    }

    /// The integral over those slopes of a region that no blocker stops.
    fn received(&self, bundle: &SlopeProjection, region: ReceiverRegion) -> f64 {
        self.passed(
            bundle,
            region,
            &self.barriers,
            &self.density(bundle, &self.barriers),
        )
    }

    /// The light of a region that passes barriers, one after the other: all, less what each shape
    /// stops.
    fn passed(
        &self,
        bundle: &SlopeProjection,
        region: ReceiverRegion,
        barriers: &[Barrier<'_>],
        density: &LobeDensity<'_>,
    ) -> f64 {
        let Some((barrier, rest)) = barriers.split_first() else {
            return region.integral(density);
        };
        let before = barrier.distance;
        let Some(open) = region.within(bundle.slopes(barrier.open, before)) else {
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

    /// What is integrated over slopes behind the gratings of some barriers.
    fn density(&self, bundle: &SlopeProjection, barriers: &[Barrier<'_>]) -> LobeDensity<'_> {
        let gratings = barriers
            .iter()
            .filter_map(|b| b.mask.grating().map(|g| bundle.grating(g, b.distance)));
        LobeDensity {
            integrator: &self.integrator,
            gratings: gratings.collect(),
        }
    }

    /// Radiance that leaves the receiver, the same in all directions: albedo / π · E (the paper's
    /// Eq. 6, whose ρ is the BRDF, albedo / π).
    fn exitance(&self) -> f64 {
        self.albedo / PI
    }
}
