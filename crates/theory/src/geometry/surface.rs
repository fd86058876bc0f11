//! Steps between three frames: the frame of the central ray, the frame of the surface that the ray
//! hits, and the frames of the surface's local normals.
//!
//! Angles of incidence θ₀ and outgoing angles θ₁ lie within ± π/2; at ± π/2 the scale 1/cos θ₀ is
//! infinite. Signs follow the [module](super): with N up, positive angles lie to the right, and a
//! mirror has θ₁ = −θ₀.

use super::AffineMap;

impl AffineMap<2> {
    /// The map of light incidence: s = −x/cos θ₀, θᵢ = θ + θ₀. Light comes from the
    /// direction θ₀, and directions of light are flipped.
    ///
    /// L'(Ωx, Ωθ) = e^(−2πi Ωθ θ₀)/cos θ₀ · L(−Ωx/cos θ₀, Ωθ). Eq. 9 of Durand et al. 2005 has cos
    /// θ₀ instead of 1/cos θ₀, both in the factor and in the argument. Table 1 has cos θ₀ only in
    /// the argument. Both Eq. 9 and Table 1 omit 2π from the phase ([`Edition`](super::Edition)).
    #[must_use]
    pub fn incidence(theta0: f64) -> Self {
        Self {
            matrix: [[-1.0 / libm::cos(theta0), 0.0], [0.0, 1.0]],
            offset: [0.0, theta0],
        }
    }

    /// The map of curvature, into the frames of the local normals: θ' = θ − k s. The
    /// surface is convex if k > 0, and |k| is 1/R, in 1/m.
    ///
    /// L'(Ωx, Ωθ) = L(Ωx − k Ωθ, Ωθ) (Durand et al. 2005, Table 1; its Eq. 11 prints + k Ωθ, which
    /// belongs to the inverse, [`back`](Self::back)).
    #[must_use]
    pub fn curvature(k: f64) -> Self {
        Self::linear([[1.0, 0.0], [-k, 1.0]])
    }

    /// The map back from the frames of the local normals: θ = θ' + k s (Durand et al. 2005,
    /// step 6). This map is the inverse of [`curvature`](Self::curvature).
    #[must_use]
    pub fn back(k: f64) -> Self {
        Self::curvature(-k)
    }

    /// The map of the outgoing angle: x = s cos θ₁, θ = θₒ − θ₁. Light leaves in the
    /// direction θ₁.
    ///
    /// L'(Ωx, Ωθ) = e^(2πi Ωθ θ₁) cos θ₁ · L(cos θ₁ Ωx, Ωθ). Eq. 10 and Table 1 of Durand et al.
    /// 2005 divide Ωx by the cosine and omit 2π from the phase.
    #[must_use]
    pub fn outgoing(theta1: f64) -> Self {
        Self {
            matrix: [[libm::cos(theta1), 0.0], [0.0, 1.0]],
            offset: [0.0, -theta1],
        }
    }
}

impl AffineMap<4> {
    /// The map of light incidence in the plane of (X, D): it is s_x = −x/cos θ₀, s_y = y,
    /// θᵢ = θ + θ₀, φᵢ = −φ.
    ///
    /// Flipping directions also flips the latitude, which section 5.2 of Durand et al. 2005 does
    /// not mention. In 2D the step is Eq. 9 of Durand et al. 2005.
    #[must_use]
    pub fn incidence(theta0: f64) -> Self {
        Self::sections(&AffineMap::<2>::incidence(theta0), &AffineMap::mirror())
    }

    /// The map of curvature, into the frames of the local normals: (θ', φ') = (θ, φ) −
    /// diag(1, cos θ₀) M s for directions about the longitude θ₀.
    ///
    /// `shape` is the symmetric matrix M, the derivative of the normal along (T, B), in 1/m and
    /// positive for convex surfaces. In principal axes M is diag(k₁, k₂). Eq. 19 of Durand et al.
    /// 2005 is this matrix M. The paper's text describes the step as a shear by M, without cos θ₀.
    /// However, if the normal is tilted about T, a direction at longitude θ₀ moves by only cos θ₀
    /// times the tilt.
    #[must_use]
    pub fn curvature(shape: Matrix2, theta0: f64) -> Self {
        Self::tilt(shape, -1.0, theta0)
    }

    /// The map back from the frames of the local normals: (θ, φ) = (θ', φ') + diag(1, cos
    /// θ₁) M s for directions about the longitude θ₁.
    #[must_use]
    pub fn back(shape: Matrix2, theta1: f64) -> Self {
        Self::tilt(shape, 1.0, theta1)
    }

    fn tilt([[m11, m12], [m21, m22]]: Matrix2, sign: f64, longitude: f64) -> Self {
        let sagittal = sign * libm::cos(longitude);
        Self::linear([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [sign * m11, sign * m12, 1.0, 0.0],
            [sagittal * m21, sagittal * m22, 0.0, 1.0],
        ])
    }

    /// The map of the outgoing angle: x = s_x cos θ₁, y = s_y, θ = θₒ − θ₁, φ = φₒ.
    #[must_use]
    pub fn outgoing(theta1: f64) -> Self {
        Self::sections(&AffineMap::<2>::outgoing(theta1), &AffineMap::identity())
    }
}

type Matrix2 = super::Matrix<2>;
