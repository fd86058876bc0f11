//! What an interface reflects, as the mean of both polarisations, and where it refracts to.

use etendue_field::Fresnel;
use etendue_trace::brdf::reflected_share;
use glam::DVec3;

/// An interface at an angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    /// The share that is reflected.
    pub(super) reflected: f64,
    /// Index of the far side over that of the near one.
    index: f64,
    /// Cosines on the near and the far side.
    cosines: [f64; 2],
}

/// An interface whose far side has `index` times that of the near one, at an angle of this cosine, above 0.
pub(super) fn dielectric(index: f64, cosine: f64) -> Interface {
    let cosine = cosine.min(1.0);
    let sine = (1.0 - cosine * cosine) / (index * index);
    Interface {
        reflected: reflected_share(&Fresnel::Dielectric { index }, cosine),
        index,
        cosines: [cosine, (1.0 - sine).max(0.0).sqrt()],
    }
}

impl Interface {
    /// The direction behind the interface that goes on to `wo` before it; `normal` is on the side of wo.
    pub(super) fn refracted(&self, wo: DVec3, normal: DVec3) -> DVec3 {
        let [near, far] = self.cosines;
        let across = (near * normal - wo) / self.index;
        (across - far * normal).normalize()
    }
}

/// What a smooth interface reflects of light that arrives evenly from all directions: 2 ∫ F(μ) μ dμ.
pub(super) fn diffuse_reflectance(index: f64) -> f64 {
    mean(|cosine| dielectric(index, cosine).reflected)
}

/// 2 ∫ f(μ) μ dμ over (0, 1), by the midpoint rule in μ²; 10⁴ points leave less than 10⁻⁶ where f has a kink.
pub(super) fn mean(f: impl Fn(f64) -> f64) -> f64 {
    const POINTS: u32 = 10_000;
    let at = |i: u32| f(((f64::from(i) + 0.5) / f64::from(POINTS)).sqrt());
    (0..POINTS).map(at).sum::<f64>() / f64::from(POINTS)
}
