//! Shading in 2D. This module computes the effect of the cosine, of a BRDF's lobe and of an
//! environment on spectra (docs/theory.md, section 9).
//!
//! Angles follow the [geometry](crate::geometry): directions point away from the surface, θ is
//! counted from the normal towards T, and a mirror has θ_o = −θ_i. Frequencies are in cycles per
//! metre and per radian. The spectrum of a product is a convolution of spectra, and the spectrum of
//! a convolution over angles is a product of spectra. No constant factors are needed:
//!
//! | step | here | in Durand et al. 2005 |
//! |---|---|---|
//! | cosine | [`cosine_hat`] | Eq. 12, 13 |
//! | Fresnel factor | [`fresnel_reflectance`], [`fresnel_cosine_hat`] | section 4.3 |
//! | BRDF lobe about the mirror direction | [`PlanarLobe`] | Eq. 15, 16 |
//! | an environment map on a curved surface | [`environment`] | section 6.1, Fig. 14 |
//! | number of samples that a glossy reflection requires | [`Criterion`] | Eq. 20, 21 |
//! | diffuse receivers, in slopes | [`g_hat`], [`g_hat_3d`] | Eq. 7 and section 5.1 |
//!
//! ```
//! use etendue_theory::shading::{PlanarLobe, cosine_hat};
//!
//! // A glossy lobe multiplies spectra along Ωθ, so it removes high frequencies.
//! let gloss = PlanarLobe::Phong { exponent: 50.0 };
//! let [slow, fast] = [0.0, 3.0].map(|omega| gloss.spectrum(omega) * cosine_hat(omega));
//! assert!((slow - 2.0).abs() < 1e-12 && fast.abs() < 1e-2);
//! ```

mod bandwidth;
mod cosine;
mod diffuse;
pub mod environment;
mod fresnel;
mod lobe;
mod panels;

pub use bandwidth::{COSINE_CUTOFF, Criterion};
pub use cosine::{cosine_hat, cosine_power_hat, cosine_squared_hat};
pub use diffuse::{g_hat, g_hat_3d};
pub(crate) use fresnel::unpolarised_reflectance;
pub use fresnel::{fresnel_cosine_hat, fresnel_reflectance};
pub use lobe::PlanarLobe;
pub use panels::even_transform;
