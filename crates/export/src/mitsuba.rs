//! Export to Mitsuba's scene format.
//!
//! The coordinates are the coordinates of [`Scene`], in metres. The centre of the light is at the
//! origin, and x, y and z are along X, Y and D of the central ray. Coordinates are written with so
//! many digits that every f64 is read back exactly.

mod aperture;
mod light;
mod material;
mod patch;
mod picture;
mod planes;
mod ply;
mod sky;
mod texture;
mod xml;

use crate::Export;
use etendue_field::{HalfPlane, Mask, Rectangle, Shape};
use etendue_scene::limits::MAX_NUMBER;
use etendue_scene::{BlockerLayer, Event, MeshObject, Object, PatchObject, Scene, Surface};
use glam::DVec3;
use planes::id;
use xml::{Xml, diffuse};

/// A part of a scene that Mitsuba cannot represent.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotInMitsuba {
    /// A light, in words, of a kind that Mitsuba lacks.
    #[error("Mitsuba has no {0}")]
    Light(String),
    /// Several lights that block each other's light in Mitsuba.
    #[error(
        "in Mitsuba, lights block light; several lights can be exported only if each is a Rectangle or a Disc, all are in one plane, and none overlap"
    )]
    Lights,
    /// A mask that is not opaque.
    #[error("in Mitsuba, semi-transparent masks must be pictures: {name:?} cannot be exported")]
    Mask {
        /// Name of the layer of blockers with this mask.
        name: String,
    },
    /// An object behind the plane in which an environment begins.
    #[error(
        "in Étendue, distant light starts in the plane of `center`; in Mitsuba, it surrounds the whole scene. {name:?} reaches behind that plane and would block the light in Mitsuba, so it cannot be exported"
    )]
    BehindTheSky {
        /// Name of the object.
        name: String,
    },
    /// A thin lens.
    #[error("Mitsuba has thin lenses in cameras only: {name:?} cannot be exported")]
    ThinLens {
        /// Name of the lens.
        name: String,
    },
    /// A sum of BRDFs that is not a blend.
    #[error(
        "Mitsuba adds two BRDFs with weights w and 1 − w only: {name:?} cannot be exported; \
         use Reflects with `other` and `blend`"
    )]
    Sum {
        /// Name of the surface.
        name: String,
    },
    /// A factor that depends on the angle to the normal.
    #[error(
        "Mitsuba has no factors of the incoming or outgoing angle: {name:?} cannot be exported"
    )]
    AngleTable {
        /// Name of the surface.
        name: String,
    },
}

/// The files of a scene for Mitsuba 3. The files are `scene.xml`, the scene's meshes and
/// pictures, and `planes.json` with the virtual planes, for which Mitsuba has no element.
///
/// A half-plane becomes a rectangle that extends beyond all light that reaches a window or a
/// surface.
///
/// # Errors
/// If the scene holds something that Mitsuba cannot represent.
pub fn mitsuba(scene: &Scene) -> Result<Export, NotInMitsuba> {
    if scene.light.environment().is_some()
        && let Some(name) = behind(scene)
    {
        return Err(NotInMitsuba::BehindTheSky { name });
    }
    let mut writer = Writer {
        xml: Xml::new(scene),
        files: Vec::new(),
        owner: "light".to_owned(),
    };
    writer.light(&scene.light)?;
    if !scene.other_lights.is_empty() {
        writer.other_lights(scene)?;
    }
    let beyond = 2.0 * reach(scene);
    for (number, layer) in scene.blockers.iter().enumerate() {
        writer.layer(number, layer, beyond)?;
    }
    for (number, surface) in scene.surfaces.iter().enumerate() {
        writer.surface(&id(Object::Surface(number)), surface);
    }
    for (number, patch) in scene.patches.iter().enumerate() {
        writer.patch(id(Object::Patch(number)), patch)?;
    }
    for (number, mesh) in scene.meshes.iter().enumerate() {
        writer.triangles(&id(Object::Mesh(number)), mesh)?;
    }
    let mut files = vec![
        ("scene.xml".to_owned(), writer.xml.finish().into_bytes()),
        ("planes.json".to_owned(), planes::json(scene)),
    ];
    files.append(&mut writer.files);
    Ok(Export { files })
}

struct Writer {
    xml: Xml,
    /// Files of meshes and pictures.
    files: Vec<(String, Vec<u8>)>,
    /// The object to which the next files belong.
    owner: String,
}

impl Writer {
    /// Adds a file that is named after the object to which it belongs; returns its name.
    fn file(&mut self, name: &str, bytes: Vec<u8>) -> String {
        let taken = |name: &String| self.files.iter().any(|(other, _)| other == name);
        let mut names = (0..).map(|number: u32| match number {
            0 => format!("{}_{name}", self.owner),
            _ => format!("{}_{number}_{name}", self.owner),
        });
        let name = names.find(|name| !taken(name)).unwrap_or_default();
        self.files.push((name.clone(), bytes));
        name
    }

    fn surface(&mut self, id: &str, surface: &Surface) {
        self.xml.comment(&format!("surface {:?}", surface.name));
        let looks = diffuse(surface.albedo);
        if let Some((distance, rectangle)) = surface.across() {
            self.xml
                .flat(id, &Shape::Rectangle(rectangle), distance, &looks);
        } else {
            let [a, b, c, d] = surface.corners();
            self.flat_mesh(id, &[[a, b, c], [a, c, d]], &looks);
        }
    }

    fn patch(&mut self, id: String, object: &PatchObject) -> Result<(), NotInMitsuba> {
        let PatchObject { name, patch, event } = object;
        self.owner.clone_from(&id);
        let (looks, is_uniform) = match event {
            Event::Specular(event) => (Self::specular(event, name)?, true),
            Event::Reflects(reflectance) => (
                self.reflects(reflectance, patch.aperture, name)?,
                reflectance.is_uniform(),
            ),
        };
        if patch.curvature.iter().all(|k| *k == 0.0) && is_uniform {
            self.xml.comment(&format!("smooth surface {name:?}"));
            self.xml.disk(&id, &patch.frame, patch.aperture, &looks);
            return Ok(());
        }
        let mesh = patch::mesh(patch);
        self.xml.comment(&format!(
            "smooth surface {name:?}: {} triangles, at most {:.1e} m from the surface",
            mesh.faces.len(),
            mesh.error
        ));
        self.mesh(&id, ply::smooth(&mesh), &looks);
        Ok(())
    }

    fn triangles(&mut self, id: &str, mesh: &MeshObject) -> Result<(), NotInMitsuba> {
        self.xml.comment(&format!("mesh {:?}", mesh.name));
        let Some(smooth) = &mesh.smooth else {
            let looks = mesh.albedo.map_or_else(xml::black, diffuse);
            self.flat_mesh(id, &mesh.triangles, &looks);
            return Ok(());
        };
        let looks = Self::specular(&smooth.event, &mesh.name)?;
        self.mesh(id, ply::shaded(&mesh.triangles, &smooth.normals), &looks);
        Ok(())
    }

    fn layer(
        &mut self,
        number: usize,
        layer: &BlockerLayer,
        beyond: f64,
    ) -> Result<(), NotInMitsuba> {
        let name = &layer.name;
        let id = format!("blockers_{number}");
        let (shapes, half_planes) = match &layer.mask {
            Mask::Opaque {
                shapes,
                half_planes,
            } => (shapes, half_planes),
            Mask::Aperture(hole) => {
                let (triangles, error) = aperture::screen(hole, layer.distance, beyond);
                let off = format!(", at most {error:.1e} m from its edge");
                let off = if error > 0.0 { &off } else { "" };
                self.xml
                    .comment(&format!("aperture {name:?}: triangles around a hole{off}"));
                self.flat_mesh(&id, &triangles, &xml::black());
                return Ok(());
            }
            Mask::Grating(_) => return Err(NotInMitsuba::Mask { name: name.clone() }),
        };
        self.xml.comment(&format!("blockers {name:?}"));
        let (mut rectangles, mut discs) = (Vec::new(), Vec::new());
        for shape in shapes {
            match *shape {
                Shape::Rectangle(rectangle) => rectangles.push(shortened(rectangle, beyond)),
                Shape::Disc(disc) => discs.push(disc),
            }
        }
        rectangles.extend(half_planes.iter().map(|half| cut_off(half, beyond)));
        // Thousands of shapes would load slowly, so rectangles form one mesh.
        if !rectangles.is_empty() {
            let triangles: Vec<[DVec3; 3]> = rectangles
                .iter()
                .flat_map(|r| halves(r, layer.distance))
                .collect();
            self.flat_mesh(&id, &triangles, &xml::black());
        }
        for (i, disc) in discs.into_iter().enumerate() {
            let (id, disc) = (format!("{id}_disk_{i}"), Shape::Disc(disc));
            self.xml.flat(&id, &disc, layer.distance, &xml::black());
        }
        Ok(())
    }

    /// Writes triangles without normals.
    fn flat_mesh(&mut self, id: &str, triangles: &[[DVec3; 3]], looks: &str) {
        let looks = format!("<boolean name=\"face_normals\" value=\"true\"/>{looks}");
        self.mesh(id, ply::ply(triangles), &looks);
    }

    /// Writes a mesh and its file.
    fn mesh(&mut self, id: &str, bytes: Vec<u8>, looks: &str) {
        let file = format!("{id}.ply");
        self.xml.mesh(id, &file, looks);
        self.files.push((file, bytes));
    }
}

/// A rectangle as two triangles.
fn halves(rectangle: &Rectangle, distance: f64) -> [[DVec3; 3]; 2] {
    let [[left, right], [low, high]] = [rectangle.extent(0), rectangle.extent(1)];
    let corner = |x, y| DVec3::new(x, y, distance);
    let (a, c) = (corner(left, low), corner(right, high));
    [[a, corner(right, low), c], [a, c, corner(left, high)]]
}

/// The part of a half-plane that light can reach, with a margin. Light reaches no
/// coordinate of modulus `beyond` or more.
fn cut_off(half_plane: &HalfPlane, beyond: f64) -> Rectangle {
    let edge = half_plane.edge;
    let end = if half_plane.above {
        edge.max(0.0) + beyond
    } else {
        edge.min(0.0) - beyond
    };
    let (mut center, mut size) = ([0.0; 2], [2.0 * beyond; 2]);
    center[half_plane.axis] = 0.5 * (edge + end);
    size[half_plane.axis] = (end - edge).abs();
    Rectangle { center, size }
}

/// The part of a bar that light can reach, and other rectangles unchanged. Light reaches no
/// coordinate of modulus `beyond` or more.
fn shortened(rectangle: Rectangle, beyond: f64) -> Rectangle {
    let size = rectangle.size.map(|side| {
        if side > MAX_NUMBER {
            2.0 * beyond
        } else {
            side
        }
    });
    Rectangle { size, ..rectangle }
}

/// The largest distance from the central ray, along X or Y, of light that goes straight to
/// a window or a surface.
fn reach(scene: &Scene) -> f64 {
    let ends = scene
        .lights()
        .flat_map(|of| [0, 1].map(|axis| of.light.extent(axis)));
    let light = ends
        .flatten()
        .fold(0.0, |most: f64, end| most.max(end.abs()));
    // The sky is infinite, so the extent is cut off. Light from beyond this extent arrives within
    // a thousandth of a radian of grazing incidence.
    let light = if light.is_finite() {
        light
    } else {
        1e3 * scene.path.first_hit().min(1e3)
    };
    let windows = scene.planes.iter().filter(|plane| plane.leg == 0);
    let windows = windows.map(|p| p.window.x.half_width().max(p.window.y.half_width()));
    let corners = bodies(scene).flat_map(|(_, corners)| corners);
    let corners = corners.map(|p| p.x.abs().max(p.y.abs()));
    windows.chain(corners).fold(light, f64::max)
}

/// The name of an object that extends behind the plane of the light.
fn behind(scene: &Scene) -> Option<String> {
    let mut bodies = bodies(scene);
    let found = bodies.find(|(_, corners)| corners.iter().any(|p| p.z < 0.0));
    found.map(|(name, _)| name.to_owned())
}

/// The name of each surface, with the corners of a shape that encloses it.
fn bodies(scene: &Scene) -> impl Iterator<Item = (&str, Vec<DVec3>)> {
    let surfaces = scene.surfaces.iter();
    let surfaces = surfaces.map(|s| (s.name.as_str(), s.corners().to_vec()));
    let patches = scene.patches.iter();
    let patches = patches.map(|p| (p.name.as_str(), p.patch.corners().to_vec()));
    let meshes = scene.meshes.iter();
    let meshes = meshes.map(|m| (m.name.as_str(), m.triangles.as_flattened().to_vec()));
    surfaces.chain(patches).chain(meshes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_planes_keep_their_edge() {
        for (edge, above) in [(0.25, true), (-3.0, true), (0.25, false), (7.0, false)] {
            let rectangle = cut_off(
                &HalfPlane {
                    axis: 1,
                    edge,
                    above,
                },
                2.0,
            );
            let [low, high] = rectangle.extent(1);
            let (kept, end) = if above { (low, high) } else { (high, low) };
            assert!((kept - edge).abs() < 1e-15); // rounding of sums below 10
            assert!(if above { end >= 2.0 } else { end <= -2.0 });
            assert!(rectangle.extent(0) <= [-2.0, 2.0] && rectangle.extent(0)[1] >= 2.0);
        }
    }
}
