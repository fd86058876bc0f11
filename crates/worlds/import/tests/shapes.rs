//! Shapes: placement, fronts, normals and texture coordinates, compared with Mitsuba 3.9.1.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::common::{
    assert_close, assert_first, assert_near, cases, first_triangle, folder, mesh, read_in, world,
};
use etendue_import::Color;
use etendue_world::{Shape, Texture, World};
use flate2::{Compression, write::ZlibEncoder};
use glam::{DAffine3, DMat3, DVec3};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

const MIRROR: &str = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
/// Two triangles that meet at a right angle, along the Y axis.
const BEND: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";
const UVS: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
const BACK: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n";

fn meshes() -> tempfile::TempDir {
    let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 0.25\n3 0 1 2\n";
    folder(&[
        ("bend.obj", BEND),
        ("uvs.obj", UVS),
        ("back.obj", BACK),
        ("a.ply", ply),
    ])
}

fn read(inside: &str, folder: &Path) -> World {
    read_in(inside, folder, Color::Luminance).unwrap().world
}

/// A shape with the steps of its placement.
fn placed(plugin: &str, steps: &str) -> String {
    let transform = format!("<transform name=\"to_world\">{steps}</transform>");
    format!("<shape type=\"{plugin}\">{transform}</shape>")
}

fn file(plugin: &str, name: &str, inside: &str) -> String {
    format!("<shape type=\"{plugin}\"><string name=\"filename\" value=\"{name}\"/>{inside}</shape>")
}

/// The shading normal of a vertex in the world.
fn shading_normal(shape: &Shape, vertex: usize) -> [f64; 3] {
    let normal = mesh(shape).normals().unwrap()[vertex];
    turned(shape, normal)
}

/// A normal of a shape in the world, on its front.
fn turned(shape: &Shape, normal: DVec3) -> [f64; 3] {
    let sign = if shape.is_flipped { -1.0 } else { 1.0 };
    let map = shape.to_world.matrix3.inverse().transpose();
    ((map * normal).normalize() * sign).to_array()
}

#[test]
fn fronts_of_simple_shapes() {
    for (plugin, inside, at, front) in [
        ("rectangle", "", DVec3::Z, DVec3::Z),
        ("rectangle", MIRROR, DVec3::Z, DVec3::Z),
        (
            "rectangle",
            "<boolean name=\"flip_normals\" value=\"true\"/>",
            DVec3::Z,
            DVec3::NEG_Z,
        ),
        ("disk", MIRROR, DVec3::Z, DVec3::Z),
        ("sphere", "", DVec3::Z, DVec3::Z),
        // A mirroring placement turns only spheres inside out.
        ("sphere", MIRROR, DVec3::Z, DVec3::NEG_Z),
        ("cylinder", MIRROR, DVec3::Y, DVec3::Y),
        ("cube", MIRROR, DVec3::Z, DVec3::Z),
    ] {
        let world = world(&format!("<shape type=\"{plugin}\">{inside}</shape>"));
        let found = turned(&world.shapes[0], at);
        assert_close(&found, &front.to_array(), 0.0);
    }
}

#[test]
fn spheres_and_cylinders_are_placed() {
    let sphere = "<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/><float name=\"radius\" value=\"2\"/>\
                  <transform name=\"to_world\"><scale value=\"3\"/></transform></shape>";
    let map = world(sphere).shapes[0].to_world;
    let expected = DAffine3::from_mat3_translation(
        DMat3::from_diagonal(DVec3::splat(6.0)),
        DVec3::new(3.0, 6.0, 9.0),
    );
    assert!(map.abs_diff_eq(expected, 0.0), "{map}");
    let cylinder = "<shape type=\"cylinder\"><point name=\"p0\" value=\"1,2,3\"/><point name=\"p1\" value=\"2,4,3\"/><float name=\"radius\" value=\"0.5\"/></shape>";
    let map = world(cylinder).shapes[0].to_world;
    let expected = [
        0.4,
        -0.2,
        -0.223_606_8,
        -0.2,
        0.1,
        -0.447_213_6,
        1.0,
        2.0,
        0.0,
    ];
    assert_close(&map.matrix3.to_cols_array(), &expected, 1e-7);
    for (shape, inside) in cases(
        r#"
        cylinder => <scale x="2"/>
        rectangle => <scale x="0"/>
        "#,
    ) {
        assert_eq!(common::causes(&placed(shape, inside)).len(), 1);
    }
    world(&placed("cylinder", "<scale value=\"2 2 5\"/>"));
}

/// The bounding boxes of Mitsuba 3.9 show that the radius of its sphere is the length of the placed
/// X axis.
#[test]
fn uneven_spheres_are_those_of_mitsuba() {
    let rotated = r#"<rotate z="1" angle="30"/><scale y="2"/>"#;
    for (scales, radius) in [
        ("<scale x=\"2\"/>", 2.0),
        ("<scale y=\"2\"/>", 1.0),
        (rotated, 1.75_f64.sqrt()),
        ("<scale x=\"-3\"/>", 3.0),
    ] {
        let inside = placed("sphere", scales);
        let map = world(&inside).shapes[0].to_world.matrix3;
        for axis in [map.x_axis, map.y_axis, map.z_axis] {
            assert!((axis.length() - radius).abs() < 1e-12, "{scales}: {axis}");
        }
        assert_first(&common::notes(&inside), "as in Mitsuba");
    }
    // An instance makes a true ellipsoid, which may not emit.
    let group = |inside: &str| {
        format!(
            "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\">{inside}</shape></shape>\
             <shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><scale x=\"2\"/></transform></shape>"
        )
    };
    let map = world(&group("")).shapes[0].to_world.matrix3;
    assert_close(&map.to_cols_array()[..5], &[2.0, 0.0, 0.0, 0.0, 1.0], 1e-12);
}

#[test]
fn meshes_without_normals_get_smooth_ones() {
    let files = meshes();
    let at = |inside: &str| {
        let world = read(&file("obj", "bend.obj", inside), files.path());
        shading_normal(&world.shapes[0], 0)
    };
    let half = 0.5_f64.sqrt();
    assert_close(&at(""), &[half, 0.0, half], 1e-12);
    // Normals are computed from the placed triangles: the mirror flips them, as in Mitsuba.
    assert_close(&at(MIRROR), &[half, 0.0, -half], 1e-12);
    let stretched = "<transform name=\"to_world\"><scale z=\"3\"/></transform>";
    assert_close(&at(stretched), &[half, 0.0, half], 1e-12);
    let flipped = "<boolean name=\"flip_normals\" value=\"true\"/>";
    assert_close(&at(flipped), &[-half, 0.0, -half], 1e-12);
    let flat = "<boolean name=\"face_normals\" value=\"true\"/>";
    let world = read(&file("obj", "bend.obj", flat), files.path());
    assert!(mesh(&world.shapes[0]).normals().is_none());
    assert_close(&turned(&world.shapes[0], DVec3::Z), &[0.0, 0.0, 1.0], 0.0);
}

#[test]
fn normals_of_the_file_say_where_the_front_is() {
    let files = meshes();
    let world = read(&file("obj", "back.obj", ""), files.path());
    let shape = &world.shapes[0];
    assert_close(&shading_normal(shape, 0), &[0.0, 0.0, -1.0], 0.0);
    let [a, b, c] = first_triangle(mesh(shape));
    assert!((b - a).cross(c - a).z < 0.0);
    let mirrored = read(&file("obj", "back.obj", MIRROR), files.path());
    let normal = shading_normal(&mirrored.shapes[0], 0);
    assert_close(&normal, &[0.0, 0.0, -1.0], 0.0);
}

#[test]
fn textures_of_obj_files_are_turned_over() {
    let files = meshes();
    let last = |plugin: &str, name: &str, inside: &str| {
        let world = read(&file(plugin, name, inside), files.path());
        let uvs = mesh(&world.shapes[0]).uvs().unwrap();
        uvs.last().unwrap().to_array()
    };
    let flip = |on: bool| format!("<boolean name=\"flip_tex_coords\" value=\"{on}\"/>");
    assert_close(&last("obj", "uvs.obj", ""), &[0.0, 0.0], 0.0);
    assert_close(&last("obj", "uvs.obj", &flip(false)), &[0.0, 1.0], 0.0);
    assert_close(&last("ply", "a.ply", ""), &[0.0, 0.25], 0.0);
    assert_close(&last("ply", "a.ply", &flip(true)), &[0.0, 0.75], 0.0);
}

#[test]
fn instances_share_triangles() {
    let files = meshes();
    let moved = "<transform name=\"to_world\"><translate x=\"1\"/></transform>";
    let group = file("ply", "a.ply", moved);
    let instance = |x: i32| {
        format!(
            "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><scale value=\"{x}\"/></transform></shape>"
        )
    };
    let inside = format!(
        "<shape type=\"shapegroup\" id=\"g\">{group}</shape>{}{}",
        instance(2),
        instance(-3)
    );
    let world = read(&inside, files.path());
    let [first, second] = &world.shapes[..] else {
        panic!("{:?}", world.shapes);
    };
    assert!(Arc::ptr_eq(mesh(first), mesh(second)));
    let places = [first, second].map(|s| s.to_world.translation.x);
    assert_close(&places, &[2.0, -3.0], 0.0);
    let shining = "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"><emitter type=\"area\"/></shape></shape><shape type=\"instance\"><ref id=\"g\"/></shape>";
    assert!(common::causes(shining)[0].contains("an emitter within a shapegroup"));
}

#[test]
fn instances_share_what_their_group_holds() {
    let group = "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\" id=\"ball\"><bsdf type=\"conductor\"/></shape><shape type=\"cube\"/></shape>";
    let instance = |scale: &str| {
        format!(
            "\n<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><scale value=\"{scale}\"/></transform></shape>"
        )
    };
    let read = world(&[group, &instance("2"), &instance("3")].concat());
    let materials: Vec<usize> = read.shapes.iter().map(|shape| shape.material).collect();
    assert_eq!(materials, [0, 1, 0, 1]);
    assert_eq!(read.shapes[2].name, "ball");
    assert!(Arc::ptr_eq(mesh(&read.shapes[1]), mesh(&read.shapes[3])));
    // A fault of a placement is reported at the instance, and a fault of the group once.
    let small = common::causes(&[group, &instance("1"), &instance("1e-12")].concat());
    assert_eq!(small.len(), 2, "{small:#?}");
    assert!(small[0].starts_with("text:4:"), "{small:#?}");
    assert!(small[0].contains("shape `instance` is placed out of range"));
    let fault = group.replace("conductor", "velvet");
    let fault = common::causes(&[&fault, &*instance("1"), &instance("2")].concat());
    assert_eq!(fault.len(), 1, "{fault:#?}");
}

#[test]
fn shapes_without_a_material_are_grey_or_black() {
    let inside = "<shape type=\"sphere\"/><shape type=\"sphere\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"2\"/></emitter></shape>";
    let world = world(inside);
    let reflectances = [0, 1].map(|i: usize| {
        let material = &world.materials[world.shapes[i].material];
        common::reflectance(material).largest()
    });
    assert_close(&reflectances, &[0.5, 0.0], 0.0);
    let emission = world.shapes[1].emission.as_ref().map(Texture::largest);
    assert_near(emission.unwrap(), 2.0, 1e-12);
    assert!(world.shapes[0].emission.is_none());
}

/// A mesh file of version 4. It has two meshes of one triangle each, and the second
/// triangle is higher by 1.
fn serialized() -> Vec<u8> {
    let mut file = Vec::new();
    let mut offsets = Vec::new();
    for z in [0.0_f32, 1.0] {
        offsets.push(file.len() as u64);
        file.extend([0x1c, 0x04, 0x04, 0x00]);
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
        let mut put = |bytes: &[u8]| packed.write_all(bytes).unwrap();
        put(&0x1003_u32.to_le_bytes());
        put(b"name\0");
        put(&3_u64.to_le_bytes());
        put(&1_u64.to_le_bytes());
        put(&[0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z]
            .map(f32::to_le_bytes)
            .concat());
        put(&[0.0, 0.0, 2.0].map(f32::to_le_bytes).concat().repeat(3));
        put(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.75]
            .map(f32::to_le_bytes)
            .concat());
        put(&[0, 1, 2].map(u32::to_le_bytes).concat());
        file.extend(packed.finish().unwrap());
    }
    for offset in offsets {
        file.extend(offset.to_le_bytes());
    }
    file.extend(2_u32.to_le_bytes());
    file
}

#[test]
fn serialized_files_hold_several_meshes() {
    let bytes = serialized();
    let files = folder(&[("a.serialized", &bytes)]);
    let shape = |i: usize| {
        let index = format!("<integer name=\"shape_index\" value=\"{i}\"/>");
        file("serialized", "a.serialized", &index)
    };
    let world = read(&(shape(0) + &shape(1)), files.path());
    let heights = world.shapes.iter().map(|s| mesh(s).vertices()[2].z);
    assert_close(&heights.collect::<Vec<f64>>(), &[0.0, 1.0], 0.0);
    assert_close(
        &mesh(&world.shapes[1]).uvs().unwrap()[2].to_array(),
        &[0.0, 0.75],
        0.0,
    );
    assert_close(&shading_normal(&world.shapes[1], 1), &[0.0, 0.0, 1.0], 0.0);
    let causes = read_in(&shape(2), files.path(), Color::Luminance).unwrap_err();
    assert_first(&causes, "has 2 meshes, but shape_index is 2");
}

/// A mesh whose triangles have no area is left out with its material, also within a group.
#[test]
fn meshes_without_area_are_left_out() {
    let files = folder(&[
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("bend.obj", BEND),
    ]);
    let flat = file("obj", "flat.obj", "<bsdf type=\"diffuse\"/>");
    let bend = file("obj", "bend.obj", "");
    let group = format!(
        "<shape type=\"shapegroup\" id=\"g\">{flat}{bend}</shape>\
        <shape type=\"instance\"><ref id=\"g\"/></shape>"
    );
    for inside in [flat + &bend, group] {
        let imported = read_in(&inside, files.path(), Color::Luminance).unwrap();
        assert_eq!(imported.world.shapes.len(), 1);
        let notes = common::all_notes(&imported);
        assert!(
            notes[0]
                .contains("file `flat.obj` has no triangle with an area above 0 and is left out"),
            "{notes:?}"
        );
    }
}

#[test]
fn pointers_of_git_lfs_are_named() {
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    let files = folder(&[("a.obj", pointer), ("a.png", pointer)]);
    let causes = read_in(&file("obj", "a.obj", ""), files.path(), Color::Luminance).unwrap_err();
    assert_first(&causes, "file `a.obj` is a pointer of Git LFS");
}

#[test]
fn mesh_files_that_are_damaged_are_causes() {
    let files = folder(&[
        ("a.obj", b"v 0 0 0\nf 1 2 3\n"),
        ("b.obj", b"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n"),
    ]);
    let inside = file("obj", "a.obj", "") + &file("obj", "b.obj", "") + &file("ply", "a.obj", "");
    let causes = read_in(&inside, files.path(), Color::Luminance).unwrap_err();
    assert_eq!(causes.len(), 2, "{causes:#?}");
    assert_first(&causes, "line 2, face 1, corner 2");
    assert!(causes[1].contains("has extension `obj`"), "{causes:#?}");
}

/// Mitsuba tilts the front of an emitting mesh by its vertex normals.
#[test]
fn emission_of_smooth_meshes_is_noted() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n";
    let files = folder(&[("a.obj", obj.as_bytes())]);
    let noted = |more: &str| {
        let shape = format!(
            "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/>{more}<emitter type=\"area\"/></shape>"
        );
        read_in(&shape, files.path(), Color::Luminance)
            .unwrap()
            .notes
            .len()
    };
    assert_eq!(noted(""), 1);
    assert_eq!(noted("<boolean name=\"face_normals\" value=\"true\"/>"), 0);
}
