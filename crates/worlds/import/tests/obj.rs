//! Scenes of OBJ and MTL, and PLY: each convention, with values that detect a violation.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_close, folder};
use etendue_import::{Imported, Options, import};
use etendue_world::{Geometry, Material, Texture, Triangles};
use glam::DVec2;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

fn read_all(obj: &str, mtl: &str) -> Result<Imported, Vec<String>> {
    let mut picture = Vec::new();
    let mut encoder = png::Encoder::new(&mut picture, 1, 2);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&[255, 255, 255, 188, 188, 188])
        .unwrap();
    writer.finish().unwrap();
    let files = [
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("a b.png", &picture),
    ];
    let folder = folder(&files);
    let read = import(&folder.path().join("a.obj"), &Options::default());
    read.map_err(|refused| refused.causes.iter().map(ToString::to_string).collect())
}

fn read(obj: &str, mtl: &str) -> Imported {
    let text = format!("mtllib a.mtl\n{SQUARE}{obj}");
    read_all(&text, mtl).unwrap_or_else(|causes| panic!("{causes:#?}"))
}

/// Returns the material of a single square.
fn material(mtl: &str) -> Material {
    let read = read(
        "usemtl m\nf 1/1 2/2 3/3 4/4\n",
        &format!("newmtl m\n{mtl}\n"),
    );
    read.world.materials.into_iter().next().unwrap()
}

/// Returns the material that both sides of a shape have.
fn side(mtl: &str) -> Material {
    match material(mtl) {
        Material::TwoSided(sides) => sides[0].clone(),
        other => panic!("{other:?}"),
    }
}

fn mesh(geometry: &Geometry) -> &Triangles {
    match geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

fn constant(texture: &Texture) -> f64 {
    match texture {
        Texture::Constant(value) => *value,
        other => panic!("{other:?}"),
    }
}

#[test]
fn each_material_is_a_shape() {
    let obj = "f 1 2 3\nusemtl a\nf 1 2 3 4\ng other\nusemtl b\nf 2 3 4\nusemtl a\nf -4 -2 -1\n";
    let shapes = read(
        obj,
        "newmtl a\nKd 0.2 0.2 0.2\nnewmtl b\nKd 0.1 0.1 0.1\nKe 3 3 3\n",
    )
    .world
    .shapes;
    let found: Vec<(&str, usize)> = shapes
        .iter()
        .map(|shape| (shape.name.as_str(), mesh(&shape.geometry).corners().len()))
        .collect();
    assert_eq!(found, [("", 1), ("a", 3), ("b", 1)]);
    // Corners run counterclockwise seen from the front; each shape has its own vertices.
    let triangles = mesh(&shapes[2].geometry);
    assert_eq!(triangles.vertices().len(), 3);
    let [a, b, c] = triangles.corners()[0].map(|i| triangles.vertices()[i as usize]);
    assert!((b - a).cross(c - a).z > 0.0 && !shapes[2].is_flipped);
    assert_close(
        &[constant(shapes[2].emission.as_ref().unwrap())],
        &[3.0],
        1e-9,
    );
    assert!(shapes[1].emission.is_none());
}

#[test]
fn negative_numbers_count_back() {
    let shapes = read("f -4 -3 -2\n", "").world.shapes;
    let triangles = mesh(&shapes[0].geometry);
    let found = triangles.corners()[0].map(|i| triangles.vertices()[i as usize]);
    assert_close(&found[2].to_array(), &[1.0, 1.0, 0.0], 0.0);
}

#[test]
fn pictures_begin_below() {
    let read = read(
        "usemtl m\nf 1/1 2/2 3/3 4/4\n",
        "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd -clamp on a b.png\n",
    );
    let Material::TwoSided(sides) = &read.world.materials[0] else {
        panic!("{:?}", read.world.materials);
    };
    let Material::Diffuse { reflectance } = &sides[0] else {
        panic!("{:?}", sides[0]);
    };
    let triangles = mesh(&read.world.shapes[0].geometry);
    let uvs = triangles.uvs().unwrap();
    let at = |y: f64| {
        let found = triangles
            .vertices()
            .iter()
            .position(|v| (v.y - y).abs() < 1e-9);
        reflectance.value(&DVec2::new(0.5, uvs[found.unwrap()].y).into())
    };
    // The lower row of the picture, at v = 0, has level 188, which is 0.502886 in linear light.
    assert_close(&[at(0.0), at(1.0)], &[0.5 * 0.502_886, 0.5], 1e-6);
}

#[test]
fn options_of_pictures_place_them_upwards() {
    let read = material("map_Kd -s 2 0.5 1 -o 0.25 0.125 a b.png");
    let Material::TwoSided(sides) = read else {
        panic!("{read:?}");
    };
    let Material::Diffuse {
        reflectance: Texture::Bitmap(bitmap),
    } = &sides[0]
    else {
        panic!("{:?}", sides[0]);
    };
    // In the file v = 0.5 maps to 0.375 from below, which is 0.625 from the top.
    let found = bitmap.to_uv.transform_point2(DVec2::new(0.5, 0.5));
    assert_close(&found.to_array(), &[1.25, 0.625], 1e-12);
}

#[test]
fn illumination_tells_the_material() {
    let Material::Phong {
        diffuse,
        specular,
        exponent,
    } = side("Kd 0.1 0.1 0.1\nKs 0.5 0.5 0.5\nNs 20\nillum 2")
    else {
        panic!("no lobe");
    };
    assert_close(
        &[constant(&diffuse), constant(&specular), constant(&exponent)],
        &[0.1, 0.5, 20.0],
        1e-9,
    );
    assert!(matches!(
        side("Kd 1 1 1\nKs 0.5 0.5 0.5\nNs 9\nillum 1"),
        Material::Diffuse { .. }
    ));
    assert!(
        matches!(side("Ks 0.5 0.5 0.5\nillum 3"), Material::Conductor(metal) if metal.index.is_none() && metal.roughness.is_none())
    );
    for illum in [4, 6, 7] {
        let found = material(&format!("Ni 1.4\nillum {illum}"));
        assert!(
            matches!(&found, Material::Dielectric(glass) if (glass.index - 1.4).abs() < 1e-9 && !glass.is_thin),
            "{found:?}"
        );
    }
    for text in ["d 0.25", "Tr 0.75"] {
        let found = material(text);
        assert!(
            matches!(&found, Material::Mask { opacity, .. } if (constant(opacity) - 0.25).abs() < 1e-9),
            "{found:?}"
        );
    }
    assert!(matches!(material("d 1"), Material::TwoSided(_)));
}

#[test]
fn what_is_left_out_is_told_with_its_line() {
    let read = read(
        "usemtl m\nf 1 2 3\nl 1 2\nl 2 3\n",
        "newmtl m\nKa 1 1 1\ndecal x.png\nKa 0 0 0\n",
    );
    let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
    for expected in [
        "a.mtl:2:1: `Ka` is left out, 2 times",
        "a.mtl:3:1: `decal` is left out",
        "a.obj:12:1: l is left out, 2 times",
    ] {
        assert!(
            notes.iter().any(|note| note == expected),
            "{expected}: {notes:#?}"
        );
    }
}

#[test]
fn all_causes_come_at_once() {
    let obj = format!("mtllib a.mtl none.mtl\n{SQUARE}usemtl m\nf 1 2 3\nusemtl k\nf 1 2 3\n");
    let found = read_all(
        &obj,
        "newmtl m\nKd 2 0 0\nNs x\nillum 2.5\nmap_Kd ../../x.png\n",
    )
    .unwrap_err();
    for expected in [
        "a.mtl:2:1: Kd is `2 0 0`; allowed: one number or three, from 0 to 1",
        "a.mtl:3:1: Ns is `x`",
        "a.mtl:4:1: illum is `2.5`",
        "a.mtl:5:1: file `../../x.png`",
        "a.obj:1:1: file `none.mtl` is not found",
        "a.obj:12:1: material `k` is in no mtllib",
    ] {
        assert!(
            found.iter().any(|cause| cause.starts_with(expected)),
            "{expected}: {found:#?}"
        );
    }
}

#[test]
fn ply_files_are_one_grey_surface() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let folder = folder(&[("a.ply", ply.as_bytes())]);
    let world = import(&folder.path().join("a.ply"), &Options::default())
        .unwrap()
        .world;
    assert_eq!((world.shapes.len(), world.cameras.len()), (1, 0));
    let Material::TwoSided(sides) = &world.materials[0] else {
        panic!("{:?}", world.materials);
    };
    assert!(
        matches!(&sides[0], Material::Diffuse { reflectance: Texture::Constant(grey) } if (grey - 0.5).abs() < 1e-12)
    );
}
