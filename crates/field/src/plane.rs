use crate::{Frame, SliceGrid, Window};
use serde::Serialize;

/// On which side of what stands at its distance a plane looks at the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Before light meets the blockers or the surface at this distance.
    Before,
    /// After it.
    After,
}

/// Where on the central ray the local light field is looked at, and how.
///
/// The plane is orthogonal to the central ray, the quantity is radiance and the parameterisation two-plane.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualPlane {
    /// Name: the folder of its results.
    pub name: String,
    /// Distance from the light along the central ray, in metres.
    pub distance: f64,
    /// Side of whatever stands at that distance.
    pub side: Side,
    /// The frame: O on the central ray, D along it.
    pub frame: Frame,
    /// The window its light field is multiplied by.
    pub window: Window,
    /// The frequencies of its slices.
    pub grid: SliceGrid,
}
