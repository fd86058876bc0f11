//! Converts materials with `KHR_materials_transmission` to transmitting interfaces.

use super::metallic::roughness;
use super::reader::GltfReader;
use super::surface::Draft;
use etendue_world::{Dielectric, Material, Texture};

impl GltfReader<'_> {
    /// Returns a material that transmits a share of the light and otherwise behaves like `opaque`,
    /// or `None` if a cause of refusal was reported.
    pub(super) fn with_glass(
        &mut self,
        draft: &mut Draft<'_>,
        opaque: Material,
    ) -> Option<Material> {
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
            let message = "approximated: metals transmit like other materials";
            self.note(&path, message);
        }
        let glass = self.glass(draft, &path)?;
        if share >= 1.0 {
            return Some(glass);
        }
        self.note(
            &path,
            "approximated: the material is a mixture of an opaque material and glass",
        );
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
            self.note(
                &path,
                "attenuation is left out: light is not absorbed inside the body",
            );
        }
        if volume.thickness_factor.0 > 0.0 && volume.thickness_texture.is_some() {
            self.note(&path, "thicknessTexture is left out");
        }
        volume.thickness_factor.0 > 0.0
    }
}
