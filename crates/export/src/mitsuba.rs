//! A scene in Mitsuba's words.
//!
//! Coordinates are those of [`Scene`]: metres, the light's centre at the origin, and x, y, z along X, Y and D of the
//! central ray. They are written so that every f64 comes back the same.

mod planes;
mod ply;
mod xml;

use crate::Export;
use etendue_field::{HalfPlane, Light, Mask, Rectangle, Shape};
use etendue_scene::{BlockerLayer, Scene, Surface};
use glam::DVec3;
use xml::{Xml, diffuse, emitter};

/// What a scene says and Mitsuba cannot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotInMitsuba {
    /// A spot.
    #[error(
        "Mitsuba has no light with an area whose radiance falls off as cosⁿθ: \
         a spot with exponent {exponent} cannot be exported, one with exponent 0 can"
    )]
    Spot {
        /// Its exponent n.
        exponent: f64,
    },
    /// A mask that is not opaque.
    #[error(
        "Mitsuba has no semi-transparent mask, only pictures of one: {name:?} cannot be exported"
    )]
    Mask {
        /// Name of its layer.
        name: String,
    },
    /// Another light.
    #[error("Mitsuba has no light that shines like this one: it cannot be exported")]
    Light,
    /// An environment.
    #[error(
        "an environment cannot be exported: here light begins in the plane of `center`, in Mitsuba it comes from all around"
    )]
    Environment,
    /// A smooth surface.
    #[error(
        "the smooth surface {name:?} cannot be exported: the light field behind it is compared here alone"
    )]
    Smooth {
        /// Its name.
        name: String,
    },
    /// A plane after several reflections.
    #[error(
        "Mitsuba sums over paths of all lengths: the plane {name:?}, after {leg} reflections, cannot be exported"
    )]
    Reflections {
        /// Its name.
        name: String,
        /// Surfaces that light has left on its way.
        leg: usize,
    },
}

/// The scene for Mitsuba 3: `scene.xml`, a `.ply` for each mesh and each layer of rectangles, and `planes.json` with
/// the virtual planes, which Mitsuba has no word for.
///
/// A half-plane becomes a rectangle that ends beyond all light that reaches a window or a surface.
///
/// # Errors
/// When the scene holds something Mitsuba has no word for.
pub fn mitsuba(scene: &Scene) -> Result<Export, NotInMitsuba> {
    let mut writer = Writer {
        xml: Xml::new(scene),
        meshes: Vec::new(),
    };
    writer.light(&scene.light)?;
    if let Some(patch) = scene.patches.first() {
        let name = patch.name.clone();
        return Err(NotInMitsuba::Smooth { name });
    }
    if let Some(plane) = scene.planes.iter().find(|plane| plane.leg > 1) {
        let (name, leg) = (plane.name.clone(), plane.leg);
        return Err(NotInMitsuba::Reflections { name, leg });
    }
    let beyond = 2.0 * reach(scene);
    for (number, layer) in scene.blockers.iter().enumerate() {
        writer.layer(number, layer, beyond)?;
    }
    for (number, surface) in scene.surfaces.iter().enumerate() {
        writer.xml.comment(&format!("surface {:?}", surface.name));
        let looks = diffuse(surface.albedo);
        let id = surface_id(number);
        if let Some((distance, rectangle)) = surface.across() {
            writer
                .xml
                .flat(&id, &Shape::Rectangle(rectangle), distance, &looks);
        } else {
            let [a, b, c, d] = surface.corners();
            writer.mesh(&id, &[[a, b, c], [a, c, d]], &looks);
        }
    }
    for (number, mesh) in scene.meshes.iter().enumerate() {
        writer.xml.comment(&format!("mesh {:?}", mesh.name));
        let looks = mesh.albedo.map_or_else(xml::black, diffuse);
        writer.mesh(&mesh_id(number), &mesh.triangles, &looks);
    }
    let mut files = vec![
        ("scene.xml".to_owned(), writer.xml.finish().into_bytes()),
        ("planes.json".to_owned(), planes::json(scene)),
    ];
    files.append(&mut writer.meshes);
    Ok(Export { files })
}

/// Names in the scene file may hold anything, identifiers may not.
fn surface_id(number: usize) -> String {
    format!("surface_{number}")
}

fn mesh_id(number: usize) -> String {
    format!("mesh_{number}")
}

struct Writer {
    xml: Xml,
    /// Files of meshes.
    meshes: Vec<(String, Vec<u8>)>,
}

impl Writer {
    fn light(&mut self, light: &Light) -> Result<(), NotInMitsuba> {
        match *light {
            Light::Area { exponent, .. } if exponent > 0.0 => {
                return Err(NotInMitsuba::Spot { exponent });
            }
            Light::Area {
                shape, radiance, ..
            } => {
                self.xml
                    .comment("the light shines along z, its back is dark");
                let looks = [emitter(radiance), xml::black()].concat();
                self.xml.flat("light", &shape, 0.0, &looks);
            }
            Light::Point { intensity } => {
                self.xml.comment("the light");
                self.xml.point_light(intensity);
            }
            Light::Environment { .. } => return Err(NotInMitsuba::Environment),
            _ => return Err(NotInMitsuba::Light),
        }
        Ok(())
    }

    fn layer(
        &mut self,
        number: usize,
        layer: &BlockerLayer,
        beyond: f64,
    ) -> Result<(), NotInMitsuba> {
        let name = &layer.name;
        let Mask::Opaque {
            shapes,
            half_planes,
        } = &layer.mask
        else {
            return Err(NotInMitsuba::Mask { name: name.clone() });
        };
        self.xml.comment(&format!("blockers {name:?}"));
        let (mut rectangles, mut discs) = (Vec::new(), Vec::new());
        for shape in shapes {
            match *shape {
                Shape::Rectangle(rectangle) => rectangles.push(rectangle),
                Shape::Disc(disc) => discs.push(disc),
            }
        }
        rectangles.extend(half_planes.iter().map(|half| cut_off(half, beyond)));
        let id = format!("blockers_{number}");
        // Thousands of shapes would be slow to load: rectangles are one mesh.
        if !rectangles.is_empty() {
            let triangles: Vec<[DVec3; 3]> = rectangles
                .iter()
                .flat_map(|r| halves(r, layer.distance))
                .collect();
            self.mesh(&id, &triangles, &xml::black());
        }
        for (i, disc) in discs.into_iter().enumerate() {
            let (id, disc) = (format!("{id}_disk_{i}"), Shape::Disc(disc));
            self.xml.flat(&id, &disc, layer.distance, &xml::black());
        }
        Ok(())
    }

    fn mesh(&mut self, id: &str, triangles: &[[DVec3; 3]], looks: &str) {
        let file = format!("{id}.ply");
        self.xml.mesh(id, &file, looks);
        self.meshes.push((file, ply::ply(triangles)));
    }
}

/// A rectangle as two triangles.
fn halves(rectangle: &Rectangle, distance: f64) -> [[DVec3; 3]; 2] {
    let [[left, right], [low, high]] = [rectangle.extent(0), rectangle.extent(1)];
    let corner = |x, y| DVec3::new(x, y, distance);
    let (a, c) = (corner(left, low), corner(right, high));
    [[a, corner(right, low), c], [a, c, corner(left, high)]]
}

/// The part of a half-plane that light can meet, and more: `beyond` is farther than light gets.
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

/// The largest coordinate across the central ray at which light that reaches a window or a surface can be: it runs
/// straight from the light to there.
fn reach(scene: &Scene) -> f64 {
    let ends = [0, 1].map(|axis| scene.light.extent(axis));
    let light = ends
        .as_flattened()
        .iter()
        .fold(0.0, |most: f64, end| most.max(end.abs()));
    let windows = scene.planes.iter().filter(|plane| plane.leg == 0);
    let windows = windows.map(|p| p.window.x.half_width().max(p.window.y.half_width()));
    let surfaces = scene.surfaces.iter().flat_map(Surface::corners);
    let meshes = scene.meshes.iter().flat_map(|m| m.triangles.as_flattened());
    let corners = surfaces.chain(meshes.copied());
    let corners = corners.map(|p| p.x.abs().max(p.y.abs()));
    windows.chain(corners).fold(light, f64::max)
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
