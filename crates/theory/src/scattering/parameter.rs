//! Numbers of a system that a measurement may be asked for.

use super::System;
use etendue_field::{Brdf, Light, Lobe};

/// A number of a [`System`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The first width of a picture, the second keeping the proportion.
    ImageWidth,
    /// The albedo, or factor, of the BRDF.
    Albedo,
    /// The exponent or the roughness of its lobe.
    Lobe,
    /// A curvature of the surface, k₁ (0) or k₂ (1); those that equal it go with it, and so does k₃
    /// where it equals it.
    Curvature(usize),
}

impl System {
    /// All parameters, in the order light meets them.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut all = Vec::new();
        if self.light.is_picture() {
            all.push(Parameter::ImageWidth);
        }
        let [k1, k2, _] = self.patch.curvature;
        if k1 != 0.0 {
            all.push(Parameter::Curvature(0));
        }
        if k2 != 0.0 && (k2 - k1).abs() > 1e-12 * k1.abs() {
            all.push(Parameter::Curvature(1));
        }
        all.push(Parameter::Albedo);
        if self.reflectance.brdf.lobe != Lobe::Lambertian {
            all.push(Parameter::Lobe);
        }
        all
    }

    /// The parameter in words.
    #[must_use]
    pub fn name_of(&self, parameter: Parameter) -> String {
        let name = &self.name;
        match parameter {
            Parameter::ImageWidth => "width of the image".to_owned(),
            Parameter::Albedo => format!("albedo of {name}"),
            Parameter::Lobe => match self.reflectance.brdf.lobe {
                Lobe::Phong { .. } => format!("exponent of {name}"),
                _ => format!("roughness of {name}"),
            },
            Parameter::Curvature(axis) => format!("curvature {} of {name}", axis + 1),
        }
    }

    /// Its unit; none for a pure number.
    #[must_use]
    pub fn unit_of(&self, parameter: Parameter) -> &'static str {
        match parameter {
            Parameter::ImageWidth => match self.light {
                Light::Beam { .. } => "m",
                _ => "",
            },
            Parameter::Curvature(_) => "1/m",
            Parameter::Albedo | Parameter::Lobe => "",
        }
    }

    /// Its value; `None` if the system does not have it.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::ImageWidth => match &self.light {
                Light::Projector { image, .. } | Light::Beam { image, .. } => Some(image.width[0]),
                _ => None,
            },
            Parameter::Albedo => Some(self.reflectance.brdf.albedo),
            Parameter::Lobe => match self.reflectance.brdf.lobe {
                Lobe::Lambertian => None,
                Lobe::Phong { exponent } => Some(exponent),
                Lobe::Beckmann { roughness } | Lobe::Ggx { roughness } => Some(roughness),
            },
            Parameter::Curvature(axis) => Some(self.patch.curvature[axis]),
        }
    }

    /// The same system with another value of it; where BRDFs are blended, of the first alone.
    #[must_use]
    pub fn with(&self, parameter: Parameter, value: f64) -> Option<Self> {
        let mut moved = self.clone();
        let brdf = &mut moved.reflectance.brdf;
        match parameter {
            Parameter::ImageWidth => match &mut moved.light {
                Light::Projector { image, .. } | Light::Beam { image, .. } => {
                    let share = value / image.width[0];
                    image.width = image.width.map(|w| w * share);
                }
                _ => return None,
            },
            Parameter::Albedo => brdf.albedo = value,
            Parameter::Lobe => *brdf = reshaped(brdf, value)?,
            Parameter::Curvature(axis) => {
                let old = self.patch.curvature[axis];
                for k in &mut moved.patch.curvature {
                    if (*k - old).abs() <= 1e-12 * old.abs() {
                        *k = value;
                    }
                }
            }
        }
        Some(moved)
    }
}

/// The BRDF with another exponent or roughness.
fn reshaped(brdf: &Brdf, value: f64) -> Option<Brdf> {
    let lobe = match brdf.lobe {
        Lobe::Lambertian => return None,
        Lobe::Phong { .. } => Lobe::Phong { exponent: value },
        Lobe::Beckmann { .. } => Lobe::Beckmann { roughness: value },
        Lobe::Ggx { .. } => Lobe::Ggx { roughness: value },
    };
    Some(Brdf { lobe, ..*brdf })
}
