//! Conversion of the metallic-roughness model to a mixture of plastic and metal.

use super::level::TextureChannel;
use super::reader::GltfReader;
use super::surface::Draft;
use etendue_world::{Conductor, Material, MicrofacetDistribution, Plastic, Roughness, Texture};

/// Default index of refraction.
const INDEX: f64 = 1.5;

/// The JSON field that contains the pictures of the base colour and of metallic and roughness.
const PBR: &str = "pbrMetallicRoughness";

/// The reflection at the surface of a dielectric.
struct DielectricCoat {
    index: f64,
    specular: f64,
}

impl GltfReader<'_> {
    /// Returns the scattering at the front of an opaque material, or `None` if a cause of refusal
    /// was reported.
    pub(super) fn metallic_roughness(&mut self, draft: &mut Draft<'_>) -> Option<Material> {
        let color = self.base_color(draft);
        let metallic = self.share(draft, "metallicFactor");
        let alpha = self.alpha(draft);
        let (color, metallic, alpha) = (color?, metallic?, alpha?);
        match metallic {
            Texture::Constant(..=0.0) => self.dielectric_base(draft, color, &alpha),
            Texture::Constant(1.0..) => Some(self.metal(draft, color, alpha)),
            weight => {
                let message =
                    "approximated: the material is a mixture of a coated base and a metal";
                self.note(&format!("{}.{PBR}.metallicFactor", draft.path), message);
                let base = self.dielectric_base(draft, color.clone(), &alpha)?;
                let metal = self.metal(draft, color, alpha);
                let of = Box::new([base, metal]);
                Some(Material::Blend { weight, of })
            }
        }
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

    /// Returns a metal whose reflectance is the base colour at all angles.
    fn metal(&self, draft: &Draft<'_>, reflectance: Texture, alpha: Texture) -> Material {
        let is_white = matches!(reflectance, Texture::Constant(v) if (v - 1.0).abs() < 1e-9);
        if !is_white {
            let message = "approximated: the metal reflects its base colour at all angles; in glTF, a metal is white at grazing angles";
            self.note(&format!("{}.{PBR}", draft.path), message);
        }
        Material::Conductor(Conductor {
            index: None,
            reflectance,
            roughness: roughness(alpha),
        })
    }

    fn dielectric_base(
        &self,
        draft: &Draft<'_>,
        diffuse: Texture,
        alpha: &Texture,
    ) -> Option<Material> {
        let DielectricCoat { index, specular } = self.coat(draft)?;
        if index <= 1.0 || specular <= 0.0 {
            return Some(Material::Diffuse {
                reflectance: diffuse,
            });
        }
        let path = format!("{}.{PBR}", draft.path);
        self.note(&path, format!("approximated: the material is a diffuse base below a coat of index {index}, with internal reflections"));
        let alpha = match alpha {
            Texture::Bitmap(bitmap) => {
                let values = bitmap.pixels.values();
                let roots: f64 = values.iter().map(|alpha| alpha.sqrt()).sum();
                let mean = roots / values.len() as f64;
                let message =
                    format!("approximated: the coat has the mean roughness, {mean:.4}, everywhere");
                self.note(&format!("{path}.metallicRoughnessTexture"), message);
                Texture::Constant(mean * mean)
            }
            other => other.clone(),
        };
        Some(Material::Plastic(Plastic {
            index,
            diffuse,
            specular: Texture::Constant(specular),
            is_nonlinear: false,
            roughness: roughness(alpha),
        }))
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

    fn coat(&self, draft: &Draft<'_>) -> Option<DielectricCoat> {
        let index = self.index(draft)?;
        let extensions = draft.source.extensions.as_ref();
        let Some(of) = extensions.and_then(|of| of.specular.as_ref()) else {
            let specular = 1.0;
            return Some(DielectricCoat { index, specular });
        };
        let path = format!("{}.extensions.KHR_materials_specular", draft.path);
        let factor = self.within(
            &format!("{path}.specularFactor"),
            of.specular_factor.0,
            [0.0, 1.0],
        )?;
        let color = of.specular_color_factor.0;
        for value in color {
            self.within(&format!("{path}.specularColorFactor"), value, [0.0, 1.0])?;
        }
        if of.specular_texture.is_some() || of.specular_color_texture.is_some() {
            self.note(&path, "pictures are left out");
        }
        let specular = factor * self.color.of(color.map(f64::from));
        let is_plain = specular <= 0.0 || (specular - 1.0).abs() < 1e-9;
        if !is_plain {
            self.note(
                &path,
                "approximated: the reflection of the coat is multiplied by this factor",
            );
        }
        Some(DielectricCoat { index, specular })
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
