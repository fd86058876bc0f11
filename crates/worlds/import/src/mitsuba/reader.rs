//! Reads the objects of a Mitsuba scene into a world.

use super::mesh_data::{MitsubaMesh, MitsubaMeshKey, ReadMesh};
use super::object::{MitsubaObject, ObjectRef};
use super::xml::Tree;
use crate::Color;
use crate::files::Files;
use crate::pictures::Pictures;
use crate::report::Report;
use etendue_world::{Shape, World};
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

/// Converts objects to a world.
pub(super) struct MitsubaReader<'a> {
    pub(super) objects: &'a [MitsubaObject<'a>],
    pub(super) ids: &'a HashMap<String, usize>,
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    pub(super) color: Color,
    pub(super) world: World,
    pub(super) pictures: Pictures,
    /// The contents of mesh files that may hold several meshes.
    pub(super) packed: HashMap<PathBuf, Result<Arc<[u8]>, String>>,
    pub(super) meshes: HashMap<MitsubaMeshKey, ReadMesh>,
    /// The attributes that the textures within an object use.
    pub(super) wanted: HashMap<usize, Rc<[String]>>,
    /// The mesh of the shape that is read now, if it has one.
    pub(super) current_mesh: Option<MitsubaMesh>,
    /// Whether the shape that is being read is left out, which a note states.
    pub(super) is_left_out: bool,
    /// The material of each bsdf; `None` if the bsdf is invalid. If textures of the bsdf use
    /// attributes of meshes, each mesh, known by its address, has its own material.
    pub(super) materials: HashMap<(usize, usize), Option<usize>>,
    /// The shapes of each group.
    pub(super) groups: HashMap<usize, Rc<[Shape]>>,
    /// Number of materials made so far, including nested ones.
    pub(super) made_materials: usize,
    /// The indices of the default material of surfaces and of the default material of emitters, if
    /// these materials are in use.
    pub(super) defaults: [Option<usize>; 2],
}

impl<'a> MitsubaReader<'a> {
    pub(super) fn new(tree: &'a Tree<'_>, color: Color) -> Self {
        Self {
            objects: &tree.objects,
            ids: &tree.ids,
            files: tree.files,
            report: tree.report,
            color,
            world: World::default(),
            pictures: Pictures::default(),
            packed: HashMap::new(),
            meshes: HashMap::new(),
            wanted: HashMap::new(),
            current_mesh: None,
            is_left_out: false,
            materials: HashMap::new(),
            groups: HashMap::new(),
            made_materials: 0,
            defaults: [None; 2],
        }
    }

    /// The world of the scene, which is the first object.
    pub(super) fn world(mut self) -> World {
        let scene = &self.objects[0];
        scene.is_used.set(true);
        self.refuse_unknown();
        self.integrator(scene);
        self.sensors(scene);
        for (_, light) in self.children(scene, "emitter") {
            // Area lights are read with their shapes.
            match light.plugin.ends_with("area") {
                true => light.is_used.set(false),
                false => self.light(light),
            }
        }
        for (_, shape) in self.children(scene, "shape") {
            self.top_shape(shape);
        }
        self.note_masks(scene);
        self.definitions(scene);
        self.refuse_media();
        self.world
    }

    /// Marks definitions at the top level as read. Definitions, such as materials and textures, are
    /// converted where the scene uses them.
    fn definitions(&self, scene: ObjectRef<'a>) {
        for property in &scene.properties {
            if let Some(object) = self.object_of(property)
                && matches!(object.kind, "bsdf" | "texture" | "film")
            {
                property.is_read.set(true);
            }
        }
    }

    /// Refuses media, because a world has no volumetric scattering.
    fn refuse_media(&self) {
        for object in self.objects {
            // A medium within another medium is not reported, because the outer medium was already
            // reported.
            let is_outermost = self.objects[object.parent].kind != "medium";
            if matches!(object.kind, "medium" | "volume") && is_outermost {
                let title = object.title();
                object.cause(format!("{title}: participating media are not supported"));
                self.drop_all(object);
            }
        }
    }

    /// Marks the object and its contents as read, after a message that covers both.
    pub(super) fn drop_all(&self, object: ObjectRef<'a>) {
        object.is_used.set(true);
        for property in &object.properties {
            property.is_read.set(true);
            if let super::object::Value::Object(at) = property.value {
                self.drop_all(&self.objects[at]);
            }
        }
    }

    /// Reports an object that could not be read, unless a cause of refusal was already added for
    /// it.
    pub(super) fn lost(&self, object: ObjectRef<'a>) {
        if !self.report.has_causes() {
            object.cause(format!("{} is not understood", object.title()));
        }
    }

    /// Reports an unsupported plugin, and returns `None` in place of the object.
    pub(super) fn unsupported<T>(&self, object: ObjectRef<'a>, allowed: &str) -> Option<T> {
        self.drop_all(object);
        let title = object.title();
        object.refuse(format!("{title} is not supported; allowed: {allowed}"))
    }
}
