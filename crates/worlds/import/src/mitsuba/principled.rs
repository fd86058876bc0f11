//! Mitsuba's `principled` material.

use super::object::MitsubaObject;
use super::reader::MitsubaReader;
use super::texture::as_number;
use crate::spectrum::Role;
use etendue_world::{Material, Principled, Texture};

impl<'a> MitsubaReader<'a> {
    pub(super) fn principled(&mut self, object: &'a MitsubaObject) -> Option<Material> {
        // A tint does not change luminance.
        let _ = self.property(object, "sheen_tint");
        let transmission = self.parameter(object, "spec_trans", 0.0)?;
        let index = self.principled_index(object);
        let index = index.map(|index| match transmission.largest() > 0.0 {
            // Mitsuba changes an index of 1, because an interface without a step does not refract.
            true if index <= 1.0 => self.least_index(object),
            _ => index,
        });
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
            transmission,
            roughness: roughness?,
            anisotropic: anisotropic?,
            tint: tint?,
            flatness: flatness?,
            sheen: sheen?,
            clearcoat: clearcoat?,
            gloss: gloss?,
            index: index?,
        };
        Some(Material::Principled(Box::new(of)))
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

    /// Returns the index that Mitsuba uses in place of 1 for a material that transmits light.
    fn least_index(&self, object: &'a MitsubaObject) -> f64 {
        match self.has(object, "eta") {
            true => 1.001,
            false => of_specular(1e-3),
        }
    }

    /// Returns the index of refraction. The file states either the index or `specular`; the
    /// reflectance at normal incidence is then 0.08 `specular`.
    fn principled_index(&mut self, object: &'a MitsubaObject) -> Option<f64> {
        if !self.has(object, "eta") {
            let is_share = |v| (0.0..=1.0).contains(&v);
            let specular = self.number_or(object, "specular", 0.5, "0 to 1", is_share)?;
            return Some(of_specular(specular));
        }
        if self.has(object, "specular") {
            let message = "specular is given together with eta; allowed: one of them";
            return self.fault(object, "specular", message);
        }
        self.number_within(object, "eta", "1 or more", |v| v >= 1.0)
    }
}

/// Returns the index whose reflectance at normal incidence is 0.08 `specular`.
fn of_specular(specular: f64) -> f64 {
    2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
}
