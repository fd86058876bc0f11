//! Materials: `bsdf` elements.

use super::metals;
use super::object::MitsubaObject;
use super::reader::MitsubaReader;
use super::texture::as_number;
use crate::range::MAX_SHARE;
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_world::{
    Conductor, Dielectric, Material, MicrofacetDistribution, Plastic, Roughness, Texture,
};
use std::sync::Arc;

/// Maximum nesting depth of materials.
const MAX_DEPTH: usize = 8;

/// Maximum number of materials, including nested ones.
const MAX_MATERIALS: usize = 1 << 20;

/// Plugins supported as materials.
const ALLOWED: &str = "diffuse, conductor, roughconductor, dielectric, thindielectric, roughdielectric, plastic, roughplastic, principled, phong, twosided, mask, blendbsdf, null";

impl<'a> MitsubaReader<'a> {
    /// Returns the index of a material, or `None` if a cause of refusal was reported.
    pub(super) fn material(&mut self, object: &'a MitsubaObject) -> Option<usize> {
        let mesh = self.current_mesh.as_ref();
        let mesh = mesh.map_or(0, |mesh| Arc::as_ptr(&mesh.triangles).addr());
        let at = match self.wanted(object).is_empty() {
            true => (object.number, 0),
            false => (object.number, mesh),
        };
        if let Some(known) = self.materials.get(&at) {
            return *known;
        }
        let made = self.make_material(object, 0);
        let number = made.map(|material| self.add_material(material));
        self.materials.insert(at, number);
        number
    }

    /// Returns the material of shapes that specify no material, which is black for emitters and
    /// otherwise diffuse.
    pub(super) fn default_material(&mut self, shines: bool) -> usize {
        if let Some(known) = self.defaults[usize::from(shines)] {
            return known;
        }
        let reflectance = Texture::Constant(if shines { 0.0 } else { 0.5 });
        let number = self.add_material(Material::Diffuse { reflectance });
        self.defaults[usize::from(shines)] = Some(number);
        number
    }

    fn add_material(&mut self, material: Material) -> usize {
        self.world.materials.push(material);
        self.world.materials.len() - 1
    }

    pub(super) fn make_material(
        &mut self,
        object: &'a MitsubaObject,
        depth: usize,
    ) -> Option<Material> {
        object.is_used.set(true);
        self.made_materials += 1;
        if self.made_materials > MAX_MATERIALS {
            // The number of materials is limited because references may duplicate nested
            // materials.
            if self.made_materials == MAX_MATERIALS + 1 {
                let message = format!("more than {MAX_MATERIALS} bsdfs, counting repetitions");
                self.report.cause(&object.place, message);
            }
            return None;
        }
        if depth > MAX_DEPTH {
            let message =
                format!("bsdfs are nested more than {MAX_DEPTH} deep, or a bsdf contains itself");
            return self.report.refuse(&object.place, message);
        }
        match object.plugin.as_str() {
            "diffuse" => Some(Material::Diffuse {
                reflectance: self.reflectance(object, "reflectance", 0.5)?,
            }),
            "conductor" => self.conductor(object, false),
            "roughconductor" => self.conductor(object, true),
            "dielectric" => self.dielectric(object, false, false),
            "thindielectric" => self.dielectric(object, false, true),
            "roughdielectric" => self.dielectric(object, true, false),
            "plastic" => self.plastic(object, false),
            "roughplastic" => self.plastic(object, true),
            "principled" => self.principled(object),
            "phong" => self.phong(object),
            "twosided" => self.two_sided(object, depth),
            "mask" => self.mask(object, depth),
            "blendbsdf" => self.blend(object, depth),
            "null" => Some(Material::Mask {
                opacity: Texture::Constant(0.0),
                of: Box::new(Material::Diffuse {
                    reflectance: Texture::Constant(0.0),
                }),
            }),
            _ => self.unsupported(object, ALLOWED),
        }
    }

    fn conductor(&mut self, object: &'a MitsubaObject, is_rough: bool) -> Option<Material> {
        let index = self.metal(object);
        let reflectance = self.reflectance(object, "specular_reflectance", 1.0);
        let roughness = self.roughness_if(is_rough, object);
        Some(Material::Conductor(Conductor {
            index: index?,
            reflectance: reflectance?,
            roughness: roughness?,
        }))
    }

    /// Returns the complex index of a conductor, n and k. The inner `None` means a perfect
    /// reflector. The outer `None` means that a cause of refusal was reported.
    fn metal(&mut self, object: &'a MitsubaObject) -> Option<Option<[f64; 2]>> {
        let name = match self.has(object, "material") {
            true => self.text(object, "material")?,
            false => "none",
        };
        let has_index = self.has(object, "eta") || self.has(object, "k");
        if name != "none" && has_index {
            let message = "material is given together with eta or k; allowed: one of them";
            return self.fault(object, "material", message);
        }
        if name != "none" {
            let Some(index) = metals::index(name) else {
                let message = format!("no index of refraction is known for {}", quoted(name));
                return self.fault(object, "material", message);
            };
            return Some(Some(index.map(|rgb| self.color.of(rgb))));
        }
        if !has_index {
            return Some(None);
        }
        let n = self.one_number(object, "eta", 0.0);
        let k = self.one_number(object, "k", 1.0);
        Some(Some([n?, k?]))
    }

    /// Reads a number that may also be written as a spectrum.
    fn one_number(&mut self, object: &'a MitsubaObject, name: &str, default: f64) -> Option<f64> {
        match self.texture_or(object, name, Role::Number, default)? {
            Texture::Constant(value) if value >= 0.0 => Some(value),
            _ => {
                let message = format!("{name} is not a number of 0 or more");
                self.fault(object, name, message)
            }
        }
    }

    fn dielectric(
        &mut self,
        object: &'a MitsubaObject,
        is_rough: bool,
        is_thin: bool,
    ) -> Option<Material> {
        let index = self.relative_index(object, "bk7");
        let reflectance = self.reflectance(object, "specular_reflectance", 1.0);
        let transmittance = self.reflectance(object, "specular_transmittance", 1.0);
        let roughness = self.roughness_if(is_rough, object);
        Some(Material::Dielectric(Dielectric {
            index: index?,
            reflectance: reflectance?,
            transmittance: transmittance?,
            roughness: roughness?,
            is_thin,
        }))
    }

    fn plastic(&mut self, object: &'a MitsubaObject, is_rough: bool) -> Option<Material> {
        let index = self.relative_index(object, "polypropylene");
        let diffuse = self.reflectance(object, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(object, "specular_reflectance", 1.0);
        let is_nonlinear = self.truth(object, "nonlinear");
        let roughness = self.roughness_if(is_rough, object);
        let is_constant = |of: &Roughness| matches!(of.alpha[0], Texture::Constant(_));
        if let Some(Some(of)) = &roughness
            && !is_constant(of)
        {
            let message = "alpha of roughplastic is a texture; allowed: a number";
            self.report.cause(self.place_of(object, "alpha"), message);
        }
        Some(Material::Plastic(Plastic {
            index: index?,
            diffuse: diffuse?,
            specular: specular?,
            is_nonlinear,
            roughness: roughness?,
        }))
    }

    /// Reads `phong`, a plugin of Mitsuba 0.6 that Mitsuba 3 does not have.
    fn phong(&mut self, object: &'a MitsubaObject) -> Option<Material> {
        let diffuse = self.reflectance(object, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(object, "specular_reflectance", 0.2);
        let exponent = self.texture_or(object, "exponent", Role::Reflectance, 30.0)?;
        let exponent = self.not_negative(object, "exponent", exponent);
        let (diffuse, specular) = (diffuse?, specular?);
        let share = diffuse.largest() + specular.largest();
        if share > MAX_SHARE {
            let message = format!(
                "diffuse_reflectance and specular_reflectance add up to {share}; allowed: up to 1"
            );
            return self.report.refuse(&object.place, message);
        }
        Some(Material::Phong {
            diffuse,
            specular,
            exponent: exponent?,
        })
    }

    #[expect(
        clippy::option_option,
        reason = "the inner `None` means a smooth surface; the outer `None` means that a cause was reported"
    )]
    fn roughness_if(
        &mut self,
        is_rough: bool,
        object: &'a MitsubaObject,
    ) -> Option<Option<Roughness>> {
        match is_rough {
            true => self.roughness(object).map(Some),
            false => Some(None),
        }
    }

    fn roughness(&mut self, object: &'a MitsubaObject) -> Option<Roughness> {
        let distribution = self.choice(
            object,
            "distribution",
            &[
                ("beckmann", MicrofacetDistribution::Beckmann),
                ("ggx", MicrofacetDistribution::Ggx),
            ],
        );
        let both = ["alpha_u", "alpha_v"].map(|name| self.has(object, name));
        let alpha = match both {
            [false, false] => {
                let alpha = self.alpha(object, "alpha")?;
                [alpha.clone(), alpha]
            }
            [true, true] if !self.has(object, "alpha") => {
                let [u, v] = ["alpha_u", "alpha_v"].map(|name| self.alpha(object, name));
                [u?, v?]
            }
            _ => {
                let message = "allowed: alpha alone, or alpha_u and alpha_v";
                return self.report.refuse(&object.place, message);
            }
        };
        Some(Roughness {
            distribution: distribution?,
            alpha,
        })
    }

    fn alpha(&mut self, object: &'a MitsubaObject, name: &str) -> Option<Texture> {
        let texture = self.texture_or(object, name, Role::Number, 0.1)?;
        if texture.largest() > 0.0 {
            return Some(as_number(texture));
        }
        let message = format!("{name} is not above 0 anywhere");
        self.fault(object, name, message)
    }
}
