//! Windowed spectra behind specular surfaces, by following rays (docs/theory.md, section 8).
//!
//! The inputs are a [`SpecularSystem`] and a [`Plane`]. The system has a light, masks across its
//! first leg, obstacles on any leg, and the mirrors, refracting surfaces and lenses that the
//! central ray visits. A system and a plane together are an [`Observed`](crate::Observed), which is
//! a [`Model`](crate::Model). The model follows rays through the real geometry and sums them, by a
//! quadrature rule if the rule converges and over scrambled nets otherwise. The function
//! [`chain`](chain()) derives the chain of first-order maps ([`geometry`](crate::geometry)) from
//! the same system, and [`linear()`] returns the prediction of such a chain. A measurement may
//! differ from the first-order chain because of noise, of linearisation, or of faults. A comparison
//! with both predictions separates these causes.
//!
//! All coordinates are in the frame at the light: the central ray starts at the origin along Z, and
//! (x, y) are along X and Y. A ray carries flux; `emission.rs` defines the flux of the rays of each
//! light. Flux is conserved at every surface. A ray is lost if it misses a patch, if it is totally
//! reflected, or if the next patch or the plane is behind it. Flux Φ corresponds to Φ (1 + u² +
//! v²)² in radiance space at a plane perpendicular to the central ray, and to Φ/(cos θ cos² φ) on a
//! surface (docs/theory.md, section 8).
//!
//! For a plane on a surface itself (`LocalNormals`), the integral over positions is over the
//! surface's area.
//!
//! This module shares neither intersection code nor sampling code with the tracers.
//!
//! ```
//! use etendue_field::{FrequencyAxis, Frame, Image, Light, Patch, Profile,
//! # ProjectionGrid, SliceGrid, Specular, Window};
//! use etendue_theory::{RayBudget, Model, Observed};
//! use etendue_theory::geometry::Edition;
//! use etendue_theory::rays::{SpecularSurface, Plane, SpecularSystem, chain, linear};
//! use glam::DVec3;
//!
//! // A beam along the axis of a concave mirror of radius 2 m; the plane is half-way to the focus.
//! let image = Image { width: [0.02; 2], grating: None };
//! let patch = Patch {
//!     frame: Frame::new(DVec3::Z, -DVec3::Z, DVec3::X).unwrap(),
//!     curvature: [-0.5; 3],
//!     aperture: 0.3,
//! };
//! let mirror = SpecularSurface { name: "mirror".into(), patch, event: Specular::Mirror };
//! let light = Light::Beam { irradiance: 1.0, image };
//! let system = SpecularSystem { light, layers: vec![], obstacles: vec![], elements: vec![mirror] };
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
mod model;
mod predict;
mod quadrature;
mod region;
mod sums;
#[cfg(test)]
mod tests;
mod trace;

pub use chain::{AffineChain, chain};
pub use defect::{defect, radiance_defect};
pub use predict::linear;

pub use crate::plane::Plane;

pub(crate) use central::Incidence;
pub(crate) use emission::{emitted, point_of};
pub(crate) use model::shrunk_light;
pub(crate) use predict::{predict, with_rays};
pub(crate) use trace::bent;

use crate::obstacle::Obstacle;
use etendue_field::{Light, Mask, Patch, Specular};

/// A point of a recording plane may be behind the light's plane by up to this distance, in metres,
/// and still be lit. This tolerance covers the rounding errors of a tilted recording plane at the
/// light itself. No object is closer to the light than this tolerance.
pub(crate) const AT_LIGHT: f64 = 1e-9;

/// A light and the specular surfaces that its central ray visits, in the frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct SpecularSystem {
    /// The light, which emits from the plane z = 0, along Z.
    pub light: Light,
    /// Masks across the first leg and their distances from the light, metres. If a mask has opaque
    /// parts, rays are summed over nets instead of by a quadrature rule.
    pub layers: Vec<(f64, Mask)>,
    /// Occluders other than the masks, on any leg.
    pub obstacles: Vec<Obstacle>,
    /// The surfaces in the order in which light from the source meets them.
    pub elements: Vec<SpecularSurface>,
}

/// A specular surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SpecularSurface {
    /// The name of the surface, which messages use.
    pub name: String,
    /// The geometry of the surface.
    pub patch: Patch,
    /// The event at the surface. A refracted ray goes from the side of the incident ray to the
    /// other side of the surface. A thin lens is flat. Slopes at a lens are relative to X and Y of
    /// the patch's frame and to the normal on the side to which light goes.
    pub event: Specular,
}
