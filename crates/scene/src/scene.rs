//! The checked scene.

use crate::{Emission, Sampling, SceneFile, Triangles};
use etendue_field::{Frame, Light, Mask, Patch, Rectangle, Reflectance, Specular, VirtualPlane};
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A checked experiment. Distances are measured from the light along the central ray, and
/// blockers lie across the first leg of this ray. All coordinates of a scene are given in the
/// frame at the light.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name of the scene: the name of its file, without the extension.
    pub name: String,
    /// The file from which the scene was resolved, including defaults and overrides.
    pub file: SceneFile,
    /// The central ray.
    pub path: CentralRay,
    /// The light, at distance zero.
    pub light: Light,
    /// A scene for each further light. It equals this scene, but has only this light, and its
    /// distances begin at this light. Planes behind the light are omitted.
    pub other_lights: Vec<Self>,
    /// The layers of blockers, in the order of their distances.
    pub blockers: Vec<BlockerLayer>,
    /// The rectangular surfaces, in the order of the scene file.
    pub surfaces: Vec<Surface>,
    /// The smooth surfaces, in the order of the scene file.
    pub patches: Vec<PatchObject>,
    /// The meshes: blockers, then surfaces, each in the order of the scene file.
    pub meshes: Vec<MeshObject>,
    /// The virtual planes, in the order of the scene file.
    pub planes: Vec<VirtualPlane>,
    /// BLAKE3 hash of each mesh and picture, by the file's name in the scene.
    pub inputs: BTreeMap<String, String>,
    /// The memory to read the pictures, in bytes.
    pub picture_bytes: usize,
    /// The settings of the measurement.
    pub run: RunSettings,
    /// The scene from which the difference of this scene is measured, if the method of measurement
    /// is that difference. It has the same planes, with their own places.
    pub against: Option<Box<Self>>,
}

/// The central ray, which consists of straight legs from surface to surface. Positions and slopes
/// of light are measured from the central ray.
#[derive(Clone, Debug, PartialEq)]
pub struct CentralRay {
    /// Frame at the light, in the world of the scene file.
    pub frame: Frame,
    /// The legs, in the order of light; their number is the number of visited surfaces plus one.
    pub legs: Vec<Leg>,
}

/// A straight piece of the central ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Frame at the beginning of the leg, in the frame at the light.
    pub frame: Frame,
    /// Distance along the path at which the leg begins.
    pub start: f64,
    /// Distance from the leg's beginning to the surface that ends the leg. The last leg ends at the
    /// first obstacle.
    pub length: f64,
    /// The hit at which the leg leaves a surface; `None` for the first leg.
    pub leaves: Option<Hit>,
}

/// A point where the central ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object that the ray meets.
    pub object: Object,
    /// The point of the hit, in the frame at the light.
    pub point: DVec3,
    /// The unit normal of the surface at the hit, in the frame at the light. It points to the side
    /// from which the light comes.
    pub normal: DVec3,
}

/// An object that light can meet and leave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Object {
    /// The flat surface with this index.
    Surface(usize),
    /// The mesh with this index.
    Mesh(usize),
    /// The smooth surface with this index.
    Patch(usize),
}

impl Hit {
    /// The frame (T, B, N) at the hit for light that arrives in the frame `arriving`, and
    /// the longitude θ₀ of the direction from which the light comes. T lies in the plane of
    /// incidence. At normal incidence, X is rotated to −T (docs/conventions.md).
    #[must_use]
    pub fn surface_frame(&self, arriving: &Frame) -> (Frame, f64) {
        let (n, from) = (self.normal, -arriving.d);
        let across = from - from.dot(n) * n;
        let t = if across.length() > 1e-9 {
            let t = across.normalize();
            if t.dot(arriving.x) > 0.0 { -t } else { t }
        } else {
            -(arriving.x - arriving.x.dot(n) * n).normalize()
        };
        let frame = Frame {
            origin: self.point,
            x: t,
            y: n.cross(t),
            d: n,
        };
        (frame, frame.longitude(from))
    }
}

impl CentralRay {
    /// The distance at which the central ray meets the first surface of its path.
    #[must_use]
    pub fn first_hit(&self) -> f64 {
        self.legs[0].length
    }

    /// The hit at which the leg ends; `None` for the last leg.
    #[must_use]
    pub fn ends_at(&self, leg: usize) -> Option<&Hit> {
        self.legs.get(leg + 1)?.leaves.as_ref()
    }

    /// Checks whether the path visits an object.
    #[must_use]
    pub fn visits(&self, object: Object) -> bool {
        let mut hits = self.legs.iter().filter_map(|leg| leg.leaves);
        hits.any(|hit| hit.object == object)
    }

    /// The distance of a plane from the beginning of its leg.
    #[must_use]
    pub fn along(&self, plane: &VirtualPlane) -> f64 {
        plane.distance - self.legs[plane.leg].start
    }

    /// The frame of a leg at a distance along the path, in the frame at the light.
    #[must_use]
    pub fn frame_at(&self, distance: f64, leg: usize) -> Frame {
        let Leg { frame, start, .. } = &self.legs[leg];
        frame.travelled(distance - start)
    }
}

/// A layer of blockers in one plane, which multiplies radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockerLayer {
    /// Name.
    pub name: String,
    /// Distance of the layer's plane from the light. It is negative if the layer stands behind a
    /// further light; light meets such a layer only on later legs.
    pub distance: f64,
    /// Distance between repetitions of the mask; `None` if the mask is not repeated. Repetitions
    /// replicate spectra at multiples of 1/pitch.
    pub pitch: Option<f64>,
    /// The mask that multiplies radiance.
    pub mask: Mask,
}

/// A triangle mesh in front of the light.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshObject {
    /// Name.
    pub name: String,
    /// The origin of the mesh's own coordinates, in the frame at the light.
    pub center: DVec3,
    /// The triangles of the mesh, with corners in the frame at the light.
    pub triangles: Triangles,
    /// The smallest and the largest distance of the triangles' corners along the first leg.
    pub extent: [f64; 2],
    /// The ratio of reflected to incident flux; `None` if the mesh is not Lambertian.
    pub albedo: Option<f64>,
    /// If the mesh is a smooth surface, its normals and its interaction with light; otherwise
    /// `None`.
    pub smooth: Option<SmoothMesh>,
}

/// A mesh as a smooth surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothMesh {
    /// The interaction of the mesh with light.
    pub event: Specular,
    /// Unit normals at the corners of the triangles, in the frame at the light. The outward side is
    /// given by the winding of the triangles.
    pub normals: Arc<[[DVec3; 3]]>,
}

impl MeshObject {
    /// Checks whether the mesh is black, which means that it is not Lambertian and not smooth.
    #[must_use]
    pub fn is_black(&self) -> bool {
        self.albedo.is_none() && self.smooth.is_none()
    }
}

/// A smooth surface that reflects or refracts.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchObject {
    /// Name.
    pub name: String,
    /// The shape of the surface, in the frame at the light.
    pub patch: Patch,
    /// The interaction of the surface with light.
    pub event: Event,
}

/// The interaction of a smooth surface with light.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// Specular interaction, which sends each ray in one direction.
    Specular(Specular),
    /// Reflection by a sum of BRDFs on the side that the surface faces. The other side of the
    /// surface is black.
    Reflects(Reflectance),
}

impl Event {
    /// Checks whether the surface sends light in or near the mirror direction, unlike a
    /// Lambertian surface. For a sum of BRDFs, the first BRDF determines the result.
    #[must_use]
    pub fn mirrors(&self) -> bool {
        match self {
            Self::Specular(event) => *event == Specular::Mirror,
            Self::Reflects(reflectance) => reflectance.first().lobe.is_about_mirror(),
        }
    }
}

/// A Lambertian rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name.
    pub name: String,
    /// Frame of the rectangle, in the frame at the light. O is the centre of the rectangle, and X
    /// and Y run along its edges. D is the normal on the side at which light arrives.
    pub frame: Frame,
    /// Side lengths along X and Y of the frame.
    pub size: [f64; 2],
    /// The ratio of reflected to incident flux of the surface.
    pub albedo: f64,
}

impl Surface {
    /// The distance and the rectangle of a surface that lies across the first leg and has
    /// its edges along X and Y. Returns `None` for any other surface.
    #[must_use]
    #[expect(
        clippy::float_cmp,
        reason = "a rectangle without a `facing` field has exactly these numbers"
    )]
    pub fn across(&self) -> Option<(f64, Rectangle)> {
        let Frame { origin, x, d, .. } = &self.frame;
        (d.z == -1.0 && x.x == 1.0).then_some((
            origin.z,
            Rectangle {
                center: [origin.x, origin.y],
                size: self.size,
            },
        ))
    }

    /// The four corners of the surface, in the frame at the light.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 4] {
        let [x, y] = self.size.map(|side| 0.5 * side);
        [[x, y], [-x, y], [-x, -y], [x, -y]]
            .map(|[x, y]| self.frame.to_world(DVec3::new(x, y, 0.0)))
    }
}

impl Scene {
    /// This scene alone, with only the planes whose indices are given.
    #[must_use]
    pub fn seen_at(&self, planes: &[usize]) -> Self {
        let kept: Vec<VirtualPlane> = planes.iter().map(|i| self.planes[*i].clone()).collect();
        let other_lights = self.other_lights.iter().map(|other| {
            let planes = kept
                .iter()
                .filter_map(|plane| other.plane_named(&plane.name));
            other.seen_at(&planes.collect::<Vec<usize>>())
        });
        Self {
            other_lights: other_lights.collect(),
            planes: kept,
            against: None,
            ..self.clone()
        }
    }

    /// This scene with nets instead of lattices, for measurements on 4D grids. Lattices are
    /// chosen for the slices of planes: at other frequencies, they may have more noise than random
    /// numbers, up to 40 dB.
    #[must_use]
    pub fn on_grids(mut self) -> Self {
        if self.run.sampling == Sampling::Lattice {
            self.run.sampling = Sampling::Net;
        }
        let others = self.other_lights.into_iter().map(Self::on_grids);
        self.other_lights = others.collect();
        self
    }

    /// The index of the plane with a name.
    #[must_use]
    pub fn plane_named(&self, name: &str) -> Option<usize> {
        self.planes.iter().position(|plane| plane.name == name)
    }

    /// A scene for each light, the first of which is this scene.
    pub fn lights(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.other_lights)
    }

    /// The BLAKE3 hash of everything that defines the scene. The hash covers the scene
    /// file as JSON, with defaults and overrides, followed by the name and hash of each mesh and
    /// picture.
    #[must_use]
    pub fn hash(&self) -> String {
        scene_hash(&self.file, &self.inputs)
    }

    /// The hash of the scene from which the difference is measured.
    #[must_use]
    pub fn hash_of_other(&self) -> Option<String> {
        self.against.as_ref().map(|other| other.hash())
    }

    /// The name of a surface.
    #[must_use]
    pub fn name_of(&self, object: Object) -> &str {
        match object {
            Object::Surface(i) => &self.surfaces[i].name,
            Object::Mesh(i) => &self.meshes[i].name,
            Object::Patch(i) => &self.patches[i].name,
        }
    }
}

/// The settings of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSettings {
    /// Photons emitted.
    pub photons: u64,
    /// Seed of the photons.
    pub seed: u64,
    /// Independent batches.
    pub batches: u32,
    /// The probability that the verdict rejects a correct scene, for all planes together.
    pub alpha: f64,
    /// The largest noise, as a share of the spectrum. A plane with more noise cannot pass.
    pub resolution: f64,
    /// The distribution with which photons leave the light.
    pub emission: Emission,
    /// The random numbers or nets from which photons are drawn.
    pub sampling: Sampling,
}

/// Returns [`Scene::hash`] of a file and of the hashes of the files it names.
#[must_use]
pub fn scene_hash(file: &SceneFile, inputs: &BTreeMap<String, String>) -> String {
    let mut hasher = blake3::Hasher::new();
    // Serialisation cannot fail, because a scene file is plain data with finite numbers.
    hasher.update(&serde_json::to_vec(file).unwrap_or_default());
    for (name, hash) in inputs {
        // Names hold no NUL, so different lists of files give different bytes.
        hasher.update(format!("\0{name}\0{hash}").as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}
