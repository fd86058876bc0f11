//! Shapes of pbrt-v4: their placement and front.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{
    PLY, assert_close, assert_first, assert_near, assert_refused, cases, first_triangle, folder,
    mesh, numbers,
};
use crate::pbrt_scenes::{causes, notes, read_in, scene, shape, world};
use etendue_import::Color;
use etendue_world::{Geometry, Material, Shape, Texture};
use glam::{DMat4, DVec2, DVec3};
use std::f64::consts::PI;

/// The front normal of a shape at a point. At this point, a ray from the shape's origin
/// along `own` leaves the shape. For a mesh, returns the front normal of the first triangle.
fn front(shape: &Shape, own: DVec3) -> DVec3 {
    let side = if shape.is_flipped { -1.0 } else { 1.0 };
    let normal = match &shape.geometry {
        Geometry::Mesh(mesh) => {
            let [a, b, c] = first_triangle(mesh);
            (b - a).cross(c - a)
        }
        Geometry::Disc => DVec3::Z,
        _ => own,
    };
    side * (shape.to_world.matrix3.inverse().transpose() * normal).normalize()
}

#[test]
fn transforms_stand_before_those_they_are_applied_after() {
    let place = |inside: &str| shape(&format!("{inside} Shape \"sphere\"")).to_world;
    let at = |inside: &str| place(inside).transform_point3(DVec3::X).to_array();
    // The matrix is given by columns, and takes X to Y.
    for (inside, expected) in cases(
        r#"
        Translate 1 2 3 Scale 2 2 2 => 3 2 3
        Rotate 90 0 0 2 Translate 1 0 0 => 0 2 0
        Transform [0 1 0 0  -1 0 0 0  0 0 1 0  4 5 6 1] => 4 6 6
        Translate 1 0 0 Transform [0 1 0 0  -1 0 0 0  0 0 1 0  4 5 6 1] => 4 6 6
        Translate 1 0 0 ConcatTransform [0 1 0 0  -1 0 0 0  0 0 1 0  4 5 6 1] => 5 6 6
        Translate 9 9 9 Identity => 1 0 0
        Translate 1 0 0 CoordinateSystem "a" Translate 1 1 1 CoordSysTransform "a" => 2 0 0
        AttributeBegin Translate 5 5 5 AttributeEnd TransformBegin Scale 3 3 3 TransformEnd => 1 0 0
        "#,
    ) {
        let digits = if inside.starts_with("Rotate") {
            1e-15
        } else {
            0.0
        };
        assert_close(&at(inside), &numbers(expected), digits);
    }
    // `LookAt` gives the map to camera coordinates, in which X points to the right.
    let look = place("LookAt 0 0 5  0 0 0  0 1 0");
    let expected = DMat4::from_cols_array(&[
        -1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 5., 1.,
    ]);
    assert!(DMat4::from(look).abs_diff_eq(expected, 1e-12), "{look}");
}

#[test]
fn fronts_are_where_normals_point() {
    let own = DVec3::new(1.0, 0.0, 0.0);
    let triangle = r#""trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0]"#;
    let patch = r#""bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0]"#;
    for (plugin, outward) in [
        ("\"sphere\"", DVec3::X),
        ("\"cylinder\"", DVec3::X),
        ("\"disk\"", DVec3::Z),
        (triangle, DVec3::Z),
        (patch, DVec3::Z),
    ] {
        let of = |before: &str| front(&shape(&format!("{before} Shape {plugin}")), own);
        assert_eq!(of(""), outward, "{plugin}");
        assert_eq!(of("ReverseOrientation"), -outward, "{plugin}");
        assert_eq!(
            of("ReverseOrientation ReverseOrientation"),
            outward,
            "{plugin}"
        );
        // In pbrt a mirror flips normals. A mirror also reverses the order of the corners of a
        // mesh, so normals of meshes are flipped twice.
        let is_mesh = plugin.contains("mesh");
        let mirrored = if is_mesh { outward } else { -outward };
        assert_eq!(of("Scale 1 -1 1"), mirrored, "{plugin}");
        assert_eq!(of("Scale 1 -1 1 ReverseOrientation"), -mirrored, "{plugin}");
    }
    // Vertex normals determine the front of a mesh.
    let down =
        "\"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
    assert_eq!(front(&shape(&format!("Shape {down}")), own), DVec3::NEG_Z);
    let turned = format!("ReverseOrientation Shape {down}");
    assert_eq!(front(&shape(&turned), own), DVec3::Z);
    // A mirrored sphere emits light outwards.
    let shining = "Scale -1 1 1 AreaLightSource \"diffuse\" Shape \"sphere\"";
    assert_eq!(front(&shape(shining), own), DVec3::NEG_X);
    assert_first(&notes(shining), "because of a mirroring transform");
}

#[test]
fn quadrics_have_sizes() {
    let at = |inside: &str, own: DVec3| shape(inside).to_world.transform_point3(own).to_array();
    assert_close(
        &at("Shape \"sphere\" \"float radius\" 3", DVec3::Y),
        &[0.0, 3.0, 0.0],
        0.0,
    );
    // A sphere that does not emit may be an ellipsoid.
    let ellipsoid = "Scale 1 2 1 Shape \"sphere\" \"float radius\" 3";
    assert_close(&at(ellipsoid, DVec3::Y), &[0.0, 6.0, 0.0], 0.0);
    let disk = "Shape \"disk\" \"float radius\" 3 \"float height\" 2";
    assert_close(&at(disk, DVec3::Y), &[0.0, 3.0, 2.0], 0.0);
    let cylinder = "Shape \"cylinder\" \"float radius\" 3 \"float zmin\" 4 \"float zmax\" 2";
    assert_close(&at(cylinder, DVec3::Y), &[0.0, 3.0, 2.0], 0.0);
    assert_close(&at(cylinder, DVec3::Z), &[0.0, 0.0, 4.0], 0.0);
    for (inside, what) in cases(
        r#"
        Shape "sphere" "float zmin" 0 => zmin is 0: parts of spheres
        Shape "sphere" "float phimax" 0 => phimax is 0
        Shape "disk" "float innerradius" 0.5 => innerradius is 0.5
        Scale 1 2 1 AreaLightSource "diffuse" Shape "sphere"
        => emits, but has shear or different scales along its axes
        Scale 1 0 1 Shape "disk" => scaled to size 0
        Shape "curve" => shape `curve` is not supported
        Shape "loopsubdiv" => shape `loopsubdiv` is not supported
        "#,
    ) {
        assert_refused(&causes(inside), &[what]);
    }
}

#[test]
fn textured_meshes_have_coordinates_by_triangle() {
    let quad = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" [0 1 2 0 2 3]";
    assert!(mesh(&shape(quad)).uvs().is_none());
    let board = "Texture \"t\" \"spectrum\" \"checkerboard\" Material \"diffuse\" \"texture reflectance\" \"t\"";
    let shape = shape(&format!("{board} {quad}"));
    let uvs = mesh(&shape).uvs().unwrap();
    assert_eq!(uvs, [[DVec2::ZERO, DVec2::X, DVec2::ONE]; 2].concat());
}

#[test]
fn patches_are_two_triangles() {
    let patch = shape("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0]");
    let mesh = mesh(&patch);
    assert_eq!(mesh.corners().len(), 2);
    for (place, uv) in mesh.vertices().iter().zip(mesh.uvs().unwrap()) {
        assert_close(&[place.x / 2.0, place.y], &uv.to_array(), 0.0);
    }
    let twisted = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 1]";
    assert_first(&causes(twisted), "a patch is not flat");
}

#[test]
fn unsound_meshes_are_refused() {
    for (inside, what) in cases(
        r#"
        "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 3]
        => an index is 3, but there are only 3 vertices
        "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1] => 2 indices
        "point3 P" [0 0 0 1 0 0 2 0 0] => no triangle with an area
        "point3 P" [0 0 0 1e10 0 0 2 1 0] => -1e9 to 1e9
        "point3 P" [0 0 0 1 0] => threes of numbers
        "#,
    ) {
        assert_refused(
            &causes(&format!("Shape \"trianglemesh\" {inside}")),
            &[what],
        );
    }
    let many = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]";
    assert_first(
        &notes(many),
        "N is left out: the mesh has 3 vertices, but N has values for 1",
    );
}

#[test]
fn objects_are_shown_where_instances_are() {
    let inside = "ObjectBegin \"o\" Translate 1 0 0 Shape \"sphere\" Shape \"disk\" ObjectEnd Scale 2 2 2 ObjectInstance \"o\" Translate 0 3 0 ObjectInstance \"o\"";
    let world = world(inside);
    let places: Vec<[f64; 3]> = world
        .shapes
        .iter()
        .map(|s| s.to_world.translation.to_array())
        .collect();
    assert_eq!(
        places,
        [
            [2.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 6.0, 0.0],
            [2.0, 6.0, 0.0]
        ]
    );
    assert_eq!(
        notes("ObjectBegin \"o\" Shape \"sphere\" ObjectEnd"),
        ["text:3:1: object `o` is not used"]
    );
    assert_first(&causes("ObjectInstance \"p\""), "object `p` is not known");
    assert_first(
        &causes("ObjectBegin \"o\" ObjectInstance \"o\" ObjectEnd"),
        "an object contains an instance",
    );
}

#[test]
fn alpha_is_a_mask() {
    let masked = world("Shape \"disk\" \"float alpha\" 0.25");
    match &masked.materials[masked.shapes[0].material] {
        Material::Mask { opacity, .. } => assert_near(opacity.largest(), 0.25, 0.0),
        other => panic!("{other:?}"),
    }
}

#[test]
fn files_may_be_packed() {
    use std::io::Write;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(PLY.as_bytes()).unwrap();
    let packed = packer.finish().unwrap();
    let folder = folder(&[("a.ply.gz", &packed), ("a.ply", PLY.as_bytes())]);
    for name in ["a.ply", "a.ply.gz"] {
        let inside = format!("Shape \"plymesh\" \"string filename\" \"{name}\"");
        let read = read_in(&scene("", &inside), folder.path(), Color::Luminance).unwrap();
        assert_eq!(mesh(&read.world.shapes[0]).corners(), [[0, 1, 2]]);
    }
}

/// The azimuth of a sphere and of a cylinder is u, and that of a disc is v. A part of a revolution
/// is opaque, and emits.
#[test]
fn parts_of_a_revolution_end_at_phimax() {
    for (plugin, is_v) in [("sphere", false), ("cylinder", false), ("disk", true)] {
        for phimax in [1.0, 90.0, 180.0, 181.0, 270.0, 359.0] {
            let lamp = "AreaLightSource \"diffuse\" \"float power\" 8";
            let world = world(&format!(
                "{lamp} Shape \"{plugin}\" \"float phimax\" {phimax}"
            ));
            let shape = &world.shapes[0];
            let Material::Mask { opacity, .. } = &world.materials[shape.material] else {
                panic!("{:?}", world.materials);
            };
            let area = match plugin {
                "sphere" => 4.0,
                "cylinder" => 4.0,
                _ => 1.0,
            };
            let radiance = 8.0 / (PI * PI * area * phimax / 360.0);
            for i in 0..720 {
                let azimuth = (f64::from(i) + 0.5) / 720.0;
                for other in [0.01, 0.5, 0.99] {
                    let uv = if is_v {
                        [other, azimuth]
                    } else {
                        [azimuth, other]
                    };
                    let at = |texture: &Texture| texture.value(&DVec2::from(uv).into());
                    let inside = f64::from(u8::from(360.0 * azimuth < phimax));
                    let found = [at(opacity), at(shape.emission.as_ref().unwrap())];
                    assert_close(&found, &[inside, inside * radiance], 1e-12);
                }
            }
        }
    }
}
