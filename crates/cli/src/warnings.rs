//! The warnings of a scene, each on a line of its own.

use crate::say;
use etendue_scene::Scene;
use std::io::Write;

/// To standard output, after the description of a scene.
pub(crate) fn describe(scene: &Scene) {
    for warning in scene.warnings() {
        say(&format!("\nwarning: {warning}"));
    }
}

/// To standard error, unless the user asked for quiet: standard output is that of the result.
pub(crate) fn tell(scene: &Scene, quiet: bool) {
    let warnings = if quiet { Vec::new() } else { scene.warnings() };
    for warning in warnings {
        // A reader that has gone changes nothing.
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
}
