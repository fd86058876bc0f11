//! Tests light fields behind a pixel in scenes where these light fields are known.

use crate::known::scaled;
use etendue_field::{Crossing, PhotonSource};
use etendue_paths::{BackwardProbe, Budget, Paths, PhotonProbe, Probe, Question, Reflects};
use etendue_world::{
    Camera, Conductor, Dielectric, Geometry, Light, Material, Shape, Texture, World,
};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::f64::consts::PI;

const QUESTION: Question = Question {
    pixel: [32, 32],
    surfaces: 1,
    across: 8.0,
    frequencies: 4,
    azimuths: 2,
};

/// A camera at (0, −3, 2) that looks at the origin, 64 × 64 pixels.
fn camera() -> Camera {
    let from = DVec3::new(0.0, -3.0, 2.0);
    let camera = Camera::pinhole([from, DVec3::ZERO, DVec3::Z], 0.5, [64; 2], [1e-3, 1e6]);
    camera.expect("two different points")
}

fn world(shapes: Vec<Shape>) -> World {
    let mirror = Conductor {
        index: None,
        reflectance: Texture::Constant(1.0),
        roughness: None,
    };
    World {
        shapes,
        materials: vec![Material::diffuse(0.5), Material::Conductor(mirror)],
        ..World::default()
    }
}

fn floor(material: usize) -> Shape {
    Shape::new(Geometry::Rectangle, scaled(20.0, 0.0), material)
}

/// An upright square in the plane of a place (y, z). Its front is towards −Y if `turned` is
/// 1, and towards Y if `turned` is −1.
fn wall([y, z]: [f64; 2], size: f64, turned: f64, material: usize) -> Shape {
    let axes = [DVec3::X, turned * DVec3::Z, -turned * DVec3::Y].map(|axis| size * axis);
    let axes = DMat3::from_cols(axes[0], axes[1], axes[2]);
    let to_world = DAffine3::from_mat3_translation(axes, DVec3::new(0.0, y, z));
    Shape::new(Geometry::Rectangle, to_world, material)
}

fn shining(mut wall: Shape) -> Shape {
    wall.emission = Some(Texture::Constant(2.0));
    wall
}

fn directional() -> Light {
    Light::Directional {
        direction: DVec3::new(0.0, 0.6, -0.8),
        irradiance: 3.0,
    }
}

/// The mean flux through the window of each plane, with its standard error over 32
/// batches.
fn sums(probe: &Probe<'_>, source: &dyn PhotonSource) -> Vec<[f64; 2]> {
    const BATCHES: u32 = 32;
    let mut each = vec![Vec::new(); probe.planes.len()];
    for batch in 0..BATCHES {
        let mut sums = vec![0.0; probe.planes.len()];
        let mut record = |plane: usize, crossings: &[Crossing]| {
            let window = &probe.planes[plane].window;
            let weights = crossings.iter().map(|c| c.weight * window.value(&c.ray));
            sums[plane] += weights.sum::<f64>();
        };
        source.emit(batch, &mut record, &|_| {});
        for (all, sum) in each.iter_mut().zip(sums) {
            all.push(sum / source.emitted(batch) as f64);
        }
    }
    let of = |sums: &Vec<f64>| {
        let count = f64::from(BATCHES);
        let mean = sums.iter().sum::<f64>() / count;
        let squares: f64 = sums.iter().map(|sum| (sum - mean).powi(2)).sum();
        [mean, (squares / (count * (count - 1.0))).sqrt()]
    };
    each.iter().map(of).collect()
}

/// Checks that rays and photons find `radiance` in the windows of these planes, where ∫ L W is the
/// radiance times the half-widths. BSDF rays are checked too, unless a light is directional.
fn assert_even(world: &World, question: &Question, planes: &[&str], radiance: f64) {
    assert_even_with(50_000, world, question, planes, radiance);
}

/// Makes the checks of `assert_even` with a given number of photons per batch.
fn assert_even_with(
    photons: u64,
    world: &World,
    question: &Question,
    planes: &[&str],
    radiance: f64,
) {
    let paths = Paths::new(world);
    let probe = Probe::new(&paths, &camera(), question).expect("the ray meets something");
    let budget = |each, seed| Budget { each, seed };
    let rays = BackwardProbe::new(&probe, budget(4_000, 5));
    let photons = PhotonProbe::new(&probe, budget(photons, 6));
    let by_bsdf = BackwardProbe::new(&probe, budget(40_000, 7)).by_bsdf();
    let mut sources: Vec<(&str, &dyn PhotonSource)> = vec![("rays", &rays), ("photons", &photons)];
    if let Some(rays) = &by_bsdf {
        sources.push(("BSDF rays", rays));
    }
    for (what, source) in sources {
        let found = sums(&probe, source);
        for (plane, [mean, error]) in probe.planes.iter().zip(found) {
            if !planes.contains(&plane.name.as_str()) {
                continue;
            }
            let half = [plane.window.x, plane.window.u].map(|profile| profile.half_width());
            let expected = radiance * half[0].powi(2) * half[1].powi(2);
            let close = (mean - expected).abs() < 5.0 * error + 1e-9 * expected;
            let place = format!("{what} at {}: {mean} ± {error}, not {expected}", plane.name);
            assert!(close, "{place}");
            // The error is small enough to detect a missing cosine or half-width.
            assert!(error < 0.06 * expected, "too little to tell: {place}");
        }
    }
}

#[test]
fn light_that_leaves_a_floor() {
    let mut of = world(vec![floor(0)]);
    of.lights = vec![directional()];
    let radiance = 0.5 * 3.0 * 0.8 / PI;
    assert_even(&of, &QUESTION, &["camera", "leaving_1"], radiance);
    // A flat light of the same direction and irradiance, behind the camera. It is wide enough for
    // the window.
    let Light::Directional { direction, .. } = directional() else {
        unreachable!()
    };
    let to_world = DAffine3::from_scale_rotation_translation(
        DVec3::new(2.0, 2.0, 1.0),
        DQuat::from_rotation_arc(DVec3::Z, direction),
        -9.0 * direction,
    );
    of.shapes.push(Shape::new(Geometry::Rectangle, to_world, 0));
    of.lights = vec![Light::Sheet {
        shape: 1,
        exitance: Texture::Constant(3.0),
    }];
    assert_even(&of, &QUESTION, &["camera", "leaving_1"], radiance);
}

#[test]
fn light_that_arrives_at_a_floor_and_leaves_a_wall() {
    // The mirrored ray continues to an emitting wall.
    let mut of = world(vec![floor(0), shining(wall([4.0, 0.0], 8.0, 1.0, 0))]);
    of.depth = Some(1);
    let question = Question {
        surfaces: 2,
        ..QUESTION
    };
    let planes = ["arriving_1", "leaving_2"];
    assert_even(&of, &question, &planes, 2.0);
    // The wall is turned away, and emits on both sides: half of the photons leave its front.
    of.shapes[1].is_flipped = true;
    of.shapes[1].emits_on_both_sides = true;
    assert_even_with(200_000, &of, &question, &planes, 2.0);
}

#[test]
fn surfaces_curve_as_they_do() {
    let of = |geometry: Geometry, to_world: DAffine3| {
        let paths = Paths::new(&world(vec![Shape::new(geometry, to_world, 0)]));
        let probe = Probe::new(&paths, &camera(), &QUESTION).unwrap();
        probe.stops[0].curvature
    };
    for k in of(Geometry::Sphere, scaled(0.5, 0.0)) {
        // Curvatures are finite differences over a few hundredths of the radius.
        assert!((k - 2.0).abs() < 0.03, "{k}");
    }
    // The axis of the cylinder is along X, perpendicular to the plane of incidence.
    let turned = DMat3::from_cols(DVec3::Z * 0.5, DVec3::Y * 0.5, -4.0 * DVec3::X);
    let to_world = DAffine3::from_mat3_translation(turned, DVec3::X * 2.0);
    let [along, across] = of(Geometry::Cylinder, to_world);
    // The ray is nearly parallel to the normal, so the plane of incidence has an error of some
    // degrees. The sum of the curvatures does not depend on this plane.
    assert!((along + across - 2.0).abs() < 0.03, "{along}, {across}");
    assert!(along > 1.9 && across < 0.1, "{along}, {across}");
    // A large sphere is seen from inside.
    let [along, across] = of(Geometry::Sphere, scaled(5.0, 0.0));
    let off = (along + 0.2).abs().max((across + 0.2).abs());
    assert!(off < 0.003, "{along}, {across}");
}

#[test]
fn the_sky_in_windows_and_mirrors() {
    let mut of = world(vec![floor(1)]);
    of.lights = vec![Light::Constant { radiance: 1.5 }];
    let all = ["camera", "leaving_1", "arriving_1"];
    assert_even(&of, &QUESTION, &all, 1.5);
    // A large mirror ball is seen from outside; all rays of its reflections end in the sky.
    of.shapes = vec![Shape::new(Geometry::Sphere, scaled(20.0, -20.0), 1)];
    assert_even(&of, &QUESTION, &all, 1.5);
}

#[test]
fn an_emitting_wall_in_one_and_two_mirrors() {
    // The ray continues from the floor to a wall, and from a mirror at the wall to a second wall.
    let planes = ["camera", "leaving_1", "arriving_1"];
    let mut of = world(vec![floor(1), shining(wall([4.0, 0.0], 4.0, 1.0, 0))]);
    of.depth = Some(1);
    assert_even(&of, &QUESTION, &planes, 2.0);
    let mut of = world(vec![
        floor(1),
        wall([4.0, 0.0], 4.0, 1.0, 1),
        shining(wall([-8.0, 10.0], 4.0, -1.0, 0)),
    ]);
    of.depth = Some(2);
    assert_even(&of, &QUESTION, &planes, 2.0);
}

#[test]
fn wide_windows() {
    // The cosines along the lines of these windows differ, and photons that continue at random
    // often hit the windows. Therefore a wrong power of the cosine, or a wrong density, causes an
    // error of many times the noise.
    let wide = Question {
        across: 48.0,
        ..QUESTION
    };
    let mut of = world(vec![floor(0)]);
    of.lights = vec![directional()];
    let radiance = 0.5 * 3.0 * 0.8 / PI;
    assert_even(&of, &wide, &["camera", "leaving_1"], radiance);
    let mut of = world(vec![floor(1)]);
    let all = ["camera", "leaving_1", "arriving_1"];
    of.lights = vec![Light::Constant { radiance: 1.5 }];
    assert_even_with(400_000, &of, &wide, &all, 1.5);
}

/// A black sheet with an opacity of 0.4 covers the floor, or also the camera's view of it.
#[test]
fn partly_transparent_sheets_between_lights_floors_and_cameras() {
    let lamp = Light::Point {
        position: DVec3::new(0.0, 0.0, 40.0),
        intensity: 800.0,
    };
    let sky = Light::Constant { radiance: 1.5 };
    let planes = ["camera", "leaving_1"];
    for (light, irradiance) in [(directional(), 2.4), (lamp, 0.5), (sky, 1.5 * PI)] {
        for (height, share) in [(3.0, 0.6), (1.0, 0.36)] {
            let sheet = Shape::new(Geometry::Rectangle, scaled(1e4, height), 2);
            let mut of = world(vec![floor(0), sheet]);
            of.materials.push(Material::Mask {
                opacity: Texture::Constant(0.4),
                of: Box::new(Material::diffuse(0.0)),
            });
            of.lights = vec![light.clone()];
            // Only light that has met the floor counts.
            of.depth = Some(1);
            assert_even(&of, &QUESTION, &planes, share * irradiance * 0.5 / PI);
        }
    }
}

#[test]
fn photons_know_what_they_miss() {
    let glass = Material::Dielectric(Dielectric {
        index: 1.5,
        is_thin: false,
        roughness: None,
        reflectance: Texture::Constant(1.0),
        transmittance: Texture::Constant(1.0),
    });
    let mut of = world(vec![Shape::new(Geometry::Sphere, DAffine3::IDENTITY, 2)]);
    of.materials.push(glass);
    of.lights = vec![Light::Constant { radiance: 1.0 }];
    let paths = Paths::new(&of);
    let probe = Probe::new(&paths, &camera(), &QUESTION).unwrap();
    assert_eq!(probe.stops[0].reflects, Reflects::Mirror);
    let photons = PhotonProbe::new(&probe, Budget { each: 10, seed: 1 });
    // The camera also sees light that the glass refracts. The window of arriving light sees only
    // the sky.
    assert_eq!(photons.misses(0), Some("a smooth surface"));
    assert_eq!(photons.misses(2), None);
}
