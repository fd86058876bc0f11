//! Materials of glTF files under an even sky, against the formula of the specification.

use crate::known::seen;
use crate::masks::{gltf, read};
use etendue_world::Light;
use glam::DVec3;
use std::f64::consts::PI;

/// A material as glTF 2.0, Appendix B, defines it.
#[derive(Clone, Copy, Debug)]
struct Formula {
    color: f64,
    metallic: f64,
    roughness: f64,
    /// `dielectric_f0` and `dielectric_f90`.
    coat: [f64; 2],
}

impl Formula {
    /// The diffuse part of the BRDF, and the factor on its specular part.
    fn parts(&self, view_half: f64) -> [f64; 2] {
        let schlick = (1.0 - view_half.abs()).powi(5);
        let metal = self.color + (1.0 - self.color) * schlick;
        let coat = self.coat[0] + (self.coat[1] - self.coat[0]) * schlick;
        let diffuse = (1.0 - self.metallic) * (1.0 - coat) * self.color / PI;
        let specular = (1.0 - self.metallic) * coat + self.metallic * metal;
        [diffuse, specular]
    }

    /// D V, the specular BRDF of Appendix B.3.
    fn specular(&self, light: DVec3, view: DVec3, half: DVec3) -> f64 {
        let squared = self.roughness.powi(4);
        let d = squared / (PI * (half.z * half.z * (squared - 1.0) + 1.0).powi(2));
        let v = |of: DVec3| of.z + (squared + (1.0 - squared) * of.z * of.z).sqrt();
        d / (v(light) * v(view))
    }

    /// The radiance towards a direction under a sky of radiance 1, by the midpoint rule.
    /// The radiance is even in the azimuth, so half of the azimuths suffice.
    fn radiance(&self, view: DVec3) -> f64 {
        const STEPS: u32 = 1000;
        let step = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        let is_smooth = self.roughness <= 0.0;
        let mut sum = if is_smooth {
            self.parts(view.z)[1]
        } else {
            0.0
        };
        for i in 0..STEPS {
            let inclination = 0.5 * PI * step(i);
            let (sin, cos) = inclination.sin_cos();
            let weight = PI * PI / f64::from(STEPS).powi(2) * sin * cos;
            for k in 0..STEPS {
                let azimuth = PI * step(k);
                let light = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
                let half = (light + view).normalize();
                let [diffuse, factor] = self.parts(view.dot(half));
                let specular = match is_smooth {
                    true => 0.0,
                    false => factor * self.specular(light, view, half),
                };
                sum += weight * (diffuse + specular);
            }
        }
        sum
    }
}

/// The radiance of a material in direction `view` under a sky of radiance 1, with its
/// standard error.
fn furnace(material: &str, view: DVec3) -> (f64, f64) {
    let mut world = read("a.gltf", &gltf([material, "{}"]));
    world.shapes.truncate(1);
    world.lights = vec![Light::Constant { radiance: 1.0 }];
    seen(&world, 2.0 * view, DVec3::ZERO, 100_000)
}

#[test]
fn gltf_materials_in_a_furnace_have_the_radiance_of_the_specification() {
    let plain = [0.04, 1.0];
    // The index 1.8 reflects (0.8/2.8)² at normal incidence.
    let extended = [0.5 * (0.8_f64 / 2.8).powi(2), 0.5];
    let extensions = r#","extensions":{"KHR_materials_ior":{"ior":1.8},"KHR_materials_specular":{"specularFactor":0.5}}"#;
    for roughness in [0.0, 0.25, 0.5, 0.75, 1.0] {
        for (color, metallic, coat, more) in [
            (1.0, 0.0, plain, ""),
            (0.5, 0.3, plain, ""),
            (0.5, 1.0, plain, ""),
            (0.8, 0.0, extended, extensions),
        ] {
            let formula = Formula {
                color,
                metallic,
                roughness,
                coat,
            };
            let material = format!(
                r#"{{"pbrMetallicRoughness":{{"baseColorFactor":[{color},{color},{color},1],
"metallicFactor":{metallic},"roughnessFactor":{roughness}}}{more}}}"#
            );
            for cosine in [1.0_f64, 0.6, 0.2] {
                let view = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                let expected = formula.radiance(view);
                let (mean, error) = furnace(&material, view);
                let place = format!("{formula:?} at {cosine}: {mean} ± {error}, not {expected}");
                // The rounding of 32-bit factors, and the error of the quadrature.
                let rounding = 2e-5;
                assert!((mean - expected).abs() < 5.0 * error + rounding, "{place}");
                assert!(error < 0.005, "too little to tell: {place}");
            }
        }
    }
}

#[test]
fn the_quadrature_knows_closed_forms() {
    let white = Formula {
        color: 1.0,
        metallic: 0.0,
        roughness: 1.0,
        coat: [0.0; 2],
    };
    let mirror = Formula {
        metallic: 1.0,
        roughness: 0.0,
        ..white
    };
    for formula in [white, mirror] {
        let radiance = formula.radiance(DVec3::new(0.8, 0.0, 0.6));
        assert!((radiance - 1.0).abs() < 1e-6, "{radiance}"); // the error of 1,000 steps
    }
}
