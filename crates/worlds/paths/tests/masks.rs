//! Light that passes partly transparent surfaces, from each kind of light and for each format.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::known::{ASIDE, assert_seen, downward, floor, scaled, seen, shape, square};
use etendue_field::{LatLong, Raster};
use etendue_import::{Options, import};
use etendue_world::{Falloff, Geometry, Light, Material, Shape, SkyMap, Texture, World};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// Height of the lights above the floor.
const HEIGHT: f64 = 4.0;

/// Returns lights above the floor of [`floor`], each with the radiance that it gives the floor at
/// the origin.
fn lights() -> Vec<(&'static str, Vec<Shape>, Vec<Light>, f64)> {
    let position = HEIGHT * DVec3::Z;
    let squared = HEIGHT * HEIGHT;
    let point = Light::Point {
        position,
        intensity: 3.0,
    };
    let spot = Light::Spot {
        to_world: downward(HEIGHT),
        intensity: 4.0,
        beam: 0.3,
        cutoff: 0.5,
        falloff: Falloff::Angle,
        picture: None,
    };
    let projector = Light::Projector {
        to_world: downward(HEIGHT),
        half: DVec2::splat(0.1),
        picture: Texture::Constant(0.5),
        scale: 4.0,
    };
    let sun = Light::Directional {
        direction: DVec3::new(0.6, 0.0, -0.8),
        irradiance: 2.0,
    };
    let sky = Light::Sky(SkyMap {
        to_world: DMat3::IDENTITY,
        radiance: Arc::new(LatLong::from_pole_to_pole(
            Raster::new(4, 3, vec![0.7; 12]).unwrap(),
        )),
    });
    let constant = Light::Constant { radiance: 0.7 };
    // Emitting shapes have the size of half a metre.
    let lamp = |geometry| Shape {
        to_world: scaled(0.5, HEIGHT) * downward(0.0),
        ..shape(geometry, scaled(1.0, 0.0), 1, Some(6.0))
    };
    // The form factor of a square, as four squares with a corner above the point (Howell, B-3).
    let x: f64 = 0.5 / HEIGHT;
    let of_square = 4.0 / PI * x / x.hypot(1.0) * (x / x.hypot(1.0)).atan();
    let alone = [
        ("point", point, 3.0 / PI / squared),
        ("spot", spot, 4.0 / PI / squared),
        ("projector", projector, 2.0 / PI / squared),
        ("sun", sun, 2.0 / PI * 0.8),
        ("constant", constant, 0.7),
        ("sky", sky, 0.7),
    ];
    let lamps = [
        ("sphere", Geometry::Sphere, 0.25 / squared),
        ("disc", Geometry::Disc, 0.25 / (squared + 0.25)),
        ("square", Geometry::Rectangle, of_square),
        ("mesh", square(), of_square),
    ];
    // The floor reflects one half of the light.
    let alone = alone.map(|(name, light, sum)| (name, vec![], vec![light], 0.5 * sum));
    let lamps = lamps.map(|(name, of, factor)| (name, vec![lamp(of)], vec![], 0.5 * 6.0 * factor));
    alone.into_iter().chain(lamps).collect()
}

/// Checks that light of each kind loses `1 - share` above the floor of a world. Light that has met
/// only the floor counts, so that surfaces which light passes must not count.
fn assert_passes(world: &World, share: f64, name: &str) {
    for (light, shapes, lights, radiance) in lights() {
        let mut world = world.clone();
        world.depth = Some(1);
        let black = world.materials.len();
        world.materials.push(Material::diffuse(0.0));
        world.shapes.extend(shapes.into_iter().map(|shape| Shape {
            material: black,
            ..shape
        }));
        world.lights = lights;
        let expected = share * radiance;
        let (mean, error) = seen(&world, ASIDE, DVec3::ZERO, 20_000);
        let place = format!("{name}, {light}: {mean} ± {error}, not {expected}");
        // The second term is the rounding error where all paths find the same value.
        assert!(
            (mean - expected).abs() <= 5.0 * error + 1e-9 * expected,
            "{place}"
        );
        assert!(error <= 0.02 * expected, "too little to tell: {place}");
    }
}

fn masked(opacity: Texture) -> Material {
    Material::Mask {
        opacity,
        of: Box::new(Material::diffuse(0.0)),
    }
}

/// The floor below sheets of these materials, which the camera sees from below.
fn sheets(materials: Vec<Material>) -> World {
    let mut world = floor(vec![], vec![]);
    for (i, material) in (0_u32..).zip(materials) {
        let place = scaled(1000.0, 1.5 + 0.25 * f64::from(i));
        let number = world.materials.len();
        world
            .shapes
            .push(shape(Geometry::Rectangle, place, number, None));
        world.materials.push(material);
    }
    world
}

#[test]
fn each_kind_of_light_passes_with_one_minus_the_opacity() {
    assert_passes(&sheets(vec![masked(Texture::Constant(0.3))]), 0.7, "one");
    let three = [0.3, 0.0, 0.4].map(|opacity| masked(Texture::Constant(opacity)));
    assert_passes(&sheets(three.to_vec()), 0.42, "three");
    // A quarter of a mixture is half transparent.
    let mixed = Material::Blend {
        weight: Texture::Constant(0.25),
        of: Box::new([Material::diffuse(0.0), masked(Texture::Constant(0.5))]),
    };
    assert_passes(&sheets(vec![mixed]), 0.125, "a mixture");
}

#[test]
fn nothing_passes_an_opaque_sheet() {
    let opaque = [masked(Texture::Constant(1.0)), Material::diffuse(0.0)];
    for material in opaque {
        for (light, shapes, lights, _) in lights() {
            let mut world = sheets(vec![material.clone()]);
            world.shapes.extend(shapes);
            world.lights = lights;
            let (mean, _) = seen(&world, ASIDE, DVec3::ZERO, 1000);
            // A part of 10⁻⁶ of the sky shines between the sheet and the floor.
            assert!(mean.abs() < 1e-6, "{light}: {mean}");
        }
    }
}

/// The sheet scatters the light that does not pass: a camera above sees its reflectance, and the
/// floor through it.
#[test]
fn a_sheet_scatters_what_does_not_pass() {
    let mut world = sheets(vec![Material::Mask {
        opacity: Texture::Constant(0.3),
        of: Box::new(Material::diffuse(0.8)),
    }]);
    world.lights = vec![Light::Directional {
        direction: DVec3::NEG_Z,
        irradiance: 2.0,
    }];
    // The sheet is black below, so light does not go to and fro.
    let expected = (0.3 * 0.8 + 0.7 * 0.7 * 0.5) * 2.0 / PI;
    assert_seen(&world, DVec3::new(1.0, 0.5, 3.0), DVec3::ZERO, expected);
}

/// Files of each format with a floor of reflectance ½ in z = 0, and a black sheet in z = 1.5 with
/// an alpha of ¼.
#[test]
fn the_alpha_of_each_format_lets_light_pass() {
    // Without its coat, a material of glTF is diffuse.
    let bare = r#""extensions":{"KHR_materials_specular":{"specularFactor":0}}"#;
    let material = |level: f64, alpha: f64, more: &str| {
        format!(
            r#"{{"pbrMetallicRoughness":{{"baseColorFactor":[{level},{level},{level},{alpha}],"metallicFactor":0}},{bare}{more}}}"#
        )
    };
    let sheet = |alpha: &str| {
        gltf([
            &material(0.5, 1.0, ""),
            &material(0.0, 0.25, &format!(",{alpha}")),
        ])
    };
    for (name, files) in [
        ("a.xml", vec![("a.xml", MITSUBA.to_owned())]),
        ("a.pbrt", vec![("a.pbrt", PBRT.to_owned())]),
        ("a.gltf", sheet(r#""alphaMode":"BLEND""#)),
        (
            "a.obj",
            vec![("a.obj", OBJ.to_owned()), ("a.mtl", MTL.to_owned())],
        ),
    ] {
        let mut world = read(name, &files);
        // pbrt makes a spectrum of each colour, which changes a reflectance slightly.
        world.materials[world.shapes[0].material] = Material::diffuse(0.5);
        assert_passes(&world, 0.75, name);
    }
    // With a cutoff, glTF shows the sheet if its alpha is not below the cutoff.
    let cut = |cutoff| sheet(&format!(r#""alphaMode":"MASK","alphaCutoff":{cutoff}"#));
    assert_passes(&read("a.gltf", &cut(0.26)), 1.0, "cut off");
    let below = read("a.gltf", &cut(0.24));
    let is_opaque = |material: &Material| !matches!(material, Material::Mask { .. });
    assert!(below.materials.iter().all(is_opaque));
}

pub(crate) fn read(name: &str, files: &[(&str, String)]) -> World {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let read = import(&folder.path().join(name), &Options::default());
    read.unwrap_or_else(|refused| panic!("{refused:?}")).world
}

const MITSUBA: &str = r#"<scene version="3.0.0">
<shape type="rectangle"><transform name="to_world"><scale value="10"/></transform>
<bsdf type="diffuse"><spectrum name="reflectance" value="0.5"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="1000"/><translate z="1.5"/></transform>
<bsdf type="mask"><float name="opacity" value="0.25"/>
<bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></bsdf></shape>
</scene>"#;

const PBRT: &str = r#"WorldBegin
Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3]
  "point3 P" [-10 -10 0 10 -10 0 10 10 0 -10 10 0]
Material "diffuse" "rgb reflectance" [0 0 0]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "float alpha" 0.25
  "point3 P" [-1000 -1000 1.5 1000 -1000 1.5 1000 1000 1.5 -1000 1000 1.5]
"#;

const OBJ: &str = "mtllib a.mtl
v -10 -10 0\nv 10 -10 0\nv 10 10 0\nv -10 10 0
v -1000 -1000 1.5\nv 1000 -1000 1.5\nv 1000 1000 1.5\nv -1000 1000 1.5
usemtl floor\nf 1 2 3 4\nusemtl sheet\nf 5 6 7 8\n";

const MTL: &str = "newmtl floor\nKd 0.5 0.5 0.5\nnewmtl sheet\nKd 0 0 0\nd 0.25\n";

/// The files of a glTF scene with the materials of a floor in z = 0, and of a sheet above.
pub(crate) fn gltf([floor, sheet]: [&str; 2]) -> Vec<(&'static str, String)> {
    // A square in z = 0 from −1 to 1, with texts of 32-bit numbers.
    let data = "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAECAAID";
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_materials_specular"],
"nodes":[{{"mesh":0,"scale":[10,10,1]}},{{"mesh":1,"scale":[1000,1000,1],"translation":[0,0,1.5]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}},
{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":1}}]}}],
"materials":[{floor},{sheet}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":6}}],
"buffers":[{{"byteLength":54,"uri":"data:application/octet-stream;base64,{data}"}}]}}"#
    );
    vec![("a.gltf", text)]
}
