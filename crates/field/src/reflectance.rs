use crate::{Grating, Raster};
use serde::{Serialize, Serializer};
use std::mem::discriminant;
use std::sync::Arc;

/// How a surface reflects light: a BRDF that may vary over it.
///
/// Places are given by (s, t), the coordinates along X and Y of the surface's [`Patch`](crate::Patch), in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reflectance {
    /// The BRDF, where nothing varies it.
    pub brdf: Brdf,
    /// What varies it: another BRDF and how they are blended.
    pub blend: Option<(Brdf, Pattern)>,
    /// What multiplies it.
    pub texture: Option<Pattern>,
}

/// A bidirectional reflectance distribution function, sr⁻¹.
///
/// With ωi and ωo the directions of light, both away from the surface, θi and θo their angles to the normal n, r the mirror
/// direction of ωi, α the angle between r and ωo, and h the unit vector half-way between ωi and ωo:
///
/// | lobe | BRDF |
/// |---|---|
/// | Lambertian | albedo / π · F(θi) |
/// | Phong | albedo · (n + 1)/(2π) · max(0, cos α)ⁿ · F(θi): its integral over dωo is the albedo (Phong 1975) |
/// | Beckmann, GGX | albedo · D(h) G₁(ωi) G₁(ωo) F(h·ωi) / (4 cos θi cos θo) (Walter et al. 2007, Eq. 20) |
///
/// D and Smith's G₁ are those of Walter et al. 2007, Eqs. 25–27 and 33–34, exact for Beckmann. Zero unless both cosines are positive.
/// A Fresnel factor of the angle of incidence makes Lambertian and Phong not reciprocal; all else is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Brdf {
    /// Its lobe.
    pub lobe: Lobe,
    /// Factor on it, 0 to 1.
    pub albedo: f64,
    /// Its Fresnel factor F.
    pub fresnel: Fresnel,
}

/// The lobe of a BRDF.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Lobe {
    /// Alike in all directions.
    Lambertian,
    /// A power of the cosine of the angle to the mirror direction.
    Phong {
        /// n.
        exponent: f64,
    },
    /// Microfacets with Beckmann's distribution of normals.
    Beckmann {
        /// α: √2 times the root mean square slope along an axis.
        roughness: f64,
    },
    /// Microfacets with the GGX distribution (Trowbridge and Reitz 1975, Walter et al. 2007).
    Ggx {
        /// α.
        roughness: f64,
    },
}

impl Lobe {
    /// Whether it is about the mirror direction; else about the normal.
    #[must_use]
    pub fn is_about_mirror(&self) -> bool {
        !matches!(self, Self::Lambertian)
    }

    /// The number it has, and what that is called.
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

/// The share of light that is reflected, unpolarised, as it depends on the angle of incidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Fresnel {
    /// All of it.
    White,
    /// At a dielectric.
    Dielectric {
        /// Index of refraction, relative to the medium that light comes from.
        index: f64,
    },
    /// At a conductor with index n + i k.
    Conductor {
        /// n.
        n: f64,
        /// k.
        k: f64,
    },
}

/// A number from 0 to 1 at each place of a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Pattern {
    /// ½ (1 + m cos(2π f t + p)) along an axis.
    Cosine(Grating),
    /// 1 and 0 by turns on squares with edges along both axes, 1 on the first beyond the vertex along both.
    Checkerboard {
        /// Two sides of a square, in metres.
        period: f64,
    },
    /// A picture around the vertex.
    Picture(Picture),
}

/// A picture on a surface: bilinear between the centres of pixels, as at the nearest centre from there to the edge, 0 beyond its edge.
///
/// Seen from where the surface faces with X to the right and Y up, it is the right way round: the first pixel is at the top left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// Its width along X and its height along Y, in metres.
    pub size: [f64; 2],
    /// Numbers from 0 to 1.
    #[serde(serialize_with = "shared")]
    pub pixels: Arc<Raster>,
}

fn shared<S: Serializer>(pixels: &Arc<Raster>, serializer: S) -> Result<S::Ok, S::Error> {
    pixels.as_ref().serialize(serializer)
}

impl Picture {
    /// Its value at (s, t).
    #[inline]
    #[must_use]
    pub fn value(&self, s: f64, t: f64) -> f64 {
        let [across, down] = [0.5 + s / self.size[0], 0.5 - t / self.size[1]];
        if !(0.0..=1.0).contains(&across) || !(0.0..=1.0).contains(&down) {
            return 0.0;
        }
        let [w, h] = [self.pixels.width() as f64, self.pixels.height() as f64];
        self.pixels.value(w * across, h * down, false)
    }
}

impl Pattern {
    /// Its value at (s, t).
    #[inline]
    #[must_use]
    pub fn value(&self, s: f64, t: f64) -> f64 {
        match self {
            Self::Cosine(grating) => grating.transmittance(s, t),
            Self::Checkerboard { period } => {
                let is_low = |x: f64| (x / period).rem_euclid(1.0) < 0.5;
                if is_low(s) == is_low(t) { 1.0 } else { 0.0 }
            }
            Self::Picture(picture) => picture.value(s, t),
        }
    }
}

impl Reflectance {
    /// The BRDF at (s, t).
    ///
    /// Where two are blended, albedo, Fresnel indices, exponent and roughness are those between them; of lobes or Fresnel factors of different
    /// kinds, one or the other.
    #[inline]
    #[must_use]
    pub fn at(&self, s: f64, t: f64) -> Brdf {
        let mut brdf = match &self.blend {
            None => self.brdf,
            Some((other, pattern)) => other.towards(&self.brdf, pattern.value(s, t)),
        };
        if let Some(texture) = &self.texture {
            brdf.albedo *= texture.value(s, t);
        }
        brdf
    }

    /// Whether it is the same everywhere.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.blend.is_none() && self.texture.is_none()
    }
}

impl Brdf {
    /// The BRDF a share of the way to another.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + share * (b - a);
        let nearer = if share < 0.5 { self } else { other };
        let [mut lobe, mut a, mut b] = [nearer, self, other].map(|brdf| brdf.lobe);
        if discriminant(&a) == discriminant(&b)
            && let [Some((_, mixed)), Some((_, a)), Some((_, b))] =
                [&mut lobe, &mut a, &mut b].map(Lobe::number_mut)
        {
            *mixed = between(*a, *b);
        }
        let fresnel = match (self.fresnel, other.fresnel) {
            (Fresnel::Dielectric { index: a }, Fresnel::Dielectric { index: b }) => {
                Fresnel::Dielectric {
                    index: between(a, b),
                }
            }
            (Fresnel::Conductor { n: a, k: c }, Fresnel::Conductor { n: b, k: d }) => {
                Fresnel::Conductor {
                    n: between(a, b),
                    k: between(c, d),
                }
            }
            _ => nearer.fresnel,
        };
        Self {
            lobe,
            albedo: between(self.albedo, other.albedo),
            fresnel,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_the_right_way_round() {
        let pixels = Raster::new(2, 2, vec![0.1, 0.2, 0.3, 0.4]).unwrap();
        let size = [0.4, 0.2];
        let pattern = Pattern::Picture(Picture {
            size,
            pixels: Arc::new(pixels),
        });
        for (s, t, expected) in [
            (-0.19, 0.09, 0.1),
            (0.1, 0.05, 0.2),
            (-0.1, -0.05, 0.3),
            (0.2, -0.1, 0.4),
            (0.0, 0.0, 0.25),
            (0.21, 0.0, 0.0),
            (0.0, -0.11, 0.0),
        ] {
            // Rounding.
            assert!((pattern.value(s, t) - expected).abs() < 1e-15, "({s}, {t})");
        }
    }

    #[test]
    fn patterns_blend_parameters() {
        let ggx = |roughness, albedo| Brdf {
            lobe: Lobe::Ggx { roughness },
            albedo,
            fresnel: Fresnel::White,
        };
        let half = Pattern::Cosine(Grating {
            axis: 0,
            frequency: 1.0,
            modulation: 0.0,
            phase: 0.0,
        });
        let board = Pattern::Checkerboard { period: 0.2 };
        let mixed = Reflectance {
            brdf: ggx(0.2, 1.0),
            blend: Some((ggx(0.4, 0.5), half)),
            texture: Some(board.clone()),
        };
        assert_eq!(mixed.at(0.05, 0.05), ggx(0.300_000_000_000_000_04, 0.75));
        assert_eq!(mixed.at(0.05, -0.05), ggx(0.300_000_000_000_000_04, 0.0));
        let phong = Brdf {
            lobe: Lobe::Phong { exponent: 10.0 },
            ..ggx(0.0, 1.0)
        };
        let picked = Reflectance {
            brdf: phong,
            blend: Some((ggx(0.4, 0.5), board)),
            texture: None,
        };
        assert_eq!(picked.at(-0.15, 0.05).lobe, phong.lobe);
        assert_eq!(picked.at(0.15, 0.05), ggx(0.4, 0.5));
    }
}
