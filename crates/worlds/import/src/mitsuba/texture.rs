//! Numbers that may vary over a surface: values, spectra and textures.

use super::mesh_data::MitsubaMesh;
use super::object::{ObjectProperty, ObjectRef, Value};
use super::reader::MitsubaReader;
use crate::Color;
use crate::pictures::TransferCurve;
use crate::range::{MAX_NUMBER, share};
use crate::report::quoted;
use crate::spectrum::{Role, from_xyz, rgb};
use etendue_field::Raster;
use etendue_world::{Bitmap, Filter, MeshValues, Texture, Wrap};
use glam::{DAffine2, DAffine3, DMat2, DVec2};
use std::collections::HashSet;
use std::rc::Rc;
use std::sync::Arc;

/// Plugins supported as textures.
const ALLOWED: &str = "bitmap, checkerboard, mesh_attribute, uniform, srgb, rawconstant, d65";

impl<'a> MitsubaReader<'a> {
    /// The texture of a property. If the property is missing, returns a constant. Returns
    /// `None` if a cause of refusal was reported.
    pub(super) fn texture_or(
        &mut self,
        object: ObjectRef<'a>,
        name: &str,
        role: Role,
        default: f64,
    ) -> Option<Texture> {
        match object.property(name) {
            None => Some(Texture::Constant(default)),
            Some(property) => self.texture(property, role),
        }
    }

    /// Reads a reflectance, which must be from 0 to 1.
    pub(super) fn reflectance(
        &mut self,
        object: ObjectRef<'a>,
        name: &str,
        default: f64,
    ) -> Option<Texture> {
        self.share(object, name, Role::Reflectance, default)
    }

    /// Reads a property like [`Self::texture_or`], but its values must be from 0 to 1.
    pub(super) fn share(
        &mut self,
        object: ObjectRef<'a>,
        name: &str,
        role: Role,
        default: f64,
    ) -> Option<Texture> {
        let texture = self.texture_or(object, name, role, default)?;
        let texture = object.not_negative(name, texture)?;
        self.report
            .accept(object.place_of(name), share(name, texture))
    }

    /// Reads the strength of a light, which must be a single number.
    pub(super) fn strength(&mut self, object: ObjectRef<'a>, name: &str) -> Option<f64> {
        let texture = self.emission(object, name)?;
        match texture {
            Texture::Constant(value) => Some(value),
            _ => object.fault(name, format!("{name} is a picture; allowed: one value")),
        }
    }

    /// Reads the emission of a surface.
    pub(super) fn emission(&mut self, object: ObjectRef<'a>, name: &str) -> Option<Texture> {
        let texture = self.texture_or(object, name, Role::Emission, 1.0)?;
        object.not_negative(name, texture)
    }

    fn texture(&mut self, property: &'a ObjectProperty, role: Role) -> Option<Texture> {
        if let Some(object) = self.object_of(property) {
            object.is_used.set(true);
            return self.texture_of(object, role);
        }
        let constant = match &property.value {
            Value::Number(value) => *value,
            Value::Whole(value) => *value as f64,
            Value::Color(color) => self.color.of(*color),
            Value::Uniform(value) => self.uniform(*value, role),
            Value::Spectrum(samples) => self.color.of(rgb(samples, role)),
            Value::Broken | Value::Reference(_) => return None,
            other => {
                let message = format!(
                    "{} is {}; allowed: a number, a colour, a spectrum or a texture",
                    property.name,
                    other.noun()
                );
                return self.report.refuse(&property.place, message);
            }
        };
        Some(Texture::Constant(constant))
    }

    /// The value of a spectrum that a scene states as a single number.
    fn uniform(&self, value: f64, role: Role) -> f64 {
        match (self.color, role) {
            (Color::Luminance, _) | (_, Role::Reflectance | Role::Number) => value,
            (_, Role::Emission) => value * self.color.of(from_xyz([1.0; 3])),
        }
    }

    fn texture_of(&mut self, object: ObjectRef<'a>, role: Role) -> Option<Texture> {
        if object.kind != "texture" {
            return object.refuse(format!("{} in place of a texture", object.kind));
        }
        match object.plugin.as_str() {
            "bitmap" => self.bitmap(object),
            "checkerboard" => self.checkerboard(object, role),
            "mesh_attribute" => self.mesh_attribute(object, role),
            "uniform" => Some(Texture::Constant(object.number("value").unwrap_or(1.0))),
            "srgb" => self.colored(object, "color").map(Texture::Constant),
            "rawconstant" => self.raw_constant(object),
            "d65" => {
                let scale = object.number("scale").unwrap_or(1.0);
                Some(Texture::Constant(scale * self.colored(object, "color")?))
            }
            _ => self.unsupported(object, ALLOWED),
        }
    }

    fn colored(&self, object: ObjectRef<'a>, name: &str) -> Option<f64> {
        let Some(property) = object.property(name) else {
            return Some(1.0);
        };
        match property.value {
            Value::Color(color) => Some(self.color.of(color)),
            Value::Number(value) => Some(value),
            _ => {
                let noun = property.value.noun();
                let message = format!("{name} is {noun}; allowed: a colour");
                self.report.refuse(&property.place, message)
            }
        }
    }

    fn raw_constant(&self, object: ObjectRef<'a>) -> Option<Texture> {
        match object.property("value").map(|p| &p.value) {
            Some(Value::Vector(v)) => Some(Texture::Constant(self.color.of(v.to_array()))),
            _ => object.number("value").map(Texture::Constant),
        }
    }

    fn checkerboard(&mut self, object: ObjectRef<'a>, role: Role) -> Option<Texture> {
        let first = self.texture_or(object, "color0", role, 0.4);
        let second = self.texture_or(object, "color1", role, 0.2);
        let to_uv = self.to_uv(object);
        let (Texture::Constant(first), Texture::Constant(second)) = (first?, second?) else {
            let message = "a checkerboard has textures as its colours; allowed: two values";
            return object.refuse(message);
        };
        Some(Texture::Checkerboard {
            to_uv,
            values: [first, second],
        })
    }

    fn bitmap(&mut self, object: ObjectRef<'a>) -> Option<Texture> {
        let to_uv = self.to_uv(object);
        let raw = object.truth("raw");
        let filter = object.choice(
            "filter_type",
            &[("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)],
        );
        let wrap = object.choice(
            "wrap_mode",
            &[
                ("repeat", Wrap::Repeat),
                ("mirror", Wrap::Mirror),
                ("clamp", Wrap::Clamp),
            ],
        );
        let pixels = self.picture(object, raw);
        Some(Texture::Bitmap(Bitmap {
            to_uv,
            pixels: pixels?,
            wrap: wrap?,
            filter: filter?,
        }))
    }

    /// The picture given by `filename`.
    pub(super) fn picture(&mut self, object: ObjectRef<'a>, raw: bool) -> Option<Arc<Raster>> {
        let name = object.file_name()?;
        let found = self.files.find(&object.folders, name);
        let curve = if raw {
            TransferCurve::Linear
        } else {
            TransferCurve::Srgb
        };
        let read = found.and_then(|path| self.pictures.read(self.files, &path, self.color, curve));
        read.map_or_else(|error| object.unread(name, &error), Some)
    }

    fn to_uv(&self, object: ObjectRef<'a>) -> DAffine2 {
        let map = object.transform("to_uv").unwrap_or(DAffine3::IDENTITY);
        let [x, y] = [map.matrix3.x_axis, map.matrix3.y_axis];
        let linear = DMat2::from_cols(DVec2::new(x.x, x.y), DVec2::new(y.x, y.y));
        DAffine2::from_mat2_translation(linear, map.translation.truncate())
    }

    /// The names of the attributes that the textures within an object use, in alphabetical
    /// order.
    pub(super) fn wanted(&mut self, object: ObjectRef<'a>) -> Rc<[String]> {
        if let Some(known) = self.wanted.get(&object.number) {
            return Rc::clone(known);
        }
        let mut names = Vec::new();
        let (mut seen, mut left) = (HashSet::new(), vec![object]);
        while let Some(object) = left.pop() {
            if !seen.insert(object.number) {
                continue;
            }
            if object.kind == "texture" && object.plugin == "mesh_attribute" {
                names.extend(object.last("name").and_then(|name| match &name.value {
                    Value::Text(name) => Some(name.clone()),
                    _ => None,
                }));
            }
            let inner = object.properties.iter().filter_map(|p| self.object_of(p));
            left.extend(inner.filter(|inner| matches!(inner.kind, "bsdf" | "texture" | "emitter")));
        }
        names.sort_unstable();
        names.dedup();
        let names: Rc<[String]> = names.into();
        self.wanted.insert(object.number, Rc::clone(&names));
        names
    }

    /// Reads a texture of type `mesh_attribute`.
    fn mesh_attribute(&mut self, object: ObjectRef<'a>, role: Role) -> Option<Texture> {
        let scale = match object.has("scale") {
            true => object.number("scale")?,
            false => 1.0,
        };
        if !object.has("name") {
            object.cause("mesh_attribute without name");
        }
        let name = object.text("name")?;
        let found = self.current_mesh.clone().ok_or_else(|| {
            "of a shape without a mesh; allowed: vertex_… or face_… of a ply shape".to_owned()
        });
        let values = found.and_then(|mesh| self.values(&mesh, name, scale, role));
        let values = values.map_err(|error| format!("mesh_attribute {} {error}", quoted(name)));
        let values = self.report.accept(object.place_of("name"), values);
        values.map(Texture::OfMesh)
    }

    /// The numbers of an attribute. A colour becomes one number.
    fn values(
        &self,
        mesh: &MitsubaMesh,
        name: &str,
        scale: f64,
        role: Role,
    ) -> Result<MeshValues, String> {
        let Some(of) = mesh.attributes.read.iter().find(|of| of.name == name) else {
            return Err(format!("is missing; {}", mesh.attributes.listed()));
        };
        let is_color = match (of.channels, role) {
            (1, _) => false,
            (3, Role::Reflectance | Role::Emission) => true,
            (channels, Role::Number) => {
                return Err(format!(
                    "has {channels} numbers; allowed: 1, for this property"
                ));
            }
            (channels, _) => return Err(format!("has {channels} numbers; allowed: 1 or 3")),
        };
        // The memory is counted for each texture, because textures may repeat an attribute.
        self.files
            .spend((of.values.len() * size_of::<f64>()) as u64)?;
        let values: Vec<f64> = match is_color {
            false => of.values.iter().map(|value| scale * value).collect(),
            true => {
                let (colors, _) = of.values.as_chunks::<3>();
                colors.iter().map(|c| scale * self.color.of(*c)).collect()
            }
        };
        if let Some(value) = values.iter().find(|value| value.abs() > MAX_NUMBER) {
            return Err(format!(
                "times scale is {value}; allowed: up to {MAX_NUMBER}"
            ));
        }
        let mesh = Arc::clone(&mesh.triangles);
        let made = MeshValues::new(mesh, values, of.is_of_vertices);
        made.ok_or_else(|| "does not fit the mesh".to_owned())
    }
}

/// A texture whose values are used as numbers and not as colours. Mitsuba 3.9.1 swaps the
/// two values of a checkerboard in such a texture.
pub(super) fn as_number(texture: Texture) -> Texture {
    match texture {
        Texture::Checkerboard { to_uv, values } => Texture::Checkerboard {
            to_uv,
            values: [values[1], values[0]],
        },
        other => other,
    }
}
