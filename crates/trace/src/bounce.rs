//! How light leaves the surface at the beginning of a leg.

use crate::arrival::Arrival;
use crate::sampling::LAMBERTIAN;
use crate::scatter::{Scatterer, Spread};
use etendue_field::{Frame, Mixture, Patch, Reflectance, Specular};
use etendue_scene::{Event, Object, Scene};
use glam::DVec3;

/// How the surface between the previous leg and this leg scatters light.
#[derive(Debug)]
pub(crate) enum Bounce {
    /// Diffuse reflection, with the albedo and a scatterer. The scatterer is `None` if no virtual
    /// plane sees light of this leg.
    Diffuse(f64, Option<Scatterer>),
    /// Reflection by a BRDF that may vary over a patch, in the frame of the leg.
    Reflects {
        patch: Patch,
        reflectance: Box<Reflectance>,
        scatterer: Option<Scatterer>,
    },
    /// Reflection, refraction or a lens, with the lens's frame in the frame of the leg.
    Specular(Frame, Specular),
}

impl Bounce {
    /// Returns `None` for the first leg, because no surface lies before it.
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
                    Event::Reflects(reflectance) => Self::Reflects {
                        patch: object.patch.seen_from(&this.frame),
                        reflectance: Box::new(reflectance.clone()),
                        scatterer: Scatterer::new(scene, leg),
                    },
                }
            }
        })
    }

    /// The direction in which a photon continues and its contribution to radiance space;
    /// `None` if the photon stops.
    #[inline]
    pub(crate) fn sample(&self, arrival: &Arrival, words: [u32; 4]) -> Option<(DVec3, f64)> {
        match self {
            Self::Diffuse(albedo, scatterer) => {
                if *albedo <= 0.0 {
                    return None;
                }
                let scatterer = scatterer.as_ref()?;
                let (point, normal) = (arrival.point, arrival.normal);
                let (towards, density) = scatterer.sample(point, normal, &Spread::Cosine, words)?;
                // The reflected radiance is albedo/π · E, and the flux of a photon represents the
                // irradiance E at the photon's point of arrival.
                Some((towards, albedo * arrival.flux / (LAMBERTIAN * density)))
            }
            Self::Reflects {
                patch,
                reflectance,
                scatterer,
            } => {
                let Arrival {
                    point,
                    facing,
                    direction,
                    flux,
                    ..
                } = *arrival;
                let brdf = at(patch, reflectance, point);
                if brdf.albedo() <= 0.0 || !arrival.is_on_front() {
                    return None;
                }
                let frame = Frame::IDENTITY.turned_to(facing);
                let wi = frame.vector_to_local(-direction).normalize();
                let spread = Spread::Lobe { brdf, frame, wi };
                let (towards, density) =
                    scatterer.as_ref()?.sample(point, facing, &spread, words)?;
                // The reflected radiance is f · E, where f is the BRDF and E the irradiance that
                // the photon's flux represents.
                let value = spread.value(towards);
                (value > 0.0).then(|| (towards, value * flux / density))
            }
            Self::Specular(lens, event) => {
                let Arrival { point, facing, .. } = *arrival;
                let onwards = event.turned(lens, facing, point, arrival.direction)?;
                // The flux of the photon is cos⁴θ times its contribution to radiance space.
                let secant = onwards.length() / onwards.z.abs();
                Some((onwards, arrival.flux * secant.powi(4)))
            }
        }
    }
}

/// The BRDFs at a point of a patch, with their weights.
#[inline]
pub(crate) fn at<'a>(patch: &Patch, reflectance: &'a Reflectance, point: DVec3) -> Mixture<'a> {
    let at = patch.frame.to_local(point);
    reflectance.at(at.x, at.y)
}
