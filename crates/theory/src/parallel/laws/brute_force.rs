//! Transforms of chains, computed as sums over many quasi-random rays. They are a reference for
//! tests.

use crate::{Chain, Operator};
use etendue_field::{Complex, Light, Mask, Shape, TwoPlane, Window};
use std::f64::consts::TAU;

/// A chain, described from its end: the distances of the masks upstream, and the number of factors
/// G.
struct WalkedRay<'a> {
    distance: f64,
    masks: Vec<(f64, &'a Mask)>,
    cosines: i32,
}

impl<'a> WalkedRay<'a> {
    fn new(chain: &'a Chain) -> Self {
        let mut walk = Self {
            distance: 0.0,
            masks: Vec::new(),
            cosines: 0,
        };
        for operator in chain.operators.iter().rev() {
            match operator {
                Operator::Travel { distance, .. } => walk.distance += distance,
                Operator::Visibility { mask, .. } => walk.masks.push((walk.distance, mask)),
                Operator::Cosine { .. } => walk.cosines += 1,
                Operator::Diffuse { .. } => panic!("rays end here"),
            }
        }
        walk
    }

    /// The fraction of the light along a ray that passes all masks.
    fn passes(&self, ray: &TwoPlane) -> f64 {
        let shading = ray.secant_squared().powi(-2 * self.cosines);
        let masks = self.masks.iter().map(|(distance, mask)| {
            let then = ray.travelled(-distance);
            mask.transmittance(then.x, then.y)
        });
        shading * masks.product::<f64>()
    }
}

/// Computes the transform as a sum over quasi-random rays from the light to the final plane.
///
/// Uses points of the R₄ sequence (Roberts 2018): multiples of the powers of 1/φ, where φ⁵ = φ +
/// 1.
pub(super) fn brute_force(
    chain: &Chain,
    window: &Window,
    frequencies: &[[f64; 4]],
    rays: u32,
) -> Vec<Complex> {
    let walk = WalkedRay::new(chain);
    let half = [window.x.half_width(), window.y.half_width()];
    let powers = [1, 2, 3, 4].map(|i| 1.167_303_978_261_418_7_f64.powi(-i));
    let mut sums = vec![Complex::ZERO; frequencies.len()];
    let (measure, exponent, brightness) = match &chain.source.light {
        Light::Area {
            shape,
            radiance,
            exponent,
        } => (shape.area(), *exponent, *radiance),
        // The distance from the point light to (x, y) is D √(1 + u² + v²).
        Light::Point { intensity } => (1.0, -1.0, *intensity),
        other => panic!("no brute force for {other:?}"),
    };
    for i in 0..rays {
        let [a, b, c, d] = powers.map(|p| (f64::from(i) * p).fract());
        let [x, y] = [(2.0 * a - 1.0) * half[0], (2.0 * b - 1.0) * half[1]];
        let from = start(&chain.source.light, c, d);
        let [u, v] = [(x, from[0]), (y, from[1])].map(|(to, from)| (to - from) / walk.distance);
        let ray = TwoPlane { x, y, u, v };
        let lobe = libm::pow(ray.secant_squared(), -0.5 * exponent);
        let value = lobe * walk.passes(&ray) * window.value(&ray);
        for (sum, k) in sums.iter_mut().zip(frequencies) {
            let phase = k[0] * x + k[1] * y + k[2] * u + k[3] * v;
            *sum += Complex::cis(-TAU * phase) * value;
        }
    }
    let area = 4.0 * half[0] * half[1] * measure * brightness;
    let scale = area / (walk.distance * walk.distance * f64::from(rays));
    sums.iter().map(|sum| sum * scale).collect()
}

/// Maps two numbers of the unit interval to a point of the light, uniformly in area.
fn start(light: &Light, c: f64, d: f64) -> [f64; 2] {
    match light {
        Light::Area {
            shape: Shape::Rectangle(r),
            ..
        } => [0, 1].map(|k| r.center[k] + ([c, d][k] - 0.5) * r.size[k]),
        Light::Area {
            shape: Shape::Disc(disc),
            ..
        } => {
            let radius = disc.radius * c.sqrt();
            let (sin, cos) = libm::sincos(TAU * d);
            [disc.center[0] + radius * cos, disc.center[1] + radius * sin]
        }
        _ => [0.0, 0.0],
    }
}
