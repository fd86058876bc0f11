//! Values of colours, spectra and pictures, compared with the variants `llvm_ad_mono` (luminance)
//! and `scalar_rgb` (channels) of Mitsuba 3.9.1.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::common::{
    assert_close, assert_first, assert_near, cases, folder, numbers, png, read_in,
};
use etendue_import::Color;
use etendue_world::{Light, Material, Texture};
use glam::DVec2;
use std::path::Path;

const ALL: [Color; 4] = [Color::Luminance, Color::Red, Color::Green, Color::Blue];

fn reflectance(property: &str, folder: &Path, color: Color) -> Texture {
    let inside = format!("<shape type=\"sphere\"><bsdf type=\"diffuse\">{property}</bsdf></shape>");
    let world = read_in(&inside, folder, color).unwrap().world;
    common::reflectance(&world.materials[0]).clone()
}

fn radiance(property: &str, color: Color) -> f64 {
    let inside = format!("<emitter type=\"constant\">{property}</emitter>");
    let files = folder(&[]);
    let world = read_in(&inside, files.path(), color).unwrap().world;
    match world.lights[0] {
        Light::Constant { radiance } => radiance,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn colours_become_one_number() {
    let rgb = "<rgb name=\"radiance\" value=\"0.2, 0.5 0.9\"/>";
    assert_close(
        &ALL.map(|c| radiance(rgb, c)),
        &[0.465_066, 0.2, 0.5, 0.9],
        5e-7,
    );
    let grey = "<rgb name=\"radiance\" value=\"3\"/>";
    assert_close(&ALL.map(|c| radiance(grey, c)), &[3.0; 4], 1e-12);
    let number = "<float name=\"radiance\" value=\"3\"/>";
    assert_close(&ALL.map(|c| radiance(number, c)), &[3.0; 4], 0.0);
    // The spectrum of a light with equal power at all wavelengths is not grey in sRGB.
    let uniform = "<spectrum name=\"radiance\" value=\"2\"/>";
    let expected = [2.0, 2.409_59, 1.896_58, 1.817_83];
    assert_close(&ALL.map(|c| radiance(uniform, c)), &expected, 1e-5);
    assert_near(radiance("", Color::Red), 1.0, 0.0);
    let d65 =
        "<spectrum name=\"radiance\" type=\"d65\"><float name=\"scale\" value=\"2\"/></spectrum>";
    assert_near(radiance(d65, Color::Luminance), 2.0, 0.0);
}

#[test]
fn spectra_are_weighed_as_in_mitsuba() {
    let files = folder(&[]);
    for (samples, reflected, emitted) in [
        ("400:0.3, 500:0.5, 600:0.1", 0.279_840_65, 0.263_115_05),
        (
            "400:0.3 500:0.5 650:0.1 700:0.5",
            0.342_733_29,
            0.335_311_65,
        ),
        ("300:0.5, 900:0.5", 0.499_446_12, 0.499_999_79),
        ("450:0.5, 500:0.5", 0.047_989_49, 0.042_399_55),
        ("400:0, 500:8, 600:15.6, 700:18.4", 1.0, 12.367_386),
    ] {
        let spectrum = |name: &str| format!("<spectrum name=\"{name}\" value=\"{samples}\"/>");
        let found = reflectance(&spectrum("reflectance"), files.path(), Color::Luminance);
        assert_near(found.largest(), reflected, 3e-7);
        let found = radiance(&spectrum("radiance"), Color::Luminance);
        assert_near(found, emitted, 3e-6);
    }
    let spectrum = "<spectrum name=\"reflectance\" value=\"400:0.3, 500:0.5, 650:0.1, 700:0.5\"/>";
    let found = ALL.map(|c| reflectance(spectrum, files.path(), c).largest());
    assert_close(&found[1..], &[0.119_805, 0.401_9, 0.413_351], 1e-6);
    let spectrum = "<spectrum name=\"radiance\" value=\"400:0.3, 500:0.5, 650:0.1, 700:0.5\"/>";
    let found = ALL.map(|c| radiance(spectrum, c));
    assert_close(&found[1..], &[0.169_93, 0.380_616, 0.373_723], 1e-6);
}

#[test]
fn spectra_are_read_from_files() {
    let files = folder(&[("s.spd", b"# nm value\n300 0.5\n900 0.5 # end\n")]);
    let file = "<spectrum name=\"reflectance\" filename=\"s.spd\"/>";
    let found = reflectance(file, files.path(), Color::Luminance);
    assert_near(found.largest(), 0.499_446_12, 3e-7);
    for (value, what) in cases(
        r#"
        500:1, 400:1 => not in rising order
        500:1 => at least two
        0.1, 0.2 => not a pair
        "#,
    ) {
        let spectrum = format!(
            "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"{value}\"/></emitter>"
        );
        assert!(common::causes(&spectrum)[0].contains(what));
    }
    let black = "<emitter type=\"constant\"><spectrum name=\"radiance\" type=\"blackbody\"><float name=\"temperature\" value=\"3000\"/></spectrum></emitter>";
    assert!(common::causes(black)[0].contains("texture `blackbody` is not supported"));
}

#[test]
fn conductors_have_indices_of_refraction() {
    for (inside, expected) in cases(
        r#"
        <string name="material" value="Au"/> => 0.402895 2.66884
        <string name="material" value="Al"/> => 1.01975 6.79442
        <rgb name="eta" value="0.2 0.4 0.8"/><rgb name="k" value="3 2 1.5"/> => 0.386333 2.17659
        <spectrum name="eta" value="400:0.3, 500:0.5, 600:0.1"/> => 0.279841 1
        <string name="material" value="none"/> => none
        => none
        "#,
    ) {
        let bsdf = format!(r#"<bsdf type="conductor">{inside}</bsdf>"#);
        let world = common::world(&format!(r#"<shape type="sphere">{bsdf}</shape>"#));
        let Material::Conductor(metal) = &world.materials[0] else {
            panic!("{:?}", world.materials);
        };
        match metal.index {
            None => assert_eq!(expected, "none"),
            Some(index) => assert_close(&index, &numbers(expected), 1e-5),
        }
    }
    let both = "<shape type=\"sphere\"><bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/><float name=\"eta\" value=\"1\"/></bsdf></shape>";
    assert!(common::causes(both)[0].contains("material is given together with eta or k"));
}

fn bitmap(file: &str, inside: &str) -> String {
    format!(
        "<texture name=\"reflectance\" type=\"bitmap\"><string name=\"filename\" value=\"{file}\"/><string name=\"filter_type\" value=\"nearest\"/>{inside}</texture>"
    )
}

#[test]
fn levels_of_pictures_are_linear_unless_raw() {
    let picture = png([2, 1], &[80, 175, 80, 0, 255, 10]);
    let files = folder(&[("a.png", &picture)]);
    let linear = [0.080_219_9, 0.428_691, 0.080_219_9];
    let luminance = 0.212_671 * linear[0] + 0.715_160 * linear[1] + 0.072_169 * linear[2];
    let at = |inside: &str, u: f64| {
        ALL.map(|c| {
            reflectance(&bitmap("a.png", inside), files.path(), c).value(&DVec2::new(u, 0.5).into())
        })
    };
    assert_close(
        &at("", 0.25),
        &[luminance, linear[0], linear[1], linear[2]],
        1e-6,
    );
    let raw = "<boolean name=\"raw\" value=\"true\"/>";
    let levels = [80.0 / 255.0, 175.0 / 255.0, 80.0 / 255.0];
    assert_close(&at(raw, 0.25)[1..], &levels, 1e-12);
    let moved = "<transform name=\"to_uv\"><translate x=\"0.5\"/></transform>";
    assert_close(&at(moved, 0.25)[1..], &at("", 0.75)[1..], 0.0);
    let clamped = "<string name=\"wrap_mode\" value=\"clamp\"/>";
    assert_close(&at(clamped, 1.25), &at("", 0.75), 0.0);
    assert_close(&at("", 1.25), &at("", 0.25), 0.0);
}

#[test]
fn jpeg_and_radiance_pictures_are_read() {
    let hdr = [
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".as_slice(),
        &[128, 64, 0, 129, 0, 0, 0, 0],
    ]
    .concat();
    let files = folder(&[("a.hdr", &hdr), ("b.jpg", include_bytes!("data/two.jpg"))]);
    let at = |file: &str, inside: &str, u: f64, color| {
        reflectance(&bitmap(file, inside), files.path(), color).value(&DVec2::new(u, 0.5).into())
    };
    let found = ALL.map(|c| at("a.hdr", "", 0.25, c));
    assert_close(&found[1..], &[1.0, 0.5, 0.0], 0.0);
    assert_near(at("a.hdr", "", 0.75, Color::Red), 0.0, 0.0);
    // The expected levels are those that Mitsuba decodes; decoders may differ by one level.
    let raw = "<boolean name=\"raw\" value=\"true\"/>";
    for (u, levels) in [(0.25, [200.0, 100.0, 50.0]), (0.75, [30.0, 60.0, 90.0])] {
        let found = ALL.map(|c| at("b.jpg", raw, u, c) * 255.0);
        assert_close(&found[1..], &levels, 1.01);
    }
}

/// Portable float maps begin with the lowest row. The sign of the scale gives the order of bytes.
#[test]
fn float_maps_are_read() {
    let bytes = |header: &str, numbers: &[f32], swaps: bool| {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend(numbers.iter().flat_map(|v| match swaps {
            true => v.to_be_bytes(),
            false => v.to_le_bytes(),
        }));
        bytes
    };
    let grey = bytes("Pf\n1 2\n-1.0\n", &[0.25, 0.75], false);
    let color = bytes("PF 1 1 0.5 ", &[0.5, 1.0, 0.25], true);
    let short = bytes("Pf\n2 2\n-1\n", &[0.25], false);
    let files = folder(&[("a.pfm", &grey), ("b.pfm", &color), ("c.pfm", &short)]);
    let at = |file: &str, v: f64, color| {
        reflectance(&bitmap(file, ""), files.path(), color).value(&DVec2::new(0.5, v).into())
    };
    let grey = [0.25, 0.75].map(|v| at("a.pfm", v, Color::Luminance));
    assert_close(&grey, &[0.75, 0.25], 0.0);
    let found = ALL.map(|c| at("b.pfm", 0.5, c));
    assert_close(&found[1..], &[0.25, 0.5, 0.125], 0.0);
    let shape = format!(
        "<shape type=\"rectangle\"><bsdf type=\"diffuse\">{}</bsdf></shape>",
        bitmap("c.pfm", "")
    );
    let causes = read_in(&shape, files.path(), Color::Luminance).unwrap_err();
    assert_first(&causes, "ends before its last pixel");
}

/// The test reads two BMP files of 2 × 2 pixels, one with three bytes per pixel and one with a
/// palette. In a BMP file, rows are stored from the lowest to the highest, and colours are stored
/// as blue, green and red. As in Mitsuba, v increases downwards.
#[test]
fn bmp_pictures_are_read() {
    let header = |offset: u32, bits: u16, colors: u32| {
        let mut bytes = b"BM".to_vec();
        for word in [offset + 16, 0, offset, 40, 2, 2] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(1_u16.to_le_bytes());
        bytes.extend(bits.to_le_bytes());
        for word in [0, 16, 0, 0, colors, 0] {
            bytes.extend(word.to_le_bytes());
        }
        bytes
    };
    // Each row of a BMP file is padded to a multiple of four bytes.
    let lower = [50, 100, 200, 90, 60, 30, 0, 0];
    let upper = [0, 0, 255, 255, 0, 0, 0, 0];
    let colors = [header(54, 24, 0), lower.to_vec(), upper.to_vec()].concat();
    let palette = [50, 100, 200, 0, 90, 60, 30, 0, 0, 0, 255, 0, 255, 0, 0, 0];
    let indices = [0, 1, 0, 0, 2, 3, 0, 0];
    let indexed = [header(70, 8, 4), palette.to_vec(), indices.to_vec()].concat();
    let files = folder(&[("a.bmp", &colors), ("b.bmp", &indexed)]);
    let raw = "<boolean name=\"raw\" value=\"true\"/>";
    for file in ["a.bmp", "b.bmp"] {
        for (u, v, levels) in [
            (0.25, 0.75, [200.0, 100.0, 50.0]),
            (0.75, 0.75, [30.0, 60.0, 90.0]),
            (0.25, 0.25, [255.0, 0.0, 0.0]),
            (0.75, 0.25, [0.0, 0.0, 255.0]),
        ] {
            let found = ALL.map(|c| {
                let texture = reflectance(&bitmap(file, raw), files.path(), c);
                texture.value(&DVec2::new(u, v).into()) * 255.0
            });
            assert_close(&found[1..], &levels, 1e-9);
        }
    }
}
