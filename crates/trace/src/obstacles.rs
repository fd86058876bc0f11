use crate::bvh::{Form, Target, Targets};
use etendue_field::{Grating, HalfPlane, Light, Mask, Side, TwoPlane};
use etendue_scene::Scene;

/// What a photon meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meeting {
    Blocker,
    Surface {
        albedo: f64,
        /// Whether the central ray visits it.
        visited: bool,
    },
}

/// Everything that stands in the way of light, and the questions both tracers ask of it.
///
/// Rays are given by where they leave the light's plane.
#[derive(Debug)]
pub(crate) struct Obstacles {
    targets: Targets<Meeting>,
    /// What has no end, with its distance.
    half_planes: Vec<(f64, HalfPlane)>,
    gratings: Vec<(f64, Grating)>,
}

impl Obstacles {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut targets = Vec::new();
        let (mut half_planes, mut gratings) = (Vec::new(), Vec::new());
        for layer in &scene.blockers {
            let distance = layer.distance;
            match &layer.mask {
                Mask::Opaque {
                    shapes,
                    half_planes: halves,
                } => {
                    targets.extend(shapes.iter().map(|&shape| Target {
                        form: Form::Flat { distance, shape },
                        tag: Meeting::Blocker,
                    }));
                    half_planes.extend(halves.iter().map(|half| (distance, *half)));
                }
                Mask::Grating(grating) => gratings.push((distance, *grating)),
            }
        }
        targets.extend(scene.surfaces.iter().map(|surface| Target {
            form: Form::Flat {
                distance: surface.distance,
                shape: surface.shape(),
            },
            tag: Meeting::Surface {
                albedo: surface.albedo,
                visited: scene.file.path.visits.contains(&surface.name),
            },
        }));
        for mesh in &scene.meshes {
            let tag = mesh
                .albedo
                .map_or(Meeting::Blocker, |albedo| Meeting::Surface {
                    albedo,
                    visited: false,
                });
            targets.extend(mesh.triangles.iter().map(|corners| Target {
                form: Form::Triangle(*corners),
                tag,
            }));
        }
        let origins = match scene.light {
            Light::Area { shape, .. } => shape.bounds().reach(),
            Light::Point { .. } => 0.0,
        };
        Self {
            targets: Targets::new(&targets, origins),
            half_planes,
            gratings,
        }
    }

    /// What a ray meets first, and at what distance.
    #[inline]
    pub(crate) fn first(&self, ray: &TwoPlane) -> Option<(f64, Meeting)> {
        let mut first = self.targets.first(ray);
        for (distance, half_plane) in &self.half_planes {
            let at = ray.travelled(*distance);
            if half_plane.contains(at.x, at.y) && first.is_none_or(|(d, _)| *distance < d) {
                first = Some((*distance, Meeting::Blocker));
            }
        }
        first
    }

    /// The share of light on a ray that gratings let through on its way to a plane.
    #[inline]
    pub(crate) fn transmittance(&self, ray: &TwoPlane, distance: f64, side: Side) -> f64 {
        let passed = self
            .gratings
            .iter()
            .filter(|(d, _)| is_passed(*d, distance, side));
        passed
            .map(|(d, grating)| {
                let at = ray.travelled(*d);
                grating.transmittance(at.x, at.y)
            })
            .product()
    }

    /// The share of light on a ray that reaches a plane, looked for from the plane back.
    pub(crate) fn visibility(&self, ray: &TwoPlane, distance: f64, side: Side) -> f64 {
        let halves = || {
            let mut passed = self
                .half_planes
                .iter()
                .filter(|(d, _)| is_passed(*d, distance, side));
            passed.any(|(d, half_plane)| {
                let at = ray.travelled(*d);
                half_plane.contains(at.x, at.y)
            })
        };
        if self.targets.blocks(ray, distance, side == Side::After) || halves() {
            return 0.0;
        }
        self.transmittance(ray, distance, side)
    }
}

/// Whether light passes what stands at `obstacle` on its way to a plane at `distance`.
fn is_passed(obstacle: f64, distance: f64, side: Side) -> bool {
    match side {
        Side::Before => obstacle < distance,
        Side::After => obstacle <= distance,
    }
}
