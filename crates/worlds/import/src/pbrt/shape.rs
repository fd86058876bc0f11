//! Shapes, objects and instances.

use super::entity::{CauseGiven, Entity, Read};
use super::material::reads_uv;
use super::mesh::PbrtMesh;
use super::reader::{Ask, PbrtReader, Uv};
use super::scene::PbrtShape;
use crate::range::{MAX_SHAPES, fault};
use crate::report::{SourcePlace, quoted};
use etendue_world::{EmittedRadiance, Geometry, Material, Texture};
use glam::{DAffine2, DAffine3, DMat2, DVec2, DVec3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Plugins supported as shapes.
const ALLOWED: &str = "sphere, disk, cylinder, trianglemesh, plymesh, bilinearmesh";

/// The geometry of a surface and its placement, without material.
pub(super) struct PbrtSurface {
    pub(super) geometry: Geometry,
    /// The map from the coordinates of the geometry to the coordinates of the shape.
    pub(super) placement: DAffine3,
    /// If a light has a required power, pbrt divides the power by this area. `None` for a shape of
    /// several surfaces.
    pub(super) area: Option<f64>,
    /// The part of the geometry that belongs to the shape, as its opacity; `None` if all of it
    /// does.
    pub(super) part: Option<Texture>,
}

impl PbrtReader<'_> {
    /// Adds the shapes outside objects.
    pub(super) fn shapes(&mut self) {
        for shape in &self.scene.shapes {
            if let Some(made) = self.shape(shape, false) {
                self.add(made, &shape.entity.place);
            }
        }
    }

    /// Adds the instances of objects.
    pub(super) fn instances(&mut self) {
        let mut known: BTreeMap<&str, Vec<etendue_world::Shape>> = BTreeMap::new();
        for instance in &self.scene.instances {
            let Some(object) = self.scene.objects.get(&instance.name) else {
                let message = format!("object {} is not known", quoted(&instance.name));
                self.report.cause(&instance.place, message);
                continue;
            };
            if !known.contains_key(&*instance.name) {
                let shapes = object.shapes.iter();
                let made = shapes.filter_map(|shape| self.shape(shape, true)).collect();
                known.insert(&instance.name, made);
            }
            for shape in known.get(&*instance.name).into_iter().flatten() {
                let to_world = instance.to_world * shape.to_world;
                let shape = shape.clone();
                let placed = etendue_world::Shape { to_world, ..shape };
                if !self.add(placed, &instance.place) {
                    return;
                }
            }
        }
    }

    /// Adds a shape, and returns whether further shapes are allowed.
    fn add(&mut self, shape: etendue_world::Shape, place: &SourcePlace) -> bool {
        if self.world.shapes.len() >= MAX_SHAPES {
            let message = format!("more than {MAX_SHAPES} shapes, counting instances");
            if self.report.is_first(&SourcePlace::whole(""), &message) {
                self.report.cause(place, message);
            }
            return false;
        }
        match fault(&shape.geometry, shape.to_world, shape.emission.is_some()) {
            Some(message) => self.report.cause(place, format!("a shape {message}")),
            None => self.world.shapes.push(shape),
        }
        true
    }

    /// A shape placed by its own transform, or `None` if a cause of refusal was reported,
    /// or if there is no surface.
    fn shape(&mut self, shape: &PbrtShape<'_>, is_in_object: bool) -> Option<etendue_world::Shape> {
        let entity = &shape.entity;
        entity.is_used.set(true);
        let uv = match entity.plugin.as_str() {
            "sphere" => Uv::Ball,
            "disk" => Uv::Disc,
            _ => Uv::Own,
        };
        let material = self.material(&shape.material, uv);
        let area = shape.area.map(|area| &self.scene.areas[area]);
        if let Ok(None) = material {
            entity.drop_all();
            if let Some(area) = area {
                let message =
                    "left out, as in pbrt: an area light on a shape without a surface material";
                self.report.note_once(&entity.place, message);
                area.is_used.set(true);
            }
            return None;
        }
        let opacity = self.texture_or(entity, "alpha", Ask::Float, 1.0, uv);
        let material =
            material.and_then(|number| Ok(self.masked(number.ok_or(CauseGiven)?, opacity?)));
        let emission = self.shape_emission(shape, uv, is_in_object);
        let varies = |emission: &EmittedRadiance| !matches!(emission, Texture::Constant(_));
        let needs_uv = material.is_ok_and(|at| reads_uv(&self.world.materials[at]))
            || emission
                .as_ref()
                .is_ok_and(|e| e.as_ref().is_some_and(varies));
        let surface = self.surface(shape, needs_uv).ok()?;
        let emission = self.powered(area, emission.ok()?, &surface).ok()?;
        let (mut material, mut emission) = (material.ok()?, emission);
        if let Some(part) = surface.part {
            if needs_uv {
                let message = "phimax of a shape with textures is not supported";
                let _ = entity.fault("phimax", message);
                return None;
            }
            if let Some(of) = emission {
                let largest = of.largest();
                emission = Some(self.mapped(entity, part.clone(), |v| v * largest).ok()?);
            }
            material = self.masked(material, part);
        }
        let is_two_sided = |area: &Entity<'_>| area.truth("twosided", false);
        let emits_on_both_sides = area.map_or(Ok(false), is_two_sided).ok()?;
        Some(etendue_world::Shape {
            name: String::new(),
            to_world: shape.to_world * surface.placement,
            is_flipped: self.is_flipped(shape, &surface.geometry, emission.is_some()),
            geometry: surface.geometry,
            material,
            emission,
            emits_on_both_sides,
        })
    }

    fn masked(&mut self, number: usize, opacity: Texture) -> usize {
        if matches!(opacity, Texture::Constant(a) if a >= 1.0) {
            return number;
        }
        let of = Box::new(self.world.materials[number].clone());
        self.world.add_material(Material::Mask { opacity, of })
    }

    /// Whether the front of a shape in pbrt is opposite to the front of the shape's
    /// geometry in a world.
    ///
    /// pbrt computes normals of meshes after placement, so a mirroring placement keeps the front of
    /// meshes, but flips the normals of other shapes. If a mirrored shape emits, pbrt shows the
    /// light on one side and emits it from the other. The import uses the side that emits.
    fn is_flipped(&self, shape: &PbrtShape<'_>, geometry: &Geometry, shines: bool) -> bool {
        let is_mirrored = shape.to_world.matrix3.determinant() < 0.0;
        let turns = is_mirrored && !matches!(geometry, Geometry::Mesh(_));
        if turns && shines {
            let message = "because of a mirroring transform, pbrt shows this light on one side and emits from the other side; the emitting side is used";
            self.report.note_once(&shape.entity.place, message);
        }
        shape.is_reversed != (turns && !shines)
    }

    fn surface(&mut self, shape: &PbrtShape<'_>, needs_uv: bool) -> Read<PbrtSurface> {
        let entity = &shape.entity;
        let meshed = |PbrtMesh { triangles, area }| PbrtSurface {
            geometry: Geometry::Mesh(triangles),
            placement: DAffine3::IDENTITY,
            area,
            part: None,
        };
        match entity.plugin.as_str() {
            "sphere" => self.sphere(entity),
            "disk" => self.disk(entity),
            "cylinder" => self.cylinder(entity),
            "trianglemesh" | "plymesh" | "bilinearmesh" => self.mesh(shape, needs_uv).map(meshed),
            _ => Err(entity.unsupported(ALLOWED)),
        }
    }

    fn radius(&self, entity: &Entity<'_>) -> Read<f64> {
        entity.float_within("radius", 1.0, "above 0", |r| r > 0.0)
    }

    /// The share of a full revolution that a shape covers.
    fn revolution(&self, entity: &Entity<'_>) -> Read<f64> {
        Ok(
            entity.float_within("phimax", 360.0, "above 0 to 360", |a| a > 0.0 && a <= 360.0)?
                / 360.0,
        )
    }

    fn sphere(&self, entity: &Entity<'_>) -> Read<PbrtSurface> {
        let radius = self.radius(entity);
        let around = self.revolution(entity)?;
        let radius = radius?;
        for (name, end) in [("zmin", -radius), ("zmax", radius)] {
            let z = entity.float_or(name, end)?;
            if (z - end) * end.signum() < 0.0 {
                let message = format!("{name} is {z}: parts of spheres are not supported");
                return Err(entity.fault(name, message));
            }
        }
        Ok(PbrtSurface {
            geometry: Geometry::Sphere,
            placement: DAffine3::from_scale(DVec3::splat(radius)),
            area: Some(around * 4.0 * PI * radius * radius),
            part: sector(around, DVec2::X),
        })
    }

    fn disk(&self, entity: &Entity<'_>) -> Read<PbrtSurface> {
        let radius = self.radius(entity);
        let height = entity.float_or("height", 0.0);
        let inner = entity.float_within("innerradius", 0.0, "0", |r| r == 0.0);
        let around = self.revolution(entity)?;
        let (radius, height) = (radius?, height?);
        inner?;
        let scale = DAffine3::from_scale(DVec3::new(radius, radius, 1.0));
        Ok(PbrtSurface {
            geometry: Geometry::Disc,
            placement: DAffine3::from_translation(height * DVec3::Z) * scale,
            area: Some(around * PI * radius * radius),
            part: sector(around, DVec2::Y),
        })
    }

    fn cylinder(&self, entity: &Entity<'_>) -> Read<PbrtSurface> {
        let radius = self.radius(entity);
        let ends = [("zmin", -1.0), ("zmax", 1.0)].map(|(name, end)| entity.float_or(name, end));
        let around = self.revolution(entity)?;
        let radius = radius?;
        let [a, b] = ends;
        let (a, b) = (a?, b?);
        let (low, high) = (a.min(b), a.max(b));
        let scale = DAffine3::from_scale(DVec3::new(radius, radius, high - low));
        Ok(PbrtSurface {
            geometry: Geometry::Cylinder,
            placement: DAffine3::from_translation(low * DVec3::Z) * scale,
            area: Some(around * 2.0 * PI * radius * (high - low)),
            part: sector(around, DVec2::X),
        })
    }
}

/// A texture that is 1 on the first `share` of a revolution and 0 on the rest, or `None`
/// for a full revolution. The product of (u, v) and `axis` is the azimuth divided by 2π.
fn sector(share: f64, axis: DVec2) -> Option<Texture> {
    // A checkerboard has two squares for each unit. The longer part of the revolution fills the
    // first square or the second, and the shorter part a piece of the other.
    let (start, length, values) = match share {
        1.0.. => return None,
        0.5.. => (0.0, share, [1.0, 0.0]),
        _ => (share, 1.0 - share, [0.0, 1.0]),
    };
    let scaled = 0.5 / length * axis;
    Some(Texture::Checkerboard {
        to_uv: DAffine2::from_mat2_translation(
            DMat2::from_cols(DVec2::X * scaled.x, DVec2::X * scaled.y),
            DVec2::new(-0.5 * start / length, 0.25),
        ),
        values,
    })
}
