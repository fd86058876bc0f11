//! Predicted spectra of local light fields, in closed form or from nets of rays.
//!
//! Every prediction comes from a [`Model`]. A model is a [`Chain`] of parallel planes, or the light
//! of a path over surfaces, [`Observed`] at a plane ([`path`]).
//!
//! A [`Chain`] contains a light, travel, masks, and the cosine and diffuse reflection of a
//! receiver. Masks are opaque shapes, half-planes and cosine gratings in planes. The prediction
//! contains the values that a measurement would have without noise: the [`slices`] of the windowed
//! spectrum, an estimate of their error ([`quadrature_error`]), their derivatives ([`with_derivatives`]) with respect
//! to any parameter of the chain, and the [`projection`] on (x, u).
//!
//! Travel is a shear of (position, slope), so every edge stays a straight line. Every field is then
//! a signed sum of products of two convex polygons, one in (x, u) and one in (y, v); windows and
//! gratings are sums of cosines. The transform of a convex polygon has a closed form, which
//! requires no quadrature and no grid and has no aliasing. A disc is replaced by a weighted sum of
//! rectangles, and a factor that depends on slopes is replaced by a sum of products of cosine
//! series. Both sums converge exponentially.
//!
//! [`geometry`] contains the steps that bend a light path (incidence, curvature, mirrors,
//! refraction, lenses). Each step is an affine map of rays, with its effect on spectra and
//! covariances. A [`Chain`] does not use these maps. A [`path`] predicts light in two ways: exactly,
//! by rays, and to first order, by affine maps that are derived from the same surfaces.
//! [`covariance`] follows second moments of spectra along the same paths. [`shading`] has cosines,
//! BRDF lobes, Fresnel factors and environments, in 2D.
//!
//! This crate has no access to scenes, photons or measured spectra, so the agreement of a
//! prediction with a measurement is evidence that both are correct.
//!
//! ```
//! use etendue_field::{FrequencyAxis, Light, Mask, Profile, Rectangle, Shape, SliceGrid, Window};
//! use etendue_theory::{Chain, Operator, Source, at, slices};
//!
//! let square = |side| Shape::Rectangle(Rectangle { center: [0.0, 0.0], size: [side, side] });
//! let light = Light::Area { shape: square(0.2), radiance: 1.0, exponent: 0.0 };
//! let mask = Mask::Opaque { shapes: vec![square(0.1)], half_planes: vec![] };
//! let travel = |from: &str, to: &str| Operator::Travel { from: from.into(), to: to.into(), distance: 1.0 };
//! let chain = Chain {
//!     source: Source { name: "light".into(), light },
//!     operators: vec![
//!         travel("light", "blocker"),
//!         Operator::Visibility { name: "blocker".into(), mask },
//!         travel("blocker", "receiver"),
//!     ],
//! };
//! let (x, u) = (Profile::Hann(0.5), Profile::Hann(0.3));
//! let window = Window { x, y: x, u, v: u };
//! let axis = |spacing| FrequencyAxis { half: 4, spacing };
//! let grid = SliceGrid { azimuths: 2, rho: axis(1.0), nu: axis(1.7) };
//! let prediction = slices(&chain, &window, &grid);
//! let plain = at(&chain, &window, grid.frequency(1, 2.0, -1.7));
//! assert!((prediction.half[[1, 2, 3]] - plain).norm() < 1e-10 * prediction.at_zero());
//! ```

mod barrier;
pub mod covariance;
pub mod geometry;
mod light;
mod model;
mod nets;
mod obstacle;
mod parallel;
mod parameter;
pub mod path;
mod plane;
mod predicted;
mod quadrature;
#[cfg(test)]
mod reference;
pub mod shading;
mod sky;
mod step;
#[cfg(test)]
mod testing;
mod words;
mod work;

pub use light::without_closed_form;
pub use model::{Model, Over};
pub use nets::{REPLICATES, RayBudget, RayNets};
pub use obstacle::{Obstacle, ObstacleForm, TriangleTree};
pub use parallel::{
    Chain, Harmonics, Operator, Source, at, projection, quadrature_error, slices, with_derivatives,
};
pub use parameter::Parameter;
pub use path::{Observed, PathKind};
pub use plane::Plane;
pub use predicted::{NetMean, Predicted};
pub use shading::{g_hat, g_hat_3d};
pub use step::{ChainAction, ChainStep};
pub use work::PredictionWork;
