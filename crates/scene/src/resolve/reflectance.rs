//! Checks BRDFs, and the factors that vary BRDFs over a surface.

use super::Resolver;
use etendue_field::{
    AngleTable, Brdf, Fresnel, Grating, MOST_TERMS, Pattern, Reflectance, Term, Weight,
};
use etendue_scenefile::{BrdfFile, EventFile, FresnelFile, GratingFile, PatternFile, TermFile};

/// The maximum number of values of a factor that depends on an angle: one value for each tenth of
/// a degree.
const FINEST: usize = 901;

impl Resolver<'_> {
    /// The reflectance of a surface; `None` if the surface sends each ray in one
    /// direction.
    pub(super) fn reflectance(&mut self, of: &str, event: &EventFile) -> Option<Reflectance> {
        let (mut resolved, texture) = match event {
            EventFile::Reflects {
                brdf,
                other,
                blend,
                texture,
            } => {
                let blended = self.blended(of, brdf, other.as_deref(), blend.as_ref());
                (blended, texture)
            }
            EventFile::Sum { terms, texture } => (self.sum(of, terms)?, texture),
            _ => return None,
        };
        let texture = texture.as_ref();
        resolved.texture = texture.map(|t| self.pattern(&format!("{of}.texture"), t));
        Some(resolved)
    }

    fn blended(
        &mut self,
        of: &str,
        brdf: &BrdfFile,
        other: Option<&BrdfFile>,
        blend: Option<&PatternFile>,
    ) -> Reflectance {
        if other.is_some() != blend.is_some() {
            let (stated, missing) = if blend.is_some() {
                ("blend", "other")
            } else {
                ("other", "blend")
            };
            let allowed = format!("only together with `{missing}`");
            self.faults.add(format!("{of}.{stated}"), "alone", allowed);
        }
        let resolved = self.brdf(&format!("{of}.brdf"), brdf);
        let other = other.map(|other| self.brdf(&format!("{of}.other"), other));
        let blend = blend.map(|blend| self.pattern(&format!("{of}.blend"), blend));
        match other.zip(blend) {
            Some((other, blend)) => Reflectance::blend(resolved, other, blend),
            None => resolved.into(),
        }
    }

    /// The sum of BRDFs; `None` if there are no terms or too many terms.
    fn sum(&mut self, of: &str, terms: &[TermFile]) -> Option<Reflectance> {
        let count = terms.len();
        if !(1..=MOST_TERMS).contains(&count) {
            let (found, allowed) = (format!("{count} terms"), format!("1 to {MOST_TERMS} terms"));
            self.faults.add(format!("{of}.terms"), found, allowed);
            return None;
        }
        let terms = terms.iter().enumerate().map(|(i, term)| {
            let of = format!("{of}.terms[{i}]");
            let weight = term.weight.as_ref();
            Term {
                brdf: self.brdf(&format!("{of}.brdf"), &term.brdf),
                weight: weight.map_or(Weight::One, |weight| {
                    Weight::Pattern(self.pattern(&format!("{of}.weight"), weight))
                }),
            }
        });
        Some(Reflectance {
            terms: terms.collect(),
            texture: None,
        })
    }

    fn brdf(&mut self, of: &str, file: &BrdfFile) -> Brdf {
        let fresnel = match file.fresnel {
            FresnelFile::White => Fresnel::White,
            FresnelFile::Dielectric(index) => Fresnel::Dielectric { index },
            FresnelFile::Conductor { n, k } => Fresnel::Conductor {
                n: n.number(self.color),
                k: k.number(self.color),
            },
        };
        let mut table =
            |field: &str, values: &Option<Vec<f64>>| self.table(&format!("{of}.{field}"), values);
        let incoming = table("incoming", &file.incoming);
        let outgoing = table("outgoing", &file.outgoing);
        Brdf {
            lobe: file.lobe.into(),
            albedo: file.albedo.number(self.color),
            fresnel,
            incoming,
            outgoing,
        }
    }

    fn table(&mut self, of: &str, values: &Option<Vec<f64>>) -> Option<AngleTable> {
        let values = values.as_ref()?;
        let count = values.len();
        if !(2..=FINEST).contains(&count) {
            let (found, allowed) = (format!("{count} values"), format!("2 to {FINEST} values"));
            self.faults.add(of, found, allowed);
        }
        let values = values.as_slice().into();
        Some(AngleTable { values })
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
                Pattern::Cosine(grating_of(&grating))
            }
            &PatternFile::Checkerboard(period) => Pattern::Checkerboard { period },
            PatternFile::Picture { file, size } => self.picture_pattern(of, file, *size),
        }
    }
}

/// The grating that a file describes.
pub(super) fn grating_of(file: &GratingFile) -> Grating {
    Grating {
        axis: file.axis.index(),
        frequency: file.frequency,
        modulation: file.modulation,
        phase: file.phase,
    }
}
