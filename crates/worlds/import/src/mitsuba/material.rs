//! Materials: `bsdf` elements.

use super::index::metal_index;
use super::object::ObjectRef;
use super::reader::MitsubaReader;
use super::texture::as_number;
use crate::range::{MAX_MATERIALS, MAX_SHARE};
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_world::{
    Conductor, Dielectric, Material, MicrofacetDistribution, Plastic, Principled, Roughness,
    Texture,
};
use std::sync::Arc;

/// Maximum nesting depth of materials.
const MAX_DEPTH: usize = 8;

/// Plugins supported as materials.
const ALLOWED: &str = "diffuse, conductor, roughconductor, dielectric, thindielectric, roughdielectric, plastic, roughplastic, pplastic, principled, phong, twosided, mask, blendbsdf, null";

impl<'a> MitsubaReader<'a> {
    /// The index of a material, or `None` if a cause of refusal was reported.
    pub(super) fn material(&mut self, object: ObjectRef<'a>) -> Option<usize> {
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
        let number = made.map(|material| self.world.add_material(material));
        self.materials.insert(at, number);
        number
    }

    /// The material of shapes that specify no material, which is black for emitters and
    /// otherwise diffuse.
    pub(super) fn default_material(&mut self, shines: bool) -> usize {
        if let Some(known) = self.defaults[usize::from(shines)] {
            return known;
        }
        let material = Material::diffuse(if shines { 0.0 } else { 0.5 });
        let number = self.world.add_material(material);
        self.defaults[usize::from(shines)] = Some(number);
        number
    }

    fn make_material(&mut self, object: ObjectRef<'a>, depth: usize) -> Option<Material> {
        object.is_used.set(true);
        self.made_materials += 1;
        if self.made_materials > MAX_MATERIALS {
            if self.made_materials == MAX_MATERIALS + 1 {
                let message = format!("more than {MAX_MATERIALS} bsdfs, counting repetitions");
                object.cause(message);
            }
            return None;
        }
        if depth > MAX_DEPTH {
            let message =
                format!("bsdfs are nested more than {MAX_DEPTH} deep, or a bsdf contains itself");
            return object.refuse(message);
        }
        match object.plugin.as_str() {
            "diffuse" => Some(Material::Diffuse {
                reflectance: self.reflectance(object, "reflectance", 0.5)?,
            }),
            "conductor" | "roughconductor" => self.conductor(object),
            "dielectric" | "thindielectric" | "roughdielectric" => self.dielectric(object),
            "plastic" | "roughplastic" => self.plastic(object),
            "pplastic" => {
                object.note("pplastic is approximated by roughplastic, within about 1 %");
                self.plastic(object)
            }
            "principled" => self.principled(object),
            "phong" => self.phong(object),
            "twosided" => self.two_sided(object, depth),
            "mask" => self.mask(object, depth),
            "blendbsdf" => self.blend(object, depth),
            "null" => Some(Material::Mask {
                opacity: Texture::Constant(0.0),
                of: Box::new(Material::diffuse(0.0)),
            }),
            _ => self.unsupported(object, ALLOWED),
        }
    }

    fn conductor(&mut self, object: ObjectRef<'a>) -> Option<Material> {
        let index = self.metal(object);
        let reflectance = self.reflectance(object, "specular_reflectance", 1.0);
        let roughness = self.roughness(object);
        Some(Material::Conductor(Conductor {
            index: index?,
            reflectance: reflectance?,
            roughness: roughness?,
        }))
    }

    /// The complex index of a conductor, n and k. The inner `None` means a perfect
    /// reflector. The outer `None` means that a cause of refusal was reported.
    fn metal(&mut self, object: ObjectRef<'a>) -> Option<Option<[f64; 2]>> {
        let name = match object.has("material") {
            true => object.text("material")?,
            false => "none",
        };
        let has_index = object.has("eta") || object.has("k");
        if name != "none" && has_index {
            let message = "material is given together with eta or k; allowed: one of them";
            return object.fault("material", message);
        }
        if name != "none" {
            let Some(index) = metal_index(name) else {
                let message = format!("no index of refraction is known for {}", quoted(name));
                return object.fault("material", message);
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
    fn one_number(&mut self, object: ObjectRef<'a>, name: &str, default: f64) -> Option<f64> {
        match self.texture_or(object, name, Role::Number, default)? {
            Texture::Constant(value) if value >= 0.0 => Some(value),
            _ => object.fault(name, format!("{name} is not a number of 0 or more")),
        }
    }

    fn dielectric(&mut self, object: ObjectRef<'a>) -> Option<Material> {
        let index = object.relative_index("bk7");
        let reflectance = self.reflectance(object, "specular_reflectance", 1.0);
        let transmittance = self.reflectance(object, "specular_transmittance", 1.0);
        let roughness = self.roughness(object);
        Some(Material::Dielectric(Dielectric {
            index: index?,
            reflectance: reflectance?,
            transmittance: transmittance?,
            roughness: roughness?,
            is_thin: object.plugin == "thindielectric",
        }))
    }

    fn plastic(&mut self, object: ObjectRef<'a>) -> Option<Material> {
        let index = object.relative_index("polypropylene");
        let diffuse = self.reflectance(object, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(object, "specular_reflectance", 1.0);
        let is_nonlinear = object.truth("nonlinear");
        let roughness = self.roughness(object);
        let is_constant = |of: &Roughness| matches!(of.alpha[0], Texture::Constant(_));
        if let Some(Some(of)) = &roughness
            && !is_constant(of)
        {
            let message = "alpha of roughplastic is a texture; allowed: a number";
            object.cause_at("alpha", message);
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
    fn phong(&mut self, object: ObjectRef<'a>) -> Option<Material> {
        let diffuse = self.reflectance(object, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(object, "specular_reflectance", 0.2);
        let exponent = self.texture_or(object, "exponent", Role::Reflectance, 30.0)?;
        let exponent = object.not_negative("exponent", exponent);
        let (diffuse, specular) = (diffuse?, specular?);
        let share = diffuse.largest() + specular.largest();
        if share > MAX_SHARE {
            let message = format!(
                "diffuse_reflectance and specular_reflectance add up to {share}; allowed: up to 1"
            );
            return object.refuse(message);
        }
        Some(Material::Phong {
            diffuse,
            specular,
            exponent: exponent?,
        })
    }

    /// The roughness. The inner `None` means a smooth surface. The outer `None` means that a cause
    /// of refusal was reported.
    fn roughness(&mut self, object: ObjectRef<'a>) -> Option<Option<Roughness>> {
        if !object.plugin.starts_with("rough") && object.plugin != "pplastic" {
            return Some(None);
        }
        let known = [
            ("beckmann", MicrofacetDistribution::Beckmann),
            ("ggx", MicrofacetDistribution::Ggx),
        ];
        let distribution = object.choice("distribution", &known);
        let both = ["alpha_u", "alpha_v"].map(|name| object.has(name));
        let alpha = match both {
            [false, false] => {
                let alpha = self.alpha(object, "alpha")?;
                [alpha.clone(), alpha]
            }
            [true, true] if !object.has("alpha") => {
                let [u, v] = ["alpha_u", "alpha_v"].map(|name| self.alpha(object, name));
                [u?, v?]
            }
            _ => return object.refuse("allowed: alpha alone, or alpha_u and alpha_v"),
        };
        let distribution = distribution?;
        Some(Some(Roughness {
            distribution,
            alpha,
        }))
    }

    fn alpha(&mut self, object: ObjectRef<'a>, name: &str) -> Option<Texture> {
        let texture = self.texture_or(object, name, Role::Number, 0.1)?;
        if texture.largest() > 0.0 {
            return Some(as_number(texture));
        }
        object.fault(name, format!("{name} is not above 0 anywhere"))
    }

    fn two_sided(&mut self, object: ObjectRef<'a>, depth: usize) -> Option<Material> {
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
            return object.refuse(message);
        }
        Some(Material::TwoSided(Box::new(both)))
    }

    fn mask(&mut self, object: ObjectRef<'a>, depth: usize) -> Option<Material> {
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

    fn blend(&mut self, object: ObjectRef<'a>, depth: usize) -> Option<Material> {
        if !object.has("weight") {
            object.cause("blendbsdf without weight");
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

    /// All nested bsdfs, or `None` if a cause of refusal was reported.
    fn nested(&mut self, object: ObjectRef<'a>, depth: usize) -> Option<Vec<Material>> {
        let within = self.children(object, "bsdf");
        // All bsdfs are read even after a failure, to find all causes of refusal.
        let all: Vec<Option<Material>> = within
            .into_iter()
            .take(3)
            .map(|(_, bsdf)| self.make_material(bsdf, depth + 1))
            .collect();
        all.into_iter().collect()
    }

    fn wrong_number(&self, object: ObjectRef<'a>, allowed: &str) -> Option<Material> {
        let plugin = &object.plugin;
        let message = format!("{plugin} has a wrong number of bsdfs; allowed: {allowed}");
        object.refuse(message)
    }

    fn principled(&mut self, object: ObjectRef<'a>) -> Option<Material> {
        // A tint does not change luminance.
        let _ = object.property("sheen_tint");
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
    fn parameter(&mut self, object: ObjectRef<'a>, name: &str, default: f64) -> Option<Texture> {
        self.share(object, name, Role::Number, default)
            .map(as_number)
    }

    /// The index that Mitsuba uses in place of 1 for a material that transmits light.
    fn least_index(&self, object: ObjectRef<'a>) -> f64 {
        match object.has("eta") {
            true => 1.001,
            false => of_specular(1e-3),
        }
    }

    /// The index of refraction. The file states either the index or `specular`; the
    /// reflectance at normal incidence is then 0.08 `specular`.
    fn principled_index(&mut self, object: ObjectRef<'a>) -> Option<f64> {
        if !object.has("eta") {
            let is_share = |v| (0.0..=1.0).contains(&v);
            let specular = object.number_or("specular", 0.5, "0 to 1", is_share)?;
            return Some(of_specular(specular));
        }
        if object.has("specular") {
            let message = "specular is given together with eta; allowed: one of them";
            return object.fault("specular", message);
        }
        object.number_within("eta", "1 or more", |v| v >= 1.0)
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

/// The index whose reflectance at normal incidence is 0.08 `specular`.
fn of_specular(specular: f64) -> f64 {
    2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
}
