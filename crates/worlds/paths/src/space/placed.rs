//! Surfaces at their places in a world, and the hits of rays.

use super::form::{Form, square_uv};
use super::mesh::WorldMesh;
use super::ray::{Ray, Spot};
use etendue_field::{box_corners, enclosing};
use etendue_world::{Geometry, Shape, TexturePoint, Triangles};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// The hit of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// The distance along the ray.
    pub distance: f64,
    /// The position in the world.
    pub position: DVec3,
    /// The index of the shape.
    pub shape: usize,
    /// The geometric normal, on the front of the surface.
    pub normal: DVec3,
    /// The shading frame, as a map to world coordinates. Z is the normal, interpolated on smooth
    /// meshes, and X is along u.
    pub frame: DMat3,
    /// The position as textures see it.
    pub point: TexturePoint,
}

/// A placed surface.
#[derive(Debug)]
pub(crate) struct Placed {
    pub(crate) form: Form,
    pub(crate) to_world: DAffine3,
    pub(super) to_local: DAffine3,
    /// The map of normals to the world.
    turned: DMat3,
    /// The shading frame of a rectangle, which is the same everywhere.
    flat: Option<DMat3>,
    /// −1 if the front of the surface is flipped, otherwise 1.
    side: f64,
}

impl Placed {
    fn new(shape: &Shape, meshes: &mut HashMap<*const Triangles, Arc<WorldMesh>>) -> Self {
        let form = match &shape.geometry {
            Geometry::Rectangle => Form::Rectangle,
            Geometry::Disc => Form::Disc,
            Geometry::Sphere => Form::Sphere,
            Geometry::Cylinder => Form::Cylinder,
            Geometry::Mesh(triangles) => {
                let mesh = meshes
                    .entry(Arc::as_ptr(triangles))
                    .or_insert_with(|| Arc::new(WorldMesh::new(Arc::clone(triangles))));
                Form::Mesh(Arc::clone(mesh))
            }
        };
        let to_local = shape.to_world.inverse();
        let turned = to_local.matrix3.transpose();
        let side = if shape.is_flipped { -1.0 } else { 1.0 };
        let flat = matches!(form, Form::Rectangle).then(|| {
            let along_u = shape.to_world.transform_vector3(DVec3::X);
            frame(side * (turned * DVec3::Z).normalize(), along_u)
        });
        Self {
            form,
            to_world: shape.to_world,
            to_local,
            turned,
            flat,
            side,
        }
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let [low, high] = self.form.bounds();
        enclosing(&box_corners(low, high).map(|corner| self.to_world.transform_point3(corner)))
    }

    /// Whether the surface is one piece, and not the triangles of its mesh.
    pub(super) fn is_whole(&self) -> bool {
        !matches!(&self.form, Form::Mesh(mesh) if !mesh.has_tree())
    }

    #[inline]
    pub(super) fn first(&self, ray: &Ray, within: [f64; 2]) -> Option<Spot> {
        self.form.first(&self.seen(ray), within)
    }

    #[inline]
    pub(super) fn is_occluded(&self, ray: &Ray, within: [f64; 2]) -> bool {
        self.form.is_occluded(&self.seen(ray), within)
    }

    /// A ray in local coordinates. Its direction has another length, so distances are
    /// those in the world.
    #[inline]
    fn seen(&self, ray: &Ray) -> Ray {
        Ray {
            from: self.to_local.transform_point3(ray.from),
            along: self.to_local.transform_vector3(ray.along),
        }
    }

    #[inline]
    pub(super) fn hit(&self, ray: &Ray, shape: usize, spot: &Spot) -> Hit {
        let position = ray.from + spot.distance * ray.along;
        let place = self.to_local.transform_point3(position);
        let (normal, frame, point) = if let Some(flat) = self.flat {
            (flat.z_axis, flat, square_uv(place.truncate()).into())
        } else {
            let local = self.form.local(place, spot);
            let normal = self.normal(local.normal);
            let shading = local.shading.map_or(normal, |shading| self.normal(shading));
            let along_u = self.to_world.transform_vector3(local.along_u);
            (normal, frame(shading, along_u), local.point)
        };
        Hit {
            distance: spot.distance,
            position,
            shape,
            normal,
            frame,
            point,
        }
    }

    /// Converts a normal to a unit normal in the world.
    #[inline]
    fn normal(&self, local: DVec3) -> DVec3 {
        self.side * (self.turned * local).normalize()
    }

    /// A point sampled uniformly by area on a piece of the surface, with its normal, and as
    /// textures see it.
    #[inline]
    pub(crate) fn sample(&self, piece: usize, random: [f64; 2]) -> (DVec3, DVec3, TexturePoint) {
        let (place, normal, point) = if let Some(flat) = self.flat {
            let uv = DVec2::from(random);
            ((2.0 * uv - 1.0).extend(0.0), flat.z_axis, uv.into())
        } else {
            let (place, local) = self.form.sample(piece, random);
            (place, self.normal(local.normal), local.point)
        };
        (self.to_world.transform_point3(place), normal, point)
    }
}

/// The surfaces of shapes. Shapes with the same triangles share a mesh.
pub(super) fn placed(shapes: &[Shape]) -> Vec<Placed> {
    let mut meshes = HashMap::new();
    let placed = shapes.iter().map(|shape| Placed::new(shape, &mut meshes));
    placed.collect()
}

/// A frame whose Z is a normal, and whose X is along the component of a direction
/// perpendicular to this normal.
#[inline]
fn frame(normal: DVec3, along: DVec3) -> DMat3 {
    let x = along
        .reject_from_normalized(normal)
        .try_normalize()
        .unwrap_or_else(|| normal.any_orthonormal_vector());
    DMat3::from_cols(x, normal.cross(x), normal)
}
