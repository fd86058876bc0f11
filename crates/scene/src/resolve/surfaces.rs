//! Checks the flat surfaces of a scene file.

use super::Resolver;
use super::faults::vector;
use crate::scene::Surface;
use etendue_field::{Frame, tidy};
use etendue_scenefile::{SceneFile, SurfaceFile};
use glam::DVec3;

impl Resolver<'_> {
    /// The rectangular surfaces.
    pub(super) fn surfaces(&mut self, file: &SceneFile, frame: &Frame) -> Vec<Surface> {
        let surfaces = file.surfaces.iter().enumerate();
        surfaces
            .filter_map(|(i, surface)| self.surface(i, surface, frame))
            .collect()
    }

    fn surface(&mut self, i: usize, surface: &SurfaceFile, frame: &Frame) -> Option<Surface> {
        let SurfaceFile::Rectangle {
            name,
            center,
            size,
            facing,
            albedo,
        } = surface
        else {
            return None;
        };
        let of = format!("surfaces[{i}]");
        let origin = frame.to_local(DVec3::from(*center));
        let frame = if let Some(facing) = facing {
            self.facing(&of, *facing, origin, frame)?
        } else {
            self.ahead(&of, origin.z);
            Frame {
                origin,
                x: DVec3::X,
                y: DVec3::NEG_Y,
                d: DVec3::NEG_Z,
            }
        };
        Some(Surface {
            name: name.clone(),
            frame,
            size: *size,
            albedo: albedo.number(self.color),
        })
    }

    /// The frame of a surface that faces along a direction of the world.
    fn facing(
        &mut self,
        of: &str,
        facing: [f64; 3],
        origin: DVec3,
        light: &Frame,
    ) -> Option<Frame> {
        let of = format!("{of}.facing");
        let d = light.vector_to_local(DVec3::from(facing));
        let frame = Frame::new(origin, d, DVec3::X).or_else(|| Frame::new(origin, d, DVec3::Y));
        if frame.is_none() && d.is_finite() {
            self.faults.add(of, vector(&facing), "a direction");
        }
        frame
    }

    /// Checks that a distance is in front of the light. An infinite distance is reported as a fault
    /// of the object's center. Without a valid path no distance is known, so nothing is checked.
    pub(super) fn ahead(&mut self, of: &str, distance: f64) {
        if distance <= 0.0 && !self.faults.astray {
            let allowed = "a place in front of the light, along path.direction";
            self.faults.add(
                format!("{of}.center"),
                format!("at distance {} m from the light", tidy(distance)),
                allowed,
            );
        }
    }
}
