//! The difference between rays that smooth meshes deflect and the same rays deflected by
//! osculating patches.

/// The difference between rays traced by the triangles of smooth meshes and the same rays traced by
/// the osculating patches.
#[derive(Clone, Copy, Debug)]
pub struct OffPatches {
    /// The distance between the arrival points, in half-widths of the window: the root mean square,
    /// weighted by light.
    pub apart: f64,
    /// ‖change of the slices‖, as a share of their value at frequency zero: an upper estimate,
    /// from a sample of rays with its standard error added.
    pub change: f64,
}
