//! Nodes of a glTF scene, and the placement of these nodes.

use super::reader::GltfReader;
use crate::range::{MAX_NUMBER, holds};
use ::gltf::json::Node;
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Maximum deviation of the length of a rotation quaternion from 1.
const UNIT: f64 = 1e-3;

/// Says why nodes are refused.
const CIRCLE: &str = "has two parents, or is its own ancestor";

/// A node and the transform of this node.
pub(super) struct PlacedNode<'a> {
    pub(super) node: &'a Node,
    pub(super) path: String,
    pub(super) to_world: DAffine3,
}

impl<'a> GltfReader<'a> {
    /// Adds the content of all nodes of the scene. The traversal of the nodes is not recursive and
    /// visits each node once.
    pub(super) fn nodes(&mut self) {
        let mut met = vec![false; self.root.nodes.len()];
        let mut open: Vec<(usize, DAffine3)> = Vec::new();
        let first = self.tops();
        open.extend(first.iter().rev().map(|top| (*top, DAffine3::IDENTITY)));
        while let Some((number, outer)) = open.pop() {
            let path = format!("nodes[{number}]");
            let Some(node) = self.root.nodes.get(number) else {
                continue;
            };
            if std::mem::replace(&mut met[number], true) {
                self.cause(&path, CIRCLE);
                continue;
            }
            let Some(own) = self.own(node, &path) else {
                continue;
            };
            let to_world = outer * own;
            let children = node.children.iter().flatten().rev();
            open.extend(children.map(|child| (child.value(), to_world)));
            let placed = PlacedNode {
                node,
                path,
                to_world,
            };
            self.hold(&placed);
        }
        self.tell_unmet(&met);
    }

    /// The root nodes of the default scene or, in a file without scenes, the nodes without
    /// a parent.
    fn tops(&self) -> Vec<usize> {
        let chosen = self.root.scene.map_or(0, |scene| scene.value());
        let Some(scene) = self.root.scenes.get(chosen) else {
            let mut is_top = vec![true; self.root.nodes.len()];
            let children = self.root.nodes.iter().flat_map(|node| &node.children);
            for child in children.flatten() {
                if let Some(top) = is_top.get_mut(child.value()) {
                    *top = false;
                }
            }
            return (0..is_top.len()).filter(|i| is_top[*i]).collect();
        };
        if self.root.scenes.len() > 1 {
            let others = self.root.scenes.len() - 1;
            let message = format!("this scene is used; {others} other scenes are left out");
            self.note(&format!("scenes[{chosen}]"), message);
        }
        scene.nodes.iter().map(|node| node.value()).collect()
    }

    /// Adds a note on the nodes that were not visited. In a file without scenes, the nodes that
    /// were not visited form cycles.
    fn tell_unmet(&self, met: &[bool]) {
        let unmet = met.iter().filter(|met| !**met).count();
        match (met.iter().position(|met| !met), self.root.scenes.is_empty()) {
            (Some(first), true) => {
                self.cause(&format!("nodes[{first}]"), CIRCLE);
            }
            (Some(_), false) => {
                let message = format!("{unmet} nodes do not belong to the scene and are left out");
                self.note("nodes", message);
            }
            (None, _) => {}
        }
    }

    /// Adds the mesh, camera and light of a node to the world.
    fn hold(&mut self, placed: &PlacedNode<'a>) {
        let (node, path) = (placed.node, &placed.path);
        if !holds(placed.to_world) {
            let message = format!("is placed out of range; allowed: up to {MAX_NUMBER:e}");
            return self.cause(path, message);
        }
        if node.skin.is_some() {
            self.note(
                &format!("{path}.skin"),
                "is left out: the mesh keeps its bind pose",
            );
        }
        if let Some(mesh) = node.mesh {
            self.mesh_of(placed, mesh.value());
        }
        if let Some(camera) = node.camera {
            self.camera_of(placed, camera.value());
        }
        let extensions = node.extensions.as_ref();
        if let Some(light) = extensions.and_then(|of| of.khr_lights_punctual.as_ref()) {
            self.light_of(placed, light.light.value());
        }
        self.tell_others(path, extensions.iter().flat_map(|of| of.others.keys()));
    }

    /// The local transform of a node, or `None` if a cause of refusal was reported.
    fn own(&self, node: &Node, path: &str) -> Option<DAffine3> {
        let is_split =
            node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
        match node.matrix {
            Some(_) if is_split => self.refuse(
                path,
                "has a matrix, and also a translation, rotation or scale; allowed: only one of the two forms",
            ),
            Some(matrix) => self.matrix(matrix, path),
            None => self.split(node, path),
        }
    }

    /// A matrix from sixteen numbers in column-major order.
    fn matrix(&self, matrix: [f32; 16], path: &str) -> Option<DAffine3> {
        let m = matrix.map(f64::from);
        let is_affine = [m[3], m[7], m[11], m[15] - 1.0]
            .iter()
            .all(|v| v.abs() < 1e-6);
        if !is_affine {
            return self.refuse(
                &format!("{path}.matrix"),
                "the last row of the matrix is not 0 0 0 1",
            );
        }
        let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        Some(DAffine3::from_mat3_translation(linear, column(3)))
    }

    /// The transform that first scales, then rotates, then translates.
    fn split(&self, node: &Node, path: &str) -> Option<DAffine3> {
        let three = |v: Option<[f32; 3]>, or| v.map_or(or, |v| DVec3::from(v.map(f64::from)));
        let turn = match &node.rotation {
            Some(rotation) => {
                let turn = DQuat::from_array(rotation.0.map(f64::from));
                let length = turn.length();
                if !(length.is_finite() && length > 1e-6) {
                    return self.refuse(&format!("{path}.rotation"), "has no length");
                }
                if (length - 1.0).abs() > UNIT {
                    let message = format!("has length {length}, and is normalised");
                    self.note(&format!("{path}.rotation"), message);
                }
                turn.normalize()
            }
            None => DQuat::IDENTITY,
        };
        Some(DAffine3::from_scale_rotation_translation(
            three(node.scale, DVec3::ONE),
            turn,
            three(node.translation, DVec3::ZERO),
        ))
    }
}

impl PlacedNode<'_> {
    /// The position and orientation of a camera or light, without scales and mirrors. A
    /// camera or light points along −Z with Y up in glTF, and along Z in a world.
    pub(super) fn looking(&self) -> Option<DAffine3> {
        let linear = self.to_world.matrix3;
        let ahead = (-linear.z_axis).try_normalize()?;
        let left = linear.y_axis.cross(ahead).try_normalize()?;
        let frame = DMat3::from_cols(left, ahead.cross(left), ahead);
        Some(DAffine3::from_mat3_translation(
            frame,
            self.to_world.translation,
        ))
    }
}
