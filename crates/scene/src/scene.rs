use crate::{Emission, SceneFile};
use etendue_field::{Frame, Rectangle, VirtualPlane};

/// A checked experiment. Distances are along the central ray from the light, rectangles lie across it.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name: the file's, without its ending.
    pub name: String,
    /// The file it was resolved from, defaults and overrides included.
    pub file: SceneFile,
    /// The central ray.
    pub path: CentralRay,
    /// The light, at distance zero.
    pub light: Light,
    /// The blockers, by distance.
    pub blockers: Vec<BlockerLayer>,
    /// The surfaces, in the order of the file.
    pub surfaces: Vec<Surface>,
    /// Where light is looked at, in the order of the file.
    pub planes: Vec<VirtualPlane>,
    /// How it is measured.
    pub run: Run,
}

/// The ray everything is measured from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentralRay {
    /// Frame at the light.
    pub frame: Frame,
    /// Distance at which the ray ends.
    pub length: f64,
}

/// A Lambertian light, facing along the central ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Its shape.
    pub rectangle: Rectangle,
    /// Radiance, W m⁻² sr⁻¹.
    pub radiance: f64,
}

/// Opaque black rectangles in one plane; they do not overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockerLayer {
    /// Name.
    pub name: String,
    /// Distance of their plane.
    pub distance: f64,
    /// Distance between grid points: they replicate spectra at multiples of 1/pitch.
    pub pitch: f64,
    /// The rectangles.
    pub rectangles: Vec<Rectangle>,
}

/// A Lambertian surface across the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// Distance of its plane.
    pub distance: f64,
    /// Its shape.
    pub rectangle: Rectangle,
    /// Reflected over incident flux.
    pub albedo: f64,
}

/// How the scene is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Photons emitted.
    pub photons: u64,
    /// Seed of the photons.
    pub seed: u64,
    /// Independent batches.
    pub batches: u32,
    /// Share of true scenes the verdict may reject, over all planes.
    pub alpha: f64,
    /// How photons leave the light.
    pub emission: Emission,
}
