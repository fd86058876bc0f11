//! The plane at which a light field is observed.

use etendue_field::{Frame, Orientation, Patch, Quantity, Side};

/// The plane at which the light field is observed, behind the surfaces that light has left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The plane's frame, in the coordinates of the frame at the light. O is on the central ray,
    /// and D is along this ray. On a surface, the axes of the frame are T, B and the normal on the
    /// side to which directions point.
    pub frame: Frame,
    /// The reference of the coordinates: the central ray, the tangent plane or the surface itself.
    pub orientation: Orientation,
    /// The angle θ of the central ray on a surface, in radians. The coordinates are then (s, t, θ
    /// − longitude, φ).
    pub longitude: f64,
    /// The surface that gives the local normals. If it is `None`, all normals are along D.
    pub patch: Option<Patch>,
    /// Whether the plane lies before or after the objects at its distance. The surface of a plane is
    /// the next surface of the path if light arrives there, and otherwise the last that light has
    /// left.
    pub side: Side,
    /// The quantity recorded. Differential irradiance on a surface is radiance times cos θ cos² φ.
    pub quantity: Quantity,
}

impl Plane {
    /// Returns a plane that is perpendicular to the D of a frame, records radiance and is not on a
    /// surface.
    #[must_use]
    pub fn orthogonal(frame: Frame) -> Self {
        Self {
            frame,
            orientation: Orientation::Orthogonal,
            longitude: 0.0,
            patch: None,
            side: Side::Before,
            quantity: Quantity::Radiance,
        }
    }

    /// Checks whether the plane observes light that arrives at a surface, for which directions are
    /// reversed.
    #[must_use]
    pub fn is_arriving(&self) -> bool {
        self.orientation != Orientation::Orthogonal && self.side == Side::Before
    }
}
