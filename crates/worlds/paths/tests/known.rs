//! Pictures of one pixel with known radiance.

use etendue_field::{LatLong, Raster};
use etendue_paths::Paths;
use etendue_world::{
    Camera, Dielectric, Falloff, Geometry, Lens, Light, Material, Projection, Shape, SkyMap,
    Texture, Triangles, World,
};
use glam::{DAffine2, DAffine3, DMat3, DQuat, DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A narrow camera at one point that looks at another point.
fn camera(from: DVec3, at: DVec3) -> Camera {
    let up = (at - from).any_orthogonal_vector();
    let camera = Camera::pinhole([from, at, up], 1e-6, [1, 1], [1e-3, 1e6]);
    camera.expect("two different points")
}

pub(crate) fn shape(
    geometry: Geometry,
    to_world: DAffine3,
    material: usize,
    emission: Option<f64>,
) -> Shape {
    Shape {
        emission: emission.map(Texture::Constant),
        ..Shape::new(geometry, to_world, material)
    }
}

pub(crate) fn scaled(scale: f64, z: f64) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        DVec3::splat(scale),
        DQuat::IDENTITY,
        DVec3::new(0.0, 0.0, z),
    )
}

/// A floor in z = 0 with reflectance one half, and more shapes and lights.
pub(crate) fn floor(more: Vec<Shape>, lights: Vec<Light>) -> World {
    let mut shapes = vec![shape(Geometry::Rectangle, scaled(10.0, 0.0), 0, None)];
    shapes.extend(more);
    World {
        shapes,
        materials: vec![Material::diffuse(0.5), Material::diffuse(0.0)],
        lights,
        ..World::default()
    }
}

/// The radiance of one pixel, with its standard error.
pub(crate) fn seen(world: &World, from: DVec3, at: DVec3, samples: u32) -> (f64, f64) {
    let picture = Paths::new(world).picture(&camera(from, at), samples, 3, &|_| {});
    (picture.mean[0], picture.variance[0].sqrt())
}

/// Checks agreement within five standard errors, or within rounding error if all paths find the
/// same value; the standard error must be small.
pub(crate) fn assert_seen(world: &World, from: DVec3, at: DVec3, expected: f64) {
    let (mean, error) = seen(world, from, at, 20_000);
    assert!(
        (mean - expected).abs() <= 5.0 * error + 1e-9 * expected,
        "{mean} ± {error}, not {expected}"
    );
    assert!(error <= 0.02 * expected, "{mean} ± {error}");
}

/// Makes the checks of [`assert_seen`] for the origin of a floor with more shapes and lights.
pub(crate) fn assert_lit(more: Vec<Shape>, lights: Vec<Light>, expected: f64) {
    assert_seen(&floor(more, lights), ASIDE, DVec3::ZERO, expected);
}

/// Two triangles that cover the square z = 0 with x and y from −1 to 1.
pub(crate) fn square() -> Geometry {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let corners = corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let square = Triangles::new(corners, vec![[0, 1, 2], [0, 2, 3]], None, None);
    Geometry::Mesh(Arc::new(square.expect("corners of a square")))
}

pub(crate) const ASIDE: DVec3 = DVec3::new(1.0, 0.5, 1.0);

#[test]
fn a_closed_sphere_gathers_light() {
    let mut inside = shape(Geometry::Sphere, scaled(2.0, 0.0), 0, Some(1.0));
    inside.is_flipped = true;
    let mut world = World {
        shapes: vec![inside],
        materials: vec![Material::diffuse(0.5)],
        ..World::default()
    };
    let at = DVec3::new(0.1, 0.2, -1.9);
    // The radiance is the sum 1 + ½ + ¼ + …, up to the given depth.
    for (depth, expected) in [
        (None, 2.0),
        (Some(0), 1.0),
        (Some(1), 1.5),
        (Some(3), 1.875),
    ] {
        world.depth = depth;
        assert_seen(&world, DVec3::ZERO, at, expected);
    }
    world.depth = None;
    world.hides_sources = true;
    assert_seen(&world, DVec3::ZERO, at, 1.0);
}

#[test]
fn lights_shine_by_their_units() {
    let point = Light::Point {
        position: DVec3::new(0.0, 1.0, 2.0),
        intensity: 3.0,
    };
    assert_lit(vec![], vec![point], 0.5 / PI * 3.0 * 2.0 / 5_f64.powf(1.5));
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let sun = Light::Directional {
        direction,
        irradiance: 2.0,
    };
    assert_lit(vec![], vec![sun], 0.5 / PI * 2.0 * 0.8);
    assert_lit(vec![], vec![Light::Constant { radiance: 0.7 }], 0.35);
    // The camera sees a point that a spot lights with the reduced intensity between the spot's two
    // angles.
    let cosine = |angle: f64| (angle.cos() - 0.5_f64.cos()) / (0.3_f64.cos() - 0.5_f64.cos());
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    for (falloff, angle, share) in [
        (Falloff::Angle, 0.4_f64, 0.5),
        (Falloff::SmoothCosine, 0.35, smooth(cosine(0.35))),
        (Falloff::SmoothCosine, 0.45, smooth(cosine(0.45))),
        (Falloff::SquaredCosine, 0.45, cosine(0.45).powi(2)),
        (Falloff::SmoothCosine, 0.29, 1.0),
    ] {
        let spot = Light::Spot {
            to_world: downward(1.0),
            intensity: 4.0,
            beam: 0.3,
            cutoff: 0.5,
            falloff,
            picture: None,
        };
        let there = DVec3::new(angle.tan(), 0.0, 0.0);
        assert_seen(
            &floor(vec![], vec![spot]),
            ASIDE,
            there,
            0.5 / PI * 4.0 * share * angle.cos().powi(3),
        );
    }
}

/// Rare directions of the BSDF that find a small light have almost no share of its light, so the
/// standard error of a pixel without such directions covers what is missing.
#[test]
fn errors_under_a_small_light_are_honest() {
    let light = shape(Geometry::Sphere, scaled(0.1, 9.0), 1, Some(1.0));
    let mut camera = camera(ASIDE, DVec3::ZERO);
    camera.size = [16, 16];
    let world = floor(vec![light], vec![]);
    let picture = Paths::new(&world).picture(&camera, 256, 3, &|_| {});
    let expected = 0.5 * (0.1_f64 / 9.0).powi(2);
    let squares = picture.mean.iter().zip(&picture.variance);
    let squares = squares.map(|(mean, variance)| (mean - expected).powi(2) / variance);
    let mean = squares.sum::<f64>() / 256.0;
    assert!(mean < 1.5, "{mean}"); // 1 if errors are right, with a deviation of 0.09
}

#[test]
fn surfaces_shine_by_their_area() {
    let turned = |height: f64, scale: f64| scaled(scale, height) * downward(0.0);
    // A disc and a sphere above a point of the floor.
    let disc = shape(Geometry::Disc, turned(2.0, 0.5), 1, Some(6.0));
    assert_lit(vec![disc], vec![], 0.5 * 6.0 * 0.25 / 4.25);
    let sphere = shape(Geometry::Sphere, scaled(0.5, 2.0), 1, Some(6.0));
    assert_lit(vec![sphere], vec![], 0.5 * 6.0 * 0.25 / 4.0);
    // The light is a square that emits only on its front. The square is given once as a rectangle
    // and once as two triangles.
    // This is the form factor of a square of side 1 at height 2, for a point below its centre. It
    // is the sum over four squares of ½ by ½ with a corner above the point (Howell, factor B-3).
    let x = 0.25_f64;
    let factor =
        4.0 / (2.0 * PI) * 2.0 * x / (1.0 + x * x).sqrt() * (x / (1.0 + x * x).sqrt()).atan();
    for geometry in [Geometry::Rectangle, square()] {
        let square = shape(geometry.clone(), turned(2.0, 0.5), 1, Some(6.0));
        assert_lit(vec![square], vec![], 0.5 * 6.0 * factor);
        let away = shape(geometry, scaled(0.5, 2.0), 1, Some(6.0));
        let (mean, _) = seen(&floor(vec![away], vec![]), ASIDE, DVec3::ZERO, 1000);
        assert!(mean.abs() < 1e-300, "{mean}");
    }
}

/// A lamp that emits on both sides gives the same light when its front is turned away, and fills
/// its inside.
#[test]
fn lamps_may_emit_on_both_sides() {
    let both = |geometry, to_world| Shape {
        emits_on_both_sides: true,
        ..shape(geometry, to_world, 1, Some(6.0))
    };
    let disc = both(Geometry::Disc, scaled(0.5, 2.0));
    let radiance = 0.5 * 6.0 * 0.25 / 4.25;
    assert_lit(vec![disc], vec![], radiance);
    let ball = both(Geometry::Sphere, scaled(0.5, 2.0));
    let radiance = 0.5 * 6.0 * 0.25 / 4.0;
    assert_lit(vec![ball], vec![], radiance);
    let around = floor(vec![both(Geometry::Sphere, scaled(5.0, 0.0))], vec![]);
    assert_seen(&around, ASIDE, DVec3::ZERO, 0.5 * 6.0);
}

/// A flat light of half-width 0.5, tilted by 60°, lights a patch of half-widths 1 and 0.5 as
/// distant light along its normal would.
#[test]
fn sheets_shine_along_their_normal_only() {
    let tilt = DQuat::from_rotation_y(2.0 * PI / 3.0);
    let place = -4.0 * (tilt * DVec3::Z);
    let to_world = DAffine3::from_scale_rotation_translation(DVec3::splat(0.5), tilt, place);
    let radiance = 0.5 * 3.0 * 0.5 / PI;
    let world = |geometry: &Geometry, is_flipped| {
        let sheet = Shape {
            is_flipped,
            ..shape(geometry.clone(), to_world, 1, None)
        };
        let light = Light::Sheet {
            shape: 1,
            exitance: Texture::Constant(3.0),
        };
        floor(vec![sheet], vec![light])
    };
    let [square, disc] = [Geometry::Rectangle, Geometry::Disc];
    let lit = [(&square, 0.9, 0.45), (&square, 0.0, 0.0), (&disc, 0.9, 0.1)];
    for (geometry, x, y) in lit {
        let at = DVec3::new(x, y, 0.0);
        assert_seen(&world(geometry, false), ASIDE, at, radiance);
        let (behind, _) = seen(&world(geometry, true), ASIDE, at, 1000);
        assert!(behind.abs() < 1e-300, "{behind}");
    }
    let dark = [(&square, 1.1, 0.0), (&square, 0.0, 0.55), (&disc, 0.9, 0.4)];
    for (geometry, x, y) in dark {
        let (beside, _) = seen(&world(geometry, false), ASIDE, DVec3::new(x, y, 0.0), 1000);
        assert!(beside.abs() < 1e-300, "{beside}");
    }
}

#[test]
fn glass_keeps_the_light_around_it() {
    let glass = Dielectric {
        index: 1.5,
        reflectance: Texture::Constant(1.0),
        transmittance: Texture::Constant(1.0),
        roughness: None,
        is_thin: false,
    };
    let ball = shape(Geometry::Sphere, scaled(1.0, 0.0), 0, None);
    let sky = vec![Light::Constant { radiance: 0.8 }];
    let world = World {
        shapes: vec![ball],
        materials: vec![Material::Dielectric(glass)],
        lights: sky,
        ..World::default()
    };
    assert_seen(
        &world,
        DVec3::new(0.0, 3.0, 0.0),
        DVec3::new(0.3, 0.0, 0.4),
        0.8,
    );
}

#[test]
fn a_sky_is_where_its_pixels_are() {
    let mut values = vec![0.0; 64 * 32];
    // Column 16 of 64 is a quarter turn from −Z to X; row 8 of the rows 0 to 31 is at 46° from Y.
    values[8 * 64 + 16] = 100.0;
    let raster = Raster::new(64, 32, values).unwrap();
    let map = Arc::new(LatLong::from_pole_to_pole(raster));
    let sky = |to_world| {
        Light::Sky(SkyMap {
            to_world,
            radiance: Arc::clone(&map),
        })
    };
    let [turn, down] = [16.5_f64 / 64.0 * 2.0 * PI, 8.0_f64 / 31.0 * PI];
    let toward = DVec3::new(
        down.sin() * turn.sin(),
        down.cos(),
        -down.sin() * turn.cos(),
    );
    // Interpolation turns the pixel into a tent function. Its integral is the value of the pixel
    // times the solid angle of one pixel.
    let solid = 2.0 * PI / 64.0 * PI / 31.0 * down.sin();
    for turned in [
        DMat3::from_rotation_x(1.0),
        DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(1.2),
    ] {
        let world = floor(vec![], vec![sky(turned)]);
        let expected = 0.5 / PI * 100.0 * solid * (turned * toward).z;
        assert!(expected > 0.0, "it is above the floor");
        let (mean, error) = seen(&world, ASIDE, DVec3::ZERO, 20_000);
        // The tent is slightly asymmetric in latitude.
        assert!(
            (mean / expected - 1.0).abs() < 0.003 + 5.0 * error / expected,
            "{mean} ± {error}, not {expected}"
        );
    }
}

#[test]
fn lenses_focus() {
    let mut of = camera(DVec3::ZERO, DVec3::Z);
    of.projection = Projection::Perspective {
        half_width: 0.5,
        shift: [0.0; 2],
        lens: Some(Lens {
            radius: 0.1,
            focus: 4.0,
        }),
    };
    let through = |lens| {
        let look = of.look([0.8, 0.3], lens);
        look.from + look.along * (4.0 / look.along.dot(DVec3::Z))
    };
    let middle = through([0.0, 0.0]);
    assert!((through([0.6, -0.7]) - middle).length() < 1e-12);
    assert!(middle.truncate().length() > 0.1);
}

/// Direct light at a point is the light of paths that end at the first surface. A wall beside the
/// floor adds indirect light, which is not part of direct light.
#[test]
fn direct_light_is_that_of_the_shortest_paths() {
    let turned = DQuat::from_rotation_y(-0.5 * PI);
    let wall = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.0),
        turned,
        DVec3::new(0.5, 0.0, 0.0),
    );
    let lamp = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.3),
        DQuat::from_rotation_x(PI),
        DVec3::new(0.0, 0.0, 1.0),
    );
    let world = floor(
        vec![
            shape(Geometry::Rectangle, wall, 0, None),
            shape(Geometry::Rectangle, lamp, 1, Some(5.0)),
        ],
        Vec::new(),
    );
    let of = |depth: Option<u32>| {
        let world = World {
            depth,
            ..world.clone()
        };
        let paths = Paths::new(&world);
        let look = camera(DVec3::new(0.2, 0.0, 0.5), DVec3::ZERO).look([0.5; 2], [0.0; 2]);
        let seen = paths.view(&look).surface.unwrap();
        let points = 0..4096;
        let direct = points.clone().map(|i| paths.direct(&seen, 1, 0, i)[0]);
        let direct = direct.sum::<f64>() / points.len() as f64;
        (direct, paths.shade(&seen, 4096, 1, 0).0[0])
    };
    let [(direct, all), (_, shortest)] = [None, Some(1)].map(of);
    // Means over nets of 4,096 points have errors of about 10⁻³.
    assert!(
        (direct / shortest - 1.0).abs() < 5e-3,
        "{direct} {shortest}"
    );
    assert!(all > 1.05 * direct, "{all} {direct}");
}

/// An ellipsoid under a distant light: its highest point has the brightness of a plane, and its
/// silhouette has the ellipsoid's half-axes.
#[test]
fn ellipsoids_have_their_own_normals() {
    let axes = DVec3::new(2.0, 0.5, 1.0);
    let ellipsoid = Shape {
        to_world: DAffine3::from_scale(axes),
        ..shape(Geometry::Sphere, DAffine3::IDENTITY, 0, None)
    };
    let world = World {
        shapes: vec![ellipsoid],
        materials: vec![Material::diffuse(0.5)],
        lights: vec![Light::Directional {
            direction: DVec3::NEG_Z,
            irradiance: 2.0,
        }],
        ..World::default()
    };
    // The normal at a point is along p/axes².
    for (x, y) in [(0.0, 0.0), (0.5, 0.1), (-0.8, 0.2)] {
        let flat = DVec3::new(x, y, 0.0) / axes;
        let z = (1.0 - flat.length_squared()).sqrt();
        let normal = (DVec3::new(x, y, z) / (axes * axes)).normalize();
        let (mean, _) = seen(&world, DVec3::new(x, y, 5.0), DVec3::new(x, y, 0.0), 16);
        let expected = 2.0 * normal.z * 0.5 / PI;
        assert!((mean / expected - 1.0).abs() < 1e-5, "{mean} {expected}"); // the pixel's width
    }
    for (x, y, is_hit) in [(1.99, 0.0, true), (2.01, 0.0, false), (0.0, 0.51, false)] {
        let (mean, _) = seen(&world, DVec3::new(x, y, 5.0), DVec3::new(x, y, 0.0), 16);
        assert_eq!(mean > 0.0, is_hit, "{x} {y}");
    }
}

/// A picture of two by two squares with the values 0.2 and 0.8.
fn board() -> Texture {
    Texture::Checkerboard {
        to_uv: DAffine2::IDENTITY,
        values: [0.2, 0.8],
    }
}

/// The placement of a light above the floor that shines down. Its X is X of the floor, and its
/// Y is −Y of the floor.
pub(crate) fn downward(height: f64) -> DAffine3 {
    DAffine3::from_mat3_translation(
        DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)),
        DVec3::new(0.0, 0.0, height),
    )
}

/// The picture of a spot has the first value where both texture coordinates are below or above ½.
/// These places are towards X and −Y of the floor, which are X and Y of the spot, or opposite to
/// both.
#[test]
fn spots_may_have_pictures() {
    let picture = board();
    for (x, y, value) in [
        (0.1, -0.1, 0.2),
        (0.1, 0.1, 0.8),
        (-0.2, 0.1, 0.2),
        (-0.1, -0.1, 0.8),
    ] {
        let spot = Light::Spot {
            to_world: downward(1.0),
            intensity: 4.0,
            beam: 0.3,
            cutoff: 0.5,
            falloff: Falloff::Angle,
            picture: Some(picture.clone()),
        };
        let there = DVec3::new(x, y, 0.0);
        let cosine = (1.0 + there.length_squared()).sqrt().recip();
        let expected = 0.5 / PI * 4.0 * value * cosine.powi(3);
        assert_seen(&floor(vec![], vec![spot]), ASIDE, there, expected);
    }
}

/// A projector lights a plane that faces it with the same pattern of irradiance everywhere, and
/// nothing outside its picture. Texture coordinates decrease along X and Y of the projector, which are
/// X and −Y of the floor.
#[test]
fn projectors_light_a_plane_evenly() {
    let picture = board();
    for (x, y, value) in [
        (0.1, -0.1, 0.2),
        (0.1, 0.1, 0.8),
        (-0.2, 0.1, 0.2),
        (0.28, 0.14, 0.8),
        (0.32, 0.1, 0.0),
        (0.1, -0.16, 0.0),
    ] {
        let projector = Light::Projector {
            to_world: downward(2.0),
            half: DVec2::new(0.15, 0.075),
            picture: picture.clone(),
            scale: 4.0,
        };
        let expected = 0.5 / PI * 4.0 * value / 4.0;
        assert_seen(
            &floor(vec![], vec![projector]),
            ASIDE,
            DVec3::new(x, y, 0.0),
            expected,
        );
    }
}
