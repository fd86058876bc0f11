//! Measures the memory of a mesh of a million triangles, for which all legs share one hierarchy.
//!
//! The test runs in its own process, because it measures the memory of the whole process.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::{SceneFile, resolve};
use etendue_trace::{Backward, Tracer};

const SCENE: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
    blockers: [Mesh(
        name: "star", center: (0.05, 0, 1),
        mesh: Star(radius: 0.25, relief: 0.3, lobes: 5, rings: 480),
    )],
    surfaces: [
        Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6), facing: (0.3, 0, -1)),
        Rectangle(name: "wall", center: (2, 0, 0), size: (6, 6), facing: (-1, 0, 0)),
    ],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor", "wall"]),
    planes: [(name: "first", at: Before("star")), (name: "last", at: After("wall"))],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (rho: (max: 4), nu: (max: 4)),
)"#;

/// A number of bytes that the kernel reports for this process.
fn bytes(what: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with(what)).unwrap();
    let kilobytes = line.split_whitespace().nth(1).unwrap();
    1024.0 * kilobytes.parse::<f64>().unwrap()
}

#[test]
fn all_legs_and_tracers_share_what_a_mesh_takes() {
    let before = bytes("VmRSS");
    let file = SceneFile::parse(SCENE).unwrap();
    let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
    let triangles = scene.meshes[0].triangles.len() as f64;
    assert!(triangles > 900_000.0);
    let each = |bytes: f64| bytes / triangles;
    let peak = each(bytes("VmHWM") - before);
    assert!(peak <= 150.0, "{peak} bytes a triangle while they are made");
    let held = bytes("VmRSS");
    let tracers = [Tracer::new(&scene), Tracer::with_uniform_emission(&scene)];
    let backward = Backward::new(&scene).unwrap();
    let more = each(bytes("VmRSS") - held);
    // The index of a triangle takes 4 bytes.
    assert!(more < 4.0, "{more} more bytes a triangle for three tracers");
    drop((tracers, backward));
}
