//! BRDFs at one point of a surface.

use serde::{Serialize, Serializer};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// A bidirectional reflectance distribution function, sr⁻¹.
///
/// In the table, ωi and ωo are the directions of light, both away from the surface, and θi and θo
/// are their angles to the normal n. The mirror direction of ωi is r, and α is the angle between r
/// and ωo. The half vector of ωi and ωo is h.
///
/// | lobe | BRDF |
/// |---|---|
/// | Lambertian | albedo / π · F(θi) |
/// | Phong | albedo · (n + 1)/(2π) · max(0, cos α)ⁿ · F(θi); if F = 1, the integral over dωo is the albedo (Phong 1975) |
/// | Beckmann, GGX | albedo · D(h) G₁(ωi) G₁(ωo) F(h·ωi) / (4 cos θi cos θo) (Walter et al. 2007, Eq. 20) |
///
/// D and Smith's G₁ are given by Walter et al. 2007, Eqs. 25–27 and 33–34. For Beckmann, G₁ is the
/// exact function. The BRDF is zero if one of the two cosines is zero or negative. If the BRDF has
/// the factors f or h, they multiply the lobe by f(θi) or h(θo) (Durand et al. 2005, section 4.3).
/// A BRDF is not reciprocal if its Fresnel factor depends on θi, or if f and h differ. All other
/// BRDFs are reciprocal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Brdf {
    /// The lobe.
    pub lobe: Lobe,
    /// The factor that multiplies the lobe, 0 to 1.
    pub albedo: f64,
    /// The Fresnel factor F.
    pub fresnel: Fresnel,
    /// The factor f, which depends on the angle of incidence. `None` stands for f = 1.
    pub incoming: Option<AngleTable>,
    /// The factor h, which depends on the angle at which light leaves. `None` stands for h = 1.
    pub outgoing: Option<AngleTable>,
}

impl Brdf {
    /// A lobe with an albedo and a Fresnel factor, and no other factors.
    #[must_use]
    pub fn new(lobe: Lobe, albedo: f64, fresnel: Fresnel) -> Self {
        Self {
            lobe,
            albedo,
            fresnel,
            incoming: None,
            outgoing: None,
        }
    }
}

/// A factor from 0 to 1 that depends on the angle to the normal. The table has values at equal
/// steps from 0 to 90°, and the factor is linear between them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AngleTable {
    /// There are at least two values. The first value is for the direction of the normal, and the
    /// last value is for directions along the surface.
    #[serde(serialize_with = "listed")]
    pub values: Arc<[f64]>,
}

fn listed<S: Serializer>(values: &Arc<[f64]>, serializer: S) -> Result<S::Ok, S::Error> {
    values.as_ref().serialize(serializer)
}

impl AngleTable {
    /// The factor at an angle. The cosine of this angle is given, and is from 0 to 1.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the number of a step"
    )]
    pub fn value(&self, cosine: f64) -> f64 {
        let last = self.values.len() - 1;
        let along = libm::acos(cosine.clamp(0.0, 1.0)) / FRAC_PI_2 * last as f64;
        let step = (along as usize).min(last - 1);
        let share = along - step as f64;
        self.values[step] + share * (self.values[step + 1] - self.values[step])
    }
}

/// The lobe of a BRDF.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Lobe {
    /// A lobe that is constant in all directions.
    Lambertian,
    /// A power of the cosine of the angle to the mirror direction.
    Phong {
        /// Exponent n.
        exponent: f64,
    },
    /// Microfacets with Beckmann's distribution of normals.
    Beckmann {
        /// Roughness α: √2 times the root mean square slope along an axis.
        roughness: f64,
    },
    /// Microfacets with the GGX distribution (Trowbridge and Reitz 1975, Walter et al. 2007).
    Ggx {
        /// Roughness α.
        roughness: f64,
    },
}

impl Lobe {
    /// Checks whether the lobe is centred on the mirror direction. If it is not, it is centred on
    /// the normal.
    #[must_use]
    pub fn is_about_mirror(&self) -> bool {
        match self {
            Self::Lambertian => false,
            Self::Phong { .. } | Self::Beckmann { .. } | Self::Ggx { .. } => true,
        }
    }

    /// The name of the lobe.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Lambertian => "Lambertian",
            Self::Phong { .. } => "Phong",
            Self::Beckmann { .. } => "Beckmann",
            Self::Ggx { .. } => "GGX",
        }
    }

    /// The lobe's parameter and the name of the parameter.
    #[must_use]
    pub fn number_mut(&mut self) -> Option<(&'static str, &mut f64)> {
        match self {
            Self::Lambertian => None,
            Self::Phong { exponent } => Some(("exponent", exponent)),
            Self::Beckmann { roughness } | Self::Ggx { roughness } => {
                Some(("roughness", roughness))
            }
        }
    }
}

/// A distribution of the normals of microfacets (Walter et al. 2007).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MicrofacetDistribution {
    /// Gaussian distribution of slopes.
    Beckmann,
    /// GGX distribution, which has longer tails (Trowbridge and Reitz 1975).
    Ggx,
}

impl MicrofacetDistribution {
    /// The lobe of microfacets with this distribution and roughness.
    #[must_use]
    pub fn lobe(self, roughness: f64) -> Lobe {
        match self {
            Self::Beckmann => Lobe::Beckmann { roughness },
            Self::Ggx => Lobe::Ggx { roughness },
        }
    }
}

/// The share of unpolarised light that is reflected, as a function of the angle of incidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Fresnel {
    /// All light is reflected.
    White,
    /// Reflection at a dielectric.
    Dielectric {
        /// Index of refraction, relative to the medium of the incident light.
        index: f64,
    },
    /// Reflection at a conductor with index n + i k.
    Conductor {
        /// Real part n of the index.
        n: f64,
        /// Imaginary part k of the index.
        k: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_linear_between_their_values() {
        let table = AngleTable {
            values: Arc::new([1.0, 0.5, 0.1, 0.7]),
        };
        for (degrees, expected) in [
            (0.0_f64, 1.0),
            (15.0, 0.75),
            (30.0, 0.5),
            (50.0, 0.5 - 0.4 * 2.0 / 3.0),
            (75.0, 0.4),
            (90.0, 0.7),
        ] {
            let value = table.value(libm::cos(degrees.to_radians()));
            // At 0.26 rad, the angle from the cosine has an error of 10⁻¹⁵.
            assert!((value - expected).abs() < 1e-14, "{degrees}: {value}");
        }
    }
}
