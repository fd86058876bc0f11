//! BRDFs and interfaces of surfaces, as Mitsuba's BSDFs.

use super::texture::VariedTexture;
use super::xml::{black, spectrum};
use super::{NotInMitsuba, Writer};
use etendue_field::{Brdf, Fresnel, Lobe, Pattern, Picture, Reflectance, Specular, Term, Weight};

impl Writer {
    /// The BSDF of a mirror or an interface.
    pub(super) fn specular(event: &Specular, name: &str) -> Result<String, NotInMitsuba> {
        match *event {
            Specular::Mirror => Ok(format!(
                "<bsdf type=\"twosided\"><bsdf type=\"conductor\">{NO_METAL}</bsdf></bsdf>"
            )),
            // Normals point to the front, which is the outside in Mitsuba.
            Specular::Refraction { front, back } => Ok(format!(
                "<bsdf type=\"dielectric\">{}{}</bsdf>",
                float("int_ior", back),
                float("ext_ior", front)
            )),
            Specular::ThinLens { .. } => Err(NotInMitsuba::ThinLens {
                name: name.to_owned(),
            }),
        }
    }

    /// Writes a BRDF that may vary over the part of a surface within `aperture` of its vertex. All
    /// BRDFs are black on the back.
    pub(super) fn reflects(
        &mut self,
        reflectance: &Reflectance,
        aperture: f64,
        name: &str,
    ) -> Result<String, NotInMitsuba> {
        let name = || name.to_owned();
        let has_table = |term: &Term| term.brdf.incoming.is_some() || term.brdf.outgoing.is_some();
        if reflectance.terms.iter().any(has_table) {
            return Err(NotInMitsuba::AngleTable { name: name() });
        }
        let texture = reflectance.texture.as_ref();
        let textured = |brdf: &Brdf| VariedTexture {
            pattern: texture,
            range: [0.0, brdf.albedo],
        };
        let looks = match &reflectance.terms[..] {
            [one] if one.weight == Weight::One => self.brdf(&one.brdf, textured(&one.brdf)),
            [one, zero] => match (&one.weight, &zero.weight) {
                (Weight::Pattern(pattern), Weight::Rest(rest)) if pattern == rest => {
                    let weight = VariedTexture {
                        pattern: Some(pattern),
                        range: [0.0, 1.0],
                    };
                    let weight = self.varied("weight", &weight);
                    let [zero, one] =
                        [zero, one].map(|term| self.brdf(&term.brdf, textured(&term.brdf)));
                    let both = blended(&weight, &zero, &one);
                    self.inside(pattern, aperture, &zero, both)
                }
                _ => return Err(NotInMitsuba::Sum { name: name() }),
            },
            _ => return Err(NotInMitsuba::Sum { name: name() }),
        };
        Ok(match texture {
            Some(texture) => self.inside(texture, aperture, &black(), looks),
            None => looks,
        })
    }

    /// Writes `inside` where a picture is, and `outside` beyond its edge. Mitsuba itself can only
    /// continue a picture beyond its edge.
    fn inside(
        &mut self,
        pattern: &Pattern,
        aperture: f64,
        outside: &str,
        inside: String,
    ) -> String {
        match pattern {
            Pattern::Picture(picture) if !covers(picture, aperture) => {
                let weight = self.within("weight", picture);
                blended(&weight, outside, &inside)
            }
            _ => inside,
        }
    }

    fn brdf(&mut self, brdf: &Brdf, albedo: VariedTexture<'_>) -> String {
        match brdf.lobe {
            Lobe::Lambertian => {
                let albedo = self.varied("reflectance", &albedo);
                factored(
                    &brdf.fresnel,
                    format!("<bsdf type=\"diffuse\">{albedo}</bsdf>"),
                )
            }
            // `tests/peers/etendue_bsdfs.py` adds this plugin of Mitsuba 0.6 to Mitsuba 3. The
            // lobe of this plugin is (n + 2)/2π cosⁿ, and Étendue's lobe is (n + 1)/2π cosⁿ.
            Lobe::Phong { exponent } => {
                let share = (exponent + 1.0) / (exponent + 2.0);
                let albedo = self.varied("specular_reflectance", &albedo.times(share));
                let lobe = format!(
                    "<bsdf type=\"phong\">{}{}{albedo}</bsdf>",
                    float("exponent", exponent),
                    spectrum("diffuse_reflectance", 0.0),
                );
                factored(&brdf.fresnel, lobe)
            }
            Lobe::Beckmann { roughness } => self.rough("beckmann", roughness, brdf, &albedo),
            Lobe::Ggx { roughness } => self.rough("ggx", roughness, brdf, &albedo),
        }
    }

    fn rough(
        &mut self,
        distribution: &str,
        roughness: f64,
        brdf: &Brdf,
        albedo: &VariedTexture<'_>,
    ) -> String {
        let metal = match index(&brdf.fresnel) {
            None => NO_METAL.to_owned(),
            Some([n, k]) => [spectrum("eta", n), spectrum("k", k)].concat(),
        };
        format!(
            "<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"{distribution}\"/>{}{metal}{}</bsdf>",
            float("alpha", roughness),
            self.varied("specular_reflectance", albedo),
        )
    }
}

/// A perfect reflector.
const NO_METAL: &str = "<string name=\"material\" value=\"none\"/>";

/// The index of refraction n and the index of absorption k. A dielectric becomes a metal
/// without absorption, which reflects in the same way.
fn index(fresnel: &Fresnel) -> Option<[f64; 2]> {
    match *fresnel {
        Fresnel::White => None,
        Fresnel::Dielectric { index } => Some([index, 0.0]),
        Fresnel::Conductor { n, k } => Some([n, k]),
    }
}

/// Writes a lobe times the Fresnel factor of the angle of incidence. Mitsuba has no plugin for this
/// product. `tests/peers/etendue_bsdfs.py` adds a plugin, without which the scene does not load.
fn factored(fresnel: &Fresnel, lobe: String) -> String {
    match index(fresnel) {
        None => lobe,
        Some([n, k]) => format!(
            "<bsdf type=\"etendue_fresnel\">{}{}{lobe}</bsdf>",
            float("n", n),
            float("k", k)
        ),
    }
}

fn blended(weight: &str, zero: &str, one: &str) -> String {
    format!("<bsdf type=\"blendbsdf\">{weight}{zero}{one}</bsdf>")
}

/// Checks whether a picture covers a circle of this radius around its centre.
fn covers(picture: &Picture, radius: f64) -> bool {
    picture.size.iter().all(|side| 0.5 * side >= radius)
}

fn float(name: &str, value: f64) -> String {
    format!("<float name=\"{name}\" value=\"{value:?}\"/>")
}
