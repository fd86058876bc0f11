//! Covariance tracing, which follows the second moments of a spectrum along a light path (Belcour
//! et al. 2013, *5D Covariance Tracing for Efficient Defocus and Motion Blur*). The dimension of
//! time is left out.
//!
//! A [`SpectralCovariance`] is the 4 × 4 matrix C of a Gaussian light field, whose power spectrum
//! is |L(Ω)|² ∝ exp(−½ Ωᵀ C⁻¹ Ω). Its axes are (ρx, ρy, νu, νv). Frequencies along x and y are in
//! cycles per metre. Frequencies along u and v are in cycles per unit slope or, on surfaces, in
//! cycles per radian. The units of the blocks of C are cycles²/m², cycles²/m and cycles². The light
//! field with this spectrum is the Gaussian exp(−½ zᵀ S⁻¹ z) with S⁻¹ = 8π² C (docs/theory.md,
//! section 6).
//!
//! | what light meets | operator | what becomes of C |
//! |---|---|---|
//! | travel, lens, projection, curvature, mirror, refraction | [`mapped`](SpectralCovariance::mapped) by any [`AffineMap`](crate::geometry::AffineMap) z' = A z + t | A⁻ᵀ C A⁻¹ |
//! | cosine, blocker, texture, the plane's window | [`multiplied`](SpectralCovariance::multiplied) | C + W |
//! | lobe of a BRDF | [`convolved`](SpectralCovariance::convolved) | (C⁻¹ + B⁻¹)⁻¹ |
//! | diffuse reflection | [`diffused`](SpectralCovariance::diffused) | the same with B = 0 along both angles |
//!
//! [`window`], [`mask`], [`grating`], [`cosine`] and [`lobe`] return the covariances W and B of the
//! elements of a scene, and [`Traced`] follows the covariance along a complete chain. The spectrum
//! of a field with edges has no second moments, but covariance tracing treats such a field as a
//! Gaussian. docs/covariance.md shows for which scenes this approximation holds.

mod factors;
mod pair;
#[cfg(test)]
mod tests;
mod traced;

pub use factors::{cosine, grating, lobe, mask, profile, slope_cosine, window};
pub use pair::{SpectralCovariance, power};
pub use traced::{Traced, Untraced};
