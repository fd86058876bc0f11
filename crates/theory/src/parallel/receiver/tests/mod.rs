//! Tests of the receiver, and the lights, masks and windows that several tests use.

mod points;
mod spectra;

use super::{Receiver, SlopeProjection};
use crate::light::closed_form;
use crate::parallel::chain::MaskLayer;
use crate::testing::{aperture, disc, opaque, square};
use etendue_field::{Grating, HalfPlane, Light, Mask, Rectangle, Shape};

impl Receiver<'_> {
    /// The irradiance at a point of the receiver, W m⁻².
    fn irradiance(&self, x: f64, y: f64) -> f64 {
        if self.light.shape.is_some() {
            return self.cell([x, y], [0.0; 2]);
        }
        let [u, v] = [x, y].map(|c| c / self.distance);
        let bundle = SlopeProjection::From(self.distance);
        let through = self.barriers.iter().map(|barrier| {
            let scale = bundle.scale(barrier.distance);
            barrier.transmittance(scale * u, scale * v)
        });
        let lobe = self.density(&bundle, &[]).value(u, v);
        through.product::<f64>() * self.light.brightness * lobe / self.distance.powi(2)
    }
}

fn area(shape: Shape, exponent: f64) -> Light {
    Light::Area {
        shape,
        radiance: 1.7,
        exponent,
    }
}

fn rectangle(center: [f64; 2], size: [f64; 2]) -> Shape {
    Shape::Rectangle(Rectangle { center, size })
}

/// A light, its distance from a receiver, and masks with their distances before the receiver.
struct TestReceiver {
    light: Light,
    masks: Vec<(f64, Mask)>,
    distance: f64,
}

impl TestReceiver {
    fn new(light: Light, masks: Vec<(f64, Mask)>) -> Self {
        Self {
            light,
            masks,
            distance: 2.0,
        }
    }

    fn layers(&self) -> Vec<MaskLayer<'_>> {
        let masks = self.masks.iter();
        masks
            .map(|(distance, mask)| MaskLayer {
                distance: *distance,
                mask,
            })
            .collect()
    }

    fn receiver(&self) -> Receiver<'_> {
        self.after(0.0)
    }

    /// Builds the receiver. Its reflected light is observed at the distance `after`.
    fn after(&self, after: f64) -> Receiver<'_> {
        Receiver::new(
            closed_form(&self.light).unwrap(),
            &self.layers(),
            self.distance,
            true,
            after,
            0.6,
        )
    }

    /// The fraction of light that passes all masks on the way from point (a, b) of the
    /// light to point (x, y) of the receiver.
    fn passes(&self, [a, b]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let masks = self.masks.iter();
        masks
            .map(|(before, mask)| {
                let way = 1.0 - before / self.distance;
                let (x, y) = (a + way * (x - a), b + way * (y - b));
                mask.transmittance(x, y)
            })
            .product()
    }

    /// L cosⁿθ · cos²θ / r², the irradiance at (x, y) per square metre of the light at (a,
    /// b).
    fn added(&self, at: [f64; 2], point: [f64; 2]) -> f64 {
        let Light::Area {
            shape,
            radiance,
            exponent,
        } = self.light
        else {
            unreachable!("area lights only")
        };
        if !shape.contains(at[0], at[1]) {
            return 0.0;
        }
        let across = libm::hypot(point[0] - at[0], point[1] - at[1]);
        let r = libm::hypot(across, self.distance);
        let cosine = self.distance / r;
        radiance * libm::pow(cosine, exponent + 2.0) / (r * r) * self.passes(at, point)
    }
}

/// Returns scenes with every kind of light and mask, off-centre to avoid symmetries that could hide
/// errors.
fn benches() -> Vec<TestReceiver> {
    let slab = rectangle([0.13, -0.07], [0.5, 0.3]);
    let round = disc([-0.1, 0.12], 0.25);
    let few = vec![
        rectangle([0.05, 0.1], [0.1, 0.08]),
        disc([-0.12, 0.02], 0.07),
        rectangle([0.21, -0.14], [0.12, 0.11]),
    ];
    let near = vec![disc([0.1, 0.1], 0.12), disc([-0.15, -0.1], 0.1)];
    let edge = Mask::Opaque {
        shapes: vec![Shape::Rectangle(square([0.1, 0.1], 0.15))],
        half_planes: vec![HalfPlane {
            axis: 1,
            edge: -0.06,
            above: false,
        }],
    };
    let grating = |axis, frequency| {
        Mask::Grating(Grating {
            axis,
            frequency,
            modulation: 0.8,
            phase: 0.7,
        })
    };
    vec![
        TestReceiver::new(area(slab, 0.0), vec![]),
        TestReceiver::new(area(round, 0.0), vec![]),
        TestReceiver::new(area(slab, 0.0), vec![(1.0, opaque(few.clone()))]),
        TestReceiver::new(area(round, 0.0), vec![(1.0, opaque(few.clone()))]),
        TestReceiver::new(
            area(round, 6.0),
            vec![(1.2, opaque(few)), (0.5, opaque(near.clone()))],
        ),
        TestReceiver::new(area(slab, 30.0), vec![(0.8, edge.clone())]),
        TestReceiver::new(area(slab, 0.0), vec![(1.0, grating(0, 6.0))]),
        TestReceiver::new(
            area(round, 3.0),
            vec![(1.1, grating(1, 5.0)), (0.7, edge), (0.4, opaque(near))],
        ),
    ]
}
