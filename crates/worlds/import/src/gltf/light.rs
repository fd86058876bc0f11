//! Converts lights of `KHR_lights_punctual`.

use super::node::PlacedNode;
use super::reader::GltfReader;
use crate::range::{MAX_NUMBER, MAX_SHAPES};
use ::gltf::json::extensions::scene::khr_lights_punctual::{Light as Punctual, Spot, Type};
use ::gltf::json::validation::Checked;
use etendue_world::{Falloff, Light};
use std::f64::consts::FRAC_PI_2;

impl<'a> GltfReader<'a> {
    pub(super) fn light_of(&mut self, placed: &PlacedNode<'a>, number: usize) {
        let path = format!("extensions.KHR_lights_punctual.lights[{number}]");
        let extensions = self.root.extensions.as_ref();
        let lights = extensions.and_then(|of| of.khr_lights_punctual.as_ref());
        let Some(light) = lights.and_then(|of| of.lights.get(number)) else {
            return self.cause(&placed.path, "an unknown light");
        };
        if self.world.lights.len() >= MAX_SHAPES {
            return self.cause(&placed.path, format!("more than {MAX_SHAPES} lights"));
        }
        if light.range.is_some() {
            let message = "left out: lights have no maximum range here";
            self.note(&format!("{path}.range"), message);
        }
        if let Some(light) = self.light(light, placed, &path) {
            self.world.lights.push(light);
            self.note_units();
        }
    }

    fn light(&mut self, light: &Punctual, placed: &PlacedNode<'a>, path: &str) -> Option<Light> {
        let most = [0.0, MAX_NUMBER];
        let strength = self.within(&format!("{path}.intensity"), light.intensity, most)?;
        for value in light.color {
            self.within(&format!("{path}.color"), value, most)?;
        }
        let strength = strength * self.color.of(light.color.map(f64::from));
        let Checked::Valid(kind) = light.type_ else {
            return None;
        };
        let looking = placed.looking();
        if looking.is_none() && kind != Type::Point {
            self.cause(&placed.path, "scales the light of this node to size 0");
        }
        match kind {
            Type::Point => Some(Light::Point {
                position: placed.to_world.translation,
                intensity: strength,
            }),
            Type::Directional => Some(Light::Directional {
                direction: looking?.matrix3.z_axis,
                irradiance: strength,
            }),
            Type::Spot => {
                let [beam, cutoff] = self.cone(light.spot.as_ref()?, &format!("{path}.spot"))?;
                Some(Light::Spot {
                    to_world: looking?,
                    intensity: strength,
                    beam,
                    cutoff,
                    falloff: Falloff::SquaredCosine,
                    picture: None,
                })
            }
        }
    }

    /// The half-angles of the inner and the outer cone of a spot light.
    fn cone(&self, spot: &Spot, path: &str) -> Option<[f64; 2]> {
        let [inner, outer] = [spot.inner_cone_angle, spot.outer_cone_angle].map(f64::from);
        // The tolerance is needed because π/2 rounded to 32 bits is slightly larger than π/2.
        let fits = 0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-6;
        if !fits {
            let message = format!(
                "the inner and outer cone angles are {inner} and {outer}; allowed: 0 <= inner < outer <= π/2"
            );
            self.cause(path, message);
        }
        fits.then_some([inner, outer.min(FRAC_PI_2)])
    }
}
