//! Shading in 2D. This module computes the effect of the cosine, the BRDF, a texture and an
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
//! | Fresnel factor | [`FresnelFactor`] | section 4.3 |
//! | factor given by a table of values | [`table_hat`] | section 4.3 |
//! | BRDF lobe about the mirror direction | [`PlanarLobe`] | Eq. 15, 16 |
//! | separable BRDFs and their weighted sums | [`SeparableTerm`] | Eq. 17, section 4.5 |
//! | texture, BRDF that varies in space | [`texture`], [`semi_convolution`] | Eq. 18, section 4.5 |
//! | all seven steps of a reflection | [`PlanarReflection`] | section 4.1 |
//! | an environment map on a curved surface | [`environment`] | section 6.1, Fig. 14 |
//! | number of samples that a glossy reflection requires | [`Criterion`] | Eq. 20, 21 |
//! | diffuse receivers, in slopes | [`g_hat`], [`g_hat_3d`] | Eq. 7 and section 5.1 |
//! | all six steps of diffuse shading, in slopes | [`Flatland`] | section 3, Fig. 6 |
//!
//! ```
//! use etendue_field::Complex;
//! use etendue_theory::shading::{Factor, Lattice, PlanarLobe, PlanarReflection, ReflectionStep, SeparableTerm};
//!
//! // A glossy cylinder of radius 2 m, in light with Gaussian profiles of 0.1 m and 0.1 rad.
//! let gloss = SeparableTerm { before: Factor::Cosine, lobe: Some(PlanarLobe::Phong { exponent: 50.0 }), after: Factor::One, weight: None };
//! let reflection = PlanarReflection {
//!     incidence: 0.4,
//!     outgoing: -0.4,
//!     curvature: 0.5,
//!     terms: vec![gloss],
//!     lattice: Lattice::circle(20.0),
//! };
//! let light = |[x, t]: [f64; 2]| Complex::from((-0.2 * (x * x + t * t)).exp());
//! let [soft, sharp] = [0.0, 3.0].map(|t| reflection.spectrum(ReflectionStep::Outgoing, [0.0, t], &light).norm());
//! assert!(sharp < soft);
//! ```

mod bandwidth;
mod cosine;
mod diffuse;
mod energy;
pub mod environment;
mod flatland;
mod fresnel;
mod gamma;
mod lobe;
mod panels;
mod product;
mod reflection;
mod table;

pub use bandwidth::{COSINE_CUTOFF, Criterion};
pub use cosine::{cosine_hat, cosine_power_hat, cosine_series, cosine_squared_hat};
pub use diffuse::{g_hat, g_hat_3d};
pub use energy::energy_below;
pub use flatland::{DiffuseStep, Flatland};
pub use fresnel::FresnelFactor;
pub(crate) use fresnel::unpolarised_reflectance;
pub use lobe::PlanarLobe;
pub use product::{Lattice, TextureWave, angular_product, semi_convolution, texture};
pub use reflection::{Factor, PlanarReflection, ReflectionStep, SeparableTerm};
pub use table::table_hat;
