//! The integrator of a scene, which limits the depth of paths.

use super::object::{MitsubaObject, ObjectKind};
use super::reader::MitsubaReader;
use crate::report::quoted;

/// Maximum nesting depth of integrators; the integrators `moment` and `aov` contain other
/// integrators.
const MAX_DEPTH: usize = 8;

impl<'a> MitsubaReader<'a> {
    /// Reads the depth from the integrator. The other settings of the integrator affect only how
    /// Mitsuba computes, not the result.
    pub(super) fn integrator(&mut self, scene: &'a MitsubaObject) {
        let Some(mut object) = self.child(scene, ObjectKind::Integrator) else {
            return;
        };
        for _ in 0..MAX_DEPTH {
            object.is_used.set(true);
            match object.plugin.as_str() {
                "moment" | "aov" => match self.child(object, ObjectKind::Integrator) {
                    Some(nested) => object = nested,
                    None => return self.note_depth(object),
                },
                "direct" => {
                    self.world.depth = Some(1);
                    return self.hide(object);
                }
                "path" | "volpath" | "volpathmis" | "ptracer" | "prb" | "prbvolpath" => {
                    self.world.depth = self.depth(object);
                    return self.hide(object);
                }
                _ => return self.note_depth(object),
            }
        }
    }

    /// Notes where light passes masks that the integrator of the scene takes for opaque.
    pub(super) fn note_masks(&self, scene: &'a MitsubaObject) {
        let is_mask =
            |of: &MitsubaObject| of.is_used.get() && matches!(of.plugin.as_str(), "mask" | "null");
        if let Some((_, object)) = self.children(scene, ObjectKind::Integrator).first()
            && !object.plugin.contains("volpath")
            && self.objects.iter().any(is_mask)
        {
            let message = "light passes `mask` and `null` as in volpath: also light of point lights, and without being counted by max_depth";
            self.report.note(&object.place, message);
        }
    }

    fn hide(&mut self, object: &'a MitsubaObject) {
        self.world.hides_sources = self.truth(object, "hide_emitters");
    }

    fn note_depth(&self, object: &'a MitsubaObject) {
        let message = format!(
            "integrator {} is left out: paths have no maximum length",
            quoted(&object.plugin)
        );
        self.report.note(&object.place, message);
    }

    /// Returns the depth. Mitsuba counts the edges of a path, so depth 1 shows only sources, and
    /// depth 2 adds direct light.
    fn depth(&self, object: &'a MitsubaObject) -> Option<u32> {
        match self.whole(object, "max_depth")? {
            -1 => None,
            // A picture with depth 0 is black, which the depth of a world cannot express.
            0 => {
                let message = "max_depth is 0, which shows nothing; allowed: -1, or 1 or more";
                self.fault(object, "max_depth", message)
            }
            depth => match depth.checked_sub(1).map(u32::try_from) {
                Some(Ok(less)) => Some(less),
                _ => {
                    let message = format!("max_depth is {depth}; allowed: -1, or 1 or more");
                    self.fault(object, "max_depth", message)
                }
            },
        }
    }
}
