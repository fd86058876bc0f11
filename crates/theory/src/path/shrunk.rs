//! Systems with smaller lights, textures and lobes, in which first-order maps are more accurate.

use super::{Interaction, PathSystem};
use etendue_field::{LightValues, Pattern, Reflectance, Weight};

impl PathSystem {
    /// The system with a light, textures and, unless `keeps_lobes`, lobes `factor` times as
    /// wide. A Lambertian lobe has no width and stays as it is. Returns `None` if a lobe stays as it
    /// is and the light that it receives does not become narrower, which is so for an environment
    /// and between several surfaces.
    ///
    /// If windows become narrower and frequencies higher by the same factor, the error of
    /// first-order maps falls with the factor.
    #[must_use]
    pub fn shrunk(&self, factor: f64, keeps_lobes: bool) -> Option<Self> {
        let is_lit_narrowly = self.visited == 1 && self.light.environment().is_none();
        let mut system = self.clone();
        let LightValues { shape, image, .. } = system.light.values();
        if let Some(shape) = shape {
            *shape = shape.mapped(factor, [0.0; 2]);
        }
        if let Some(image) = image {
            image.width = image.width.map(|w| w * factor);
            if let Some(grating) = &mut image.grating {
                grating.frequency /= factor;
            }
        }
        for surface in &mut system.surfaces[..self.visited] {
            match &mut surface.interaction {
                Interaction::Specular(_) => {}
                Interaction::Diffuse { .. } if is_lit_narrowly => {}
                Interaction::Diffuse { .. } => return None,
                Interaction::Reflects(reflectance) => {
                    let lobes = if keeps_lobes { 1.0 } else { factor };
                    let have_width = shrink(reflectance, factor, lobes);
                    if (keeps_lobes || !have_width) && !is_lit_narrowly {
                        return None;
                    }
                }
            }
        }
        Some(system)
    }
}

/// Makes the patterns of a reflectance `factor` times as wide, and its lobes `lobes` times as wide.
/// Returns whether all lobes have a width.
fn shrink(reflectance: &mut Reflectance, factor: f64, lobes: f64) -> bool {
    let Reflectance { terms, texture } = reflectance;
    let mut have_width = true;
    for term in &mut *terms {
        match term.brdf.lobe.number_mut() {
            Some(("exponent", exponent)) => *exponent /= lobes * lobes,
            Some((_, roughness)) => *roughness *= lobes,
            None => have_width = false,
        }
    }
    let weights = terms.iter_mut().filter_map(|term| match &mut term.weight {
        Weight::One => None,
        Weight::Pattern(pattern) | Weight::Rest(pattern) => Some(pattern),
    });
    for pattern in weights.chain(texture) {
        match pattern {
            Pattern::Cosine(grating) => grating.frequency /= factor,
            Pattern::Checkerboard { period } => *period *= factor,
            Pattern::Picture(picture) => picture.size = picture.size.map(|side| side * factor),
        }
    }
    have_width
}
