//! Checks three properties of each material. The value divided by the density equals the weight of
//! a sample. The density integrates to one minus the absorbed part. The mean weight equals the
//! integral of the value.

use super::*;
use etendue_transform::random::{Stream, unit, words};
use etendue_world::MicrofacetDistribution::{self, Beckmann, Ggx};
use etendue_world::{Conductor, Dielectric, Plastic, Principled};
use std::f64::consts::PI;

fn constant(value: f64) -> Texture {
    Texture::Constant(value)
}

fn rough(distribution: MicrofacetDistribution, alpha: [f64; 2]) -> Option<Roughness> {
    Some(Roughness {
        distribution,
        alpha: alpha.map(constant),
    })
}

fn glass(index: f64, roughness: Option<Roughness>) -> Material {
    let [reflectance, transmittance] = [constant(1.0), constant(1.0)];
    Material::Dielectric(Dielectric {
        index,
        reflectance,
        transmittance,
        roughness,
        is_thin: false,
    })
}

#[expect(clippy::too_many_lines, reason = "a test may be a list of cases")]
fn materials() -> Vec<(&'static str, Material)> {
    let metal = |roughness| {
        Material::Conductor(Conductor {
            index: Some([0.2, 3.9]),
            reflectance: constant(0.9),
            roughness,
        })
    };
    let plastic = |roughness| {
        Material::Plastic(Plastic {
            index: 1.5,
            diffuse: constant(0.4),
            specular: constant(0.8),
            is_nonlinear: true,
            roughness,
        })
    };
    let diffuse = || Material::diffuse(0.7);
    let black = Material::Plastic(Plastic {
        index: 1.5,
        diffuse: constant(0.0),
        specular: constant(0.0),
        is_nonlinear: false,
        roughness: None,
    });
    vec![
        ("diffuse", diffuse()),
        (
            "diffuse transmission",
            Material::DiffuseTransmission {
                reflectance: constant(0.2),
                transmittance: constant(0.5),
            },
        ),
        ("ggx", metal(rough(Ggx, [0.3, 0.1]))),
        ("beckmann", metal(rough(Beckmann, [0.2, 0.4]))),
        ("glass", glass(1.5, rough(Ggx, [0.3, 0.3]))),
        ("rough glass", glass(1.3, rough(Beckmann, [0.5, 0.2]))),
        ("plastic", plastic(rough(Ggx, [0.2, 0.2]))),
        ("smooth plastic", plastic(None)),
        (
            "phong",
            Material::Phong {
                diffuse: constant(0.3),
                specular: constant(0.5),
                exponent: constant(20.0),
            },
        ),
        ("principled", principled(0.3, 0.0)),
        ("transmitting principled", principled(0.1, 0.7)),
        (
            "two sides",
            Material::TwoSided(Box::new([diffuse(), metal(rough(Ggx, [0.3, 0.3]))])),
        ),
        (
            "blend",
            Material::Blend {
                weight: constant(0.3),
                of: Box::new([diffuse(), glass(1.5, rough(Ggx, [0.4, 0.4]))]),
            },
        ),
        // If the black material samples a direction, this direction carries light that the other
        // material scatters.
        (
            "half black",
            Material::Blend {
                weight: constant(0.5),
                of: Box::new([diffuse(), black]),
            },
        ),
        (
            "mask",
            Material::Mask {
                opacity: constant(0.4),
                of: Box::new(diffuse()),
            },
        ),
    ]
}

fn principled(metallic: f64, transmission: f64) -> Material {
    Material::Principled(Box::new(Principled {
        color: constant(0.6),
        metallic: constant(metallic),
        transmission: constant(transmission),
        roughness: constant(0.5),
        anisotropic: constant(0.8),
        index: 1.5,
        tint: constant(0.5),
        flatness: constant(0.3),
        sheen: constant(0.2),
        clearcoat: constant(0.8),
        gloss: constant(0.3),
    }))
}

fn numbers(i: u32) -> [f64; 3] {
    let [a, b, c, _] = words(7, Stream::Backward, u64::from(i), 0).map(unit);
    [a, b, c]
}

fn directions() -> [DVec3; 3] {
    [(0.3, 0.2, 1.0), (-0.9, 0.5, 0.4), (0.2, -0.6, -0.8)]
        .map(|(x, y, z)| DVec3::new(x, y, z).normalize())
}

/// A uniform direction over the whole sphere.
fn anywhere([a, b, _]: [f64; 3]) -> DVec3 {
    let (z, (sin, cos)) = (2.0 * a - 1.0, libm::sincos(2.0 * PI * b));
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

#[test]
fn samples_follow_value_and_density() {
    const COUNT: u32 = 400_000;
    for (name, material) in materials() {
        let scatter = Scatter::from(&material);
        for wo in directions() {
            let (mut sampled, mut shining, mut squares) = (0.0, 0.0, 0.0);
            let (mut plain, mut density) = (0.0, 0.0);
            for i in 0..COUNT {
                if let Some(bounce) = scatter.sample(&TexturePoint::default(), wo, numbers(i))
                    && let Some(of) = bounce.density
                {
                    assert!(
                        (scatter.density(&TexturePoint::default(), bounce.wi, wo) / of - 1.0).abs()
                            < 1e-9,
                        "{name}"
                    );
                    sampled += bounce.weight;
                    squares += bounce.weight.powi(2);
                    shining += 1.0;
                }
                let wi = anywhere(numbers(i));
                plain += scatter.value(&TexturePoint::default(), wi, wo) * 4.0 * PI;
                density += scatter.density(&TexturePoint::default(), wi, wo) * 4.0 * PI;
            }
            let count = f64::from(COUNT);
            let [sampled, plain, density, shining] =
                [sampled, plain, density, shining].map(|x| x / count);
            assert!(squares / count < 30.0, "{name}: weights are bounded");
            // The tolerance covers the noise of 4·10⁵ random numbers.
            assert!(
                (sampled - plain).abs() < 0.015 * (1.0 + plain),
                "{name} {wo}: {sampled} {plain}"
            );
            // Samples below the front, or from the coat, carry no light but are part of the
            // density.
            assert!(
                density < 1.015 && density > shining - 0.015,
                "{name} {wo}: {density} {shining}"
            );
        }
    }
}
