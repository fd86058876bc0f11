//! The warnings of a scene, each on a line of its own.

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
