//! Weighted sums of BRDFs. Each direction is drawn by one of the BRDFs, and the probability of a
//! BRDF is its share of the total albedo.

use super::{density, sample, value};
use etendue_field::Mixture;
use glam::DVec3;

/// The value of the sum of BRDFs, sr⁻¹.
#[inline]
#[must_use]
pub fn sum(mixture: &Mixture<'_>, wi: DVec3, wo: DVec3) -> f64 {
    let values = mixture.weighted();
    values.map(|(weight, of)| weight * value(of, wi, wo)).sum()
}

/// A direction drawn by one of the BRDFs as in [`sample`]. The first random number also
/// selects the BRDF.
#[inline]
pub(crate) fn towards(mixture: &Mixture<'_>, wi: DVec3, [a, b]: [f64; 2]) -> DVec3 {
    let total = mixture.albedo();
    let mut left = a;
    let mut chosen = None;
    for (weight, of) in mixture.weighted() {
        let share = weight * of.albedo / total;
        if share > 0.0 {
            // Because of rounding errors, the random number that remains for the last BRDF may
            // exceed 1.
            chosen = Some((of, (left / share).min(BELOW_ONE)));
        }
        if left < share {
            break;
        }
        left -= share;
    }
    chosen.map_or(DVec3::Z, |(of, a)| sample(of, wi, [a, b]))
}

/// The largest random number from which a direction is drawn.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON;

/// The density of [`towards`] per solid angle.
#[inline]
pub(crate) fn densities(mixture: &Mixture<'_>, wi: DVec3, wo: DVec3) -> f64 {
    let each = mixture.weighted();
    let sum: f64 = each
        .map(|(weight, of)| weight * of.albedo * density(of, wi, wo))
        .sum();
    sum / mixture.albedo()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{Brdf, Fresnel, Lobe, Reflectance, Term, Weight};
    use etendue_transform::random::{Stream, unit, words};
    use std::f64::consts::PI;

    /// A function of directions.
    type Weighting = fn(DVec3) -> f64;

    fn reflectance(albedos: [f64; 3]) -> Reflectance {
        let lobes = [
            Lobe::Phong { exponent: 30.0 },
            Lobe::Lambertian,
            Lobe::Ggx { roughness: 0.3 },
        ];
        let terms = lobes.into_iter().zip(albedos).map(|(lobe, albedo)| Term {
            brdf: Brdf::new(lobe, albedo, Fresnel::White),
            weight: Weight::One,
        });
        Reflectance {
            terms: terms.collect(),
            texture: None,
        }
    }

    /// Returns, for each of several functions f, the difference between the sample mean of f
    /// divided by the density and ∫ f, in standard errors.
    fn deviations(drawn: &Mixture<'_>, claimed: &Mixture<'_>, wi: DVec3) -> Vec<f64> {
        const SAMPLES: u32 = 100_000;
        // The functions are integrated over the hemisphere. Two of the functions are larger on one
        // side of the normal, so they detect lobes that lean to one side.
        let functions: [(Weighting, f64); 3] = [
            (|v| v.z.powi(2), 2.0 * PI / 3.0),
            (|v| v.z * (1.0 + v.x), PI),
            (|v| v.z * (1.0 - v.x - v.y).powi(2), 1.5 * PI),
        ];
        let numbers = (0..u64::from(SAMPLES)).map(|i| words(5, Stream::Photon, i, 0).map(unit));
        let directions: Vec<DVec3> = numbers.map(|r| towards(drawn, wi, [r[0], r[1]])).collect();
        let deviation = |(f, expected): (Weighting, f64)| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for v in directions.iter().filter(|v| v.z > 0.0) {
                let x = f(*v) / densities(claimed, wi, *v);
                sum += x;
                squares += x * x;
            }
            let n = f64::from(SAMPLES);
            let mean = sum / n;
            (mean - expected).abs() / ((squares / n - mean * mean) / n).sqrt()
        };
        functions.into_iter().map(deviation).collect()
    }

    #[test]
    fn samples_of_a_sum_follow_its_density() {
        let [right, swapped] = [[0.5, 0.3, 0.1], [0.3, 0.5, 0.1]].map(reflectance);
        let [right, swapped] = [right.at(0.0, 0.0), swapped.at(0.0, 0.0)];
        for angle in [0.0, 0.6, 1.2, 1.5] {
            let (sin, cos) = libm::sincos(angle);
            let wi = DVec3::new(0.8 * sin, 0.6 * sin, cos);
            let found = deviations(&right, &right, wi);
            assert!(found.iter().all(|d| *d < 4.5), "{angle}: {found:?}");
            let fault = deviations(&right, &swapped, wi);
            assert!(
                fault.iter().any(|d| *d > 9.0),
                "{angle}, shares swapped: {fault:?}"
            );
        }
    }
}
