//! Furnace tests. Under a sky of radiance 1, a lossless surface is invisible, and no surface is
//! brighter than the sky.
//!
//! Sheets and opaque surfaces are tested on a disc, seen from its front and from its back, and on
//! an open cylinder, whose inside and outside are visible. Every material is tested on a cube and a
//! sphere, seen from outside. A material that transmits light is also tested on a sphere, seen from
//! inside.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_paths::{Paths, Picture};
use etendue_world::{
    Camera, Conductor, Dielectric, Geometry, Light, Material, MicrofacetDistribution, Plastic,
    Principled, Roughness, Shape, Texture, Triangles, World,
};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Pixels along a side of a picture.
const SIDE: usize = 24;
/// Paths per pixel.
const SAMPLES: u32 = 100;

fn constant(value: f64) -> Texture {
    Texture::Constant(value)
}

fn roughness(distribution: MicrofacetDistribution, alpha: [f64; 2]) -> Option<Roughness> {
    Some(Roughness {
        distribution,
        alpha: alpha.map(constant),
    })
}

fn glass(index: f64, is_thin: bool, roughness: Option<Roughness>) -> Material {
    Material::Dielectric(Dielectric {
        index,
        reflectance: constant(1.0),
        transmittance: constant(1.0),
        roughness,
        is_thin,
    })
}

fn metal(index: Option<[f64; 2]>, roughness: Option<Roughness>) -> Material {
    Material::Conductor(Conductor {
        index,
        reflectance: constant(1.0),
        roughness,
    })
}

fn plastic(roughness: Option<Roughness>, is_nonlinear: bool) -> Material {
    Material::Plastic(Plastic {
        index: 1.5,
        diffuse: constant(1.0),
        specular: constant(1.0),
        is_nonlinear,
        roughness,
    })
}

fn two_sided(of: Material) -> Material {
    of.on_both_sides()
}

fn white() -> Material {
    two_sided(Material::diffuse(1.0))
}

fn blend(first: Material, second: Material) -> Material {
    Material::Blend {
        weight: constant(0.3),
        of: Box::new([first, second]),
    }
}

fn mask(of: Material) -> Material {
    Material::Mask {
        opacity: constant(0.4),
        of: Box::new(of),
    }
}

/// The medium behind a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Behind {
    /// The same medium is in front of the surface and behind it.
    Same,
    /// A medium with this index. Radiance in the medium is larger by the square of the index.
    Medium(f64),
    /// No light is transmitted.
    Nothing,
}

/// Returns materials by name, each with the medium behind it, and whether it absorbs no light.
fn cases() -> Vec<(&'static str, Behind, Material, bool)> {
    use Behind::{Medium, Nothing, Same};
    let ggx = |alpha| roughness(MicrofacetDistribution::Ggx, [alpha, alpha]);
    let beckmann = || roughness(MicrofacetDistribution::Beckmann, [0.3, 0.15]);
    let mirror = || two_sided(metal(None, None));
    let phong = Material::Phong {
        diffuse: constant(0.4),
        specular: constant(0.6),
        exponent: constant(20.0),
    };
    let principled = |metallic, transmission| {
        Material::Principled(Box::new(Principled {
            color: constant(0.6),
            metallic: constant(metallic),
            transmission: constant(transmission),
            roughness: constant(0.5),
            anisotropic: constant(0.7),
            index: 1.5,
            tint: constant(0.5),
            flatness: constant(0.3),
            sheen: constant(0.2),
            clearcoat: constant(0.8),
            gloss: constant(0.3),
        }))
    };
    let translucent = Material::DiffuseTransmission {
        reflectance: constant(0.3),
        transmittance: constant(0.7),
    };
    let smooth = |index| glass(index, false, None);
    let thin = |index| glass(index, true, None);
    let (silver, inverse) = (Some([0.2, 3.9]), 1.0 / 1.5);
    let lossless = [
        ("glass", Medium(1.5), smooth(1.5)),
        ("bubble", Medium(inverse), smooth(inverse)),
        ("white and glass", Medium(1.5), blend(white(), smooth(1.5))),
        ("thin glass", Same, thin(1.5)),
        ("thin gap", Same, thin(0.75)),
        ("masked thin glass", Same, mask(thin(1.5))),
        ("masked white", Same, mask(white())),
        ("mirror and thin glass", Same, blend(mirror(), thin(1.5))),
        ("white", Nothing, white()),
        ("diffuse transmission", Same, translucent),
        ("mirror", Nothing, mirror()),
        ("plastic", Nothing, two_sided(plastic(None, true))),
        ("linear plastic", Nothing, two_sided(plastic(None, false))),
        ("white and mirror", Nothing, blend(white(), mirror())),
    ];
    let rough_bubble = glass(inverse, false, beckmann());
    let lossy = [
        ("rough glass", Medium(1.5), glass(1.5, false, ggx(0.2))),
        ("rough bubble", Medium(inverse), rough_bubble),
        ("rough mirror", Nothing, two_sided(metal(None, beckmann()))),
        ("rough metal", Nothing, two_sided(metal(silver, ggx(0.3)))),
        ("smooth metal", Nothing, two_sided(metal(silver, None))),
        ("rough plastic", Nothing, two_sided(plastic(ggx(0.2), true))),
        ("phong", Nothing, two_sided(phong)),
        ("principled", Nothing, two_sided(principled(0.4, 0.0))),
        ("transmitting principled", Medium(1.5), principled(0.1, 0.8)),
    ];
    let lossless = lossless.map(|(name, behind, of)| (name, behind, of, true));
    let lossy = lossy.map(|(name, behind, of)| (name, behind, of, false));
    lossless.into_iter().chain(lossy).collect()
}

/// A shape with a camera that looks at its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum View {
    DiscFront,
    DiscBack,
    Cylinder,
    Cube,
    SphereOutside,
    SphereInside,
}

impl View {
    /// The views in which radiance 1 must be seen.
    fn of(behind: Behind) -> &'static [Self] {
        let all = &[
            Self::SphereInside,
            Self::SphereOutside,
            Self::Cube,
            Self::DiscFront,
            Self::DiscBack,
            Self::Cylinder,
        ];
        match behind {
            Behind::Same => all,
            Behind::Nothing => &all[1..],
            // A material with different media on its two sides encloses a body. Total reflection
            // traps some light inside a denser body for ever.
            Behind::Medium(index) if index > 1.0 => &all[1..3],
            Behind::Medium(_) => &all[..3],
        }
    }

    fn picture(self, material: &Material) -> Picture {
        let (geometry, from, half_width) = match self {
            Self::DiscFront => (Geometry::Disc, DVec3::new(2.0, 0.5, 1.0), 0.5),
            Self::DiscBack => (Geometry::Disc, DVec3::new(2.0, 0.5, -1.0), 0.5),
            Self::Cylinder => (Geometry::Cylinder, DVec3::new(1.0, 1.5, 3.0), 0.5),
            Self::Cube => (cube(), DVec3::new(2.0, 3.0, 1.5), 0.5),
            // The view is as wide as the sphere, so the outer pixels show its rim.
            Self::SphereOutside => (Geometry::Sphere, DVec3::new(0.3, 2.0, 0.5), 0.58),
            Self::SphereInside => (Geometry::Sphere, DVec3::new(0.3, 0.5, 0.2), 1.0),
        };
        let world = World {
            shapes: vec![Shape::new(geometry, DAffine3::IDENTITY, 0)],
            materials: vec![material.clone()],
            lights: vec![Light::Constant { radiance: 1.0 }],
            ..World::default()
        };
        let points = [from, DVec3::ZERO, from.any_orthogonal_vector()];
        let camera = Camera::pinhole(points, half_width, [SIDE; 2], [1e-3, 1e6]);
        Paths::new(&world).picture(&camera.unwrap(), SAMPLES, 5, &|_| {})
    }
}

/// A cube from −1 to 1 with flat faces.
fn cube() -> Geometry {
    let sign = |i: usize, axis: usize| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
    let vertices = (0..8).map(|i| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
    let faces: [[u32; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let corners = faces.into_iter().flat_map(halves).collect();
    Geometry::Mesh(Arc::new(
        Triangles::new(vertices.collect(), corners, None, None).unwrap(),
    ))
}

/// The mean of some pixels, with its standard error.
fn mean(picture: &Picture, of: impl Fn(usize) -> bool) -> (f64, f64) {
    let pixels: Vec<usize> = (0..SIDE * SIDE).filter(|i| of(*i)).collect();
    let count = pixels.len() as f64;
    let sum: f64 = pixels.iter().map(|i| picture.mean[*i]).sum();
    let variance: f64 = pixels.iter().map(|i| picture.variance[*i]).sum();
    (sum / count, variance.sqrt() / count)
}

#[test]
fn no_surface_changes_the_energy_of_a_furnace() {
    for (name, behind, material, is_lossless) in cases() {
        for view in View::of(behind) {
            let picture = view.picture(&material);
            let expected = match (view, behind) {
                (View::SphereInside, Behind::Medium(index)) => index * index,
                _ => 1.0,
            };
            // Each row is tested alone, and then the whole picture is tested.
            for row in 0..=SIDE {
                let (mean, error) = mean(&picture, |i| row == SIDE || i / SIDE == row);
                let place = format!("{name} {view:?} row {row}: {mean} ± {error}");
                let bound = 5.0 * error + 1e-9; // 2,300 means are tested; all paths may find the same value up to rounding
                assert!(mean < expected + bound, "brighter than the sky: {place}");
                let is_kept = !is_lossless || mean > expected - bound;
                assert!(is_kept, "light is lost: {place}");
                assert!(error < 0.05 && mean > 0.2, "too little to tell: {place}");
            }
        }
    }
}
