//! How far smooth meshes lead rays beside where their osculating patches do.

/// How far rays that meet the triangles of smooth meshes are from those that meet the patches that
/// osculate them.
#[derive(Clone, Copy, Debug)]
pub struct OffPatches {
    /// How far apart they arrive, in half-widths of the window: the root of the mean square over
    /// light.
    pub apart: f64,
    /// ‖change of the slices‖, as a share of their value at frequency zero: an upper estimate,
    /// from a sample of rays with its standard error added.
    pub change: f64,
}
