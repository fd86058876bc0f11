//! The exact conversion between slopes, which are two-plane coordinates, and angles, which are
//! plane-sphere coordinates.
//!
//! The conversion does not change positions. In 2D the slope is v = tan θ. In 4D the direction is
//! D + u X + v Y. With longitude θ and latitude φ the direction is cos φ (cos θ D + sin θ X) + sin
//! φ Y, so u = tan θ and v = tan φ / cos θ (Durand et al. 2005, section 5.2, whose "co-latitude" φ
//! is a latitude). Radiance does not change under the conversion; a density must be multiplied by
//! the Jacobian. Angles are in radians, within ± π/2.
//!
//! The effect of the conversion on a spectrum is not an affine map; in 2D the effect is an
//! integral with the kernel [`plane_sphere_kernel`](super::plane_sphere_kernel). If slopes are
//! treated as angles, the error is of second order: frequencies are stretched by 1 + v² at the
//! slope v.

/// Converts (x, v) to (x, θ).
#[must_use]
pub fn to_angles_2d([x, v]: [f64; 2]) -> [f64; 2] {
    [x, libm::atan(v)]
}

/// Converts (x, θ) to (x, v).
#[must_use]
pub fn to_slopes_2d([x, theta]: [f64; 2]) -> [f64; 2] {
    [x, libm::tan(theta)]
}

/// Returns dv/dθ = 1/cos² θ.
#[must_use]
pub fn jacobian_2d(theta: f64) -> f64 {
    libm::cos(theta).powi(-2)
}

/// Converts (x, y, u, v) to (x, y, θ, φ).
#[must_use]
pub fn to_angles([x, y, u, v]: [f64; 4]) -> [f64; 4] {
    [x, y, libm::atan(u), libm::atan2(v, libm::hypot(1.0_f64, u))]
}

/// Converts (x, y, θ, φ) to (x, y, u, v).
#[must_use]
pub fn to_slopes([x, y, theta, phi]: [f64; 4]) -> [f64; 4] {
    [x, y, libm::tan(theta), libm::tan(phi) / libm::cos(theta)]
}

/// Returns du dv / dθ dφ = 1/(cos³ θ cos² φ), at (θ, φ).
#[must_use]
pub fn jacobian([theta, phi]: [f64; 2]) -> f64 {
    libm::cos(theta).powi(-3) * libm::cos(phi).powi(-2)
}
