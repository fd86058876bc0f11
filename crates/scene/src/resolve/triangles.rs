//! Checks that the triangles of a placed mesh are within the range of coordinates of a scene, and
//! thick enough to be distinguished from lines.

use super::Resolver;
use etendue_meshfile::Mesh;
use etendue_scenefile::MeshSource;
use etendue_scenefile::limits::MAX_NUMBER;
use glam::DVec3;
use std::path::Path;

/// The smallest ratio of a triangle's height to the largest coordinate of the scene. If the ratio
/// is smaller, the triangle cannot be distinguished from a line.
///
/// Rounding changes a coordinate in the frame of a leg by up to 4e-16 of the largest coordinate. At
/// a ratio of 1e-12, rounding tilts the normal of a triangle by 4e-4 radians and changes the
/// barycentric coordinates of a point by as much. At smaller ratios, rounding dominates.
const THIN: f64 = 1e-12;
/// The smallest allowed height of a triangle in metres: the smallest size in a scene times the
/// smallest scale. Products of six lengths of 1e-18 m are within the range of f64.
const LEAST_HEIGHT: f64 = 1e-18;
/// Thin triangles are dropped if together they have at most this share of the mesh's area. The
/// light that they would meet is far below the noise.
const MAX_DROPPED_SHARE: f64 = 1e-6;
/// The placement of a mesh in the scene, with the information to report its faults.
pub(super) struct MeshPlacement<'a> {
    /// The path of the blocker's or surface's field in the scene file.
    pub(super) of: String,
    pub(super) source: &'a MeshSource,
    pub(super) center: DVec3,
    pub(super) scale: f64,
    /// The largest distance from the origin at which light starts or leaves a surface.
    pub(super) reach: f64,
}

impl MeshPlacement<'_> {
    /// The position of a vertex in the world of the scene file.
    pub(super) fn world(&self, vertex: DVec3) -> DVec3 {
        self.center + vertex * self.scale
    }

    /// The index of a vertex as its mesh file counts it, from 1 in OBJ files and from 0 in
    /// PLY files and generated meshes.
    pub(super) fn number(&self, vertex: u32) -> u64 {
        let extension = match self.source {
            MeshSource::File(path) => Path::new(path).extension(),
            _ => None,
        };
        u64::from(vertex) + u64::from(extension.is_some_and(|e| e.eq_ignore_ascii_case("obj")))
    }

    /// The path of a field of the mesh.
    pub(super) fn field(&self, what: &str) -> String {
        match self.source {
            MeshSource::File(path) => format!("{}.mesh, {path:?}: {what}", self.of),
            _ => format!("{}.mesh, {what}", self.of),
        }
    }

    /// The description of a triangle in messages, by the numbers of its vertices.
    pub(super) fn triangle(&self, corners: [u32; 3]) -> String {
        let [a, b, c] = corners.map(|i| self.number(i));
        format!("the triangle of vertices {a}, {b} and {c}")
    }
}

impl Resolver<'_> {
    /// Returns the mesh without the triangles that are too thin for f64. If these triangles are not
    /// a negligible part of the mesh, reports a fault and returns `None`.
    pub(super) fn distinct_triangles(
        &mut self,
        at: &MeshPlacement<'_>,
        mesh: Mesh,
    ) -> Option<Mesh> {
        self.inside(at, &mesh)?;
        let [low, high] = mesh.bounds();
        let size = at.scale * low.abs().max(high.abs()).length();
        let least = (THIN * (at.reach + at.center.length() + size)).max(LEAST_HEIGHT);
        let (mut thin, mut kept) = (Vec::new(), Vec::new());
        let (mut area, mut thin_area) = (0.0, 0.0);
        for (corners, indices) in mesh.corners().zip(mesh.triangles()) {
            let [height, twice] = height(corners);
            area += twice;
            if height * at.scale < least {
                thin_area += twice;
                thin.push((*indices, height * at.scale));
            } else {
                kept.push(*indices);
            }
        }
        let Some(&(first, height)) = thin.first() else {
            return Some(mesh);
        };
        if !kept.is_empty() && thin_area <= MAX_DROPPED_SHARE * area {
            return Mesh::new(mesh.vertices().to_vec(), kept).ok();
        }
        let allowed = format!(
            "at least {least:.3e} m, {THIN:e} of the largest coordinate{}: thinner triangles have no normal in f64",
            others(thin.len())
        );
        let field = at.field(&at.triangle(first));
        self.faults
            .add(field, format!("{height:.3e} m high"), allowed);
        None
    }

    /// Checks that the vertices of a mesh are within the range of coordinates of a scene.
    fn inside(&mut self, at: &MeshPlacement<'_>, mesh: &Mesh) -> Option<()> {
        let mut corners: Vec<u32> = mesh.triangles().as_flattened().to_vec();
        corners.sort_unstable();
        corners.dedup();
        let world = |i: u32| at.world(mesh.vertices()[i as usize]);
        corners.retain(|i| world(*i).abs().max_element() > MAX_NUMBER);
        let Some(first) = corners.first() else {
            return Some(());
        };
        let field = at.field(&format!("vertex {}", at.number(*first)));
        let value = format!("at {} in the world", world(*first));
        let allowed = format!(
            "coordinates of {:?} to {MAX_NUMBER:?}{}",
            -MAX_NUMBER,
            others(corners.len())
        );
        self.faults.add(field, value, allowed);
        None
    }
}

/// The height of a triangle over its longest side, and twice its area.
fn height([a, b, c]: [DVec3; 3]) -> [f64; 2] {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let twice = (b - a).cross(c - a).length();
    [twice / longest, twice]
}

/// The part of a message that counts the faults after the first fault.
pub(super) fn others(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        more => format!(" ({} more have this fault)", more - 1),
    }
}
