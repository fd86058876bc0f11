//! Windowed spectra behind specular surfaces, by following rays (docs/theory.md, section 8).
//!
//! The surfaces that light leaves before the plane are mirrors, refracting surfaces and lenses. The
//! model of such a [path](crate::path) follows rays through the real geometry and sums them, by a
//! quadrature rule if the rule converges and over scrambled nets otherwise. The function
//! [`chain`](chain()) derives the chain of first-order maps ([`geometry`](crate::geometry)) from
//! the same system, and [`linear()`] returns the prediction of such a chain. A measurement may
//! differ from the first-order chain because of noise, of linearisation, or of faults. A comparison
//! with both predictions separates these causes.
//!
//! All coordinates are in the frame at the light: the central ray starts at the origin along Z, and
//! (x, y) are along X and Y. A ray carries flux; `emission.rs` defines the flux of the rays of each
//! light. Flux is conserved at every surface. A ray is lost if it misses a patch, if it is totally
//! reflected, if the next patch or the plane is behind it, or if something stops it before. Flux Φ
//! corresponds to Φ (1 + u² + v²)² in radiance space at a plane perpendicular to the central ray, and
//! to Φ/(cos θ cos² φ) on a surface (docs/theory.md, section 8).
//!
//! For a plane on a surface itself (`LocalNormals`), the integral over positions is over the
//! surface's area.
//!
//! ```
//! use etendue_field::{FrequencyAxis, Frame, Image, Light, Patch, Profile,
//! # ProjectionGrid, SliceGrid, Specular, Window};
//! use etendue_theory::{RayBudget, Model, Observed, Plane};
//! use etendue_theory::geometry::Edition;
//! use etendue_theory::path::{Interaction, PathSurface, PathSystem};
//! use etendue_theory::path::rays::{chain, linear};
//! use glam::DVec3;
//!
//! // A beam along the axis of a concave mirror of radius 2 m; the plane is half-way to the focus.
//! let image = Image { width: [0.02; 2], grating: None };
//! let patch = Patch {
//!     frame: Frame::new(DVec3::Z, -DVec3::Z, DVec3::X).unwrap(),
//!     curvature: [-0.5; 3],
//!     aperture: 0.3,
//! };
//! let mirror = PathSurface::new("mirror", patch, Interaction::Specular(Specular::Mirror));
//! let light = Light::Beam { irradiance: 1.0, image };
//! let system = PathSystem::new(light, vec![mirror]);
//! let plane = Plane::orthogonal(Frame::new(0.5 * DVec3::Z, -DVec3::Z, -DVec3::X).unwrap());
//! let view = Observed { system, plane };
//! let first = chain(&view, Edition::Corrected).unwrap();
//! assert!((first.foci[0] - 1.0).abs() < 1e-12);
//! let profile = Profile::Hann(0.02);
//! let window = Window { x: profile, y: profile, u: profile, v: profile };
//! let axis = FrequencyAxis { half: 8, spacing: 25.0 };
//! let grid = SliceGrid { azimuths: 2, rho: axis, nu: axis };
//! let picture = ProjectionGrid::new(&window, 16);
//! let over = (&window, &grid, &picture);
//! let budget = RayBudget::new(1e6, 1e-3);
//! let right = view.predict(&[], over, budget);
//! let near = linear(&view, over, &first.map, budget);
//! // Slopes of 0.02 are small.
//! let off = near.slices.at_zero() / right.slices.at_zero() - 1.0;
//! assert!(off.abs() < 1e-3 && right.error < Some(1e-4));
//! ```

mod backward;
mod central;
mod chain;
mod coordinates;
mod defect;
mod draw;
mod emission;
mod predict;
mod quadrature;
mod region;
mod sums;
#[cfg(test)]
mod tests;
mod trace;

pub use chain::{AffineChain, chain};
pub use defect::{defect, radiance_defect};
pub use predict::{LightRay, linear, sampled};

pub(crate) use central::{CentralHit, Incidence};
pub(crate) use predict::{predict, with_rays};
pub(crate) use trace::bent;

/// A point of a recording plane may be behind the light's plane by up to this distance, in metres,
/// and still be lit. This tolerance covers the rounding errors of a tilted recording plane at the
/// light itself. No object is closer to the light than this tolerance.
pub(crate) const AT_LIGHT: f64 = 1e-9;
