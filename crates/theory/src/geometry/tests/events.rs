//! Complete reflections and refractions at a surface. Each of them is composed of single steps,
//! which lead from the frame of the arriving central ray to the frame of the leaving central ray.

use crate::geometry::{AffineMap, Matrix, Media};

impl AffineMap<2> {
    /// The map of the reflection by a mirror that the central ray meets at the angle θ₀.
    /// The curvature k, in 1/m, is positive for a convex mirror.
    ///
    /// The event consists of the steps incidence, curvature, mirror, back, and outgoing at −θ₀. The
    /// product is x' = −x, θ' = −θ − (2k/cos θ₀) x (docs/theory.md (26)). The two shears by
    /// curvature, on the way in and on the way out, add up (Durand et al. 2005, step 6).
    pub(crate) fn mirror_reflection(theta0: f64, k: f64) -> Self {
        Self::incidence(theta0)
            .then(&Self::curvature(k))
            .then(&Self::mirror())
            .then(&Self::back(k))
            .then(&Self::outgoing(-theta0))
    }

    /// The distance of the focus behind the map's end, −A₀₀/A₁₀ metres. Rays that were
    /// parallel before the map meet at the focus. The distance is negative for a virtual focus.
    /// Returns `None` if the rays stay parallel.
    pub(crate) fn focus(&self) -> Option<f64> {
        let [[x, _], [slope, _]] = self.matrix;
        let distance = -x / slope;
        distance.is_finite().then_some(distance)
    }

    /// The map of the refraction at a surface that the central ray meets at the angle θ₀.
    /// The curvature k, in 1/m, is positive if the surface is convex on the side of the incident
    /// light.
    ///
    /// The event consists of the steps incidence, curvature, refraction, back, and outgoing on the
    /// other side of the surface, where the central ray continues at θ₂. Returns `None` as for
    /// [`refraction`](Self::refraction).
    pub(crate) fn refracting_surface(theta0: f64, k: f64, media: &Media) -> Option<Self> {
        let theta2 = media.refracted(theta0)?;
        let local = Self::refraction(theta0, media)?;
        let onto = Self::incidence(theta0).then(&Self::curvature(k));
        let off = Self::back(k).then(&Self::incidence(theta2).inverse()?);
        Some(onto.then(&local).then(&off))
    }

    /// The map of a caustic, which is a mirror reflection followed by travel over a
    /// distance in metres (Durand et al. 2005, Fig. 11).
    ///
    /// The [focus](Self::focus) of the reflection is at the distance −cos θ₀/2k. At this distance,
    /// the position of a ray depends only on its direction, so parallel light meets in a point.
    pub(crate) fn caustic(theta0: f64, k: f64, distance: f64) -> Self {
        Self::mirror_reflection(theta0, k).then(&Self::travel(distance))
    }
}

impl AffineMap<4> {
    /// The map of the reflection by a mirror with the shape operator M (see
    /// [`curvature`](Self::curvature)). The central ray meets the mirror at the angle θ₀.
    ///
    /// The product is x' = −x, y' = y, θ' = −θ − (2 M₁₁/c₀) x + 2 M₁₂ y, φ' = φ − 2 M₁₂ x + 2 c₀
    /// M₂₂ y. A sphere of radius R thus has its focus at R/2 · cos θ₀ in the plane of incidence,
    /// and at R/(2 cos θ₀) across this plane (Coddington's equations).
    pub(crate) fn mirror_reflection(theta0: f64, shape: Matrix<2>) -> Self {
        Self::incidence(theta0)
            .then(&Self::curvature(shape, theta0))
            .then(&Self::mirror())
            .then(&Self::back(shape, -theta0))
            .then(&Self::outgoing(-theta0))
    }

    /// The map of the refraction at a surface with the shape operator M. The central ray
    /// meets the surface at the angle θ₀. The event is composed of the same steps as in 2D; the
    /// step back uses the cosine of θ₂.
    pub(crate) fn refracting_surface(theta0: f64, shape: Matrix<2>, media: &Media) -> Option<Self> {
        let theta2 = media.refracted(theta0)?;
        let local = Self::refraction(theta0, media)?;
        let onto = Self::incidence(theta0).then(&Self::curvature(shape, theta0));
        let off = Self::back(shape, theta2).then(&Self::incidence(theta2).inverse()?);
        Some(onto.then(&local).then(&off))
    }
}
