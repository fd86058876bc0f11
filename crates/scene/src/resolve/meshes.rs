//! Checks and places the meshes of a scene file.

use super::Resolver;
use super::faults::show;
use super::triangles::MeshPlacement;
use crate::scene::{MeshObject, SmoothMesh};
use crate::triangles::Triangles;
use etendue_field::Frame;
use etendue_meshfile::{Fault, Mesh};
use etendue_scenefile::limits::MAX_NUMBER;
use etendue_scenefile::{
    BlockersFile, EventFile, FormFile, LightFile, MeshSource, SceneFile, SurfaceFile,
};
use glam::DVec3;
use std::path::Path;

/// A mesh of the scene file, placed in the scene.
struct PlacedMesh<'a> {
    of: String,
    name: &'a String,
    center: &'a [f64; 3],
    mesh: &'a MeshSource,
    scale: f64,
    albedo: Option<f64>,
    event: Option<&'a EventFile>,
}

impl Resolver<'_> {
    /// The meshes: blockers, then surfaces.
    pub(super) fn meshes(&mut self, file: &SceneFile, frame: &Frame) -> Vec<MeshObject> {
        let blockers = file
            .blockers
            .iter()
            .enumerate()
            .filter_map(|(i, b)| match b {
                BlockersFile::Mesh {
                    name,
                    center,
                    mesh,
                    scale,
                } => Some(PlacedMesh {
                    of: format!("blockers[{i}]"),
                    name,
                    center,
                    mesh,
                    scale: *scale,
                    albedo: None,
                    event: None,
                }),
                _ => None,
            });
        let surfaces = file
            .surfaces
            .iter()
            .enumerate()
            .filter_map(|(i, s)| match s {
                SurfaceFile::Mesh {
                    name,
                    center,
                    mesh,
                    scale,
                    albedo,
                    event,
                } => Some(PlacedMesh {
                    of: format!("surfaces[{i}]"),
                    name,
                    center,
                    mesh,
                    scale: *scale,
                    albedo: event.is_none().then_some(albedo.number(self.color)),
                    event: event.as_ref(),
                }),
                SurfaceFile::Rectangle { .. } | SurfaceFile::Smooth { .. } => None,
            });
        let placed: Vec<_> = blockers.chain(surfaces).collect();
        let reach = reach(file);
        let objects = placed.into_iter();
        let objects = objects.filter_map(|p| self.mesh(&p, reach, frame));
        objects.collect()
    }

    fn mesh(&mut self, placed: &PlacedMesh<'_>, reach: f64, frame: &Frame) -> Option<MeshObject> {
        let of = &placed.of;
        let mesh = self.source(of, placed.mesh)?;
        let at = MeshPlacement {
            of: placed.of.clone(),
            source: placed.mesh,
            center: DVec3::from(*placed.center),
            scale: placed.scale,
            reach,
        };
        // A place that is no number is a fault already, and a hierarchy over it would take long.
        if !(at.center * at.scale).is_finite() {
            return None;
        }
        let mesh = self.distinct_triangles(&at, mesh)?;
        let local = |i: &u32| frame.to_local(at.world(mesh.vertices()[*i as usize]));
        let triangles: Vec<[DVec3; 3]> = mesh
            .triangles()
            .iter()
            .map(|corners| corners.each_ref().map(local))
            .collect();
        let extent = super::extent(triangles.as_flattened());
        self.ahead(of, extent[0]);
        let smooth = match placed.event {
            Some(event) => Some(self.smooth(&at, event, &mesh, frame)?),
            None => None,
        };
        // The mesh of the file is freed before a hierarchy is built.
        drop(mesh);
        Some(MeshObject {
            name: placed.name.clone(),
            center: frame.to_local(at.center),
            triangles: Triangles::new(triangles, reach),
            extent,
            albedo: placed.albedo,
            smooth,
        })
    }

    /// A smooth mesh with the normals of its vertices.
    fn smooth(
        &mut self,
        at: &MeshPlacement<'_>,
        event: &EventFile,
        mesh: &Mesh,
        frame: &Frame,
    ) -> Option<SmoothMesh> {
        let of = format!("{}.event", at.of);
        if let EventFile::ThinLens(_) | EventFile::Reflects { .. } | EventFile::Sum { .. } = event {
            self.faults.add(of, show(event), "Mirror or Refraction(…)");
            return None;
        }
        let event = self.specular(&of, event, FormFile::Plane)?;
        let normals = self.normals(at, mesh)?;
        let local = |i: &u32| frame.vector_to_local(normals[*i as usize]);
        let normals = mesh.triangles().iter();
        let normals = normals.map(|corners| corners.each_ref().map(local));
        Some(SmoothMesh {
            event,
            normals: normals.collect(),
        })
    }

    fn source(&mut self, of: &str, source: &MeshSource) -> Option<Mesh> {
        match source {
            MeshSource::File(path) => {
                let of = format!("{of}.mesh");
                let bytes = self.named_file(&of, path)?;
                let fault = |fault: Fault| {
                    let field = format!("{of}, {path:?}: {}", fault.field);
                    self.faults.add(field, fault.value, fault.allowed);
                };
                Mesh::parse(Path::new(path), &bytes).map_err(fault).ok()
            }
            // If the size of the mesh is faulty, the fault has been reported already.
            _ if self.faults.has_below(&format!("{of}.mesh")) => None,
            &MeshSource::Paraboloid {
                curvatures,
                half,
                cells,
            } => self.generated(of, Mesh::paraboloid(curvatures, half, cells)),
            &MeshSource::Star {
                radius,
                relief,
                lobes,
                rings,
            } => self.generated(of, Mesh::star(radius, relief, lobes, rings)),
        }
    }

    fn generated(&mut self, of: &str, mesh: Result<Mesh, Fault>) -> Option<Mesh> {
        mesh.map_err(|fault| {
            let field = format!("{of}.mesh.{}", fault.field);
            self.faults.add(field, fault.value, fault.allowed);
        })
        .ok()
    }
}

/// The largest distance from the origin at which light may start at the light source or
/// leave a surface. The distance bounds the coordinates of rays and meshes.
fn reach(file: &SceneFile) -> f64 {
    let centers = file.surfaces.iter().map(|surface| match surface {
        SurfaceFile::Rectangle { center, .. }
        | SurfaceFile::Mesh { center, .. }
        | SurfaceFile::Smooth { center, .. } => *center,
    });
    let lights = std::iter::once(&file.light).chain(&file.other_lights);
    let centers = centers.chain(lights.map(LightFile::center));
    let farthest = centers.map(|center| DVec3::from(center).length());
    // A scene with a farther centre is refused. Boxes that are padded for such a distance all
    // overlap, and a hierarchy over them takes minutes.
    let allowed = farthest.filter(|distance| *distance < 2.0 * MAX_NUMBER);
    allowed.fold(0.0, f64::max)
}
