//! Pictures of few shading samples with known radiance, and properties that all methods have.

use etendue_adaptive::{Rendered, SampleMethod, SamplePlan, render};
use etendue_paths::Paths;
use etendue_world::{Camera, Geometry, Light, Material, Projection, Shape, Texture, World};
use glam::{DAffine3, DMat3, DVec3};

const ALL: [SampleMethod; 5] = [
    SampleMethod::Auto,
    SampleMethod::Uniform,
    SampleMethod::Predicted,
    SampleMethod::Weighted,
    SampleMethod::Variance,
];

/// Returns a ball of radius 1 and reflectance one half, in uniform light.
fn ball() -> World {
    World {
        shapes: vec![Shape {
            name: "ball".to_owned(),
            geometry: Geometry::Sphere,
            to_world: DAffine3::IDENTITY,
            is_flipped: false,
            material: 0,
            emission: None,
        }],
        materials: vec![Material::Diffuse {
            reflectance: Texture::Constant(0.5),
        }],
        lights: vec![Light::Constant { radiance: 3.0 }],
        ..World::default()
    }
}

fn camera(size: [usize; 2]) -> Camera {
    let turned = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::Z);
    Camera {
        name: "camera".to_owned(),
        to_world: DAffine3::from_mat3_translation(turned, DVec3::new(0.0, 0.0, -4.0)),
        size,
        projection: Projection::Perspective {
            half_width: 0.4,
            shift: [0.0; 2],
            lens: None,
        },
        clip: [1e-3, 1e6],
    }
}

fn picture(world: &World, method: SampleMethod, samples: usize, seed: u64) -> Rendered {
    let plan = SamplePlan {
        method,
        samples,
        each: 128,
        blocker_rays: 16,
        is_even: false,
        seed,
    };
    let paths = Paths::new(world);
    render(&paths, &camera([96, 60]), &plan, &|_, _| {}, &|_| {})
}

/// A convex diffuse ball in uniform light reflects half of it everywhere.
#[test]
fn even_light_stays_even() {
    for method in ALL {
        let found = picture(&ball(), method, 300, 1);
        let lit = found.radiance.iter().filter(|x| **x < 2.0).count();
        assert!(lit > 1000, "{method:?}: {lit} pixels of the ball");
        for radiance in &found.radiance {
            // A pixel at the edge mixes ball and background in multiples of a quarter; other
            // deviations are noise of 128 paths.
            let quarters = (radiance - 1.5) / 0.375;
            assert!(
                (quarters - quarters.round()).abs() < 0.15,
                "{method:?}: {radiance}"
            );
        }
    }
}

#[test]
fn the_same_bytes_on_any_threads() {
    for method in ALL {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| picture(&ball(), method, 200, 5))
        };
        let (one, three) = (on(1), on(3));
        let bits = |of: &Rendered| of.radiance.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&one), bits(&three), "{method:?}");
        assert_eq!(one.points, three.points, "{method:?}");
    }
}

/// As many samples are shaded as requested, except those whose points hit nothing.
#[test]
fn samples_are_spent() {
    for method in ALL {
        let found = picture(&ball(), method, 400, 2);
        let count = found.points.len() - found.added;
        assert!((360..=400).contains(&count), "{method:?}: {count}");
        assert!(found.added < 20, "{method:?}: {} added", found.added);
    }
}

/// The criterion of a sphere increases towards its edge, and so does the density of predicted
/// samples, but not that of uniform samples.
#[test]
fn predicted_samples_gather_at_the_edge() {
    let far = |method: SampleMethod| {
        let found = picture(&ball(), method, 600, 4);
        let edge = |at: &&[f64; 2]| ((at[0] - 48.0).powi(2) + (at[1] - 30.0).powi(2)).sqrt() > 26.0;
        let outside = found.points.iter().filter(edge).count() as f64;
        outside / found.points.len() as f64
    };
    // The visible disc has a radius of about 31 pixels; 30 % of its area is more than 26 pixels
    // from the centre.
    let [even, predicted] = [SampleMethod::Uniform, SampleMethod::Predicted].map(far);
    assert!((even - 0.3).abs() < 0.06, "{even}");
    assert!(predicted > even + 0.1, "{predicted} {even}");
}

/// Without light, or with nothing in view, the picture is black.
#[test]
fn nothing_to_see_is_dark() {
    let dark = World {
        lights: Vec::new(),
        ..ball()
    };
    let empty = World {
        shapes: Vec::new(),
        lights: Vec::new(),
        ..ball()
    };
    for method in ALL {
        for world in [&dark, &empty] {
            let found = picture(world, method, 50, 1);
            assert!(found.radiance.iter().all(|x| *x == 0.0), "{method:?}");
        }
    }
}
