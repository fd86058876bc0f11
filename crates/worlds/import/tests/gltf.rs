//! Scenes of glTF: each convention, with values that detect a violation.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{
    assert_close, assert_first, assert_near, assert_told, constant, first_triangle,
    mesh as triangles_of, reflectance,
};
use crate::gltf_scene::{BASE, causes, mesh, notes, with, world};
use etendue_world::{Light, Material, MicrofacetDistribution, Projection};
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[test]
fn cameras_look_along_minus_z_with_y_up() {
    let camera = r#""cameras":[{"type":"perspective","perspective":{"yfov":0.8,"aspectRatio":2,"znear":0.5,"zfar":9}}]"#;
    let file = with(
        r#"{"camera":0,"translation":[1,2,3],"scale":[5,5,5]}"#,
        camera,
    );
    let camera = &world(&file).cameras[0];
    assert_eq!(camera.size, [512, 256]);
    let middle = camera.look([256.0, 128.0], [0.5; 2]);
    assert_close(&middle.from.to_array(), &[1.0, 2.0, 3.0], 1e-12);
    assert_close(&middle.along.to_array(), &[0.0, 0.0, -1.0], 1e-12);
    // X points to the right of the picture and Y up. The angle yfov is the vertical angle of view.
    let top = camera.look([256.0, 0.0], [0.5; 2]).along;
    assert_close(&[top.y / -top.z, top.x], &[libm::tan(0.4), 0.0], 1e-7);
    let right = camera.look([512.0, 128.0], [0.5; 2]).along;
    assert_close(
        &[right.x / -right.z, right.y],
        &[2.0 * libm::tan(0.4), 0.0],
        1e-7,
    );
    assert_close(&camera.clip, &[0.5, 9.0], 0.0);
}

#[test]
fn orthographic_cameras_show_xmag_to_both_sides() {
    let camera = r#""cameras":[{"type":"orthographic","orthographic":{"xmag":4,"ymag":2,"znear":0,"zfar":9}}]"#;
    let camera = &world(&with(r#"{"camera":0}"#, camera)).cameras[0];
    assert!(matches!(camera.projection, Projection::Orthographic));
    assert_eq!(camera.size, [512, 256]);
    let corner = camera.look([512.0, 0.0], [0.5; 2]);
    assert_close(&corner.from.to_array(), &[4.0, 2.0, 0.0], 1e-12);
}

#[test]
fn matrices_are_columns_and_parts_are_scaled_first() {
    let of = |node: &str| {
        let file = mesh(node, "", "");
        let shape = world(&file).shapes.remove(0);
        shape.to_world.transform_point3(DVec3::new(1.0, 0.0, 0.0))
    };
    let matrix = of(r#"{"mesh":0,"matrix":[0,2,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1]}"#);
    assert_close(&matrix.to_array(), &[5.0, 8.0, 7.0], 1e-12);
    // A quarter turn about Z takes the X axis, which is scaled by 2, to Y.
    let parts = of(
        r#"{"mesh":0,"translation":[5,6,7],"rotation":[0,0,0.70710678,0.70710678],"scale":[2,3,4]}"#,
    );
    assert_close(&parts.to_array(), &[5.0, 8.0, 7.0], 1e-6);
    let both = mesh(
        r#"{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"scale":[1,1,1]}"#,
        "",
        "",
    );
    assert_first(
        &causes(&both),
        "nodes[0]: has a matrix, and also a translation",
    );
}

#[test]
fn children_are_placed_within_their_parents() {
    let nodes = r#"{"children":[1],"scale":[2,2,2]},{"mesh":0,"translation":[1,0,0]}"#;
    let shape = &world(&mesh(nodes, "", "")).shapes[0];
    assert_close(
        &shape.to_world.translation.to_array(),
        &[2.0, 0.0, 0.0],
        1e-12,
    );
    let circle = r#"{"children":[1]},{"children":[0]}"#;
    let found = causes(&mesh(circle, "", ""));
    assert_first(&found, "nodes[0]: has two parents, or is its own ancestor");
}

#[test]
fn the_front_is_where_corners_run_counterclockwise() {
    let world = world(&mesh(r#"{"mesh":0},{"mesh":0,"scale":[-1,1,1]}"#, "", ""));
    let first = triangles_of(&world.shapes[0]);
    // The corners are counterclockwise with X to the right and Y up, so the front is towards Z.
    let [a, b, c] = first_triangle(first);
    assert!((b - a).cross(c - a).z > 0.0);
    // A mirrored surface keeps its front, because the inverse transpose transforms its normals.
    let mirrored = &world.shapes[1];
    assert!(!mirrored.is_flipped && mirrored.to_world.matrix3.determinant() < 0.0);
    let second = triangles_of(mirrored);
    assert!(Arc::ptr_eq(first, second), "instances share their mesh");
}

#[test]
fn base_colours_are_linear_and_their_pictures_srgb() {
    let texture = r#","baseColorTexture":{"index":0}"#;
    let matte = r#","extensions":{"KHR_materials_specular":{"specularFactor":0}}"#;
    let material = format!(
        r#"{{"doubleSided":true,"pbrMetallicRoughness":{{"metallicFactor":0,"baseColorFactor":[0.5,0.5,0.5,1]{texture}}}{matte}}}"#
    );
    let world = world(&mesh(r#"{"mesh":0}"#, &material, BASE));
    assert!(matches!(world.materials[0], Material::TwoSided(_)));
    let reflectance = reflectance(&world.materials[0]);
    // The upper row of the picture, at v = 0, is white. The lower row has level 188, which is
    // 0.502886 in linear light.
    let at = |u, v| reflectance.value(&DVec2::new(u, v).into());
    assert_close(
        &[at(0.5, 0.25), at(0.5, 0.75)],
        &[0.5, 0.5 * 0.502_886],
        1e-6,
    );
}

#[test]
fn alpha_is_the_square_of_roughness() {
    let material = r#"{"pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0.5}}"#;
    let world = world(&mesh(r#"{"mesh":0}"#, material, ""));
    let Material::MetallicRoughness(metal) = &world.materials[0] else {
        panic!("{:?}", world.materials);
    };
    let roughness = metal.roughness.as_ref().unwrap();
    assert_eq!(roughness.distribution, MicrofacetDistribution::Ggx);
    assert_near(constant(&roughness.alpha[0]), 0.25, 1e-12);
}

#[test]
fn factors_of_a_material_keep_their_values() {
    let of = |factor: f64| {
        let material = format!(
            r#"{{"pbrMetallicRoughness":{{"metallicFactor":{factor}}},"extensions":{{"KHR_materials_ior":{{"ior":1.3}}}}}}"#
        );
        world(&mesh(r#"{"mesh":0}"#, &material, ""))
            .materials
            .remove(0)
    };
    for factor in [0.0, 0.25] {
        let Material::MetallicRoughness(of) = of(factor) else {
            panic!("{:?}", of(factor));
        };
        // At normal incidence, an index of 1.3 reflects (0.3/2.3)².
        assert_close(&of.coat, &[0.017_013_2, 1.0], 1e-6);
        assert_near(constant(&of.metallic), factor, 1e-12);
    }
}

#[test]
fn double_sided_lamps_emit_on_both_sides() {
    let material = |sides: bool| {
        format!(
            r#"{{"doubleSided":{sides},"emissiveFactor":[1,0.5,0],"extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":4}}}}}}"#
        )
    };
    let one = world(&mesh(r#"{"mesh":0}"#, &material(false), ""));
    let radiance = 4.0 * (0.212_671 + 0.5 * 0.715_160);
    assert_near(
        constant(one.shapes[0].emission.as_ref().unwrap()),
        radiance,
        1e-9,
    );
    let two = world(&mesh(r#"{"mesh":0}"#, &material(true), ""));
    let sides = [one, two].map(|world| (world.shapes.len(), world.shapes[0].emits_on_both_sides));
    assert_eq!(sides, [(1, false), (1, true)]);
}

#[test]
fn lights_shine_along_minus_z() {
    let lights = r#""extensions":{"KHR_lights_punctual":{"lights":[
        {"type":"point","intensity":3,"color":[0,1,0]},{"type":"directional","intensity":2},
        {"type":"spot","intensity":5,"spot":{"innerConeAngle":0.2,"outerConeAngle":0.4}}]}}"#;
    let node = |light: u32, more: &str| {
        format!(r#"{{"extensions":{{"KHR_lights_punctual":{{"light":{light}}}}}{more}}}"#)
    };
    let down = r#","rotation":[-0.70710678,0,0,0.70710678],"scale":[3,3,3]"#;
    let nodes = [
        node(0, r#","translation":[1,2,3]"#),
        node(1, down),
        node(2, down),
    ]
    .join(",");
    let found = world(&with(&nodes, lights)).lights;
    let Light::Point {
        position,
        intensity,
    } = found[0]
    else {
        panic!("{found:?}");
    };
    assert_close(&position.to_array(), &[1.0, 2.0, 3.0], 1e-12);
    assert_near(intensity, 3.0 * 0.715_160, 1e-9);
    let Light::Directional {
        direction,
        irradiance,
    } = found[1]
    else {
        panic!("{found:?}");
    };
    assert_close(&direction.to_array(), &[0.0, -1.0, 0.0], 1e-7);
    assert_near(irradiance, 2.0, 1e-9);
    let Light::Spot {
        to_world,
        beam,
        cutoff,
        ..
    } = found[2]
    else {
        panic!("{found:?}");
    };
    assert_close(&to_world.matrix3.z_axis.to_array(), &[0.0, -1.0, 0.0], 1e-7);
    assert_close(&[beam, cutoff], &[0.2, 0.4], 1e-7);
}

#[test]
fn alpha_lets_light_through_where_the_mode_says_so() {
    let of = |mode: &str| {
        let material = format!(
            r#"{{"alphaMode":"{mode}","alphaCutoff":0.3,"pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,0.25]}}}}"#
        );
        world(&mesh(r#"{"mesh":0}"#, &material, ""))
            .materials
            .remove(0)
    };
    let opacity = |material: Material| match material {
        Material::Mask { opacity, .. } => constant(&opacity),
        _ => 1.0,
    };
    let found = ["OPAQUE", "MASK", "BLEND"].map(|mode| opacity(of(mode)));
    assert_close(&found, &[1.0, 0.0, 0.25], 1e-9);
}

#[test]
fn what_is_left_out_is_told_with_its_path() {
    let material = r#"{"occlusionTexture":{"index":0},"extensions":{"KHR_materials_unlit":{},"KHR_materials_sheen":{}}}"#;
    let found = notes(&mesh(r#"{"mesh":0}"#, material, BASE));
    let expected = [
        "a.gltf: materials[0].occlusionTexture: is left out",
        "a.gltf: materials[0].extensions.KHR_materials_unlit: is left out",
        "a.gltf: materials[0].extensions: `KHR_materials_sheen` is left out",
    ];
    assert_told(&found, &expected);
}
