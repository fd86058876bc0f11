//! Materials that contain other materials.

use super::object::{MitsubaObject, ObjectKind};
use super::reader::MitsubaReader;
use super::texture::as_number;
use crate::spectrum::Role;
use etendue_world::Material;

impl<'a> MitsubaReader<'a> {
    pub(super) fn two_sided(
        &mut self,
        object: &'a MitsubaObject,
        depth: usize,
    ) -> Option<Material> {
        let sides = self.nested(object, depth);
        let both = match <[Material; 2]>::try_from(sides?) {
            Ok(both) => both,
            Err(mut rest) => match (rest.pop(), rest.pop()) {
                (Some(one), None) => [one.clone(), one],
                _ => return self.wrong_number(object, "one or two"),
            },
        };
        if both.iter().any(lets_through) {
            let message = "twosided contains a bsdf that transmits light; allowed: opaque bsdfs";
            return self.report.refuse(&object.place, message);
        }
        Some(Material::TwoSided(Box::new(both)))
    }

    pub(super) fn mask(&mut self, object: &'a MitsubaObject, depth: usize) -> Option<Material> {
        let opacity = self.share(object, "opacity", Role::Number, 0.5);
        let mut of = self.nested(object, depth)?;
        match (of.pop(), of.pop()) {
            (Some(of), None) => Some(Material::Mask {
                opacity: as_number(opacity?),
                of: Box::new(of),
            }),
            _ => self.wrong_number(object, "one"),
        }
    }

    pub(super) fn blend(&mut self, object: &'a MitsubaObject, depth: usize) -> Option<Material> {
        if !self.has(object, "weight") {
            self.report.cause(&object.place, "blendbsdf without weight");
        }
        let weight = self.share(object, "weight", Role::Number, 0.5);
        match <[Material; 2]>::try_from(self.nested(object, depth)?) {
            Ok(of) => Some(Material::Blend {
                weight: as_number(weight?),
                of: Box::new(of),
            }),
            Err(_) => self.wrong_number(object, "two"),
        }
    }

    /// Returns all nested bsdfs, or `None` if a cause of refusal was reported.
    fn nested(&mut self, object: &'a MitsubaObject, depth: usize) -> Option<Vec<Material>> {
        let within = self.children(object, ObjectKind::Bsdf);
        // All bsdfs are read even after a failure, to find all causes of refusal.
        let all: Vec<Option<Material>> = within
            .into_iter()
            .take(3)
            .map(|(_, bsdf)| self.make_material(bsdf, depth + 1))
            .collect();
        all.into_iter().collect()
    }

    fn wrong_number(&self, object: &'a MitsubaObject, allowed: &str) -> Option<Material> {
        let plugin = &object.plugin;
        let message = format!("{plugin} has a wrong number of bsdfs; allowed: {allowed}");
        self.report.refuse(&object.place, message)
    }
}

fn lets_through(material: &Material) -> bool {
    match material {
        Material::Dielectric(_) | Material::Mask { .. } => true,
        Material::Principled(of) => of.transmission.largest() > 0.0,
        Material::Blend { of, .. } => of.iter().any(lets_through),
        _ => false,
    }
}
