//! A leg of the path for backward rays.

use crate::area_sampler::AreaSampler;
use crate::courses::{Both, rounding};
use crate::heading::Heading;
use crate::obstacles::{Around, Obstacles};
use crate::primitive::Primitive;
use crate::primitive_set::{PrimitiveSet, TaggedPrimitive};
use etendue_field::{Frame, Patch, Reflectance, Specular, TwoPlane};
use etendue_scene::{Event, Object, PatchObject, Scene};

/// A leg of the path, traced from its end.
#[derive(Debug)]
pub(super) struct BackwardLeg {
    pub(super) courses: Both<BackwardCourse>,
    /// The object on which the leg ends.
    pub(super) ends: Option<Object>,
}

/// The objects that light can meet if it travels along a leg in one of the leg's two directions.
#[derive(Debug)]
pub(super) struct BackwardCourse {
    /// The frame of the heading (the direction of light along the leg), in the frame at the
    /// light.
    pub(super) frame: Frame,
    pub(super) obstacles: Obstacles,
    /// The surface at the beginning of the leg; `None` for the first leg.
    pub(super) leaves: Option<LeftSurface>,
}

/// A ray of a leg, along which light may arrive. The ray is given in the frame of its heading.
#[derive(Clone, Copy, Debug)]
pub(super) struct IncomingRay {
    pub(super) leg: usize,
    pub(super) heading: Heading,
    pub(super) ray: TwoPlane,
}

/// The surface that light leaves at the beginning of a leg.
#[derive(Debug)]
pub(super) struct LeftSurface {
    pub(super) object: Object,
    /// The geometric primitives of the surface, in the frame of the light's heading along the
    /// leg.
    pub(super) primitives: PrimitiveSet<()>,
    pub(super) how: Scattering,
    pub(super) rounding: f64,
}

/// How light leaves a surface.
#[derive(Debug)]
pub(super) enum Scattering {
    /// Diffuse reflection, from flat pieces on which points can be sampled.
    Diffuse { albedo: f64, pieces: AreaSampler },
    /// Reflection by a BRDF that may vary over a patch, in the frame of the light's heading along
    /// the leg.
    Reflects {
        patch: Patch,
        reflectance: Box<Reflectance>,
    },
    /// Reflection, refraction or a lens. The frame of the lens is given in the frame of the light's
    /// heading along the leg.
    Turned { lens: Frame, event: Specular },
}

impl IncomingRay {
    /// A ray of the first leg, given by its coordinates in the plane of the light.
    pub(super) fn from_light(ray: TwoPlane) -> Self {
        Self {
            leg: 0,
            heading: Heading::Along,
            ray,
        }
    }
}

impl BackwardLeg {
    pub(super) fn new(scene: &Scene, leg: usize) -> Self {
        Self {
            courses: Both::new(scene, leg, |_, this| BackwardCourse {
                frame: this.frame,
                obstacles: Obstacles::new(scene, this),
                leaves: this
                    .leaves
                    .map(|hit| LeftSurface::new(scene, this, hit.object)),
            }),
            ends: scene.path.ends_at(leg).map(|hit| hit.object),
        }
    }
}

impl LeftSurface {
    pub(super) fn new(scene: &Scene, leg: &etendue_scene::Leg, object: Object) -> Self {
        let around = Around(leg.frame);
        let tagged = |primitive| TaggedPrimitive { primitive, tag: () };
        let diffuse = |albedo, pieces| Scattering::Diffuse { albedo, pieces };
        let (primitives, how) = match object {
            Object::Surface(i) => {
                let surface = &scene.surfaces[i];
                let [a, b, _, d] = surface.corners();
                (
                    vec![tagged(around.surface(surface))],
                    diffuse(surface.albedo, AreaSampler::One([a, b, d])),
                )
            }
            Object::Mesh(i) => {
                let mesh = &scene.meshes[i];
                let how = if let Some(smooth) = &mesh.smooth {
                    let (lens, event) = (Frame::IDENTITY, smooth.event);
                    Scattering::Turned { lens, event }
                } else {
                    let pieces = AreaSampler::triangles(&mesh.triangles);
                    diffuse(mesh.albedo.unwrap_or(0.0), pieces)
                };
                (vec![tagged(around.mesh(mesh))], how)
            }
            Object::Patch(i) => {
                let PatchObject { patch, event, .. } = &scene.patches[i];
                let patch = patch.seen_from(&leg.frame);
                let how = match event {
                    Event::Specular(event) => Scattering::Turned {
                        lens: patch.frame,
                        event: *event,
                    },
                    Event::Reflects(reflectance) => Scattering::Reflects {
                        patch,
                        reflectance: Box::new(reflectance.clone()),
                    },
                };
                (vec![tagged(Primitive::Smooth(Box::new(patch)))], how)
            }
        };
        Self {
            object,
            primitives: PrimitiveSet::new(&primitives, 0.0),
            how,
            rounding: rounding(leg),
        }
    }
}
