//! Prints the warnings of a scene, each on its own line.

use crate::print;
use etendue_scene::Scene;

/// Prints the warnings of a scene to standard error, because standard output is for the result. If
/// `quiet` is set, prints nothing.
pub(crate) fn tell(scene: &Scene, quiet: bool) {
    let warnings = if quiet { Vec::new() } else { scene.warnings() };
    for warning in warnings {
        warn(&warning);
    }
}

/// Prints one warning.
pub(crate) fn warn(warning: &str) {
    print::tell(&format!("warning: {warning}"));
}
