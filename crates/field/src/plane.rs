//! Virtual planes.

use crate::{Frame, SliceGrid, TwoPlane, Window};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// On which side of what stands at its distance a plane looks at the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Before light meets the blockers or the surface at this distance.
    Before,
    /// After it.
    After,
}

/// What a plane records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Quantity {
    /// Radiance, W m⁻² sr⁻¹.
    #[default]
    Radiance,
    /// Differential irradiance: radiance times G = (1 + u² + v²)⁻² = cos θ dω / du dv
    /// (Durand et al. 2005, section 3.3 in 2D; docs/theory.md (7)); on a surface times cos θ cos² φ = cos θ dω / dθ dφ.
    DifferentialIrradiance,
}

/// What the coordinates of a plane's rays are counted from.
///
/// On a surface, T is in the plane of incidence and B = N × T (docs/conventions.md); directions point away from the surface, those of
/// light that arrives being turned around. A direction is cos φ (sin θ T + cos θ N) + sin φ B: the plane-sphere parameterisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Orientation {
    /// The plane across the central ray, two-plane parameterisation.
    #[default]
    Orthogonal,
    /// The tangent plane where the central ray hits: positions along T and B, angles to the normal N there.
    Tangent,
    /// The surface itself: positions along T and B of the point hit, angles to the normal at that point, T and B being turned with
    /// it by the smallest angle.
    LocalNormals,
    /// As `LocalNormals`, light that arrives being turned about the normal: in the direction in which a mirror would send it
    /// (Durand et al. 2005, Fig. 10, step 4).
    Mirrored,
}

impl Orientation {
    /// Whether angles are counted from the normal at the point hit.
    #[must_use]
    pub fn is_local(self) -> bool {
        matches!(self, Self::LocalNormals | Self::Mirrored)
    }
}

/// Where on the central ray the local light field is looked at, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualPlane {
    /// Name: the folder of its results.
    pub name: String,
    /// Distance from the light along the central ray, in metres; it goes on growing from leg to leg.
    pub distance: f64,
    /// The leg of the path it stands on: the number of surfaces the light has left on its way.
    pub leg: usize,
    /// Side of whatever stands at that distance.
    pub side: Side,
    /// What is recorded.
    pub quantity: Quantity,
    /// What its coordinates are counted from.
    pub orientation: Orientation,
    /// θ of the central ray on a surface, radians; 0 on an orthogonal plane. The coordinates of rays are (x, y, θ − longitude, φ).
    pub longitude: f64,
    /// The frame: O on the central ray, D along it; on a surface X = T, Y = B and D = N.
    pub frame: Frame,
    /// The window its light field is multiplied by.
    pub window: Window,
    /// The frequencies of its slices.
    pub grid: SliceGrid,
}

impl VirtualPlane {
    /// What its quantity multiplies radiance by at a ray.
    #[inline]
    #[must_use]
    pub fn factor(&self, ray: &TwoPlane) -> f64 {
        match (self.quantity, self.orientation) {
            (Quantity::Radiance, _) => 1.0,
            (Quantity::DifferentialIrradiance, Orientation::Orthogonal) => {
                let secant_squared = ray.secant_squared();
                1.0 / (secant_squared * secant_squared)
            }
            (Quantity::DifferentialIrradiance, _) => {
                let latitude = libm::cos(ray.v);
                libm::cos(ray.u + self.longitude) * latitude * latitude
            }
        }
    }
}
