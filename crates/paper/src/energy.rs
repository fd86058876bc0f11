//! The distribution of the energy of a spectrum over frequencies.

/// Number of steps of a sum up to the largest frequency.
const STEPS: usize = 3000;

/// A frequency for each share. Below this frequency, a spectrum has this share of its
/// energy. The frequency is in the unit of `largest`, and `None` if it would be above `largest`.
///
/// `hat` is the transform of an even function, and `energy` is the integral of this function's
/// square, which is ∫|f̂|² over all frequencies (Parseval). The energy below a frequency is a sum
/// over midpoints of steps of `largest`/3000.
pub(crate) fn energy_below<const N: usize>(
    hat: impl Fn(f64) -> f64,
    energy: f64,
    shares: [f64; N],
    largest: f64,
) -> [Option<f64>; N] {
    let step = largest / STEPS as f64;
    let mut found = [None; N];
    let mut inside = 0.0;
    for i in 0..STEPS {
        let low = i as f64 * step;
        // The factor 2 includes negative frequencies.
        let here = 2.0 * step * hat(low + 0.5 * step).powi(2);
        for (found, share) in found.iter_mut().zip(shares) {
            let wanted = share * energy - inside;
            if found.is_none() && here >= wanted {
                *found = Some(low + step * wanted / here);
            }
        }
        inside += here;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_theory::shading::{cosine_hat, g_hat};
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn shares_of_known_spectra() {
        // The Gaussian exp(−πt²) is its own transform. The square of this Gaussian has the standard
        // deviation 1/√(4π), and 95 % of the square's integral is within 1.96 standard deviations.
        let bell = |t: f64| libm::exp(-PI * t * t);
        let [found, most] = energy_below(bell, 0.5_f64.sqrt(), [0.95, 1.1], 2.0);
        let expected = 1.959_964 / (4.0 * PI).sqrt();
        assert!((found.unwrap() - expected).abs() < 1e-6); // steps squared
        assert_eq!(most, None);
        // The energy of the cosine is ∫ cos² over the half-circle; the energy of the factor g is ∫
        // (1 + v²)⁻³ over all slopes.
        let [cosine] = energy_below(cosine_hat, FRAC_PI_2, [0.99], 4.0);
        // The value 0.376183 is from an independent sum with 2·10⁶ steps.
        assert!((cosine.unwrap() - 0.376_183).abs() < 1e-5, "{cosine:?}"); // its digits, and steps squared
        let [slopes] = energy_below(g_hat, 0.375 * PI, [0.99], 4.0);
        assert!((slopes.unwrap() - 0.467).abs() < 1e-3, "{slopes:?}"); // three digits are known
    }
}
