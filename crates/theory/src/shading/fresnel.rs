//! The reflectance of a smooth interface, and the transform of its product with the cosine.

use super::panels::even_transform;
use etendue_field::{Complex, Fresnel, square_root};
use std::f64::consts::FRAC_PI_2;

/// Number of times that panels are halved towards grazing angles. There the reflectance for an
/// index N changes within an angle of about 1/N. This number suffices for indices beyond 1000.
const GRAZING: i32 = 12;
/// Number of times that panels are halved towards the critical angle, where the reflectance behaves
/// as a square root.
const CRITICAL: i32 = 40;

/// The share of unpolarised radiance that an interface reflects. It is the factor f(θ) of a
/// separable BRDF. The angle θ is measured from the normal, in radians, with |θ| ≤ π/2. An index
/// below 1 describes light that arrives inside a denser medium. All of this light is reflected if
/// the angle of incidence exceeds asin(index).
#[must_use]
pub fn fresnel_reflectance(fresnel: Fresnel, theta: f64) -> f64 {
    let (sine, cosine) = libm::sincos(theta);
    unpolarised_reflectance(fresnel, cosine, sine * sine)
}

/// The transform of F(θ) cos⁺(θ), with Ω in cycles per radian. It is the combined kernel of
/// Fresnel reflection and cosine. The transform is real and even. Durand et al. 2005 plot it in
/// Fig. 12-b, but give no formula. It is computed by quadrature to 10⁻¹².
#[must_use]
pub fn fresnel_cosine_hat(fresnel: Fresnel, omega: f64) -> f64 {
    even_transform(&ends(fresnel), omega, |theta| {
        fresnel_reflectance(fresnel, theta) * libm::cos(theta)
    })
}

/// The ends of panels that become shorter towards grazing angles, and towards the critical
/// angle, where the reflectance behaves as a square root.
fn ends(fresnel: Fresnel) -> Vec<f64> {
    let halved = |most: i32| (1..=most).map(|n| 0.5_f64.powi(n));
    let mut ends: Vec<f64> = halved(GRAZING).map(|h| FRAC_PI_2 * (1.0 - h)).collect();
    ends.extend([0.0, FRAC_PI_2]);
    if let Fresnel::Dielectric { index } = fresnel
        && index < 1.0
    {
        let critical = libm::asin(index);
        ends.push(critical);
        ends.extend(
            halved(CRITICAL)
                .flat_map(|h| [critical * (1.0 - h), critical + h * (FRAC_PI_2 - critical)]),
        );
    }
    ends.sort_by(f64::total_cmp);
    ends
}

/// The share of unpolarised radiance that an interface reflects, at an angle with the given
/// cosine and squared sine. The share is the mean over both polarisations (Born and Wolf 1999,
/// section 1.5).
pub(crate) fn unpolarised_reflectance(fresnel: Fresnel, cosine: f64, squared_sine: f64) -> f64 {
    let index = match fresnel {
        Fresnel::White => return 1.0,
        Fresnel::Dielectric { index } => Complex::from(index),
        Fresnel::Conductor { n, k } => Complex::new(n, k),
    };
    let square = index * index;
    // The refractive index times the cosine of the refracted angle.
    let beyond = square_root(square - squared_sine);
    let across = (cosine - beyond) / (cosine + beyond);
    let along = (square * cosine - beyond) / (square * cosine + beyond);
    0.5 * (across.norm_sqr() + along.norm_sqr())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brewster_and_total_reflection() {
        let glass = Fresnel::Dielectric { index: 1.5 };
        let at = libm::atan(1.5_f64);
        // At Brewster's angle one polarisation is not reflected, and the mean reflectance is half
        // of (n² − 1)²/(n² + 1)².
        let expected = 0.5 * (1.25_f64 / 3.25).powi(2);
        assert!((fresnel_reflectance(glass, at) - expected).abs() < 1e-15); // rounding
        let inside = Fresnel::Dielectric { index: 1.0 / 1.5 };
        assert!((fresnel_reflectance(inside, 0.8) - 1.0).abs() < 1e-15); // all is reflected beyond 0.7297
        assert!((fresnel_reflectance(inside, 0.0) - 0.04).abs() < 1e-15); // rounding
    }

    #[test]
    fn from_inside_the_transform_at_zero_is_the_integral() {
        let inside = Fresnel::Dielectric { index: 1.0 / 1.5 };
        let critical = libm::asin(1.0_f64 / 1.5);
        // A quadratic substitution on both sides of the critical angle removes the square root.
        let below = crate::quadrature::integrate(60, [0.0, critical.sqrt()], |t| {
            let theta = critical - t * t;
            2.0 * t * fresnel_reflectance(inside, theta) * libm::cos(theta)
        });
        let expected = 2.0 * (below + 1.0 - 1.0 / 1.5);
        assert!((fresnel_cosine_hat(inside, 0.0) - expected).abs() < 1e-12); // the stated error
    }

    #[test]
    fn metals_of_any_index_have_panels_enough() {
        for (index, extinction) in [(0.05, 4.0), (3.0, 3.0), (500.0, 1000.0)] {
            let metal = Fresnel::Conductor {
                n: index,
                k: extinction,
            };
            let halved = (1..=40).map(|n| FRAC_PI_2 * (1.0 - 0.5_f64.powi(n)));
            let ends: Vec<f64> = [0.0].into_iter().chain(halved).chain([FRAC_PI_2]).collect();
            let finer =
                even_transform(&ends, 0.7, |t| fresnel_reflectance(metal, t) * libm::cos(t));
            assert!(
                (fresnel_cosine_hat(metal, 0.7) - finer).abs() < 1e-12,
                "{index}"
            ); // the stated error
        }
    }
}
