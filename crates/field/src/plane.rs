//! Virtual planes.

use crate::{Frame, SliceGrid, TwoPlane, Window};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The side on which a plane observes light. It is relative to the mask or surface at the same
/// distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Before light meets the blockers or the surface at this distance.
    Before,
    /// After light has met the blockers or the surface at this distance.
    After,
}

/// The quantity that a plane records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Quantity {
    /// Radiance, in W m⁻² sr⁻¹.
    #[default]
    Radiance,
    /// Differential irradiance: radiance times G = (1 + u² + v²)⁻² = cos θ dω / du dv
    /// (Durand et al. 2005, section 3.3 in 2D; docs/theory.md (7)). On a surface, differential
    /// irradiance is radiance times cos θ cos² φ = cos θ dω / dθ dφ.
    DifferentialIrradiance,
}

/// The reference for the coordinates of a plane's rays.
///
/// On a surface, T is in the plane of incidence and B = N × T (docs/conventions.md). Directions
/// point away from the surface, so the directions of arriving light are reversed. A direction has
/// the form cos φ (sin θ T + cos θ N) + sin φ B, which is the plane-sphere parameterisation. The
/// coordinates of a ray are its position along T and B, θ − θ₁ and φ, where θ₁ is the θ of the
/// central ray; the window and the spectrum are those of θ − θ₁ and φ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Orientation {
    /// The plane orthogonal to the central ray, in two-plane parameterisation.
    #[default]
    Orthogonal,
    /// The tangent plane at the point where the central ray hits the surface. Positions are those
    /// on this plane; θ and φ are measured from the normal N at this point.
    Tangent,
    /// The surface itself. Positions are the coordinates of the point that the ray hits. θ and φ
    /// are measured from the normal at the point that the ray hits, but θ₁ from the normal N; T and
    /// B are turned together with the normal, by the smallest angle.
    LocalNormals,
    /// As `LocalNormals`, but arriving light is rotated about the normal into the direction of mirror
    /// reflection (Durand et al. 2005, Fig. 10, step 4).
    Mirrored,
}

impl Orientation {
    /// Checks whether angles are relative to the normal at the point hit.
    #[must_use]
    pub fn is_local(self) -> bool {
        matches!(self, Self::LocalNormals | Self::Mirrored)
    }
}

/// The position on the central ray at which the local light field is observed, and the settings of
/// the observation.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualPlane {
    /// Name of the plane, and of the folder of its results.
    pub name: String,
    /// Distance from the light along the central ray, in metres, accumulated over all legs.
    pub distance: f64,
    /// The leg of the path that the plane is on: the number of surfaces that the light has left
    /// before the plane.
    pub leg: usize,
    /// The side on which the plane observes light, relative to a mask or surface at its distance.
    pub side: Side,
    /// The quantity recorded.
    pub quantity: Quantity,
    /// The reference for the plane's coordinates.
    pub orientation: Orientation,
    /// The angle θ₁ of the central ray on a surface, radians; 0 on an orthogonal plane. The
    /// coordinates of rays are (x, y, θ − θ₁, φ).
    pub longitude: f64,
    /// The plane's frame, whose origin O is on the central ray. D is along the central ray; on a
    /// surface, X = T, Y = B and D = N.
    pub frame: Frame,
    /// The window that multiplies the light field.
    pub window: Window,
    /// The frequencies of the slices.
    pub grid: SliceGrid,
}

impl VirtualPlane {
    /// The factor that converts the radiance of a ray to the plane's quantity.
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
