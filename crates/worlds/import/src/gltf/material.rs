//! Materials of a glTF file.

use super::level::TextureChannel;
use super::reader::GltfReader;
use super::surface::{Draft, GltfSurface};
use crate::range::MAX_NUMBER;
use crate::report::quoted;
use ::gltf::json::Material as BufferSource;
use ::gltf::json::material::AlphaMode;
use ::gltf::json::validation::Checked;
use etendue_world::{Material, Texture};
use std::collections::BTreeSet;

impl<'a> GltfReader<'a> {
    /// Returns the material with a given number in the file. If no number is given, returns the
    /// default material of the specification. Returns `None` if a cause of refusal was reported.
    pub(super) fn material(&mut self, number: Option<usize>) -> Option<GltfSurface> {
        if let Some(known) = self.materials.get(&number) {
            return known.clone();
        }
        let made = match number.map(|n| (n, self.root.materials.get(n))) {
            Some((n, Some(source))) => self.surface(source, format!("materials[{n}]")),
            _ => self.surface(&BufferSource::default(), "the default material".to_owned()),
        };
        self.materials.insert(number, made.clone());
        made
    }

    fn surface(&mut self, source: &BufferSource, path: String) -> Option<GltfSurface> {
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
            None => scatter,
            Some(opacity) => {
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
        self.world.materials.push(material);
        Some(GltfSurface {
            material: self.world.materials.len() - 1,
            emission,
            is_double_sided: source.double_sided,
            set: draft.sets.first().copied(),
        })
    }

    /// Returns the scattering of a material, on one side or on both sides.
    fn scatter(&mut self, draft: &mut Draft<'_>) -> Option<Material> {
        let metallic_roughness = self.metallic_roughness(draft)?;
        let opaque = match draft.source.double_sided {
            true => Material::TwoSided(Box::new([metallic_roughness.clone(), metallic_roughness])),
            false => {
                self.note_once("surfaces that are not doubleSided scatter light on their front only; their backs, which glTF does not show, are black");
                metallic_roughness
            }
        };
        self.with_glass(draft, opaque)
    }

    /// Returns the emission of a material's front. The outer `None` means that a cause of refusal
    /// was reported.
    #[expect(
        clippy::option_option,
        reason = "the outer `None` means that a cause was reported"
    )]
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
        self.note_once("strengths of lights are taken as radiometric: 1 cd as 1 W/sr, 1 lx as 1 W/m², 1 nit of emission as 1 W m⁻² sr⁻¹");
        let level = TextureChannel::Color(factor.map(|v| v * strength));
        let source = draft.source;
        match &source.emissive_texture {
            Some(info) => self.bitmap(draft, info, "emissiveTexture", level).map(Some),
            None => Some(Some(self.constant(&level))),
        }
    }

    /// Returns the opacity. The inner `None` means an opaque material, and the outer `None` means
    /// that a cause of refusal was reported.
    #[expect(
        clippy::option_option,
        reason = "the outer `None` means that a cause was reported"
    )]
    fn opacity(&mut self, draft: &mut Draft<'_>) -> Option<Option<Texture>> {
        let source = draft.source;
        let factor = f64::from(source.pbr_metallic_roughness.base_color_factor.0[3]);
        let cutoff = match source.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => return Some(None),
            Checked::Valid(AlphaMode::Mask) => {
                Some(source.alpha_cutoff.as_ref().map_or(0.5, |c| f64::from(c.0)))
            }
            Checked::Valid(AlphaMode::Blend) => None,
        };
        let level = TextureChannel::Alpha { factor, cutoff };
        let texture = match &source.pbr_metallic_roughness.base_color_texture {
            Some(info) => {
                if cutoff.is_some() {
                    let message = "approximated: each pixel is opaque or transparent, with no interpolation between pixels";
                    self.note(&format!("{}.alphaCutoff", draft.path), message);
                }
                self.bitmap(draft, info, "pbrMetallicRoughness.baseColorTexture", level)?
            }
            None => self.constant(&level),
        };
        Some(match texture {
            Texture::Constant(1.0..) => None,
            other => Some(other),
        })
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
        for name in extensions.others.keys() {
            let name = quoted(name);
            self.note(&format!("{path}.extensions"), format!("{name} is left out"));
        }
    }
}

/// Checks whether a material emits light.
fn is_lit(source: &BufferSource) -> bool {
    source.emissive_factor.0.iter().any(|v| *v > 0.0)
}
