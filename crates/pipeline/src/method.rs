//! The sources of photons for each method of measurement.

use etendue_field::{PhotonSource, VirtualPlane};
use etendue_scene::Scene;
use etendue_store::{Failure, Method};
use etendue_trace::{Backward, Tracer, finds};

/// Returns the source of photons that `method` sends through a scene.
pub fn source(scene: &Scene, method: Method) -> Result<Box<dyn PhotonSource>, Failure> {
    Ok(match method {
        Method::Photons => Box::new(Tracer::new(scene)),
        Method::Backward => Box::new(Backward::new(scene).map_err(Failure::bad_input)?),
        Method::Even => Box::new(Tracer::evenly(scene)),
    })
}

/// Fails, before anything is written, when a scene cannot be measured by `method`.
pub fn check(scene: &Scene, method: Method) -> Result<(), Failure> {
    match method {
        Method::Backward => Backward::new(scene).map(drop).map_err(Failure::bad_input),
        Method::Photons | Method::Even => Ok(()),
    }
}

/// Returns the method against which another method is judged at a plane. It is as independent as
/// the scene allows.
pub fn judge_of(method: Method, scene: &Scene, plane: &VirtualPlane) -> Method {
    match method {
        Method::Photons if finds(scene, plane) => Method::Backward,
        Method::Photons => Method::Even,
        Method::Backward | Method::Even => Method::Photons,
    }
}

/// Returns the text of the prediction step of a plane without theory: rays traced by this
/// method are the prediction.
pub fn step(method: Method) -> String {
    let shared = match method {
        Method::Photons | Method::Backward => "",
        // Backward rays would not find the light here.
        Method::Even => {
            "; after emission, these rays are traced in the same way as photons, so errors of this tracing are not detected"
        }
    };
    format!("instead of theory  {}{shared}", method.words())
}
