use crate::{Frame, SliceGrid, TwoPlane, Window};
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quantity {
    /// Radiance, W m⁻² sr⁻¹.
    #[default]
    Radiance,
    /// Differential irradiance: radiance times G = (1 + u² + v²)⁻² = cos θ dω / du dv
    /// (Durand et al. 2005, section 3.3 in 2D; docs/theory.md, Eq. 7).
    DifferentialIrradiance,
}

impl Quantity {
    /// What the quantity multiplies radiance by at a ray.
    #[inline]
    #[must_use]
    pub fn factor(&self, ray: &TwoPlane) -> f64 {
        match self {
            Self::Radiance => 1.0,
            Self::DifferentialIrradiance => {
                let secant_squared = ray.secant_squared();
                1.0 / (secant_squared * secant_squared)
            }
        }
    }
}

/// Where on the central ray the local light field is looked at, and how.
///
/// The plane is orthogonal to the central ray and the parameterisation two-plane.
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
    /// The frame: O on the central ray, D along it.
    pub frame: Frame,
    /// The window its light field is multiplied by.
    pub window: Window,
    /// The frequencies of its slices.
    pub grid: SliceGrid,
}
