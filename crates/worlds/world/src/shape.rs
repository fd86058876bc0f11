//! Shapes and their geometry.

use crate::light::EmittedRadiance;
use crate::triangles::Triangles;
use glam::DAffine3;
use std::sync::Arc;

/// A surface with one material.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The name of the surface in the file.
    pub name: String,
    /// The geometry in local coordinates.
    pub geometry: Geometry,
    /// The map from local to world coordinates. Normals are mapped by the inverse transpose, so a
    /// reflection keeps the front. Spheres that emit are scaled uniformly. Cylinders that emit are
    /// scaled uniformly along X and Y, and may have another factor along Z.
    pub to_world: DAffine3,
    /// Whether the front of the surface is opposite to the front of its [`Geometry`].
    pub is_flipped: bool,
    /// The index of the surface's material.
    pub material: usize,
    /// Radiance that the front emits, W m⁻² sr⁻¹; `None` if the surface does not emit.
    pub emission: Option<EmittedRadiance>,
    /// Whether the back emits as the front does.
    pub emits_on_both_sides: bool,
}

impl Shape {
    /// Creates a surface without a name, which does not emit.
    #[must_use]
    pub fn new(geometry: Geometry, to_world: DAffine3, material: usize) -> Self {
        Self {
            name: String::new(),
            geometry,
            to_world,
            is_flipped: false,
            material,
            emission: None,
            emits_on_both_sides: false,
        }
    }
}

/// The geometry of a surface, with its front and its texture coordinates (u, v).
#[derive(Clone, Debug)]
pub enum Geometry {
    /// The square z = 0 with x and y from −1 to 1. The square's front is towards Z, and (u, v) =
    /// ((x + 1)/2, (y + 1)/2).
    Rectangle,
    /// The disc z = 0, x² + y² ≤ 1. The disc's front is towards Z, u is the radius, and v is the
    /// azimuth from X to Y, divided by 2π.
    Disc,
    /// The sphere x² + y² + z² = 1. The sphere's front is the outside, u is the azimuth from X to
    /// Y, divided by 2π, and v is the angle to Z, divided by π.
    Sphere,
    /// The cylinder x² + y² = 1 with z from 0 to 1, open at both ends. The cylinder's front is the
    /// outside, u is the azimuth from X to Y, divided by 2π, and v is z.
    Cylinder,
    /// A mesh of triangles, which several shapes may share.
    Mesh(Arc<Triangles>),
}
