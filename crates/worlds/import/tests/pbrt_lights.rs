//! Lights of pbrt-v4. A light with a colour has the value that a picture of pbrt shows, and a
//! light with a spectrum has luminance 1.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, assert_first, assert_near, cases, folder, numbers};
use crate::pbrt_scenes::{causes, light, notes, read_in, scene, shape, world};
use etendue_import::Color;
use etendue_world::{Falloff, Light, Texture};
use glam::DVec3;
use std::f64::consts::PI;

fn intensity(inside: &str) -> f64 {
    match light(&format!("LightSource \"point\" {inside}")) {
        Light::Point { intensity, .. } => intensity,
        other => panic!("{other:?}"),
    }
}

#[test]
fn numbers_are_those_of_pbrts_pictures() {
    // pbrt divides spectra by their integral, and a power by 4π.
    for (inside, expected) in cases(
        r#"
        => 1
        "rgb I" [2 2 2] "float scale" 3 => 6
        "rgb I" [0 1 0] => 0.715160
        "blackbody I" 3000 "float scale" 2 => 2
        "spectrum I" [300 7 900 7] => 1
        "spectrum I" "stdillum-F11" => 1
        "rgb I" [2 2 2] "float power" 6 => 0.954929658551372
        "#,
    ) {
        assert_close(&[intensity(inside)], &numbers(expected), 1e-12);
    }
    assert_first(
        &causes("LightSource \"point\" \"rgb I\" [-1 0 0]"),
        "I is below 0",
    );
}

#[test]
fn spectra_have_colours() {
    let channel = |color| {
        let text = scene("", "LightSource \"infinite\" \"blackbody L\" 3000");
        let read = read_in(&text, std::path::Path::new("."), color).unwrap();
        match read.world.lights[0] {
            Light::Constant { radiance } => radiance,
            ref other => panic!("{other:?}"),
        }
    };
    let [r, g, b] = [Color::Red, Color::Green, Color::Blue].map(channel);
    // The colour of the light is reddish, with luminance 1.
    assert!(r > 1.5 && g < 0.9 && b < 0.3, "{r} {g} {b}");
    assert_near(0.212_671 * r + 0.715_160 * g + 0.072_169 * b, 1.0, 1e-12);
}

#[test]
fn places_are_transformed() {
    let moved = "Translate 1 0 0 Scale 2 2 2 LightSource \"point\" \"point3 from\" [1 2 3]";
    match light(moved) {
        Light::Point { position, .. } => assert_close(&position.to_array(), &[3.0, 4.0, 6.0], 0.0),
        other => panic!("{other:?}"),
    }
    let turned =
        "Rotate 90 0 0 1 LightSource \"distant\" \"point3 to\" [2 0 0] \"float illuminance\" 5";
    match light(turned) {
        Light::Directional {
            direction,
            irradiance,
        } => {
            assert_close(&direction.to_array(), &[0.0, 1.0, 0.0], 1e-15);
            assert_near(irradiance, 5.0, 1e-12);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn spots_fall_with_the_cosine() {
    match light(
        "Scale -1 1 1 LightSource \"spot\" \"point3 from\" [1 0 0] \"point3 to\" [3 0 0] \"float power\" 2",
    ) {
        Light::Spot {
            to_world,
            intensity,
            beam,
            cutoff,
            falloff,
            ..
        } => {
            assert_close(&to_world.translation.to_array(), &[-1.0, 0.0, 0.0], 0.0);
            assert_close(&to_world.matrix3.z_axis.to_array(), &[-1.0, 0.0, 0.0], 0.0);
            assert_close(
                &[beam.to_degrees(), cutoff.to_degrees()],
                &[25.0, 30.0],
                1e-12,
            );
            let mean = (25_f64.to_radians().cos() + 30_f64.to_radians().cos()) / 2.0;
            assert_near(intensity, 2.0 / (2.0 * PI * (1.0 - mean)), 1e-12);
            assert_eq!(falloff, Falloff::SmoothCosine);
        }
        other => panic!("{other:?}"),
    }
    let wrong = "LightSource \"spot\" \"float conedeltaangle\" 40";
    assert_first(&causes(wrong), "conedeltaangle is 40");
}

fn radiance(inside: &str) -> f64 {
    let world = world(&format!("AreaLightSource \"diffuse\" {inside}"));
    match world.shapes[0].emission {
        Some(Texture::Constant(value)) => value,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn areas_shine_by_their_power() {
    assert_near(radiance("\"rgb L\" [1 1 1] Shape \"sphere\""), 1.0, 1e-5);
    // pbrt uses the area of the sphere before it is scaled.
    let sphere = "\"float power\" 8 Scale 2 2 2 Shape \"sphere\" \"float radius\" 0.5";
    assert_near(radiance(sphere), 8.0 / (PI * PI), 1e-12);
    let triangle =
        "\"float power\" 8 Scale 2 2 2 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    assert_near(radiance(triangle), 4.0 / PI, 1e-12);
    let patch = "\"float power\" 8 Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0 2 2 0]";
    assert_near(radiance(patch), 2.0 / PI, 1e-12);
    let two = "AreaLightSource \"diffuse\" \"float power\" 8 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2 1 3 2]";
    assert_first(&causes(two), "pbrt gives this power to each triangle");
    // Half of the power leaves each side.
    let both = "\"bool twosided\" true \"float power\" 8 Shape \"sphere\" \"float radius\" 0.5";
    assert_near(radiance(both), 4.0 / (PI * PI), 1e-12);
    assert!(shape(&format!("AreaLightSource \"diffuse\" {both}")).emits_on_both_sides);
}

#[test]
fn lights_without_an_equal_are_refused() {
    for plugin in ["projection", "goniometric"] {
        let found = causes(&format!("LightSource \"{plugin}\" \"float scale\" 2"));
        assert_eq!(
            found,
            [format!(
                "text:3:1: light `{plugin}` is not supported; allowed: point, spot, distant, infinite"
            )]
        );
    }
    let interface = "Material \"interface\" AreaLightSource \"diffuse\" Shape \"sphere\"";
    assert_first(&notes(interface), "left out, as in pbrt");
}

/// A square Radiance picture of equal pixels, with one brighter pixel.
fn square(side: usize, bright: usize) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n\n-Y {side} +X {side}\n").into_bytes();
    for i in 0..side * side {
        let level = if i == bright { 128 } else { 0 };
        bytes.extend([level, level, level, 131]);
    }
    bytes
}

#[test]
fn skies_are_squares_of_equal_area() {
    // The bright pixel lies to the right of the centre. The direction of the pixel is tilted from Z
    // towards X by slightly more than 45°.
    let (side, bright) = (16, 8 * 16 + 12);
    let files = [
        ("a.hdr", &*square(side, bright)),
        ("b.hdr", b"#?RADIANCE\n\n-Y 1 +X 2\nabcdabcd"),
    ];
    let folder = folder(&files);
    let read = |inside: &str| read_in(&scene("", inside), folder.path(), Color::Luminance);
    let sky = "Rotate 90 0 0 1 LightSource \"infinite\" \"string filename\" \"a.hdr\"";
    let read_sky = read(sky).unwrap();
    assert!(
        read_sky.notes[0]
            .message
            .contains("resampled to 64 × 33 pixels")
    );
    let Light::Sky(map) = &read_sky.world.lights[0] else {
        panic!("{:?}", read_sky.world.lights);
    };
    // The sums are the total light of the map and the mean direction of the map's light.
    let raster = map.radiance.raster();
    let (w, h) = (raster.width(), raster.height());
    let (mut sum, mut toward) = (0.0, DVec3::ZERO);
    for (i, value) in raster.values().iter().enumerate() {
        let (sin, cos) = ((i / w) as f64 * PI / (h - 1) as f64).sin_cos();
        let (x, z) = (((i % w) as f64 + 0.5) * 2.0 * PI / w as f64).sin_cos();
        let light = value * sin * (2.0 * PI / w as f64) * (PI / (h - 1) as f64);
        sum += light;
        toward += light * DVec3::new(sin * x, cos, -sin * z);
    }
    // The spot has the size of a pixel, so the means over pixels conserve its light only to a few
    // per cent.
    let pixel = 4.0 * PI / (side * side) as f64;
    assert!((sum / (4.0 * pixel) - 1.0).abs() < 0.1, "{sum}");
    // The centre of the pixel is at u = 9/16 and v = 1/16 in coordinates from −1 to 1, so r =
    // 10/16.
    let r = 10.0_f64 / 16.0;
    let turn = (1.0 / 16.0 / r) * PI / 2.0;
    let across = r * (2.0 - r * r).sqrt();
    // The expected direction is rotated by a quarter turn from X to Y.
    let expected = DVec3::new(-across * turn.sin(), across * turn.cos(), 1.0 - r * r);
    let found = map.to_world * toward.normalize();
    assert!(found.angle_between(expected) < 0.02, "{found} {expected}");
    let wide = read("LightSource \"infinite\" \"string filename\" \"b.hdr\"").unwrap_err();
    assert_first(&wide, "2 × 1 pixels; allowed: squares");
}
