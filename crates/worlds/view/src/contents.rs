//! Describes the content of another program's scene.

use crate::world_source::{WorldSource, has_light, load, no_camera, no_light, notes};
use etendue_report::table::aligned;
use etendue_store::{ArgumentStyle, Failure};
use etendue_world::{Camera, Geometry, Light, Projection, World};
use std::collections::HashSet;
use std::sync::Arc;

/// The content of a scene, with its omissions and approximations.
#[derive(Clone, Debug)]
pub struct Contents {
    /// The number of each kind of content, such as `triangles`.
    pub counts: Vec<(&'static str, usize)>,
    /// Cameras of the scene. The first camera is used unless another is named.
    pub cameras: Vec<Camera>,
    /// Whether the scene has a light.
    pub has_light: bool,
    /// The largest number of surfaces that light meets between a source and the camera; `None` if
    /// there is no limit.
    pub depth: Option<u32>,
    /// A sentence for each omission or approximation.
    pub notes: Vec<String>,
    arguments: ArgumentStyle,
}

impl Contents {
    /// Reads a scene.
    pub fn read(source: &WorldSource) -> Result<Self, Failure> {
        let imported = load(source)?;
        let notes = notes(&imported);
        let world = imported.world;
        Ok(Self {
            counts: counts(&world),
            has_light: has_light(&world),
            depth: world.depth,
            cameras: world.cameras,
            notes,
            arguments: source.arguments,
        })
    }

    /// The whole description, line by line.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let counts = self.counts.iter();
        let counts = counts.map(|(kind, count)| vec![count.to_string(), (*kind).to_owned()]);
        let mut lines = aligned(counts.collect());
        lines.extend(self.cameras.iter().map(of_camera));
        if self.cameras.is_empty() {
            lines.push(no_camera(self.arguments));
        }
        if !self.has_light {
            lines.push(no_light(self.arguments));
        }
        lines.push(match self.depth {
            Some(depth) => format!("light meets at most {depth} surfaces"),
            None => "light meets any number of surfaces".to_owned(),
        });
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines
    }
}

/// The number of each kind of content.
fn counts(world: &World) -> Vec<(&'static str, usize)> {
    let mut counts: Vec<(&'static str, usize)> = Vec::new();
    let mut count = |kind, by| match counts.iter_mut().find(|(known, _)| *known == kind) {
        Some((_, count)) => *count += by,
        None => counts.push((kind, by)),
    };
    let mut distinct = HashSet::new();
    for shape in &world.shapes {
        match &shape.geometry {
            Geometry::Rectangle => count("rectangles", 1),
            Geometry::Disc => count("discs", 1),
            Geometry::Sphere => count("spheres", 1),
            Geometry::Cylinder => count("cylinders", 1),
            Geometry::Mesh(mesh) => {
                count("meshes", 1);
                count("triangles", mesh.corners().len());
                if distinct.insert(Arc::as_ptr(mesh)) {
                    count("distinct meshes", 1);
                    count("triangles of distinct meshes", mesh.corners().len());
                }
            }
        }
        if shape.emission.is_some() {
            count("area lights", 1);
        }
    }
    for light in &world.lights {
        let kind = match light {
            Light::Point { .. } => "point lights",
            Light::Spot { .. } => "spotlights",
            Light::Projector { .. } => "projectors",
            Light::Directional { .. } => "directional lights",
            Light::Sheet { .. } => "collimated lights",
            Light::Constant { .. } => "constant environments",
            Light::Sky(_) => "environment maps",
        };
        count(kind, 1);
    }
    count("materials", world.materials.len());
    // Instances share a mesh. Without instances, all meshes are distinct.
    let of = |kind| {
        counts
            .iter()
            .find(|(known, _)| *known == kind)
            .map(|(_, n)| *n)
    };
    if of("meshes") == of("distinct meshes") {
        counts.retain(|(kind, _)| !kind.ends_with("distinct meshes"));
    }
    counts
}

fn of_camera(camera: &Camera) -> String {
    let Camera {
        name, size: [w, h], ..
    } = camera;
    let kind = match camera.projection {
        Projection::Perspective {
            half_width, lens, ..
        } => {
            let angle = 2.0 * libm::atan(half_width).to_degrees();
            let lens = lens.map_or(String::new(), |lens| {
                format!(", lens of radius {} focused at {}", lens.radius, lens.focus)
            });
            format!("perspective, {angle:.4}° wide{lens}")
        }
        Projection::Orthographic => "orthographic".to_owned(),
    };
    let name = if name.is_empty() {
        "without a name"
    } else {
        name
    };
    format!("camera {name}: {w} × {h} pixels, {kind}")
}
