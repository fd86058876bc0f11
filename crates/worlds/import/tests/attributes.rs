//! Textures of type `mesh_attribute`, compared with Mitsuba 3.9.1.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, assert_near, assert_refused, folder, read_in};
use etendue_import::Color;
use etendue_world::{Material, Texture, World};
use std::path::Path;

/// A square of two triangles with colours at its vertices and on its faces.
const PLY: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\n\
    property float foo_x\nproperty float foo_y\nproperty float foo_z\nproperty float bar_r\nproperty float bar_g\nproperty float bar_b\n\
    property float q_1\nproperty float z_0\nproperty float z_1\n\
    element face 2\nproperty list uchar int vertex_indices\nproperty float w_0\nproperty float r\nproperty float g\nproperty float b\nproperty float a\nend_header\n\
    -1 -1 0 255 128 0 .1 .2 .3 .4 .5 .6 .7 .9 .95\n1 -1 0 0 0 0 0 0 0 0 0 0 0 0 0\n1 1 0 0 0 0 0 0 0 0 0 0 1 0 0\n-1 1 0 0 0 0 0 0 0 0 0 0 0 0 0\n\
    3 0 1 2 0.25 .1 .2 .3 1\n3 0 2 3 0.5 .1 .2 .3 1\n";

fn files() -> tempfile::TempDir {
    folder(&[
        ("a.ply", PLY),
        ("b.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ])
}

fn texture(property: &str, name: &str, more: &str) -> String {
    format!(
        "<texture type=\"mesh_attribute\" name=\"{property}\"><string name=\"name\" value=\"{name}\"/>{more}</texture>"
    )
}

fn ply(inside: &str) -> String {
    format!("<shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>{inside}</shape>")
}

fn diffuse(name: &str, more: &str) -> String {
    let reflectance = texture("reflectance", name, more);
    ply(&format!("<bsdf type=\"diffuse\">{reflectance}</bsdf>"))
}

fn read(inside: &str, folder: &Path, color: Color) -> World {
    read_in(inside, folder, color).unwrap().world
}

fn values(world: &World) -> Vec<f64> {
    match &world.materials[world.shapes[0].material] {
        Material::Diffuse {
            reflectance: Texture::OfMesh(values),
        } => values.values().to_vec(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn attributes_have_the_names_of_mitsuba() {
    let folder = files();
    let of = |name: &str, color| values(&read(&diffuse(name, ""), folder.path(), color));
    for (name, color, expected) in [
        ("vertex_foo", Color::Red, [0.1, 0.0, 0.0, 0.0]),
        ("vertex_foo", Color::Blue, [0.3, 0.0, 0.0, 0.0]),
        ("vertex_bar_color", Color::Green, [0.5, 0.0, 0.0, 0.0]),
        ("vertex_q", Color::Luminance, [0.7, 0.0, 1.0, 0.0]),
        ("vertex_q", Color::Red, [0.7, 0.0, 1.0, 0.0]),
    ] {
        assert_close(&of(name, color), &expected, 1e-7);
    }
    assert_close(&of("face_w", Color::Luminance), &[0.25, 0.5], 1e-12);
}

#[test]
fn integers_are_scaled_only_by_the_scene() {
    let folder = files();
    let scale = "<float name=\"scale\" value=\"0.00390625\"/>";
    let scene = diffuse("vertex_color", scale);
    let red = values(&read(&scene, folder.path(), Color::Red));
    assert_close(&red, &[255.0 / 256.0, 0.0, 0.0, 0.0], 1e-12);
    let green = values(&read(&scene, folder.path(), Color::Green));
    assert_close(&green, &[0.5, 0.0, 0.0, 0.0], 1e-12);
}

#[test]
fn each_mesh_has_its_own_material() {
    let folder = files();
    let bsdf = format!(
        "<bsdf type=\"diffuse\" id=\"m\">{}</bsdf>",
        texture("reflectance", "face_w", "")
    );
    let flat = "<boolean name=\"face_normals\" value=\"true\"/>";
    let shape = |more: &str| ply(&format!("<ref id=\"m\"/>{more}"));
    let scene = [bsdf, shape(""), shape(""), shape(flat)].concat();
    let world = read(&scene, folder.path(), Color::Luminance);
    let materials: Vec<usize> = world.shapes.iter().map(|shape| shape.material).collect();
    assert_eq!(materials, [0, 0, 1]);
}

#[test]
fn attributes_serve_wherever_textures_do() {
    let folder = files();
    let weight = texture("weight", "face_w", "");
    let two = "<bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/>";
    let blend = ply(&format!("<bsdf type=\"blendbsdf\">{weight}{two}</bsdf>"));
    let world = read(&blend, folder.path(), Color::Luminance);
    assert!(matches!(
        &world.materials[0],
        Material::Blend {
            weight: Texture::OfMesh(_),
            ..
        }
    ));
    let radiance = texture("radiance", "vertex_color", "");
    let light = ply(&format!("<emitter type=\"area\">{radiance}</emitter>"));
    let world = read(&light, folder.path(), Color::Red);
    let largest = world.shapes[0].emission.as_ref().map(Texture::largest);
    assert_near(largest.unwrap(), 255.0, 1e-12);
}

#[test]
fn unsuited_attributes_are_refused() {
    let folder = files();
    let blend = |name: &str| {
        let weight = texture("weight", name, "");
        let two = "<bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/>";
        ply(&format!("<bsdf type=\"blendbsdf\">{weight}{two}</bsdf>"))
    };
    let elsewhere = |plugin: &str, inside: &str| {
        let bsdf = texture("reflectance", "vertex_color", "");
        format!("<shape type=\"{plugin}\">{inside}<bsdf type=\"diffuse\">{bsdf}</bsdf></shape>")
    };
    let scale = |value: &str| format!("<float name=\"scale\" value=\"{value}\"/>");
    let nameless = r#"<texture type="mesh_attribute" name="reflectance"/>"#;
    let nameless = ply(&format!("<bsdf type=\"diffuse\">{nameless}</bsdf>"));
    let obj = "<string name=\"filename\" value=\"b.obj\"/>";
    let scenes = [
        diffuse("vertex_none", ""),
        elsewhere("obj", obj),
        elsewhere("cube", ""),
        elsewhere("sphere", ""),
        blend("vertex_foo"),
        diffuse("face_color", ""),
        diffuse("vertex_z", ""),
        diffuse("vertex_color", ""),
        diffuse("vertex_q", &scale("-1")),
        diffuse("vertex_color", &scale("1e8")),
        nameless,
    ];
    let words = [
        "mesh_attribute `vertex_none` is missing; allowed: vertex_color, vertex_foo, vertex_bar_color, vertex_q, vertex_z, face_color, face_w",
        "mesh_attribute `vertex_color` is missing; the mesh has no attributes",
        "the mesh has no attributes",
        "mesh_attribute `vertex_color` of a shape without a mesh; allowed: vertex_… or face_… of a ply shape",
        "has 3 numbers; allowed: 1, for this property",
        "has 4 numbers; allowed: 1 or 3",
        "has 2 numbers; allowed: 1 or 3",
        "reflectance goes up to 145",
        "reflectance goes down to -1; allowed: 0 or more",
        "times scale is",
        "mesh_attribute without name",
    ];
    for (scene, words) in scenes.into_iter().zip(words) {
        let causes = read_in(&scene, folder.path(), Color::Luminance).unwrap_err();
        let found = causes.iter().any(|cause| cause.contains(words));
        assert!(found, "{words}: {causes:#?}");
        assert!(causes[0].starts_with("text:2:"), "{causes:#?}");
    }
}

#[test]
fn rough_plastic_has_one_roughness() {
    let folder = files();
    let alpha = texture("alpha", "face_w", "");
    let scene = ply(&format!("<bsdf type=\"roughplastic\">{alpha}</bsdf>"));
    let causes = read_in(&scene, folder.path(), Color::Luminance).unwrap_err();
    let message = "alpha of roughplastic is a texture; allowed: a number";
    assert_refused(&causes, &[message]);
}

#[test]
fn polarizing_plastic_is_rough_plastic_with_a_note() {
    let folder = files();
    let read = |plugin: &str| {
        let alpha = r#"<float name="alpha" value="0.3"/>"#;
        let scene = ply(&format!("<bsdf type=\"{plugin}\">{alpha}</bsdf>"));
        read_in(&scene, folder.path(), Color::Luminance).unwrap()
    };
    let [rough, polarizing] = ["roughplastic", "pplastic"].map(read);
    let material = |of: &etendue_import::Imported| format!("{:?}", of.world.materials);
    assert_eq!(material(&rough), material(&polarizing));
    assert_eq!(polarizing.notes.len(), rough.notes.len() + 1);
}
