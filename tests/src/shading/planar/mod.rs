//! The operators of a reflection in 2D, as the paper describes them. Other tests compare them with
//! quadrature and with traced rays.
//!
//! | step | here | in Durand et al. 2005 |
//! |---|---|---|
//! | factor given by a table of values | [`table`] | section 4.3 |
//! | separable BRDFs and their weighted sums | [`SeparableTerm`] | Eq. 17, section 4.5 |
//! | texture, BRDF that varies in space | [`texture`], [`semi_convolution`] | Eq. 18, section 4.5 |
//! | all seven steps of a reflection | [`PlanarReflection`] | section 4.1 |
//! | differential irradiance of an environment | [`environment`] | section 6.1, Fig. 14 |
//!
//! Frequencies are in cycles per metre and per radian. The spectrum of a product is a convolution of
//! spectra, and the spectrum of a convolution over angles is a product of spectra.

pub(super) mod environment;
mod product;
mod reflection;
mod schlick;
mod table;

pub(super) use product::{Lattice, TextureWave, angular_product, semi_convolution, texture};
pub(super) use reflection::{Factor, PlanarReflection, ReflectionStep, SeparableTerm};
pub(super) use schlick::Schlick;
pub(super) use table::table_hat;
