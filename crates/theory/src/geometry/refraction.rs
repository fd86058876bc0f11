//! Refraction at an interface.

use super::AffineMap;

/// The refractive indices on both sides of an interface, positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Media {
    /// Index n₁ of the medium in which light arrives.
    pub before: f64,
    /// Index n₂ of the medium into which the light continues.
    pub after: f64,
}

impl Media {
    /// Returns n₁/n₂, the argument of [`AffineMap::symplectic_defect`]; this ratio is also the
    /// factor by which dx du changes along each axis.
    #[must_use]
    pub fn index_ratio(&self) -> f64 {
        self.before / self.after
    }

    /// The angle θ₂ of the refracted ray by Snell's law, n₁ sin θ₁ = n₂ sin θ₂. Returns
    /// `None` under total internal reflection.
    ///
    /// Like every angle on a surface, θ₂ is the direction from which light seems to come: the
    /// refracted central ray runs along −(sin θ₂ T + cos θ₂ N).
    #[must_use]
    pub fn refracted(&self, theta1: f64) -> Option<f64> {
        let sine = self.index_ratio() * libm::sin(theta1);
        (sine.abs() < 1.0).then(|| libm::asin(sine))
    }
}

impl AffineMap<2> {
    /// The map of local directions under refraction by Snell's law, linearised at θ₀: θ' =
    /// θ₂ + (θ − θ₀) n₁ cos θ₀/(n₂ cos θ₂).
    ///
    /// The formula follows by differentiating n₁ sin θ = n₂ sin θ' (docs/theory.md (27)); Durand et
    /// al. 2005 do not treat refraction. Directions stay flipped, because light continues through
    /// the surface. The next step into a light frame is therefore the inverse of the incidence at
    /// θ₂. Returns `None` under total internal reflection, and at the critical angle, where there
    /// is no derivative.
    #[must_use]
    pub fn refraction(theta0: f64, media: &Media) -> Option<Self> {
        let theta2 = media.refracted(theta0)?;
        let scale = media.index_ratio() * libm::cos(theta0) / libm::cos(theta2);
        Some(Self {
            matrix: [[1.0, 0.0], [0.0, scale]],
            offset: [0.0, theta2 - scale * theta0],
        })
    }
}

impl AffineMap<4> {
    /// The map of local directions under refraction. The longitude changes as in 2D, and
    /// the latitude satisfies n₁ φ = n₂ φ'.
    ///
    /// The tangential part of n ω is the same on both sides. Its component along B is n sin φ. Its
    /// component along T is n cos φ sin θ, where cos φ is 1 to first order (docs/theory.md (27)).
    #[must_use]
    pub fn refraction(theta0: f64, media: &Media) -> Option<Self> {
        let in_plane = AffineMap::<2>::refraction(theta0, media)?;
        let across = AffineMap::<2>::refraction(0.0, media)?;
        Some(Self::sections(&in_plane, &across))
    }
}
