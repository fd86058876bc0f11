//! Reads the metallic-roughness model.

use super::level::TextureChannel;
use super::reader::GltfReader;
use super::surface::Draft;
use etendue_world::{Material, MetallicRoughness, MicrofacetDistribution, Roughness, Texture};

/// Default index of refraction.
const INDEX: f64 = 1.5;

/// The JSON field that contains the pictures of the base colour and of metallic and roughness.
const PBR: &str = "pbrMetallicRoughness";

impl GltfReader<'_> {
    /// Returns the scattering at the front of an opaque material, or `None` if a cause of refusal
    /// was reported.
    pub(super) fn metallic_roughness(&mut self, draft: &mut Draft<'_>) -> Option<Material> {
        let color = self.base_color(draft);
        let metallic = self.share(draft, "metallicFactor");
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

    pub(super) fn base_color(&mut self, draft: &mut Draft<'_>) -> Option<Texture> {
        let pbr = &draft.source.pbr_metallic_roughness;
        let path = format!("{}.{PBR}.baseColorFactor", draft.path);
        let [r, g, b, _] = self.shares(&path, pbr.base_color_factor.0)?;
        let level = TextureChannel::Color([r, g, b]);
        match &pbr.base_color_texture {
            Some(info) => self.bitmap(draft, info, &format!("{PBR}.baseColorTexture"), level),
            None => Some(self.constant(&level)),
        }
    }

    /// Returns `metallicFactor` times the metallic channel of the picture.
    fn share(&mut self, draft: &mut Draft<'_>, name: &str) -> Option<Texture> {
        let pbr = &draft.source.pbr_metallic_roughness;
        let path = format!("{}.{PBR}.{name}", draft.path);
        let factor = self.within(&path, pbr.metallic_factor.0, [0.0, 1.0])?;
        match &pbr.metallic_roughness_texture {
            // If the metallic factor is 0, the picture has no effect.
            Some(info) if factor > 0.0 => {
                let field = format!("{PBR}.metallicRoughnessTexture");
                self.bitmap(draft, info, &field, TextureChannel::Blue(factor))
            }
            _ => Some(Texture::Constant(factor)),
        }
    }

    /// Returns α, which is the square of the roughness.
    pub(super) fn alpha(&mut self, draft: &mut Draft<'_>) -> Option<Texture> {
        let pbr = &draft.source.pbr_metallic_roughness;
        let path = format!("{}.{PBR}.roughnessFactor", draft.path);
        let factor = self.within(&path, pbr.roughness_factor.0, [0.0, 1.0])?;
        match &pbr.metallic_roughness_texture {
            Some(info) if factor > 0.0 => {
                let field = format!("{PBR}.metallicRoughnessTexture");
                self.bitmap(draft, info, &field, TextureChannel::GreenSquared(factor))
            }
            _ => Some(Texture::Constant(factor * factor)),
        }
    }

    /// Returns the index of refraction, or `None` if a cause of refusal was reported.
    pub(super) fn index(&self, draft: &Draft<'_>) -> Option<f64> {
        let ior = draft
            .source
            .extensions
            .as_ref()
            .and_then(|of| of.ior.as_ref());
        let Some(ior) = ior else {
            return Some(INDEX);
        };
        let path = format!("{}.extensions.KHR_materials_ior.ior", draft.path);
        self.within(&path, ior.ior.0, [1.0, 10.0])
    }

    /// Returns the reflectance of the coat of a dielectric at normal and at grazing incidence.
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
}

/// Returns the isotropic microfacet roughness α, or `None` for a smooth surface.
pub(super) fn roughness(alpha: Texture) -> Option<Roughness> {
    match alpha {
        Texture::Constant(..=0.0) => None,
        alpha => Some(Roughness {
            distribution: MicrofacetDistribution::Ggx,
            alpha: [alpha.clone(), alpha],
        }),
    }
}
