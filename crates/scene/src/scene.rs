use crate::{Emission, SceneFile};
use etendue_field::{Frame, Light, Mask, Rectangle, Shape, VirtualPlane};
use glam::DVec3;

/// A checked experiment. Distances are along the central ray from the light, flat things lie across it, and
/// all coordinates are those of the frame at the light.
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
    /// The flat surfaces, in the order of the file.
    pub surfaces: Vec<Surface>,
    /// The meshes: blockers, then surfaces, in the order of the file.
    pub meshes: Vec<MeshObject>,
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
    /// Distance of the surface it visits.
    pub length: f64,
    /// Distance it goes back, along the path, until something stands in its way.
    pub back: f64,
}

impl CentralRay {
    /// The frame at a distance along the path, after `reflections` (0 or 1) on the surface it visits.
    ///
    /// At normal incidence the outgoing frame is (−X, Y, −D) (Durand et al. 2005, section 4.1, steps 1 and 7, at θ = 0).
    #[must_use]
    pub fn frame_at(&self, distance: f64, reflections: usize) -> Frame {
        if reflections == 0 {
            return self.frame.travelled(distance);
        }
        let at_surface = self.frame.travelled(self.length);
        let turned = Frame {
            x: -at_surface.x,
            d: -at_surface.d,
            ..at_surface
        };
        turned.travelled(distance - self.length)
    }
}

/// What stands in one plane and multiplies radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockerLayer {
    /// Name.
    pub name: String,
    /// Distance of their plane.
    pub distance: f64,
    /// Distance between repetitions, if there are any: they replicate spectra at multiples of 1/pitch.
    pub pitch: Option<f64>,
    /// What they do to radiance.
    pub mask: Mask,
}

/// A triangle mesh in front of the light.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshObject {
    /// Name.
    pub name: String,
    /// Corners of the triangles, in the frame at the light.
    pub triangles: Vec<[DVec3; 3]>,
    /// Nearest and farthest distance of its corners.
    pub extent: [f64; 2],
    /// Reflected over incident flux; `None` for a black blocker.
    pub albedo: Option<f64>,
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

impl Surface {
    /// Its shape.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape::Rectangle(self.rectangle)
    }
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
