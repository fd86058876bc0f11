//! Meshes with their attributes.

use etendue_meshfile::{DetailedMesh, MeshAttribute};
use etendue_world::Triangles;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

/// The largest number of attributes that a message lists.
const MOST_LISTED: usize = 8;

/// The triangles of a mesh and its attributes, or the reason why the mesh cannot be read.
pub(super) type ReadMesh = Result<(Arc<Triangles>, Rc<MitsubaAttributes>), String>;

/// The mesh of a shape.
#[derive(Clone, Debug)]
pub(super) struct MitsubaMesh {
    pub(super) triangles: Arc<Triangles>,
    pub(super) attributes: Rc<MitsubaAttributes>,
    /// Whether the front of the mesh is opposite to its normals.
    pub(super) is_flipped: bool,
}

/// The attributes of a mesh.
#[derive(Debug, Default)]
pub(super) struct MitsubaAttributes {
    /// The names of all attributes of the file.
    names: Vec<String>,
    /// The attributes that textures of the shape use.
    pub(super) read: Vec<MeshAttribute>,
}

impl MitsubaAttributes {
    /// Moves the attributes out of a mesh.
    pub(super) fn take(mesh: &mut DetailedMesh) -> Self {
        Self {
            names: std::mem::take(&mut mesh.attribute_names),
            read: std::mem::take(&mut mesh.attributes),
        }
    }

    /// Drops the numbers of triangles that were dropped.
    pub(super) fn keep(&mut self, kept: &[bool]) {
        for attribute in self.read.iter_mut().filter(|of| !of.is_of_vertices) {
            let rows = attribute.values.chunks(attribute.channels.max(1));
            let rows = rows.zip(kept).filter(|(_, is_kept)| **is_kept);
            attribute.values = rows.flat_map(|(row, _)| row).copied().collect();
        }
    }

    /// The approximate size in memory, in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let all = self.read.iter().map(|of| size_of_val(of.values.as_slice()));
        all.sum::<usize>() as u64
    }

    /// The names of the file's attributes, for messages.
    pub(super) fn listed(&self) -> String {
        if self.names.is_empty() {
            return "the mesh has no attributes".to_owned();
        }
        let mut listed: Vec<&str> = self.names.iter().map(String::as_str).collect();
        listed.truncate(MOST_LISTED);
        if self.names.len() > MOST_LISTED {
            listed.push("…");
        }
        format!("allowed: {}", listed.join(", "))
    }
}

/// The source and the options of a mesh; shapes with equal keys share the mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MitsubaMeshKey {
    pub(super) path: PathBuf,
    pub(super) number: u32,
    pub(super) is_flat: bool,
    pub(super) is_flipped: bool,
    /// The names of the attributes to read.
    pub(super) attributes: Rc<[String]>,
    /// The linear part of the placement, on which smooth normals depend.
    pub(super) linear: Option<[u64; 9]>,
}
