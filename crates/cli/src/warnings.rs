//! The warnings of a scene, each on a line of its own.

use crate::values::{Point, shown};
use etendue_scene::Scene;
use std::io::Write;

/// To standard error, unless the user asked for quiet: standard output is that of the result.
pub(crate) fn tell(scene: &Scene, quiet: bool) {
    let warnings = if quiet { Vec::new() } else { scene.warnings() };
    for warning in warnings {
        warn(&warning);
    }
}

/// One of them.
pub(crate) fn warn(warning: &str) {
    // A reader that has gone changes nothing.
    let _ = writeln!(std::io::stderr(), "warning: {warning}");
}

/// Those of the scenes at the points of a sweep, each once, with the first point it is about.
pub(crate) fn tell_at(points: &[Point], scenes: &[Scene]) {
    let mut told: Vec<String> = Vec::new();
    for (point, scene) in points.iter().zip(scenes) {
        for warning in scene.warnings() {
            // The same words with other numbers are told once.
            let words: String = warning
                .chars()
                .filter(|c| !c.is_ascii_digit() && *c != '.')
                .collect();
            if !told.contains(&words) {
                warn(&format!("at {}: {warning}", shown(point)));
                told.push(words);
            }
        }
    }
}
