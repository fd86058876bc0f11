//! Materials: `bsdf` elements.

use super::metals;
use super::object::{Kind, Object};
use super::reader::Reader;
use crate::report::quoted;
use crate::spectrum::Role;
use etendue_world::{Conductor, Dielectric, Distribution, Material, Plastic, Roughness, Texture};

/// Materials within one another.
const DEEPEST: usize = 8;

/// Plugins that are materials of a world.
const ALLOWED: &str = "diffuse, conductor, roughconductor, dielectric, thindielectric, roughdielectric, plastic, roughplastic, phong, twosided, mask, blendbsdf, null, bumpmap, normalmap";

impl<'a> Reader<'a> {
    /// The number of a material; `None` after a cause.
    pub(super) fn material(&mut self, object: &'a Object) -> Option<usize> {
        let at = self.index(object)?;
        if let Some(known) = self.materials.get(&at) {
            return *known;
        }
        let made = self.make_material(object, 0);
        let number = made.map(|material| self.add_material(material));
        self.materials.insert(at, number);
        number
    }

    /// The material of shapes without one: diffuse, and black for those that shine.
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

    fn make_material(&mut self, object: &'a Object, depth: usize) -> Option<Material> {
        object.is_used.set(true);
        if depth > DEEPEST {
            let message = format!("more than {DEEPEST} bsdfs in one another, or one in itself");
            self.report.cause(&object.place, message);
            return None;
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
            "phong" => self.phong(object),
            "twosided" => self.two_sided(object, depth),
            "mask" => self.mask(object, depth),
            "blendbsdf" => self.blend(object, depth),
            "null" => Some(Material::Mask {
                opacity: Texture::Constant(0.0),
                of: Box::new(black()),
            }),
            "bumpmap" | "normalmap" => self.without_map(object, depth),
            _ => {
                self.unsupported(object, ALLOWED);
                None
            }
        }
    }

    fn conductor(&mut self, object: &'a Object, is_rough: bool) -> Option<Material> {
        let index = self.metal(object);
        let reflectance = self.reflectance(object, "specular_reflectance", 1.0);
        let roughness = self.roughness_if(is_rough, object);
        Some(Material::Conductor(Conductor {
            index: index?,
            reflectance: reflectance?,
            roughness: roughness?,
        }))
    }

    /// n and k, or `None` for what reflects all. The outer `None` is after a cause.
    fn metal(&mut self, object: &'a Object) -> Option<Option<[f64; 2]>> {
        let name = match self.has(object, "material") {
            true => self.text(object, "material")?,
            false => "none",
        };
        let has_index = self.has(object, "eta") || self.has(object, "k");
        if name != "none" && has_index {
            let message = "material beside eta or k; allowed: one of both";
            self.report
                .cause(self.place_of(object, "material"), message);
            return None;
        }
        if name != "none" {
            let Some(index) = metals::index(name) else {
                let message = format!("no index of refraction is known for {}", quoted(name));
                self.report
                    .cause(self.place_of(object, "material"), message);
                return None;
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

    /// A number that may be written as a spectrum.
    fn one_number(&mut self, object: &'a Object, name: &str, default: f64) -> Option<f64> {
        match self.texture_or(object, name, Role::Number, default)? {
            Texture::Constant(value) if value >= 0.0 => Some(value),
            _ => {
                let message = format!("{name} is no number from 0 on");
                self.report.cause(self.place_of(object, name), message);
                None
            }
        }
    }

    fn dielectric(
        &mut self,
        object: &'a Object,
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

    fn plastic(&mut self, object: &'a Object, is_rough: bool) -> Option<Material> {
        let index = self.relative_index(object, "polypropylene");
        let diffuse = self.reflectance(object, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(object, "specular_reflectance", 1.0);
        let is_nonlinear = self.truth(object, "nonlinear");
        let roughness = self.roughness_if(is_rough, object);
        Some(Material::Plastic(Plastic {
            index: index?,
            diffuse: diffuse?,
            specular: specular?,
            is_nonlinear,
            roughness: roughness?,
        }))
    }

    /// Of Mitsuba 0.6; Mitsuba 3 has none.
    fn phong(&mut self, object: &'a Object) -> Option<Material> {
        let diffuse = self.reflectance(object, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(object, "specular_reflectance", 0.2);
        let exponent = self.reflectance(object, "exponent", 30.0);
        Some(Material::Phong {
            diffuse: diffuse?,
            specular: specular?,
            exponent: exponent?,
        })
    }

    #[expect(
        clippy::option_option,
        reason = "none is smooth; the outer none is a cause"
    )]
    fn roughness_if(&mut self, is_rough: bool, object: &'a Object) -> Option<Option<Roughness>> {
        match is_rough {
            true => self.roughness(object).map(Some),
            false => Some(None),
        }
    }

    fn roughness(&mut self, object: &'a Object) -> Option<Roughness> {
        let distribution = self.choice(
            object,
            "distribution",
            &[
                ("beckmann", Distribution::Beckmann),
                ("ggx", Distribution::Ggx),
            ],
        );
        // How Mitsuba draws directions.
        self.skip(object, &["sample_visible"]);
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
                self.report.cause(&object.place, message);
                return None;
            }
        };
        Some(Roughness {
            distribution: distribution?,
            alpha,
        })
    }

    fn alpha(&mut self, object: &'a Object, name: &str) -> Option<Texture> {
        let texture = self.texture_or(object, name, Role::Number, 0.1)?;
        if texture.largest() > 0.0 {
            return Some(texture);
        }
        let message = format!("{name} is nowhere above 0");
        self.report.cause(self.place_of(object, name), message);
        None
    }

    fn two_sided(&mut self, object: &'a Object, depth: usize) -> Option<Material> {
        let sides = self.nested(object, depth);
        self.skip(object, &["allow_transmission"]);
        let both = match <[Material; 2]>::try_from(sides?) {
            Ok(both) => both,
            Err(mut rest) => match (rest.pop(), rest.pop()) {
                (Some(one), None) => [one.clone(), one],
                _ => return self.wrong_number(object, "one or two"),
            },
        };
        if both.iter().any(lets_through) {
            let message = "twosided around a bsdf that lets light through";
            self.report.cause(&object.place, message);
            return None;
        }
        Some(Material::TwoSided(Box::new(both)))
    }

    fn mask(&mut self, object: &'a Object, depth: usize) -> Option<Material> {
        let opacity = self.reflectance(object, "opacity", 0.5);
        let mut of = self.nested(object, depth)?;
        match (of.pop(), of.pop()) {
            (Some(of), None) => Some(Material::Mask {
                opacity: opacity?,
                of: Box::new(of),
            }),
            _ => self.wrong_number(object, "one"),
        }
    }

    fn blend(&mut self, object: &'a Object, depth: usize) -> Option<Material> {
        if !self.has(object, "weight") {
            self.report.cause(&object.place, "blendbsdf without weight");
        }
        let weight = self.reflectance(object, "weight", 0.5);
        match <[Material; 2]>::try_from(self.nested(object, depth)?) {
            Ok(of) => Some(Material::Blend {
                weight: weight?,
                of: Box::new(of),
            }),
            Err(_) => self.wrong_number(object, "two"),
        }
    }

    /// What is below a bump map or a normal map.
    fn without_map(&mut self, object: &'a Object, depth: usize) -> Option<Material> {
        let message = format!(
            "approximated: {} is left out, the surface is smooth",
            object.plugin
        );
        self.report.note(&object.place, message);
        for (_, texture) in self.children(object, Kind::Texture) {
            self.drop_all(texture);
        }
        let of_the_map = ["scale", "flip_invalid_normals", "use_shadowing_function"];
        self.skip(object, &of_the_map);
        let mut of = self.nested(object, depth)?;
        match (of.pop(), of.pop()) {
            (Some(of), None) => Some(of),
            _ => self.wrong_number(object, "one"),
        }
    }

    /// All bsdfs within; `None` after a cause.
    fn nested(&mut self, object: &'a Object, depth: usize) -> Option<Vec<Material>> {
        let within = self.children(object, Kind::Bsdf);
        // All are read, so that all causes are found.
        let all: Vec<Option<Material>> = within
            .into_iter()
            .take(3)
            .map(|(_, bsdf)| self.make_material(bsdf, depth + 1))
            .collect();
        all.into_iter().collect()
    }

    fn wrong_number(&self, object: &'a Object, allowed: &str) -> Option<Material> {
        let plugin = &object.plugin;
        let message = format!("{plugin} with another number of bsdfs; allowed: {allowed}");
        self.report.cause(&object.place, message);
        None
    }
}

fn black() -> Material {
    Material::Diffuse {
        reflectance: Texture::Constant(0.0),
    }
}

fn lets_through(material: &Material) -> bool {
    match material {
        Material::Dielectric(_) | Material::Mask { .. } => true,
        Material::Blend { of, .. } => of.iter().any(lets_through),
        _ => false,
    }
}
