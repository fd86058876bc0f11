use crate::emit::LAMBERTIAN;
use crate::obstacles::ray_through;
use crate::scatter::Scatterer;
use crate::tracer::{Arrival, cosines};
use etendue_field::{Frame, Specular, TwoPlane};
use etendue_scene::{Event, Object, Scene};

/// How light begins a leg, at the surface that ended the one before.
#[derive(Debug)]
pub(crate) enum Bounce {
    /// Diffusely; the albedo, and `None` when no plane looks at light that has come so far.
    Diffuse(f64, Option<Scatterer>),
    /// By reflection, refraction or a lens; the lens's frame, in the frame of the leg.
    Specular(Frame, Specular),
}

impl Bounce {
    /// `None` for the first leg.
    pub(crate) fn new(scene: &Scene, leg: usize) -> Option<Self> {
        let this = &scene.path.legs[leg];
        let diffuse = |albedo| Self::Diffuse(albedo, Scatterer::new(scene, leg));
        Some(match this.leaves?.object {
            Object::Surface(i) => diffuse(scene.surfaces[i].albedo),
            Object::Mesh(i) => match &scene.meshes[i].smooth {
                Some(smooth) => Self::Specular(Frame::IDENTITY, smooth.event),
                None => diffuse(scene.meshes[i].albedo?),
            },
            Object::Patch(i) => {
                let object = &scene.patches[i];
                match &object.event {
                    Event::Specular(event) => {
                        Self::Specular(this.frame.decompose(&object.patch.frame), *event)
                    }
                    Event::Reflects(_) => todo!(),
                }
            }
        })
    }

    /// The ray of a photon and what it adds to radiance space; `None` when it does not go on along the leg.
    #[inline]
    pub(crate) fn sample(&self, arrival: &Arrival, words: [u32; 4]) -> Option<(TwoPlane, f64)> {
        match self {
            Self::Diffuse(albedo, scatterer) => {
                if *albedo <= 0.0 {
                    return None;
                }
                let scatterer = scatterer.as_ref()?;
                let (ray, density) = scatterer.sample(arrival.point, arrival.normal, words)?;
                // Radiance albedo/π · E, and a photon's flux is E at its point.
                Some((ray, albedo * arrival.flux / (LAMBERTIAN * density)))
            }
            Self::Specular(lens, event) => {
                let Arrival { point, facing, .. } = *arrival;
                let onwards = event.turned(lens, facing, point, arrival.direction)?;
                let ray = ray_through(arrival.point, onwards)?;
                Some((ray, arrival.flux * cosines(&ray)))
            }
        }
    }
}
