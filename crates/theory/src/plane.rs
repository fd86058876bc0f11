//! Where a light field is looked at.

use etendue_field::{Frame, Orientation, Patch, Quantity};

/// Where the light field is looked at, after all that light meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Its frame in coordinates of the frame at the light: O on the central ray, D along it; on a
    /// surface T, B and the normal there, on the side to which directions point.
    pub frame: Frame,
    /// What its coordinates are counted from.
    pub orientation: Orientation,
    /// θ of the central ray on a surface, radians: coordinates are (s, t, θ − longitude, φ) there.
    pub longitude: f64,
    /// The surface, for local normals; without it they are all along D.
    pub patch: Option<Patch>,
    /// On a surface: light that arrives at it, directions turned around. The surface is then not
    /// among the elements; else it is the last.
    pub arriving: bool,
    /// What is recorded. Differential irradiance on a surface is radiance times cos θ cos² φ.
    pub quantity: Quantity,
}

impl Plane {
    /// The radiance across the central ray of a frame, on no surface.
    #[must_use]
    pub fn orthogonal(frame: Frame) -> Self {
        Self {
            frame,
            orientation: Orientation::Orthogonal,
            longitude: 0.0,
            patch: None,
            arriving: false,
            quantity: Quantity::Radiance,
        }
    }
}
