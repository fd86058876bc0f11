//! Scenes of OBJ and MTL, and PLY: each convention, with values that detect a violation.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{
    PLY, all_notes, assert_close, assert_near, assert_told, constant, first_triangle, front_side,
    mesh, png, read_files, reflectance,
};
use etendue_import::Imported;
use etendue_world::{Material, Texture};
use glam::DVec2;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

fn read_all(obj: &str, mtl: &str) -> Result<Imported, Vec<String>> {
    let picture = png([1, 2], &[255, 255, 255, 188, 188, 188]);
    let [obj, mtl] = [obj, mtl].map(str::as_bytes);
    read_files(&[("a.obj", obj), ("a.mtl", mtl), ("a b.png", &picture)])
}

fn read(obj: &str, mtl: &str) -> Imported {
    let text = format!("mtllib a.mtl\n{SQUARE}{obj}");
    read_all(&text, mtl).unwrap_or_else(|causes| panic!("{causes:#?}"))
}

/// The material of a single square.
fn material(mtl: &str) -> Material {
    let read = read(
        "usemtl m\nf 1/1 2/2 3/3 4/4\n",
        &format!("newmtl m\n{mtl}\n"),
    );
    read.world.materials.into_iter().next().unwrap()
}

/// The material that both sides of a shape have.
fn side(mtl: &str) -> Material {
    let material = material(mtl);
    assert!(matches!(material, Material::TwoSided(_)), "{material:?}");
    front_side(&material).clone()
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
        .map(|shape| (shape.name.as_str(), mesh(shape).corners().len()))
        .collect();
    assert_eq!(found, [("", 1), ("a", 3), ("b", 1)]);
    // Corners run counterclockwise seen from the front; each shape has its own vertices.
    let triangles = mesh(&shapes[2]);
    assert_eq!(triangles.vertices().len(), 3);
    let [a, b, c] = first_triangle(triangles);
    assert!((b - a).cross(c - a).z > 0.0 && !shapes[2].is_flipped);
    assert_near(constant(shapes[2].emission.as_ref().unwrap()), 3.0, 1e-9);
    assert!(shapes[1].emission.is_none());
}

#[test]
fn negative_numbers_count_back() {
    let shapes = read("f -4 -3 -2\n", "").world.shapes;
    let triangles = mesh(&shapes[0]);
    let found = first_triangle(triangles);
    assert_close(&found[2].to_array(), &[1.0, 1.0, 0.0], 0.0);
}

#[test]
fn pictures_begin_below() {
    let read = read(
        "usemtl m\nf 1/1 2/2 3/3 4/4\n",
        "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd -clamp on a b.png\n",
    );
    assert!(matches!(read.world.materials[0], Material::TwoSided(_)));
    let reflectance = reflectance(&read.world.materials[0]);
    let triangles = mesh(&read.world.shapes[0]);
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
    let read = side("map_Kd -s 2 0.5 1 -o 0.25 0.125 a b.png");
    let Texture::Bitmap(bitmap) = reflectance(&read) else {
        panic!("{read:?}");
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
    let notes = all_notes(&read);
    for expected in [
        "a.mtl:2:1: `Ka` is left out, 2 times",
        "a.mtl:3:1: `decal` is left out",
        "a.obj:12:1: l is left out, 2 times",
    ] {
        assert!(notes.iter().any(|note| note == expected), "{notes:#?}");
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
    let expected = [
        "a.mtl:2:1: Kd is `2 0 0`; allowed: one number or three, from 0 to 1",
        "a.mtl:3:1: Ns is `x`",
        "a.mtl:4:1: illum is `2.5`",
        "a.mtl:5:1: file `../../x.png`",
        "a.obj:1:1: file `none.mtl` is not found",
        "a.obj:12:1: material `k` is in no mtllib",
    ];
    assert_told(&found, &expected);
}

#[test]
fn ply_files_are_one_grey_surface() {
    let world = read_files(&[("a.ply", PLY.as_bytes())]).unwrap().world;
    assert_eq!((world.shapes.len(), world.cameras.len()), (1, 0));
    assert!(matches!(world.materials[0], Material::TwoSided(_)));
    assert_near(constant(reflectance(&world.materials[0])), 0.5, 1e-12);
}
