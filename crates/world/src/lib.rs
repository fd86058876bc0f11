//! A world: surfaces, each with a geometry and a material, lights, and cameras that look at them.
//!
//! It is what scenes of other programs are read as. Coordinates are right-handed, or left-handed where the file's are: then maps of
//! cameras mirror. They are in the units of the file, which are metres where the file says nothing else. Light is one number: the luminance of what the file has as a colour, or one of its channels.

mod camera;
mod light;
mod material;
mod shape;
mod texture;

pub use camera::{Camera, Lens, Look, Projection};
pub use etendue_field::MicrofacetDistribution;
pub use light::{EmittedRadiance, Falloff, Light, SkyMap};
pub use material::{Conductor, Dielectric, Material, Plastic, Roughness};
pub use shape::{Geometry, Shape, Triangles};
pub use texture::{Bitmap, Filter, Texture, Wrap};

/// Everything that a camera may see.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// Surfaces, which may also shine.
    pub shapes: Vec<Shape>,
    /// Materials, which shapes name by their number.
    pub materials: Vec<Material>,
    /// Lights that are no surfaces.
    pub lights: Vec<Light>,
    /// Cameras: at least one where pictures or pixels are asked for.
    pub cameras: Vec<Camera>,
    /// Most surfaces that light meets between its source and the camera, less one; `None` without an end. 0 shows sources alone, 1 adds direct light.
    pub depth: Option<u32>,
    /// Whether sources that a camera sees directly are left dark.
    pub hides_sources: bool,
}
