//! The geometry of rays near a central ray. Every geometric step of a light path is one affine map.
//!
//! A ray is a point z of 2 or 4 coordinates, positions first: (x, u) or (x, y, u, v). A step maps
//! the ray to z' = A z + t and preserves the ray's radiance. The step therefore maps the spectrum L
//! to L'(Ω) = |det A| e^(−2πi Ω·t) L(Aᵀ Ω) (docs/theory.md (1)). An [`AffineMap`] is such a step.
//! The functions of this module construct maps, or return the effect of a map on rays, spectra and
//! covariances. Steps are chained by [`AffineMap::then`] in the order of propagation:
//!
//! | step | constructor | in Durand et al. 2005 |
//! |---|---|---|
//! | travel | [`AffineMap::travel`] | Eq. 3 |
//! | thin lens | [`AffineMap::thin_lens`] | – |
//! | light incidence: onto the surface | [`incidence`](AffineMap::<2>::incidence) | Eq. 9 |
//! | curvature: into local frames | [`2D`](AffineMap::<2>::curvature), [`4D`](AffineMap::<4>::curvature) | 11, 19 |
//! | mirror | [`AffineMap::mirror`] | Eq. 14 |
//! | refraction | [`refraction`](AffineMap::<2>::refraction) | – |
//! | back from the local normals | [`back`](AffineMap::<2>::back) | step 6 |
//! | outgoing angle: off the surface | [`outgoing`](AffineMap::<2>::outgoing) | Eq. 10 |
//! | turning the axes | [`AffineMap::rotation`] | section 5.2 |
//!
//! In the frame of a light ray, the last coordinates are slopes or angles to the central ray. These
//! maps hold to first order, and to this order slopes and angles are equal. Lengths are in metres,
//! angles in radians.
//!
//! **Surface frame.** N is the normal at the point that the central ray hits, on the side from
//! which light comes. T and N are the axes of the plane of incidence; if N points up, T points to
//! the right. B is N × T. Directions point away from the surface, and their angle θ is counted from
//! N towards T. The coordinate s is arc length along T. With c₀ = cos θ₀ and c₁ = cos θ₁, the axes
//! before the event are D = −(sin θ₀ T + c₀ N) and X = −c₀ T + sin θ₀ N. After the event the axes
//! are D = sin θ₁ T + c₁ N and X = c₁ T − sin θ₁ N. Y is B before and after the event. In 4D, a
//! direction of longitude θ and latitude φ is cos φ (sin θ T + cos θ N) + sin φ B.
//!
//! **Order.** Travel, mirror and a thin lens are exact. A step between a light frame and a surface
//! holds to first order in the size e of the neighbourhood. The relative error of the step falls as
//! e, and at normal incidence as e².
//!
//! **The printed equations.** Some equations of Durand et al. 2005 differ from the maps of this
//! module; [`Edition`] contains both versions.
//!
//! ```
//! use etendue_theory::geometry::AffineMap;
//!
//! // A concave mirror of radius 2 m, met at 0.3 rad, focuses parallel light at R/2 · cos 0.3.
//! let onto = AffineMap::<2>::incidence(0.3).then(&AffineMap::<2>::curvature(-0.5));
//! let off = AffineMap::<2>::back(-0.5).then(&AffineMap::<2>::outgoing(-0.3));
//! let map = onto.then(&AffineMap::mirror()).then(&off);
//! // There the position of a ray depends on its direction alone.
//! let f = 0.3_f64.cos();
//! let [x, _] = map.then(&AffineMap::travel(f)).apply([0.01, 0.002]);
//! assert!((x + f * 0.002).abs() < 1e-15);
//! ```

mod map;
mod matrix;
mod printed;
mod refraction;
mod spectrum_map;
mod surface;
#[cfg(test)]
pub(crate) mod tests;
mod travel;

pub use map::AffineMap;
pub use matrix::Matrix;
pub(crate) use matrix::{
    congruent, diagonal, from_fn, inverse, plus, product, sum, times, transpose,
};
pub use printed::Edition;
pub use refraction::Media;
pub use spectrum_map::SpectrumMap;
