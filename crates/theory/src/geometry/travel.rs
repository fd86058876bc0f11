//! Steps in the frame of the central ray.

use super::AffineMap;
use super::matrix::{diagonal, from_fn, transpose};
use std::array;

impl<const N: usize> AffineMap<N> {
    /// The map of travel over a distance d, in metres: x' = x + d u, y' = y + d v.
    ///
    /// The step is exact if (u, v) are slopes. If (u, v) are angles, the step holds to first order.
    /// L'(Ωx, Ωu) = L(Ωx, Ωu + d Ωx) (Durand et al. 2005, Eq. 3, with the errors of Eq. 2
    /// corrected: docs/theory.md, section 1).
    #[must_use]
    pub fn travel(distance: f64) -> Self {
        let (one, half) = (diagonal::<N>([1.0; N]), N / 2);
        Self::linear(from_fn(
            |i, j| {
                if i + half == j { distance } else { one[i][j] }
            },
        ))
    }

    /// The map of a thin lens of focal length f, in metres: u' = u − x/f, v' = v − y/f. If
    /// f is positive, the lens converges light.
    ///
    /// The map describes an ideal lens, which images planes onto planes exactly if directions are
    /// slopes (docs/theory.md (24)). Durand et al. 2005 do not treat lenses.
    #[must_use]
    pub fn thin_lens(focal_length: f64) -> Self {
        Self::linear(transpose(&Self::travel(-1.0 / focal_length).matrix))
    }

    /// The map of the mirror reflection of local directions, θ' = −θ and φ' = −φ, in the
    /// frames of the local normals.
    ///
    /// L'(Ωx, Ωθ) = L(Ωx, −Ωθ) (Durand et al. 2005, Eq. 14). An ideal mirror has the BRDF δ/cos θ,
    /// so no cosine appears; the paper's bare Dirac (section 4.2) would leave a factor cos θ₀.
    #[must_use]
    pub fn mirror() -> Self {
        let signs = array::from_fn(|i| if i < N / 2 { 1.0 } else { -1.0 });
        Self::linear(diagonal(signs))
    }
}

impl AffineMap<4> {
    /// The map of a rotation of the axes by an angle in radians, from the first axis
    /// towards the second: x' = x cos + y sin, y' = −x sin + y cos, and likewise for directions. A
    /// is orthogonal.
    ///
    /// For two-plane coordinates, a rotation about the central ray is exact; it is used, for
    /// example, to bring the plane of incidence onto X. For a rotation about a surface normal, the
    /// map of (s_x, s_y) is exact, and the map of (θ, φ) holds to first order in the angle to the
    /// normal (Durand et al. 2005, section 5.2).
    #[must_use]
    pub fn rotation(angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self::linear([
            [cos, sin, 0.0, 0.0],
            [-sin, cos, 0.0, 0.0],
            [0.0, 0.0, cos, sin],
            [0.0, 0.0, -sin, cos],
        ])
    }
}
