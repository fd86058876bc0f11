//! A world: surfaces, each with a geometry and a material, lights, and cameras.
//!
//! Scenes of other programs are read into worlds. Coordinates are right-handed or left-handed, as
//! in the file. If they are left-handed, the maps of cameras contain a reflection. Coordinates are
//! in the units of the file, metres by default. Worlds are monochrome: a colour of the file becomes
//! one number, its luminance or one of its channels.

mod camera;
mod light;
mod material;
mod mesh_values;
mod shape;
mod texture;
mod texture_point;
mod triangles;

pub use camera::{Camera, Lens, Look, Projection};
pub use etendue_field::MicrofacetDistribution;
pub use light::{EmittedRadiance, Falloff, Light, SkyMap};
pub use material::{
    Conductor, Dielectric, Material, MetallicRoughness, Plastic, Principled, Roughness,
};
pub use mesh_values::MeshValues;
pub use shape::{Geometry, Shape};
pub use texture::{Bitmap, Filter, Texture, Wrap};
pub use texture_point::TexturePoint;
pub use triangles::Triangles;

/// Everything that a camera may see.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// Surfaces, including emitting ones.
    pub shapes: Vec<Shape>,
    /// Materials, to which shapes refer by index.
    pub materials: Vec<Material>,
    /// Lights that are not surfaces.
    pub lights: Vec<Light>,
    /// Cameras: at least one is needed for pictures or probes.
    pub cameras: Vec<Camera>,
    /// Maximum number of surfaces between a source and the camera; `None` if there is no limit.
    /// With 0, only sources are visible, and 1 adds direct light.
    pub depth: Option<u32>,
    /// Whether sources that the camera sees directly appear black.
    pub hides_sources: bool,
}

impl World {
    /// Adds a material, and returns its index.
    pub fn add_material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }
}
