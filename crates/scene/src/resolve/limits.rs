//! Checks the numbers of objects before any single object is checked.

use super::Resolver;
use etendue_scenefile::limits;
use etendue_scenefile::{
    BlockersFile, EnvironmentFile, LightFile, MeshSource, SceneFile, SurfaceFile,
};

impl Resolver<'_> {
    /// Adds a fault for each kind of object that is too numerous, and returns whether no fault
    /// was added.
    pub(super) fn counts(&mut self, file: &SceneFile) -> bool {
        let lobes = |light: &LightFile| match light {
            LightFile::Environment {
                map: EnvironmentFile::Lobes(lobes),
                ..
            } => lobes.len(),
            _ => 0,
        };
        let others = &file.other_lights;
        let visits = file.path.visits.len();
        for (field, count, what, most) in [
            ("blockers", file.blockers.len(), "layers", limits::LAYERS),
            (
                "surfaces",
                file.surfaces.len(),
                "surfaces",
                limits::SURFACES,
            ),
            ("planes", file.planes.len(), "planes", limits::PLANES),
            ("path.visits", visits, "visits", limits::VISITS),
            ("light.map", lobes(&file.light), "lobes", limits::LOBES),
            ("other_lights", others.len(), "lights", limits::OTHER_LIGHTS),
            (
                "other_lights: lobes of all maps",
                others.iter().map(lobes).sum(),
                "lobes",
                limits::LOBES,
            ),
        ] {
            self.at_most(field, count as u64, what, most as u64);
        }
        for (i, blockers) in file.blockers.iter().enumerate() {
            if let BlockersFile::Aperture { hole, .. } = blockers {
                self.corners(&format!("blockers[{i}].hole"), hole);
            }
        }
        // A single layer with too many shapes is reported later, when that layer is checked.
        let most = limits::SHAPES as u64;
        let shapes = file.blockers.iter().map(|b| shapes(b).min(most)).sum();
        self.at_most("blockers: shapes of all layers", shapes, "shapes", most);
        let triangles = meshes(file).map(triangles).sum();
        let field = "triangles of all Star and Paraboloid meshes";
        self.at_most(field, triangles, "triangles", limits::MADE_TRIANGLES);
        self.faults.all.is_empty()
    }

    pub(super) fn at_most(&mut self, field: &str, count: u64, what: &str, most: u64) {
        if count > most {
            let allowed = format!("at most {most}");
            self.faults.add(field, format!("{count} {what}"), allowed);
        }
    }
}

fn shapes(blockers: &BlockersFile) -> u64 {
    match blockers {
        BlockersFile::JitteredSquares { count, .. } => count.map(u64::from).iter().product(),
        BlockersFile::Bars { count, .. } => u64::from(*count),
        BlockersFile::Shapes { shapes, .. } => shapes.len() as u64,
        _ => 0,
    }
}

fn meshes(file: &SceneFile) -> impl Iterator<Item = &MeshSource> {
    let blockers = file.blockers.iter().filter_map(|b| match b {
        BlockersFile::Mesh { mesh, .. } => Some(mesh),
        _ => None,
    });
    let surfaces = file.surfaces.iter().filter_map(|s| match s {
        SurfaceFile::Mesh { mesh, .. } => Some(mesh),
        SurfaceFile::Rectangle { .. } | SurfaceFile::Smooth { .. } => None,
    });
    blockers.chain(surfaces)
}

/// The approximate number of triangles of a generated mesh, or zero for a mesh that will
/// be refused.
fn triangles(mesh: &MeshSource) -> u64 {
    let square = |n: u32| u64::from(if n > limits::CELLS { 0 } else { n }).pow(2);
    match mesh {
        MeshSource::Star { rings, .. } => 4 * square(*rings),
        MeshSource::Paraboloid { cells, .. } => 2 * square(*cells),
        MeshSource::File(_) => 0,
    }
}
