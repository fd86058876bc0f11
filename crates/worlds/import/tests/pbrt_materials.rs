//! Materials and textures of pbrt-v4.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, assert_first, assert_near, constant, folder, png, reflectance};
use crate::pbrt_scenes::{causes, material, notes, read_in, scene, world};
use etendue_import::Color;
use etendue_world::{Material, MicrofacetDistribution};
use glam::DVec2;

/// Returns α along u and v, or `None` for a mirror.
fn alpha(parameters: &str) -> Option<[f64; 2]> {
    match material(&format!("Material \"conductor\" {parameters}")) {
        Material::Conductor(metal) => metal.roughness.map(|rough| {
            assert_eq!(rough.distribution, MicrofacetDistribution::Ggx);
            [constant(&rough.alpha[0]), constant(&rough.alpha[1])]
        }),
        other => panic!("{other:?}"),
    }
}

#[test]
fn roughness_is_remapped_by_its_root() {
    assert_eq!(alpha(""), None);
    assert_close(
        &alpha("\"float roughness\" 0.09").unwrap(),
        &[0.3; 2],
        1e-12,
    );
    let both = "\"float uroughness\" 0.04 \"float vroughness\" 0.25";
    assert_close(&alpha(both).unwrap(), &[0.2, 0.5], 1e-12);
    let raw = "\"float roughness\" 0.09 \"bool remaproughness\" false";
    assert_close(&alpha(raw).unwrap(), &[0.09; 2], 1e-12);
    // pbrt treats α below 0.001 as a mirror.
    assert_eq!(alpha("\"float roughness\" 0.0000005"), None);
}

#[test]
fn what_reflects_does_so_on_both_sides() {
    for (plugin, is_both) in [
        ("diffuse", true),
        ("conductor", true),
        ("coateddiffuse", true),
        ("dielectric", false),
        ("thindielectric", false),
    ] {
        let world = world(&format!("Material \"{plugin}\"\nShape \"sphere\""));
        let of = &world.materials[world.shapes[0].material];
        assert_eq!(matches!(of, Material::TwoSided(_)), is_both, "{plugin}");
    }
    // pbrt's default material is also diffuse, with reflectance one half.
    assert_near(constant(reflectance(&material(""))), 0.5, 0.0);
}

#[test]
fn metals_have_an_index() {
    let index = |parameters: &str| match material(&format!("Material \"conductor\" {parameters}")) {
        Material::Conductor(metal) => metal.index.unwrap(),
        other => panic!("{other:?}"),
    };
    // The default metal is copper.
    let copper = index("\"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\"");
    assert_close(&index(""), &copper, 0.0);
    let luminance = |[r, g, b]: [f64; 3]| 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
    let [n, k] = [
        [0.105_056, 0.976_819, 1.203_228],
        [3.270_163, 2.589_603, 2.366_343],
    ];
    assert_close(&copper, &[luminance(n), luminance(k)], 1e-5);
    assert_close(
        &index("\"rgb eta\" [2 2 2] \"rgb k\" [3 3 3]"),
        &[2.0, 3.0],
        1e-5,
    );
    // At normal incidence a metal with n = 1 reflects k² / (4 + k²).
    let [n, k] = index("\"rgb reflectance\" [0.6 0.6 0.6]");
    assert_close(&[n, k * k / (4.0 + k * k)], &[1.0, 0.6], 1e-5);
}

#[test]
fn glass_has_an_index() {
    let index = |parameters: &str| match material(&format!("Material \"dielectric\" {parameters}"))
    {
        Material::Dielectric(glass) => glass.index,
        other => panic!("{other:?}"),
    };
    assert_close(&[index(""), index("\"float eta\" 1.33")], &[1.5, 1.33], 0.0);
    // BK7 has n = 1.5168 at 587.6 nm.
    assert_near(index("\"spectrum eta\" \"glass-BK7\""), 1.5168, 1e-3);
    let eta = "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\nShape \"sphere\"";
    assert_eq!(
        notes(eta),
        ["text:3:23: approximated: eta is the same at all wavelengths"]
    );
}

#[test]
fn translucent_materials_reflect_and_transmit() {
    let translucent = "Material \"diffusetransmission\"";
    let of = |more: &str| match material(&format!("{translucent} {more}")) {
        Material::DiffuseTransmission {
            reflectance,
            transmittance,
        } => [reflectance, transmittance].map(|of| constant(&of)),
        other => panic!("{other:?}"),
    };
    assert_close(&of(""), &[0.25, 0.25], 0.0);
    // A spectrum of one value keeps it within the sums over wavelengths.
    let given = of(
        "\"spectrum reflectance\" [300 0.1 800 0.1] \"spectrum transmittance\" [300 0.6 800 0.6]",
    );
    assert_close(&given, &[0.1, 0.6], 2e-3);
    let bright =
        "\"spectrum reflectance\" [300 0.6 800 0.6] \"spectrum transmittance\" [300 0.6 800 0.6]";
    let found = causes(&format!("{translucent} {bright}\nShape \"sphere\""));
    assert_first(
        &found,
        "reflectance and transmittance together go up to 1.19",
    );
}

#[test]
fn mixtures_have_amounts_of_the_second() {
    let two = "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" \"conductor\"";
    let mix = "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.25";
    match material(&format!("{two} {mix}")) {
        Material::Blend { weight, of } => {
            assert_near(constant(&weight), 0.25, 0.0);
            assert!(
                matches!(&of[1], Material::TwoSided(both) if matches!(both[0], Material::Conductor(_)))
            );
        }
        other => panic!("{other:?}"),
    }
    let itself = "MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"] NamedMaterial \"a\" Shape \"sphere\"";
    assert_first(&causes(itself), "the material contains itself");
}

#[test]
fn what_has_no_equal_is_refused() {
    for plugin in ["hair", "measured", "subsurface", "coatedconductor"] {
        let found = causes(&format!(
            "Material \"{plugin}\"\nShape \"sphere\" Shape \"disk\""
        ));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("text:3:1: material"), "{found:?}");
    }
    let coated = notes("Material \"coateddiffuse\"\nShape \"sphere\" Shape \"disk\"");
    assert_eq!(coated.len(), 1, "{coated:?}");
    assert!(coated[0].contains("approximated: the material is a plastic, whose rough coat"));
}

#[test]
fn interfaces_are_no_surfaces() {
    let inside = "Material \"interface\" Shape \"sphere\" Material \"\" Shape \"sphere\"";
    assert!(world(inside).shapes.is_empty());
}

/// The value of the reflectance at the point (u, v) of a shape in a world.
fn value(inside: &str, shape: &str, uv: [f64; 2]) -> f64 {
    let declared = format!("{inside} Material \"diffuse\" \"texture reflectance\" \"t\" {shape}");
    let world = world(&declared);
    reflectance(&world.materials[world.shapes[0].material]).value(&DVec2::from(uv).into())
}

#[test]
fn squares_of_a_checkerboard_are_one_unit() {
    let board = "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 3 \"float vdelta\" 0.5 \"rgb tex1\" [.8 .8 .8] \"rgb tex2\" [.2 .2 .2]";
    let mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    for (uv, expected) in [
        ([0.1, 0.1], 0.8),
        ([0.4, 0.1], 0.2),
        ([0.7, 0.4], 0.8),
        ([0.1, 0.6], 0.2),
        ([-0.1, 0.1], 0.2),
    ] {
        assert_near(value(board, mesh, uv), expected, 1e-5);
    }
    // In pbrt, v of a sphere increases from its lower pole, and u of a disk is the azimuth.
    let rings = "Texture \"t\" \"spectrum\" \"checkerboard\" \"float vscale\" 4 \"rgb tex1\" [.8 .8 .8] \"rgb tex2\" [.2 .2 .2]";
    assert_near(value(rings, "Shape \"sphere\"", [0.5, 0.99]), 0.8, 1e-5);
    assert_near(value(rings, "Shape \"sphere\"", [0.5, 0.01]), 0.2, 1e-5);
    // The edge of a disk has v = 0; in a world, u is the radius.
    assert_near(value(rings, "Shape \"disk\"", [0.99, 0.3]), 0.8, 1e-5);
    assert_near(value(rings, "Shape \"disk\"", [0.01, 0.3]), 0.2, 1e-5);
}

#[test]
fn textures_scale_and_mix() {
    let mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    let scale = "Texture \"b\" \"spectrum\" \"checkerboard\" Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"b\" \"float scale\" 0.25";
    assert_near(value(scale, mesh, [0.5, 0.5]), 0.25, 1e-12);
    let mix = "Texture \"t\" \"spectrum\" \"mix\" \"rgb tex1\" [.4 .4 .4] \"rgb tex2\" [.8 .8 .8] \"float amount\" 0.25";
    assert_near(value(mix, mesh, [0.5, 0.5]), 0.5, 1e-5);
    let itself = "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\" Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"disk\"";
    assert_first(&causes(itself), "contains itself");
    let noise = "Texture \"t\" \"spectrum\" \"marble\" Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"disk\"";
    assert_first(&causes(noise), "texture `marble` is not supported");
}

#[test]
fn pictures_have_an_encoding_and_stand_upright() {
    // The upper pixel is white.
    let folder = folder(&[("a.png", &png([1, 2], &[255, 128]))]);
    let value = |parameters: &str, v: f64| {
        let inside = format!(
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"string filter\" \"point\" {parameters} Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"cylinder\""
        );
        let read = read_in(&scene("", &inside), folder.path(), Color::Luminance).unwrap();
        let material = &read.world.materials[read.world.shapes[0].material];
        reflectance(material).value(&DVec2::new(0.5, v).into())
    };
    let grey = 128.0 / 255.0;
    assert_close(&[value("", 0.9), value("", 0.1)], &[1.0, 0.215_861], 1e-6);
    assert_near(value("\"string encoding\" \"linear\"", 0.1), grey, 1e-12);
    assert_near(
        value("\"string encoding\" \"gamma 3\"", 0.1),
        grey.powi(3),
        1e-12,
    );
    let inverted = "\"string encoding\" \"linear\" \"bool invert\" true \"float scale\" 0.5";
    assert_near(value(inverted, 0.1), 1.0 - grey / 2.0, 1e-12);
}
