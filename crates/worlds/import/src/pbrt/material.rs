//! Materials. Opaque materials are the same on both sides.

use super::entity::{CauseGiven, Entity, Read};
use super::reader::{Ask, PbrtReader, Uv};
use super::scene::MaterialOf;
use super::spectrum::named_index;
use crate::range::{MAX_MATERIALS, MAX_SHARE};
use crate::report::{SourcePlace, quoted};
use crate::spectrum::Role;
use etendue_world::{
    Conductor, Dielectric, Material, MicrofacetDistribution, Plastic, Roughness, Texture,
};

/// Maximum nesting depth of materials.
const MAX_DEPTH: usize = 8;

/// The roughness below which pbrt treats a surface as smooth.
const SMOOTH: f64 = 1e-3;

/// Plugins supported as materials.
const ALLOWED: &str = "diffuse, diffusetransmission, coateddiffuse, conductor, dielectric, thindielectric, mix, interface";

/// The index of pbrt's default material.
const DEFAULT: usize = usize::MAX;

const ALBEDO: Ask = Ask::Spectrum(Role::Reflectance);

impl PbrtReader<'_> {
    /// The index of a material, or `None` if there is no surface at all.
    pub(super) fn material(&mut self, of: &MaterialOf, uv: Uv) -> Read<Option<usize>> {
        let number = match of {
            MaterialOf::Default => DEFAULT,
            MaterialOf::Number(number) => *number,
            MaterialOf::Named(name, place) => match self.scene.named.get(&**name) {
                Some(number) => *number,
                None => {
                    let message = format!("material {} is not known", quoted(name));
                    self.cause_once(place, &message);
                    return Err(CauseGiven);
                }
            },
        };
        // A material that is invalid on one surface is invalid on all surfaces.
        let all = [Uv::Own, Uv::Ball, Uv::Disc].map(|uv| self.materials.get(&(number, uv)));
        if all.contains(&Some(&Err(CauseGiven))) {
            return Err(CauseGiven);
        }
        if let Some(known) = self.materials.get(&(number, uv)) {
            return *known;
        }
        let made = match self.scene.materials.get(number) {
            Some(entity) => self.make_material(entity, uv),
            None => Ok(Some(Material::diffuse(0.5).on_both_sides())),
        };
        let made = made.map(|of| of.map(|material| self.world.add_material(material)));
        self.materials.insert((number, uv), made);
        made
    }

    fn cause_once(&self, place: &SourcePlace, message: &str) {
        if self.report.is_first(place, message) {
            self.report.cause(place, message);
        }
    }

    fn make_material(&mut self, entity: &Entity<'_>, uv: Uv) -> Read<Option<Material>> {
        entity.is_used.set(true);
        self.made_materials += 1;
        if self.made_materials > MAX_MATERIALS || self.depth > MAX_DEPTH {
            let message = "the material contains itself, or too many materials are nested";
            self.cause_once(&entity.place, message);
            return Err(CauseGiven);
        }
        for name in ["displacement", "normalmap"] {
            if entity.has(name) {
                let message = format!("{name} is not supported: normals are those of the shape");
                return Err(entity.fault(name, message));
            }
        }
        // A named material has its type in a parameter.
        let plugin = match entity.plugin.as_str() {
            "" => entity.text("type")?.unwrap_or_default(),
            plugin => plugin,
        };
        Ok(Some(match plugin {
            "" | "none" | "interface" => return Ok(None),
            "diffuse" => {
                let reflectance = self.albedo_or(entity, "reflectance", 0.5, uv)?;
                Material::Diffuse { reflectance }.on_both_sides()
            }
            "diffusetransmission" => self.translucent(entity, uv)?,
            "conductor" => Material::Conductor(self.conductor(entity, uv)?).on_both_sides(),
            "coateddiffuse" => Material::Plastic(self.coated(entity, uv)?).on_both_sides(),
            "dielectric" => Material::Dielectric(self.dielectric(entity, false, uv)?),
            "thindielectric" => Material::Dielectric(self.dielectric(entity, true, uv)?),
            "mix" => self.mixed(entity, uv)?,
            other => {
                let other = quoted(other);
                entity.drop_all();
                let message = format!("material {other} is not supported; allowed: {ALLOWED}");
                return Err(entity.refuse(message));
            }
        }))
    }

    fn translucent(&mut self, entity: &Entity<'_>, uv: Uv) -> Read<Material> {
        let scale = entity.float_within("scale", 1.0, "1", |scale| (scale - 1.0).abs() <= 0.0);
        let reflectance = self.albedo_or(entity, "reflectance", 0.25, uv);
        let transmittance = self.albedo_or(entity, "transmittance", 0.25, uv);
        scale?;
        let (reflectance, transmittance) = (reflectance?, transmittance?);
        let sum = reflectance.largest() + transmittance.largest();
        if sum > MAX_SHARE {
            let message =
                format!("reflectance and transmittance together go up to {sum}; allowed: 0 to 1");
            return Err(entity.fault("transmittance", message));
        }
        Ok(Material::DiffuseTransmission {
            reflectance,
            transmittance,
        })
    }

    fn conductor(&mut self, entity: &Entity<'_>, uv: Uv) -> Read<Conductor> {
        let index = self.metal(entity);
        let roughness = self.roughness(entity, uv);
        Ok(Conductor {
            index: Some(index?),
            reflectance: Texture::Constant(1.0),
            roughness: roughness?,
        })
    }

    /// Returns n and k. If the file states a reflectance instead, n is 1, and k gives this
    /// reflectance at normal incidence.
    fn metal(&mut self, entity: &Entity<'_>) -> Read<[f64; 2]> {
        let number = Ask::Spectrum(Role::Number);
        if entity.has("reflectance") {
            if entity.has("eta") || entity.has("k") {
                let message = "reflectance is given together with eta or k; allowed: one of them";
                return Err(entity.fault("reflectance", message));
            }
            let share = self.constant_or(entity, "reflectance", ALBEDO, 1.0)?;
            let share = share.clamp(0.0, 0.9999);
            return Ok([1.0, 2.0 * (share / (1.0 - share)).sqrt()]);
        }
        let copper = |name| named_index(name).map_or(0.0, |rgb| self.color.of(rgb));
        let [n, k] = ["metal-Cu-eta", "metal-Cu-k"].map(copper);
        let n = self.constant_or(entity, "eta", number, n);
        let k = self.constant_or(entity, "k", number, k);
        Ok([n?, k?])
    }

    fn coated(&mut self, entity: &Entity<'_>, uv: Uv) -> Read<Plastic> {
        let message = "approximated: the material is a plastic, whose rough coat does not blur the light from the base; pbrt-v4 traces random walks between the layers";
        self.report.note_once(&entity.place, message);
        let albedo = self.constant_or(entity, "albedo", ALBEDO, 0.0);
        for name in ["thickness", "maxdepth", "nsamples", "g"] {
            // The parameters are marked as read, because the note about the approximation covers
            // them.
            entity.has(name);
        }
        if albedo? > 0.0 {
            let message = "a medium between the layers is not supported; allowed: albedo 0";
            return Err(entity.fault("albedo", message));
        }
        let index = self.index(entity);
        let diffuse = self.albedo_or(entity, "reflectance", 0.5, uv);
        let roughness = self.roughness(entity, uv);
        Ok(Plastic {
            index: index?,
            diffuse: diffuse?,
            specular: Texture::Constant(1.0),
            is_nonlinear: true,
            roughness: roughness?,
        })
    }

    fn dielectric(&mut self, entity: &Entity<'_>, is_thin: bool, uv: Uv) -> Read<Dielectric> {
        let index = self.index(entity);
        let roughness = match is_thin {
            true => Ok(None),
            false => self.roughness(entity, uv),
        };
        Ok(Dielectric {
            index: index?,
            reflectance: Texture::Constant(1.0),
            transmittance: Texture::Constant(1.0),
            roughness: roughness?,
            is_thin,
        })
    }

    /// The ratio of the index of refraction behind the surface to the index on the side
    /// of the normal.
    fn index(&mut self, entity: &Entity<'_>) -> Read<f64> {
        let index = match entity.find("eta") {
            Some(parameter) if parameter.kind != "float" => {
                let message = "approximated: eta is the same at all wavelengths";
                self.report.note_once(&parameter.place, message);
                self.number_of(entity, "eta", Role::Number)?.unwrap_or(1.5)
            }
            _ => entity.float_or("eta", 1.5)?,
        };
        match index > 0.0 {
            true => Ok(index),
            false => Err(entity.fault("eta", format!("eta is {index}; allowed: above 0"))),
        }
    }

    fn mixed(&mut self, entity: &Entity<'_>, uv: Uv) -> Read<Material> {
        let weight = self.texture_or(entity, "amount", Ask::Float, 0.5, uv);
        let names = entity.texts("materials")?;
        let [first, second] = names else {
            let message = format!("a mix has {} materials; allowed: 2", names.len());
            return Err(entity.fault("materials", message));
        };
        let [first, second] = [first, second].map(|name| self.part(entity, name, uv));
        Ok(Material::Blend {
            weight: weight?,
            of: Box::new([first?, second?]),
        })
    }

    fn part(&mut self, entity: &Entity<'_>, name: &str, uv: Uv) -> Read<Material> {
        let known = self.scene.named.get(name);
        let fault =
            |what: &str| entity.fault("materials", format!("material {} {what}", quoted(name)));
        let Some(of) = known.and_then(|number| self.scene.materials.get(*number)) else {
            return Err(fault("is not known"));
        };
        self.depth += 1;
        let made = self.make_material(of, uv);
        self.depth -= 1;
        made?.ok_or_else(|| fault("does not describe a surface"))
    }

    /// The roughness, or `None` for a smooth surface.
    fn roughness(&mut self, entity: &Entity<'_>, uv: Uv) -> Read<Option<Roughness>> {
        let remaps = entity.truth("remaproughness", true);
        let both = ["uroughness", "vroughness"].map(|name| {
            let name = if entity.has(name) { name } else { "roughness" };
            self.texture_or(entity, name, Ask::Float, 0.0, uv)
        });
        let remaps = remaps?;
        let alpha = |v: f64| if remaps { v.max(0.0).sqrt() } else { v };
        let [u, v] = both;
        let [u, v] = [u?, v?];
        if [&u, &v].iter().any(|t| matches!(t, Texture::Bitmap(_))) && remaps {
            let message =
                "approximated: pixels of a roughness are remapped before they are interpolated";
            self.report
                .note_once(entity.place_of("remaproughness"), message);
        }
        let [u, v] = [u, v].map(|texture| self.mapped(entity, texture, alpha));
        let [u, v] = [u?, v?];
        if u.largest().max(v.largest()) < SMOOTH {
            return Ok(None);
        }
        let rough = |v: f64| v.max(1e-4);
        let [u, v] = [u, v].map(|texture| self.mapped(entity, texture, rough));
        Ok(Some(Roughness {
            distribution: MicrofacetDistribution::Ggx,
            alpha: [u?, v?],
        }))
    }
}

/// Checks whether a material depends on texture coordinates, either because the material varies or
/// because it is anisotropic along u and v.
pub(super) fn reads_uv(material: &Material) -> bool {
    let varies = |texture: &Texture| !matches!(texture, Texture::Constant(_));
    let rough = |roughness: &Option<Roughness>| {
        roughness.as_ref().is_some_and(|r| match &r.alpha {
            #[expect(
                clippy::float_cmp,
                reason = "a material is isotropic only if both numbers are identical"
            )]
            [Texture::Constant(u), Texture::Constant(v)] => u != v,
            _ => true,
        })
    };
    match material {
        Material::Diffuse { reflectance } => varies(reflectance),
        Material::DiffuseTransmission {
            reflectance,
            transmittance,
        } => varies(reflectance) || varies(transmittance),
        Material::Conductor(of) => varies(&of.reflectance) || rough(&of.roughness),
        Material::Dielectric(of) => rough(&of.roughness),
        Material::Plastic(of) => varies(&of.diffuse) || rough(&of.roughness),
        // pbrt has no such materials.
        Material::Phong { .. } | Material::MetallicRoughness(_) | Material::Principled(_) => false,
        Material::TwoSided(of) => of.iter().any(reads_uv),
        Material::Mask { opacity, of } => varies(opacity) || reads_uv(of),
        Material::Blend { weight, of } => varies(weight) || of.iter().any(reads_uv),
    }
}
