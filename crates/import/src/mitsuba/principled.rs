//! Mitsuba's `principled` material without transmission.

use super::object::MitsubaObject;
use super::reader::MitsubaReader;
use super::texture::as_number;
use crate::spectrum::Role;
use etendue_world::{Material, Principled, Texture};

impl<'a> MitsubaReader<'a> {
    pub(super) fn principled(&mut self, object: &'a MitsubaObject) -> Option<Material> {
        // A tint does not change luminance.
        let _ = self.property(object, "sheen_tint");
        let is_opaque = self.is_opaque(object);
        let index = self.principled_index(object);
        let color = self.reflectance(object, "base_color", 0.5);
        let metallic = self.parameter(object, "metallic", 0.0);
        let roughness = self.parameter(object, "roughness", 0.5);
        let mut zero = |name| self.parameter(object, name, 0.0);
        let [anisotropic, tint, flatness, sheen, clearcoat, gloss] = [
            "anisotropic",
            "spec_tint",
            "flatness",
            "sheen",
            "clearcoat",
            "clearcoat_gloss",
        ]
        .map(&mut zero);
        let of = Principled {
            color: color?,
            metallic: metallic?,
            roughness: roughness?,
            anisotropic: anisotropic?,
            tint: tint?,
            flatness: flatness?,
            sheen: sheen?,
            clearcoat: clearcoat?,
            gloss: gloss?,
            index: index?,
        };
        is_opaque?.then(|| Material::Principled(Box::new(of)))
    }

    /// Reads a parameter from 0 to 1.
    fn parameter(
        &mut self,
        object: &'a MitsubaObject,
        name: &str,
        default: f64,
    ) -> Option<Texture> {
        self.share(object, name, Role::Number, default)
            .map(as_number)
    }

    /// Checks that the material transmits no light; otherwise, this is a cause of refusal.
    fn is_opaque(&mut self, object: &'a MitsubaObject) -> Option<bool> {
        let largest = self.parameter(object, "spec_trans", 0.0)?.largest();
        if largest > 0.0 {
            let message = format!("spec_trans of principled is {largest}; allowed: 0");
            let place = self.place_of(object, "spec_trans");
            self.report.cause(place, message);
        }
        Some(largest <= 0.0)
    }

    /// Returns the index of refraction. The file states either the index or `specular`; the
    /// reflectance at normal incidence is then 0.08 `specular`.
    fn principled_index(&mut self, object: &'a MitsubaObject) -> Option<f64> {
        let has_specular = self.has(object, "specular");
        if !self.has(object, "eta") {
            let specular = match has_specular {
                true => {
                    self.number_within(object, "specular", "0 to 1", |v| (0.0..=1.0).contains(&v))?
                }
                false => 0.5,
            };
            return Some(2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0);
        }
        if has_specular {
            let message = "specular is given together with eta; allowed: one of them";
            self.report
                .cause(self.place_of(object, "specular"), message);
            return None;
        }
        self.number_within(object, "eta", "1 or more", |v| v >= 1.0)
    }
}
