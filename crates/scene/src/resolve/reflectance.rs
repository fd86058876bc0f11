//! BRDFs and what varies them over a surface.

use super::Resolver;
use crate::file::{BrdfFile, FresnelFile, GratingFile, LobeFile, PatternFile};
use etendue_field::{Brdf, Fresnel, Grating, Lobe, Pattern, Reflectance};

/// Highest exponent of a Phong lobe: it is 0.01 rad wide.
const SHARPEST: f64 = 1e4;
/// Lowest roughness: 0.1 % is as good as a mirror.
const SMOOTHEST: f64 = 1e-3;
/// Highest index of refraction or absorption.
const DENSEST: f64 = 20.0;

impl Resolver<'_> {
    /// How a surface reflects.
    pub(super) fn reflectance(
        &mut self,
        of: &str,
        brdf: &BrdfFile,
        other: Option<&BrdfFile>,
        blend: Option<&PatternFile>,
        texture: Option<&PatternFile>,
    ) -> Reflectance {
        if other.is_some() != blend.is_some() {
            let (stated, missing) = if blend.is_some() {
                ("blend", "other")
            } else {
                ("other", "blend")
            };
            let allowed = format!("stated together with `{missing}`");
            self.faults.add(format!("{of}.{stated}"), "alone", allowed);
        }
        let resolved = self.brdf(&format!("{of}.brdf"), brdf);
        let other = other.map(|other| self.brdf(&format!("{of}.other"), other));
        let blend = blend.map(|blend| self.pattern(&format!("{of}.blend"), blend));
        Reflectance {
            brdf: resolved,
            blend: other.zip(blend),
            texture: texture.map(|t| self.pattern(&format!("{of}.texture"), t)),
        }
    }

    fn brdf(&mut self, of: &str, file: &BrdfFile) -> Brdf {
        let lobe = format!("{of}.lobe");
        let mut rough = |roughness: f64| self.faults.within(&lobe, roughness, SMOOTHEST..=1.0);
        let resolved = match file.lobe {
            LobeFile::Lambertian => Lobe::Lambertian,
            LobeFile::Phong(exponent) => {
                self.faults.within(&lobe, exponent, 0.0..=SHARPEST);
                Lobe::Phong { exponent }
            }
            LobeFile::Beckmann(roughness) => {
                rough(roughness);
                Lobe::Beckmann { roughness }
            }
            LobeFile::Ggx(roughness) => {
                rough(roughness);
                Lobe::Ggx { roughness }
            }
        };
        self.faults
            .within(format!("{of}.albedo"), file.albedo, 0.0..=1.0);
        let fresnel = format!("{of}.fresnel");
        let least = 1.0 / DENSEST;
        let fresnel = match file.fresnel {
            FresnelFile::White => Fresnel::White,
            FresnelFile::Dielectric(index) => {
                self.faults.within(fresnel, index, least..=DENSEST);
                Fresnel::Dielectric { index }
            }
            FresnelFile::Conductor { n, k } => {
                self.faults
                    .within(format!("{fresnel}.n"), n, least..=DENSEST);
                self.faults.within(format!("{fresnel}.k"), k, 0.0..=DENSEST);
                Fresnel::Conductor { n, k }
            }
        };
        Brdf {
            lobe: resolved,
            albedo: file.albedo,
            fresnel,
        }
    }

    fn pattern(&mut self, of: &str, file: &PatternFile) -> Pattern {
        match file {
            &PatternFile::Cosine {
                axis,
                frequency,
                modulation,
                phase,
            } => {
                let grating = GratingFile {
                    axis,
                    frequency,
                    modulation,
                    phase,
                };
                Pattern::Cosine(self.grating(of, &grating))
            }
            PatternFile::Checkerboard(period) => {
                self.faults.positive(of, *period);
                Pattern::Checkerboard { period: *period }
            }
            PatternFile::Picture { file, size } => self.picture_pattern(of, file, *size),
        }
    }

    /// The grating of a picture or a pattern.
    pub(super) fn grating(&mut self, of: &str, g: &GratingFile) -> Grating {
        self.faults.positive(format!("{of}.frequency"), g.frequency);
        self.faults
            .within(format!("{of}.modulation"), g.modulation, 0.0..=1.0);
        self.faults.coordinates(&format!("{of}.phase"), &[g.phase]);
        Grating {
            axis: g.axis.index(),
            frequency: g.frequency,
            modulation: g.modulation,
            phase: g.phase,
        }
    }
}
