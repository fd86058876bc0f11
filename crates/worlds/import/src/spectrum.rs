//! Conversion of spectra to colours.

use crate::cie::{COUNT, D65, FIRST_WAVELENGTH, LAST_WAVELENGTH, OBSERVER};
use etendue_field::whole;

/// Number of wavelengths at which a spectrum is summed.
const STEPS: u32 = 1000;
/// The factor that normalises the constant spectrum 1 to luminance 1.
const PER_OBSERVER: f64 = 1.0 / 106.750_259_399_414_06;
/// The factor that normalises the power of D65 to luminance 1.
const PER_D65: f64 = 1.0 / 98.997_417_518_762_55;

/// The quantity that a spectrum represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// A reflectance or transmittance, 0 to 1.
    Reflectance,
    /// A quantity without an upper limit, such as an index of refraction.
    Number,
    /// Emitted light.
    Emission,
}

/// The linear sRGB colour of a spectrum: pairs of a wavelength, nm, in rising order, and a
/// value. See [`Color`](crate::Color).
pub(crate) fn rgb(samples: &[[f64; 2]], role: Role) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    let mut next = 0;
    for step in 0..STEPS {
        let wavelength = FIRST_WAVELENGTH
            + f64::from(step) / f64::from(STEPS - 1) * (LAST_WAVELENGTH - FIRST_WAVELENGTH);
        while next < samples.len() && samples[next][0] <= wavelength {
            next += 1;
        }
        let Some(value) = between(samples, next, wavelength) else {
            continue;
        };
        let lit = match role {
            Role::Emission => value,
            _ => value * at(&D65, wavelength) * PER_D65,
        };
        for (sum, observer) in xyz.iter_mut().zip(&OBSERVER) {
            *sum += at(observer, wavelength) * lit;
        }
    }
    let scale = (LAST_WAVELENGTH - FIRST_WAVELENGTH) * PER_OBSERVER / f64::from(STEPS);
    let most = if role == Role::Reflectance {
        1.0
    } else {
        f64::INFINITY
    };
    from_xyz(xyz.map(|sum| sum * scale)).map(|v| v.clamp(0.0, most))
}

/// Converts CIE XYZ to linear sRGB, with Mitsuba's coefficients.
pub(crate) fn from_xyz([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.240_479 * x - 1.537_150 * y - 0.498_535 * z,
        -0.969_256 * x + 1.875_991 * y + 0.041_556 * z,
        0.055_648 * x - 0.204_043 * y + 1.057_311 * z,
    ]
}

/// The value at a wavelength before sample `next`, or `None` beyond the ends of the
/// spectrum.
fn between(samples: &[[f64; 2]], next: usize, wavelength: f64) -> Option<f64> {
    let [w0, v0] = *samples.get(next.checked_sub(1)?)?;
    match samples.get(next) {
        Some([w1, v1]) => Some(v0 + (wavelength - w0) / (w1 - w0) * (v1 - v0)),
        // The last wavelength of a spectrum is inside the spectrum's range.
        None => (wavelength <= w0).then_some(v0),
    }
}

fn at(table: &[f64; COUNT], wavelength: f64) -> f64 {
    let place =
        (wavelength - FIRST_WAVELENGTH) / (LAST_WAVELENGTH - FIRST_WAVELENGTH) * (COUNT - 1) as f64;
    let index = whole(place).min(COUNT - 2);
    let share = place - index as f64;
    table[index] * (1.0 - share) + table[index + 1] * share
}
