//! The difference between rays that smooth meshes deflect and the same rays deflected by
//! osculating patches.

/// The difference between two ways to trace rays: by the triangles of smooth meshes, and by the
/// osculating patches.
#[derive(Clone, Copy, Debug)]
pub struct OffPatches {
    /// The root mean square distance between the two arrivals of a ray, in half-widths of the
    /// window. Rays are weighted by their light.
    pub apart: f64,
    /// ‖change of the slices‖, as a share of their value at frequency zero. The number is an upper
    /// estimate: the standard error is added to the value that a sample of rays gives.
    pub change: f64,
}
