//! Provides the source of photons for each method of measurement.

use crate::file_rays::FileRays;
use crate::twin_photons::TwinPhotons;
use etendue_field::{PhotonSource, VirtualPlane};
use etendue_scene::Scene;
use etendue_store::{Failure, Method};
use etendue_trace::{AllLights, Backward, Tracer, finds};

/// The source of photons that `method` sends through a scene.
pub fn source(scene: &Scene, method: Method) -> Result<Box<dyn PhotonSource>, Failure> {
    if let (Method::Difference, Some(other)) = (method, &scene.against) {
        return Ok(Box::new(TwinPhotons::new(scene, other)));
    }
    if !scene.other_lights.is_empty() {
        return Ok(match method {
            Method::Photons | Method::Difference => Box::new(AllLights::photons(scene)),
            Method::Backward => Box::new(AllLights::backward(scene).map_err(Failure::bad_input)?),
            Method::Even => Box::new(AllLights::with_uniform_emission(scene)),
            Method::Given => {
                let what = "given rays are the light of one file; allowed: no further lights";
                return Err(Failure::bad_input(what));
            }
        });
    }
    Ok(match method {
        Method::Photons | Method::Difference => Box::new(Tracer::new(scene)),
        Method::Backward => Box::new(Backward::new(scene).map_err(Failure::bad_input)?),
        Method::Even => Box::new(Tracer::with_uniform_emission(scene)),
        Method::Given => Box::new(FileRays::new(scene)?),
    })
}

/// Fails, before any file is written, if a scene cannot be measured by `method`.
pub fn check(scene: &Scene, method: Method) -> Result<(), Failure> {
    match method {
        Method::Backward | Method::Given => source(scene, method).map(drop),
        Method::Photons | Method::Even | Method::Difference => Ok(()),
    }
}

/// The method against which a measurement by `method` is tested at a plane. The returned
/// method is as independent of `method` as the scene allows. Nothing tests rays that were given.
pub fn judge_of(method: Method, scene: &Scene, plane: &VirtualPlane) -> Method {
    match method {
        Method::Photons | Method::Difference if finds_all(scene, plane) => Method::Backward,
        Method::Photons | Method::Difference => Method::Even,
        Method::Backward | Method::Even => Method::Photons,
        Method::Given => Method::Given,
    }
}

/// Checks whether rays traced back from a plane find each light that the plane may see.
fn finds_all(scene: &Scene, plane: &VirtualPlane) -> bool {
    scene.lights().all(|of| {
        let seen = of.plane_named(&plane.name);
        seen.is_none_or(|i| finds(of, &of.planes[i]))
    })
}

/// The text that describes the prediction of a plane without theory: rays traced by
/// `method` serve as the prediction.
pub fn step(method: Method) -> String {
    let shared = match method {
        Method::Photons | Method::Backward | Method::Difference | Method::Given => "",
        // At this plane, backward rays would not find the light.
        Method::Even => {
            "; after emission, the same code traces these rays and the photons, so the comparison does not detect errors in this code"
        }
    };
    format!("instead of theory  {}{shared}", method.words())
}
