//! Compares the work and the memory that a command needs with the available resources, before the
//! command begins.

use etendue_field::byte_size;
use etendue_predict::{Applicability, Memory, too_much_work};
use etendue_scene::Scene;
use etendue_store::{Failure, machine};

/// Fails if a run of the scene on `threads` threads would take too long, or would not fit into the
/// memory of this machine. `theories` has the theory that applies to each plane of the scene.
pub fn check(scene: &Scene, theories: &[Applicability], threads: usize) -> Result<(), Failure> {
    check_work(scene, theories)?;
    check_memory(scene, theories, threads)
}

/// Fails if a prediction of the scene would take too long.
pub fn check_work(scene: &Scene, theories: &[Applicability]) -> Result<(), Failure> {
    check_rays(scene, theories)?;
    match too_much_work(scene, theories) {
        Some(too_much) => Err(Failure::cannot_run(format!("{}: {too_much}", scene.name))),
        None => Ok(()),
    }
}

/// Fails if a scene has several lights, which `what` does not support.
pub fn check_one_light(scene: &Scene, what: &str) -> Result<(), Failure> {
    match scene.lights().count() {
        1 => Ok(()),
        lights => Err(Failure::bad_input(format!(
            "{}: the scene has {lights} lights, but {what} supports only one; remove other_lights",
            scene.name
        ))),
    }
}

/// Fails if a plane cannot be compared with anything. This happens if the light is a ray file and
/// no theory applies to the plane, because backward rays do not find the rays of a file.
fn check_rays(scene: &Scene, theories: &[Applicability]) -> Result<(), Failure> {
    let mut lights = scene.lights();
    if !lights.any(|of| of.light.listed().is_some()) {
        return Ok(());
    }
    let mut planes = scene.planes.iter().zip(theories);
    match planes.find(|(_, theory)| !theory.reasons.is_empty()) {
        Some((plane, theory)) => Err(Failure::bad_input(format!(
            "{}: plane {}: the light is a ray file, and there is no prediction at this plane ({}); allowed: planes before the first surface that are orthogonal to the central ray. All blockers before such a plane must also be flat and orthogonal to the ray. `etendue measure` accepts any plane",
            scene.name,
            plane.name,
            theory.reasons.join(", ")
        ))),
        None => Ok(()),
    }
}

/// A number of threads in words.
#[must_use]
pub fn counted(threads: usize) -> String {
    format!("{threads} thread{}", if threads == 1 { "" } else { "s" })
}

/// Fails if a run of the scene on `threads` threads would not fit into the memory of this machine.
pub fn check_memory(
    scene: &Scene,
    theories: &[Applicability],
    threads: usize,
) -> Result<(), Failure> {
    let needed = Memory::new(scene, theories, threads);
    let available = machine::available_memory();
    if needed.total() <= available as f64 {
        return Ok(());
    }
    let threads = counted(threads);
    let Memory {
        batches,
        threads: grids,
        predictions,
        comparison,
        meshes,
        pictures,
    } = needed;
    Err(Failure::cannot_run(format!(
        "{}: a run on {threads} needs {} of memory: {} for {} batches, {} for the grids of threads, {} for predictions, {} to compare, {} for meshes, {} for pictures; {} are available",
        scene.name,
        byte_size(needed.total()),
        byte_size(batches),
        scene.run.batches,
        byte_size(grids),
        byte_size(predictions),
        byte_size(comparison),
        byte_size(meshes),
        byte_size(pictures),
        byte_size(available as f64)
    )))
}
