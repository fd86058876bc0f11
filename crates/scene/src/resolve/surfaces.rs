use super::Resolver;
use super::faults::show;
use crate::file::{SceneFile, SurfaceFile};
use crate::scene::{MeshObject, Surface};
use etendue_field::{Frame, Rectangle, TwoPlane, triangle_distance};
use glam::DVec3;

impl Resolver<'_> {
    /// The flat surfaces.
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
            albedo,
        } = surface
        else {
            return None;
        };
        let of = format!("surfaces[{i}]");
        self.faults.coordinates(&format!("{of}.center"), center);
        self.size(&of, size);
        self.faults
            .within(format!("{of}.albedo"), *albedo, 0.0..=1.0);
        let center = frame.to_local(DVec3::from(*center));
        self.ahead(&of, center.z);
        Some(Surface {
            name: name.clone(),
            distance: center.z,
            rectangle: Rectangle {
                center: [center.x, center.y],
                size: *size,
            },
            albedo: *albedo,
        })
    }

    pub(super) fn size(&mut self, of: &str, size: &[f64; 2]) {
        for (i, side) in size.iter().enumerate() {
            self.faults.positive(format!("{of}.size[{i}]"), *side);
        }
    }

    /// A finite distance must be in front of the light; an infinite one is a fault of its center.
    pub(super) fn ahead(&mut self, of: &str, distance: f64) {
        if distance <= 0.0 {
            let allowed = "a place in front of the light, along path.direction";
            self.faults.add(
                format!("{of}.center"),
                format!("at distance {distance} m from the light"),
                allowed,
            );
        }
    }

    /// The distance of the surface that the central ray visits.
    pub(super) fn length(
        &mut self,
        file: &SceneFile,
        surfaces: &[Surface],
        meshes: &[MeshObject],
    ) -> f64 {
        let [visit] = file.path.visits.as_slice() else {
            let allowed = "the name of one surface, on which the central ray ends";
            self.faults
                .add("path.visits", show(&file.path.visits), allowed);
            return f64::NAN;
        };
        let flat = surfaces.iter().map(|s| {
            let hit = s.rectangle.contains(0.0, 0.0).then_some(s.distance);
            (s.name.as_str(), hit, s.distance.is_finite())
        });
        let meshes = meshes.iter().filter(|m| m.albedo.is_some());
        let meshes = meshes.map(|m| (m.name.as_str(), m.on_axis(), true));
        let known: Vec<_> = flat.chain(meshes).collect();
        let Some((_, hit, located)) = known.iter().find(|(name, ..)| name == visit) else {
            let names: Vec<&str> = known.iter().map(|(name, ..)| *name).collect();
            self.faults.add(
                "path.visits[0]",
                show(visit),
                format!("one of the surfaces: {}", names.join(", ")),
            );
            return f64::NAN;
        };
        let Some(distance) = *hit else {
            if *located {
                let allowed = "a surface that the central ray hits";
                self.faults.add("path.visits[0]", show(visit), allowed);
            }
            return f64::NAN;
        };
        for (name, ..) in known
            .iter()
            .filter(|(_, hit, _)| hit.is_some_and(|d| d < distance))
        {
            let allowed = format!("{}, which the central ray hits first", show(name));
            self.faults.add("path.visits[0]", show(visit), allowed);
        }
        distance
    }
}

impl MeshObject {
    /// Where the central ray hits it first.
    fn on_axis(&self) -> Option<f64> {
        let central = TwoPlane::default();
        let hits = self.triangles.iter();
        let hits = hits.filter_map(|corners| triangle_distance(corners, &central));
        hits.reduce(f64::min)
    }
}
