//! Checks the names of the scene, its objects and its planes.

use super::faults::show;
use super::fields::fields;
use super::{PathStop, Resolver};
use etendue_scenefile::is_printable;
use etendue_scenefile::limits;
use etendue_scenefile::{BlockersFile, SceneFile, SurfaceFile};

impl Resolver<'_> {
    /// Checks the name of the scene, which becomes the name of a folder of results.
    pub(super) fn name_of_scene(&mut self, name: &str) {
        if !is_name(name) || name == "." || name == ".." || name.contains('/') {
            let field = "the name of the scene file";
            let allowed = format!("{}, no `/`, and neither `.` nor `..`", printable());
            self.faults.add(field, show(name), allowed);
        }
    }

    pub(super) fn names(&mut self, file: &SceneFile, stops: &[PathStop<'_>]) {
        let blockers = file.blockers.iter().map(BlockersFile::name).enumerate();
        let surfaces = file.surfaces.iter().map(SurfaceFile::name).enumerate();
        let blockers = blockers.map(|(i, name)| (format!("blockers[{i}].name"), name));
        let surfaces = surfaces.map(|(i, name)| (format!("surfaces[{i}].name"), name));
        for (field, name) in blockers.chain(surfaces) {
            if !is_name(name) {
                self.faults.add(field, show(name), printable());
            }
        }
        for repeated in repeated(stops.iter().map(|stop| stop.name)) {
            let field = fields(file, repeated).nth(1).unwrap_or_default();
            let allowed = "a name that no other blockers or surface has";
            self.faults
                .add(format!("{field}.name"), show(repeated), allowed);
        }
        self.names_of_planes(file);
    }

    fn names_of_planes(&mut self, file: &SceneFile) {
        // Some file systems treat `Light` and `light` as one folder.
        let folders: Vec<String> = file.planes.iter().map(|p| p.name.to_lowercase()).collect();
        for repeated in repeated(folders.iter().map(String::as_str)) {
            let mut named = (0..folders.len()).filter(|i| folders[*i] == repeated);
            let field = format!("planes[{}].name", named.nth(1).unwrap_or_default());
            self.faults
                .add(field, show(repeated), "a name that no other plane has");
        }
        let usable = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        for (i, plane) in file.planes.iter().enumerate() {
            if !is_name(&plane.name) || !plane.name.chars().all(usable) {
                let most = limits::NAME;
                let allowed = format!("1 to {most} letters, digits, - and _: it names a folder");
                self.faults
                    .add(format!("planes[{i}].name"), show(&plane.name), allowed);
            }
        }
    }
}

/// Checks whether a name can be used in messages, files and pictures.
fn is_name(name: &str) -> bool {
    let length = name.chars().take(limits::NAME + 1).count();
    (1..=limits::NAME).contains(&length) && name.chars().all(is_printable)
}

fn printable() -> String {
    format!("1 to {} printable characters of any script", limits::NAME)
}

fn repeated<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    let mut twice: Vec<&str> = names
        .windows(2)
        .filter(|w| w[0] == w[1])
        .map(|w| w[0])
        .collect();
    twice.dedup();
    twice
}
