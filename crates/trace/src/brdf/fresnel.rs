//! The share of unpolarised light that is reflected at an interface: the mean of both polarisations.

use etendue_field::Fresnel;

/// At an angle of incidence with this cosine, 0 to 1.
#[inline]
#[must_use]
pub fn reflected_share(fresnel: &Fresnel, cosine: f64) -> f64 {
    match *fresnel {
        Fresnel::White => 1.0,
        Fresnel::Dielectric { index } => dielectric(index, cosine),
        Fresnel::Conductor { n, k } => conductor(n, k, cosine),
    }
}

/// All of it beyond the critical angle of an index below 1.
fn dielectric(index: f64, cosine: f64) -> f64 {
    let squared = index * index;
    let inside = squared - 1.0 + cosine * cosine;
    if inside <= 0.0 {
        return 1.0;
    }
    // index · cos of the angle of refraction.
    let refracted = inside.sqrt();
    let s = (cosine - refracted) / (cosine + refracted);
    let p = (squared * cosine - refracted) / (squared * cosine + refracted);
    0.5 * (s * s + p * p)
}

/// The same with index n + i k: (n + i k)² − sin²θ = (a + i b)².
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
                let share = reflected_share(&of, libm::cos(*angle));
                // They are given to 14 digits.
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
        // sin θ of total reflection is 1/1.5: its cosine is 0.7454.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12; // rounding
        assert!(close(reflected_share(&air, 0.74), 1.0));
        assert!(reflected_share(&air, 0.75) < 0.8);
        assert!(close(reflected_share(&glass, 0.0), 1.0));
        for angle in ANGLES {
            let plain = reflected_share(&glass, libm::cos(angle));
            let bare = Fresnel::Conductor { n: 1.5, k: 0.0 };
            assert!(
                close(reflected_share(&bare, angle.cos()), plain),
                "no absorption at {angle}"
            );
            // The same interface from inside, at the angle of refraction.
            let inside = libm::asin(libm::sin(angle) / 1.5);
            assert!(
                close(reflected_share(&air, inside.cos()), plain),
                "reversed at {angle}"
            );
        }
    }
}
