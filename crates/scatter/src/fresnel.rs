//! Computes the reflectance of interfaces for unpolarised light, which is the mean over both
//! polarisations, and directions of refraction.

use etendue_field::Fresnel;
use glam::DVec3;

/// The reflected share of light at an angle of incidence, given by its cosine from 0 to
/// 1.
#[inline]
#[must_use]
pub fn reflectance(fresnel: &Fresnel, cosine: f64) -> f64 {
    match *fresnel {
        Fresnel::White => 1.0,
        Fresnel::Dielectric { index } => dielectric(index, cosine),
        Fresnel::Conductor { n, k } => conductor(n, k, cosine),
    }
}

/// The reflectance of a dielectric. With an index below 1, all light beyond the critical
/// angle is reflected.
#[inline]
fn dielectric(index: f64, cosine: f64) -> f64 {
    let squared = index * index;
    let inside = squared - 1.0 + cosine * cosine;
    if inside <= 0.0 {
        return 1.0;
    }
    // This root is the index times the cosine of the angle of refraction.
    let refracted = inside.sqrt();
    let s = (cosine - refracted) / (cosine + refracted);
    let p = (squared * cosine - refracted) / (squared * cosine + refracted);
    0.5 * (s * s + p * p)
}

/// For a conductor with index n + i k, (n + i k)² − sin²θ = (a + i b)².
fn conductor(n: f64, k: f64, cosine: f64) -> f64 {
    let c2 = cosine * cosine;
    let s2 = 1.0 - c2;
    let real = n * n - k * k - s2;
    let modulus = libm::hypot(real, 2.0 * n * k);
    let a = (0.5 * (modulus + real)).max(0.0).sqrt();
    let ratio = |sum: f64, cross: f64| (sum - cross) / (sum + cross);
    let s = ratio(modulus + c2, 2.0 * a * cosine);
    let p = s * ratio(c2 * modulus + s2 * s2, 2.0 * a * cosine * s2);
    0.5 * (s + p)
}

/// An interface of two dielectrics at an angle of incidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interface {
    /// The share of light that is reflected.
    pub(crate) reflected: f64,
    /// Index of the far side divided by the index of the near side.
    index: f64,
    /// Cosines on the near and the far side.
    cosines: [f64; 2],
}

impl Interface {
    /// Builds an interface for an angle of incidence. The cosine of this angle is given, and must
    /// be above 0. The index of the far side is `index` times the index of the near side.
    #[inline]
    pub(crate) fn new(index: f64, cosine: f64) -> Self {
        let cosine = cosine.min(1.0);
        let sine_squared = (1.0 - cosine * cosine) / (index * index);
        Self {
            reflected: dielectric(index, cosine),
            index,
            cosines: [cosine, (1.0 - sine_squared).max(0.0).sqrt()],
        }
    }

    /// The direction behind the interface from which light is refracted to `wo` in front of
    /// the interface. `normal` is on the side of wo.
    #[inline]
    pub(crate) fn refracted(&self, wo: DVec3, normal: DVec3) -> DVec3 {
        let [near, far] = self.cosines;
        let across = (near * normal - wo) / self.index;
        (across - far * normal).normalize()
    }
}

/// The reflectance of a smooth interface for uniform light from all directions: 2 ∫ F(μ) μ
/// dμ over (0, 1).
///
/// Uses the midpoint rule in μ². With 10⁴ points, the error is less than 10⁻⁶ even if F has a kink.
pub(crate) fn diffuse_reflectance(index: f64) -> f64 {
    const POINTS: u32 = 10_000;
    let at = |i: u32| dielectric(index, ((f64::from(i) + 0.5) / f64::from(POINTS)).sqrt());
    (0..POINTS).map(at).sum::<f64>() / f64::from(POINTS)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANGLES: [f64; 5] = [0.0, 0.3, 0.7, 1.1, 1.4];

    /// Known values, computed from the two amplitudes in complex numbers.
    #[test]
    fn known_values() {
        let dielectric = [
            0.04,
            0.040_141_638_474_671_996,
            0.045_807_898_596_632_763,
            0.106_337_144_148_651_86,
            0.395_131_394_819_772_31,
        ];
        let conductor = [
            0.920_983_914_876_63,
            0.920_915_467_731_41,
            0.918_696_850_446_167_8,
            0.902_866_136_595_391,
            0.867_438_841_447_289_3,
        ];
        let metal = Fresnel::Conductor { n: 0.96, k: 6.69 };
        for (of, expected) in [
            (Fresnel::Dielectric { index: 1.5 }, dielectric),
            (metal, conductor),
        ] {
            for (angle, expected) in ANGLES.iter().zip(expected) {
                let share = reflectance(&of, libm::cos(*angle));
                // The values have 14 digits.
                assert!(
                    (share - expected).abs() < 1e-13,
                    "{of:?} at {angle}: {share}, {expected}"
                );
            }
        }
    }

    #[test]
    fn limits() {
        let glass = Fresnel::Dielectric { index: 1.5 };
        let air = Fresnel::Dielectric { index: 1.0 / 1.5 };
        // sin θ of total reflection is 1/1.5, so its cosine is 0.7454.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12; // rounding
        assert!(close(reflectance(&air, 0.74), 1.0));
        assert!(reflectance(&air, 0.75) < 0.8);
        assert!(close(reflectance(&glass, 0.0), 1.0));
        for angle in ANGLES {
            let plain = reflectance(&glass, libm::cos(angle));
            let bare = Fresnel::Conductor { n: 1.5, k: 0.0 };
            assert!(
                close(reflectance(&bare, angle.cos()), plain),
                "no absorption at {angle}"
            );
            // The same interface is met from inside, at the angle of refraction.
            let inside = libm::asin(libm::sin(angle) / 1.5);
            assert!(
                close(reflectance(&air, inside.cos()), plain),
                "reversed at {angle}"
            );
        }
        // Egan and Hilgeman 1973: 0.0918 and 0.5963 for an index of 1.5.
        assert!((diffuse_reflectance(1.5) - 0.0918).abs() < 1e-4);
        assert!((diffuse_reflectance(1.0 / 1.5) - 0.5963).abs() < 1e-4);
    }
}
