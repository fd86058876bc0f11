//! Scenes of glTF 2.0, in `.gltf` files (JSON) or `.glb` files (JSON and a buffer).
//!
//! * Coordinates are right-handed with Y up, and are kept. Angles are in radians and lengths in
//!   metres.
//! * Light is radiometric: a candela is read as 1 W/sr, a lux as 1 W/m², a nit of emission as 1 W m⁻² sr⁻¹.
//! * Cameras and lights point along −Z of their node. The scale of the node affects neither cameras
//!   nor lights.
//! * The front of a triangle is the side from which its corners run counterclockwise, or clockwise
//!   if the node mirrors. Normals do not determine the front.
//! * Surfaces scatter light only on their front unless they are `doubleSided`.
//! * Roughness r becomes GGX with α = r². Metallic 0 is a diffuse base below a dielectric coat.
//!   Metallic 1 is a metal that reflects its base colour at all angles. Values of metallic between
//!   0 and 1 are a mixture of both materials. A material with metallic 0 and without specular
//!   reflection (`specularFactor` 0, or index 1) is Lambertian.
//! * Pictures of colours are sRGB, and pictures of other quantities are linear. The first row of a
//!   picture is at v = 0, as in a world.
//!
//! Limits: 2²⁰ shapes, 2²⁰ lights, and the byte limit of an import.

mod accessor;
mod camera;
mod container;
mod light;
mod material;
mod node;
mod reader;
mod shape;
mod texture;

use crate::main_file::MainFile;
use crate::{Imported, Options, Refused};
use std::path::Path;

pub(crate) fn import(file: &Path, options: &Options) -> Result<Imported, Refused> {
    let file = MainFile::open(file, options)?;
    let document = container::read(&file.read()?, &file.place(), &file.report);
    let world = document.map(|document| reader::GltfReader::new(&document, &file).world());
    file.finish(world.unwrap_or_default())
}
