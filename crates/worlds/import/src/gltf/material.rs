//! Materials of a glTF file.

use super::reader::{Draft, GltfReader, GltfSurface};
use super::texture::TextureChannel;
use crate::range::MAX_NUMBER;
use ::gltf::json::Material as GltfMaterial;
use ::gltf::json::material::AlphaMode;
use ::gltf::json::validation::Checked;
use etendue_world::{
    Dielectric, Material, MetallicRoughness, MicrofacetDistribution, Roughness, Texture,
};
use std::collections::BTreeSet;

/// Default index of refraction.
const INDEX: f64 = 1.5;

/// The JSON field that contains the pictures of the base colour and of metallic and roughness.
const PBR: &str = "pbrMetallicRoughness";

/// The JSON field of the picture of the base colour.
const BASE_COLOR: &str = "pbrMetallicRoughness.baseColorTexture";

impl<'a> GltfReader<'a> {
    /// The material with a given number in the file. If no number is given, returns the
    /// default material of the specification. Returns `None` if a cause of refusal was reported.
    pub(super) fn material(&mut self, number: Option<usize>) -> Option<GltfSurface> {
        if let Some(known) = self.materials.get(&number) {
            return known.clone();
        }
        let made = match number.map(|n| (n, self.root.materials.get(n))) {
            Some((n, Some(source))) => self.surface(source, format!("materials[{n}]")),
            _ => self.surface(&GltfMaterial::default(), "the default material".to_owned()),
        };
        self.materials.insert(number, made.clone());
        made
    }

    fn surface(&mut self, source: &GltfMaterial, path: String) -> Option<GltfSurface> {
        let mut draft = Draft {
            source,
            path,
            sets: BTreeSet::new(),
        };
        self.tell_dropped_of(&draft);
        let scatter = self.scatter(&mut draft);
        let emission = self.emission(&mut draft);
        let opacity = self.opacity(&mut draft);
        let (scatter, emission) = (scatter?, emission?);
        let material = match opacity? {
            Texture::Constant(1.0..) => scatter,
            opacity => {
                if emission.is_some() {
                    let message = "does not affect the emission of the material";
                    self.note(&format!("{}.alphaMode", draft.path), message);
                }
                let of = Box::new(scatter);
                Material::Mask { opacity, of }
            }
        };
        if draft.sets.len() > 1 {
            let message = format!(
                "the pictures use several sets of texture coordinates, {:?}; allowed: one set",
                draft.sets
            );
            return self.refuse(&draft.path, message);
        }
        Some(GltfSurface {
            material: self.world.add_material(material),
            emission,
            is_double_sided: source.double_sided,
            set: draft.sets.first().copied(),
        })
    }

    /// The scattering of a material, on one side or on both sides.
    fn scatter(&mut self, draft: &mut Draft<'_>) -> Option<Material> {
        let metallic_roughness = self.metallic_roughness(draft)?;
        let opaque = match draft.source.double_sided {
            true => metallic_roughness.on_both_sides(),
            false => {
                self.note_once("surfaces that are not doubleSided scatter light on their front only; their backs, which glTF does not show, are black");
                metallic_roughness
            }
        };
        self.with_glass(draft, opaque)
    }

    /// The emission of a material's front. The outer `None` means that a cause of refusal
    /// was reported.
    fn emission(&mut self, draft: &mut Draft<'_>) -> Option<Option<Texture>> {
        let path = format!("{}.emissiveFactor", draft.path);
        let factor = self.shares(&path, draft.source.emissive_factor.0)?;
        let extensions = draft.source.extensions.as_ref();
        let strength = extensions.and_then(|of| of.emissive_strength.as_ref());
        let strength = match strength {
            Some(of) => {
                let path = format!("{}.extensions.KHR_materials_emissive_strength", draft.path);
                self.within(&path, of.emissive_strength.0, [0.0, MAX_NUMBER])?
            }
            None => 1.0,
        };
        if !is_lit(draft.source) {
            return Some(None);
        }
        self.note_units();
        let level = TextureChannel::Color(factor.map(|v| v * strength));
        let info = draft.source.emissive_texture.as_ref();
        self.textured(draft, info, "emissiveTexture", level)
            .map(Some)
    }

    /// The opacity, or `None` if a cause of refusal was reported.
    fn opacity(&mut self, draft: &mut Draft<'_>) -> Option<Texture> {
        let source = draft.source;
        let factor = f64::from(source.pbr_metallic_roughness.base_color_factor.0[3]);
        let cutoff = match source.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => {
                return Some(Texture::Constant(1.0));
            }
            Checked::Valid(AlphaMode::Mask) => {
                Some(source.alpha_cutoff.as_ref().map_or(0.5, |c| f64::from(c.0)))
            }
            Checked::Valid(AlphaMode::Blend) => None,
        };
        let level = TextureChannel::Alpha { factor, cutoff };
        let info = source.pbr_metallic_roughness.base_color_texture.as_ref();
        if info.is_some() && cutoff.is_some() {
            let message = "approximated: each pixel is opaque or transparent, with no interpolation between pixels";
            self.note(&format!("{}.alphaCutoff", draft.path), message);
        }
        self.textured(draft, info, BASE_COLOR, level)
    }

    fn tell_dropped_of(&self, draft: &Draft<'_>) {
        let (source, path) = (draft.source, &draft.path);
        if source.normal_texture.is_some() {
            let message = "is not supported: normals are those of the mesh";
            self.cause(&format!("{path}.normalTexture"), message);
        }
        if source.occlusion_texture.is_some() {
            let message = "is left out: paths of light determine the occlusion";
            self.note(&format!("{path}.occlusionTexture"), message);
        }
        let Some(extensions) = &source.extensions else {
            return;
        };
        if extensions.unlit.is_some() {
            let message = "is left out: the surface reflects light like any other surface";
            self.note(&format!("{path}.extensions.KHR_materials_unlit"), message);
        }
        self.tell_others(path, extensions.others.keys());
    }

    /// The scattering at the front of an opaque material, or `None` if a cause of refusal
    /// was reported.
    fn metallic_roughness(&mut self, draft: &mut Draft<'_>) -> Option<Material> {
        let color = self.base_color(draft);
        let factor = draft.source.pbr_metallic_roughness.metallic_factor.0;
        let metallic = self.channel(draft, "metallicFactor", factor, TextureChannel::Blue);
        let alpha = self.alpha(draft);
        let (color, metallic, alpha) = (color?, metallic?, alpha?);
        let coat = self.coat(draft)?;
        if matches!(metallic, Texture::Constant(..=0.0)) && coat[1] <= 0.0 {
            return Some(Material::Diffuse { reflectance: color });
        }
        Some(Material::MetallicRoughness(Box::new(MetallicRoughness {
            color,
            metallic,
            roughness: roughness(alpha),
            coat,
        })))
    }

    fn base_color(&mut self, draft: &mut Draft<'_>) -> Option<Texture> {
        let pbr = &draft.source.pbr_metallic_roughness;
        let path = format!("{}.{PBR}.baseColorFactor", draft.path);
        let [r, g, b, _] = self.shares(&path, pbr.base_color_factor.0)?;
        let level = TextureChannel::Color([r, g, b]);
        self.textured(draft, pbr.base_color_texture.as_ref(), BASE_COLOR, level)
    }

    /// Returns α, which is the square of the roughness.
    fn alpha(&mut self, draft: &mut Draft<'_>) -> Option<Texture> {
        let factor = draft.source.pbr_metallic_roughness.roughness_factor.0;
        self.channel(
            draft,
            "roughnessFactor",
            factor,
            TextureChannel::GreenSquared,
        )
    }

    /// A factor from 0 to 1, as a channel of the picture of metallic and roughness.
    fn channel(
        &mut self,
        draft: &mut Draft<'_>,
        name: &str,
        factor: f32,
        channel: fn(f64) -> TextureChannel,
    ) -> Option<Texture> {
        let path = format!("{}.{PBR}.{name}", draft.path);
        let factor = self.within(&path, factor, [0.0, 1.0])?;
        let info = &draft
            .source
            .pbr_metallic_roughness
            .metallic_roughness_texture;
        // If the factor is 0, the picture has no effect.
        let info = info.as_ref().filter(|_| factor > 0.0);
        let field = format!("{PBR}.metallicRoughnessTexture");
        self.textured(draft, info, &field, channel(factor))
    }

    /// The index of refraction, or `None` if a cause of refusal was reported.
    fn index(&self, draft: &Draft<'_>) -> Option<f64> {
        let extensions = draft.source.extensions.as_ref();
        let Some(ior) = extensions.and_then(|of| of.ior.as_ref()) else {
            return Some(INDEX);
        };
        let path = format!("{}.extensions.KHR_materials_ior.ior", draft.path);
        self.within(&path, ior.ior.0, [1.0, 10.0])
    }

    /// The reflectance of the coat of a dielectric at normal and at grazing incidence.
    fn coat(&self, draft: &Draft<'_>) -> Option<[f64; 2]> {
        let index = self.index(draft)?;
        let normal = ((index - 1.0) / (index + 1.0)).powi(2);
        let extensions = draft.source.extensions.as_ref();
        let Some(of) = extensions.and_then(|of| of.specular.as_ref()) else {
            return Some([normal, 1.0]);
        };
        let path = format!("{}.extensions.KHR_materials_specular", draft.path);
        let field = format!("{path}.specularFactor");
        let factor = self.within(&field, of.specular_factor.0, [0.0, 1.0])?;
        let color = of.specular_color_factor.0;
        for value in color {
            self.within(&format!("{path}.specularColorFactor"), value, [0.0, 1.0])?;
        }
        if of.specular_texture.is_some() || of.specular_color_texture.is_some() {
            self.note(&path, "pictures are left out");
        }
        Some([
            factor * normal * self.color.of(color.map(f64::from)),
            factor,
        ])
    }

    /// A material that transmits a share of the light and otherwise behaves like `opaque`,
    /// or `None` if a cause of refusal was reported.
    fn with_glass(&mut self, draft: &mut Draft<'_>, opaque: Material) -> Option<Material> {
        let extensions = draft.source.extensions.as_ref();
        let transmission = extensions.and_then(|of| of.transmission.as_ref());
        let Some(of) = transmission else {
            if extensions.is_some_and(|of| of.volume.is_some()) {
                let path = format!("{}.extensions.KHR_materials_volume", draft.path);
                self.note(&path, "is left out: the material transmits no light");
            }
            return Some(opaque);
        };
        let path = format!("{}.extensions.KHR_materials_transmission", draft.path);
        let field = format!("{path}.transmissionFactor");
        let share = self.within(&field, of.transmission_factor.0, [0.0, 1.0])?;
        if of.transmission_texture.is_some() {
            self.note(&format!("{path}.transmissionTexture"), "is left out");
        }
        if share <= 0.0 {
            return Some(opaque);
        }
        let metallic = draft.source.pbr_metallic_roughness.metallic_factor.0;
        if metallic > 0.0 {
            self.note(&path, "approximated: metals transmit like other materials");
        }
        let glass = self.glass(draft, &path)?;
        if share >= 1.0 {
            return Some(glass);
        }
        let message = "approximated: the material is a mixture of an opaque material and glass";
        self.note(&path, message);
        let weight = Texture::Constant(share);
        let of = Box::new([opaque, glass]);
        Some(Material::Blend { weight, of })
    }

    fn glass(&mut self, draft: &mut Draft<'_>, path: &str) -> Option<Material> {
        let color = self.base_color(draft);
        let alpha = self.alpha(draft);
        let index = self.index(draft)?;
        let is_thin = !self.has_volume(draft);
        let roughness = roughness(alpha?).filter(|_| !is_thin);
        let message = match is_thin {
            true => {
                "approximated: the surface is a smooth thin sheet with all internal reflections; the base colour applies once"
            }
            false => {
                "approximated: the surface is an interface, and the base colour applies each time light passes"
            }
        };
        self.note(path, message);
        Some(Material::Dielectric(Dielectric {
            index,
            reflectance: Texture::Constant(1.0),
            transmittance: color?,
            roughness,
            is_thin,
        }))
    }

    /// Checks whether the surface encloses a volume.
    fn has_volume(&self, draft: &Draft<'_>) -> bool {
        let extensions = draft.source.extensions.as_ref();
        let Some(volume) = extensions.and_then(|of| of.volume.as_ref()) else {
            return false;
        };
        let path = format!("{}.extensions.KHR_materials_volume", draft.path);
        if volume.attenuation_distance.0.is_finite() {
            let message = "attenuation is left out: light is not absorbed inside the body";
            self.note(&path, message);
        }
        if volume.thickness_factor.0 > 0.0 && volume.thickness_texture.is_some() {
            self.note(&path, "thicknessTexture is left out");
        }
        volume.thickness_factor.0 > 0.0
    }
}

/// Checks whether a material emits light.
fn is_lit(source: &GltfMaterial) -> bool {
    source.emissive_factor.0.iter().any(|v| *v > 0.0)
}

/// The isotropic microfacet roughness α, or `None` for a smooth surface.
fn roughness(alpha: Texture) -> Option<Roughness> {
    match alpha {
        Texture::Constant(..=0.0) => None,
        alpha => Some(Roughness {
            distribution: MicrofacetDistribution::Ggx,
            alpha: [alpha.clone(), alpha],
        }),
    }
}
