//! What emits the photons of a measurement.

use etendue_field::{PhotonSource, VirtualPlane};
use etendue_scene::Scene;
use etendue_store::{Failure, Method};
use etendue_trace::{Backward, Tracer, finds};

/// The photons that `method` sends through a scene.
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

/// The method that judges another one at a plane, as independent of it as the scene allows.
pub fn judge_of(method: Method, scene: &Scene, plane: &VirtualPlane) -> Method {
    match method {
        Method::Photons if finds(scene, plane) => Method::Backward,
        Method::Photons => Method::Even,
        Method::Backward | Method::Even => Method::Photons,
    }
}

/// The step of a prediction that measurements by a method take the place of.
pub fn step(method: Method) -> String {
    let shared = match method {
        Method::Photons | Method::Backward => "",
        // No ray finds the light otherwise.
        Method::Even => ", which go on as photons do: what is wrong on their way is not seen",
    };
    format!("instead of theory  {}{shared}", method.words())
}
