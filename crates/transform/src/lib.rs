//! The numerical tools that the tracer and theory share: transforms, nets and random numbers.
//!
//! [`SliceTransform`] sums weighted rays on all slices of a [`SliceGrid`](etendue_field::SliceGrid)
//! by a non-uniform fast Fourier transform, tested against the plain sums of [`direct`].
//! [`RealFft4`] transforms a 4D grid. A [`Net`] generates the points of a scrambled Sobol' net, and
//! the module [`random`] generates random numbers that are addressed by index.
//!
//! This crate knows no scenes, photons or theory.
//!
//! ```
//! use etendue_field::{FrequencyAxis, SliceGrid, TwoPlane};
//! use etendue_transform::SliceTransform;
//!
//! let grid = SliceGrid {
//!     azimuths: 1,
//!     rho: FrequencyAxis { half: 2, spacing: 1.0 },
//!     nu: FrequencyAxis { half: 2, spacing: 1.0 },
//! };
//! let plan = SliceTransform::new(&grid);
//! let mut sum = plan.accumulator();
//! sum.deposit(&TwoPlane { x: 0.25, ..TwoPlane::default() }, 3.0);
//! let slices = sum.finish(1.0);
//! // At ρ = 1 cycle per metre, a ray at x = 1/4 m has the phase −π/2.
//! assert!((slices.half[[0, 1, 2]].im + 3.0).abs() < 1e-6); // 2e-7 of the weight
//! ```

pub mod direct;
mod fft;
mod net;
mod quadrature;
pub mod random;
mod slices;

pub use fft::{RealFft4, real, real_mut};
pub use net::{Net, sobol_directions};
pub use quadrature::gauss_legendre;
pub use slices::{Accumulator, SliceTransform};
