//! Finds objects in a scene file by name, and returns the paths of their fields.

use etendue_scenefile::{BlockersFile, SceneFile, SurfaceFile};

/// The paths of the objects with a given name, such as `blockers[0]` or `surfaces[0]`.
pub(super) fn fields<'a>(file: &'a SceneFile, name: &'a str) -> impl Iterator<Item = String> + 'a {
    let blockers = file.blockers.iter().map(BlockersFile::name).enumerate();
    let surfaces = file.surfaces.iter().map(SurfaceFile::name).enumerate();
    let blockers = blockers.map(|(i, name)| (format!("blockers[{i}]"), name));
    let surfaces = surfaces.map(|(i, name)| (format!("surfaces[{i}]"), name));
    let named = blockers
        .chain(surfaces)
        .filter(move |(_, its)| *its == name);
    named.map(|(field, _)| field)
}
