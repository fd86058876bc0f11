//! One operator for the effect of a weighted sum of BRDFs on spectra.

use etendue_field::{Brdf, Complex, Fresnel, Lobe, Pattern, Reflectance, Weight};
use etendue_theory::shading::cosine_power_hat;
use std::f64::consts::TAU;

/// The spectrum at Ω = (Ωx, Ωy, Ωθ, Ωφ) of the light that leaves a surface, in the frames
/// of its local normals. `before` is the spectrum of the differential irradiance, rotated about
/// the normals. For each BRDF, `before` is multiplied by the transform of the BRDF's lobe over
/// (Ωθ, Ωφ), and the product is convolved over (Ωx, Ωy) with the transform of the BRDF's weight
/// (Durand et al. 2005, section 4.5, the "semi-convolution" in 4D).
///
/// The result holds to first order, like the chain. The result includes light at all angles; a
/// window over positions must be included in `before`. `axes` are the axes X and Y of the surface's
/// patch in the coordinates (x, y). Returns `None` if a lobe is not a Phong lobe, if a BRDF has a
/// factor that depends on an angle, or if a weight or a texture is not a cosine.
pub(super) fn semi_convolution(
    reflectance: &Reflectance,
    axes: [[f64; 2]; 2],
    omega: [f64; 4],
    before: &dyn Fn([f64; 4]) -> Complex,
) -> Option<Complex> {
    let [x, y, theta, phi] = omega;
    let texture = reflectance.texture.as_ref().map(cosine_waves);
    let texture = texture.unwrap_or_else(|| Some(vec![CONSTANT]))?;
    let mut sum = Complex::from(0.0);
    for term in &reflectance.terms {
        let lobe = lobe_hat(&term.brdf, [theta, phi])?;
        for weight in waves(&term.weight)? {
            for texture in &texture {
                let frequency = [0, 1].map(|i| weight.frequency[i] + texture.frequency[i]);
                let [fx, fy] =
                    [0, 1].map(|i| frequency[0] * axes[0][i] + frequency[1] * axes[1][i]);
                let moved = before([x - fx, y - fy, theta, phi]);
                sum += weight.amplitude * texture.amplitude * lobe * moved;
            }
        }
    }
    Some(sum)
}

/// A wave A e^(2πi (f s + g t)) in the Fourier series of a BRDF's weight over a surface.
#[derive(Clone, Copy)]
struct WeightWave {
    frequency: [f64; 2],
    amplitude: Complex,
}

const CONSTANT: WeightWave = WeightWave {
    frequency: [0.0; 2],
    amplitude: Complex::new(1.0, 0.0),
};

fn waves(weight: &Weight) -> Option<Vec<WeightWave>> {
    match weight {
        Weight::One => Some(vec![CONSTANT]),
        Weight::Pattern(pattern) => cosine_waves(pattern),
        Weight::Rest(pattern) => {
            let mut waves = cosine_waves(pattern)?;
            for wave in &mut waves {
                wave.amplitude = -wave.amplitude;
            }
            waves.push(CONSTANT);
            Some(waves)
        }
    }
}

/// The waves of a cosine pattern, ½ + ¼ m (e^(2πi f t + ip) + its conjugate).
fn cosine_waves(pattern: &Pattern) -> Option<Vec<WeightWave>> {
    let Pattern::Cosine(grating) = pattern else {
        return None;
    };
    let side = |sign: f64| {
        let mut frequency = [0.0; 2];
        frequency[grating.axis] = sign * grating.frequency;
        let (sin, cos) = libm::sincos(sign * grating.phase);
        let amplitude = Complex::new(cos, sin) * (0.25 * grating.modulation);
        WeightWave {
            frequency,
            amplitude,
        }
    };
    let mean = WeightWave {
        amplitude: Complex::from(0.5),
        ..CONSTANT
    };
    Some(vec![mean, side(1.0), side(-1.0)])
}

/// The transform of the Phong lobe albedo (n + 1)/2π (cos θ cos φ)ⁿ over both angles from
/// the mirror direction.
fn lobe_hat(brdf: &Brdf, [theta, phi]: [f64; 2]) -> Option<Complex> {
    let is_plain =
        brdf.fresnel == Fresnel::White && brdf.incoming.is_none() && brdf.outgoing.is_none();
    match brdf.lobe {
        Lobe::Phong { exponent } if is_plain => {
            let along = cosine_power_hat(exponent, theta) * cosine_power_hat(exponent, phi);
            Some(Complex::from(brdf.albedo * (exponent + 1.0) / TAU * along))
        }
        _ => None,
    }
}
