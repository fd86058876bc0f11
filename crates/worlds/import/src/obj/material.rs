//! Materials of MTL files.

use super::mtl::{MtlEntry, MtlMap, ObjSurface};
use super::reader::ObjReader;
use crate::pictures::{counted, decode, linear, weighted};
use crate::range::{MAX_NUMBER, MAX_SHARE, share};
use crate::report::quoted;
use etendue_field::Raster;
use etendue_world::{Bitmap, Conductor, Dielectric, Filter, Material, Texture};
use std::sync::Arc;

/// Default index of refraction.
const INDEX: f64 = 1.5;

impl ObjReader<'_> {
    /// Adds the surface of parts without a material.
    pub(super) fn default_surface(&mut self) -> ObjSurface {
        ObjSurface {
            material: (self.world).add_material(Material::diffuse(0.5).on_both_sides()),
            emission: None,
            has_picture: false,
        }
    }

    /// The surface of a material, or `None` if a cause of refusal was reported.
    pub(super) fn surface(&mut self, entry: &MtlEntry) -> Option<ObjSurface> {
        let scatter = self.scatter(entry);
        let emission = self.emission(entry);
        let opacity = match &entry.map_d {
            Some(map) => Some(self.bitmap(map, [entry.d.unwrap_or(1.0); 3], true)?),
            None => entry.d.filter(|d| *d < 1.0).map(Texture::Constant),
        };
        let (scatter, emission) = (scatter?, emission?);
        let material = match opacity {
            Some(opacity) => Material::Mask {
                opacity,
                of: Box::new(scatter),
            },
            None => scatter,
        };
        let maps = [&entry.map_kd, &entry.map_ke, &entry.map_d];
        Some(ObjSurface {
            material: self.world.add_material(material),
            emission,
            has_picture: maps.iter().any(|map| map.is_some()),
        })
    }

    fn scatter(&mut self, entry: &MtlEntry) -> Option<Material> {
        let note = |message: &str| self.report.note(&entry.place, message);
        let ks = self.color.of(entry.ks.unwrap_or_default());
        let illum = entry.illum.unwrap_or(if ks > 0.0 { 2 } else { 1 });
        match illum {
            0 => note("illum 0, a colour without light, is read as diffuse"),
            10 => note("illum 10, which shows only shadows, is read as diffuse"),
            _ => {}
        }
        let side = match illum {
            4 | 6 | 7 | 9 => return Some(self.glass(entry)),
            3 | 5 | 8 => {
                note(
                    "approximated: the material is a mirror that reflects Ks at all angles; Kd and Ns are left out",
                );
                Material::Conductor(Conductor {
                    index: None,
                    reflectance: Texture::Constant(self.color.of(entry.ks.unwrap_or([1.0; 3]))),
                    roughness: None,
                })
            }
            2 if ks > 0.0 => self.phong(entry, ks)?,
            _ => Material::Diffuse {
                reflectance: self.diffuse(entry)?,
            },
        };
        Some(side.on_both_sides())
    }

    /// The colour `Kd` times the picture of `Kd`.
    fn diffuse(&mut self, entry: &MtlEntry) -> Option<Texture> {
        match &entry.map_kd {
            Some(map) => {
                let texture = self.bitmap(map, entry.kd.unwrap_or([1.0; 3]), false)?;
                self.report.accept(&map.place, share("Kd", texture))
            }
            None => {
                let factor = entry.kd.unwrap_or([0.5; 3]);
                Some(Texture::Constant(self.color.of(factor)))
            }
        }
    }

    fn phong(&mut self, entry: &MtlEntry, ks: f64) -> Option<Material> {
        let diffuse = self.diffuse(entry)?;
        let exponent = entry.ns.unwrap_or(1.0);
        let note = |message: &str| self.report.note(&entry.place, message);
        if entry.ns.is_none() {
            note("Ks without Ns: Ns = 1 is used");
        }
        note(
            "approximated: Ks and Ns become the modified Phong lobe ks (n + 2)/(2π) cosⁿ α about the mirror direction",
        );
        let share = diffuse.largest() + ks;
        if share > MAX_SHARE {
            let message =
                format!("Kd and Ks reflect up to {share:.4} of the light; allowed: up to 1");
            return self.report.refuse(&entry.place, message);
        }
        Some(Material::Phong {
            diffuse,
            specular: Texture::Constant(ks),
            exponent: Texture::Constant(exponent),
        })
    }

    fn glass(&self, entry: &MtlEntry) -> Material {
        let index = entry.ni.unwrap_or(INDEX);
        if entry.ni.is_none() {
            let message = format!("transmits without Ni: Ni = {INDEX} is used");
            self.report.note(&entry.place, message);
        }
        let message =
            "approximated: the material is a smooth interface; Kd, Ks and Ns are left out";
        self.report.note(&entry.place, message);
        Material::Dielectric(Dielectric {
            index,
            reflectance: Texture::Constant(1.0),
            transmittance: Texture::Constant(self.color.of(entry.tf.unwrap_or([1.0; 3]))),
            roughness: None,
            is_thin: false,
        })
    }

    /// The emission. The outer `None` means that a cause of refusal was reported.
    fn emission(&mut self, entry: &MtlEntry) -> Option<Option<Texture>> {
        if let Some(map) = &entry.map_ke {
            return self
                .bitmap(map, entry.ke.unwrap_or([1.0; 3]), false)
                .map(Some);
        }
        let factor = self.color.of(entry.ke.unwrap_or_default());
        Some((factor > 0.0).then_some(Texture::Constant(factor)))
    }

    /// A picture times factors, or `None` if a cause of refusal was reported. The levels
    /// of the picture are sRGB unless `raw` is set.
    fn bitmap(&mut self, map: &MtlMap, factor: [f64; 3], raw: bool) -> Option<Texture> {
        let read = self.pixels(map, factor, raw);
        let read = read.map_err(|error| format!("file {} {error}", quoted(&map.file)));
        let pixels = self.report.accept(&map.place, read)?;
        Some(Texture::Bitmap(Bitmap {
            to_uv: map.to_uv,
            pixels: Arc::new(pixels),
            wrap: map.wrap,
            filter: Filter::Bilinear,
        }))
    }

    fn pixels(&self, map: &MtlMap, factor: [f64; 3], raw: bool) -> Result<Raster, String> {
        let path = self
            .files
            .find(std::slice::from_ref(&map.folder), &map.file)?;
        let bytes = self.files.read(&path)?;
        let channels = decode(&path, &bytes, self.files)?;
        let light = |level: f64| if raw { level } else { linear(level) };
        let raster = weighted(&channels, self.color, Some(factor), light);
        let raster = counted(self.files, raster)?;
        let is_in_range = |v: &f64| (0.0..=MAX_NUMBER).contains(v);
        if !raster.values().iter().all(is_in_range) {
            return Err(format!(
                "has pixels out of range; allowed: 0 to {MAX_NUMBER:e}"
            ));
        }
        Ok(raster)
    }
}
