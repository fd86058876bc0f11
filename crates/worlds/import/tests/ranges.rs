//! Allowed ranges of numbers, and refusals of scenes whose picture would be wrong.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{assert_refused, cases, causes, png, read_files, world};

fn pbrt_causes(text: &str) -> Vec<String> {
    file_causes(&[("a.pbrt", text.as_bytes())])
}

/// The causes for refusing a scene that consists of the given files.
fn file_causes(files: &[(&str, &[u8])]) -> Vec<String> {
    read_files(files).map(drop).unwrap_err()
}

/// The causes for refusing a triangle with the material `a`.
fn mtl_causes(mtl: &str) -> Vec<String> {
    let obj = "mtllib a.mtl\nusemtl a\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    file_causes(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())])
}

#[test]
fn numbers_out_of_range_are_refused_at_their_line() {
    let range = "allowed: -1e9 to 1e9";
    for (inside, line) in [
        (
            r#"<emitter type="constant"><rgb name="radiance" value="2e9"/></emitter>"#,
            "text:2:",
        ),
        (
            "<emitter type=\"constant\">\n<spectrum name=\"radiance\" value=\"400:1, 700:1e200\"/></emitter>",
            "text:3:",
        ),
        (
            r#"<shape type="sphere"><float name="radius" value="1e160"/></shape>"#,
            "text:2:",
        ),
        (
            r#"<emitter type="point"><point name="position" x="-1e155" y="0" z="0"/></emitter>"#,
            "text:2:",
        ),
    ] {
        assert_refused(&causes(inside), &[line, range]);
    }
    let scaled = |scales: &str| {
        format!(
            "<shape type=\"rectangle\">\n<transform name=\"to_world\">{scales}</transform></shape>"
        )
    };
    let large = scaled(r#"<scale value="1e6"/><scale value="1e6"/>"#);
    assert_refused(&causes(&large), &["text:3:", "out of range"]);
    let small = scaled(r#"<scale value="1e-6"/><scale value="1e-6"/>"#);
    assert_refused(&causes(&small), &["text:3:", "scales from 1e-9 to 1e9"]);
    world(&scaled(r#"<scale value="1e9"/><scale value="1e-9"/>"#));

    let pbrt = |inside: &str| format!("WorldBegin\n{inside}\nShape \"sphere\"");
    for inside in [
        r#"LightSource "infinite" "rgb L" [1e200 1 1]"#,
        r#"LightSource "distant" "float scale" 1e155"#,
        "Scale 1e160 1e160 1e160",
        "Scale 1e6 1e6 1e6 Scale 1e6 1e6 1e6",
    ] {
        assert_refused(&pbrt_causes(&pbrt(inside)), &["a.pbrt:2:", "allowed: "]);
        assert!(pbrt_causes(&pbrt(inside))[0].contains("1e9"), "{inside}");
    }
    let found = mtl_causes("newmtl a\nKd 0.5 0.5 0.5\nKe 1e200 1 1\n");
    assert_refused(&found, &["a.mtl:3:", "from 0 to 1000000000"]);
}

#[test]
fn an_illuminance_that_no_factor_reaches_is_refused() {
    // The illuminance of a black picture cannot be scaled to 1.
    let light = r#"LightSource "infinite" "string filename" "a.png" "float illuminance" 1"#;
    let text = format!("WorldBegin\n{light}\nShape \"sphere\"");
    let black = png([2, 2], &[0; 4]);
    let found = file_causes(&[("a.pbrt", text.as_bytes()), ("a.png", &black)]);
    assert_refused(&found, &["the factor for illuminance"]);
}

#[test]
fn surfaces_reflect_no_more_light_than_there_is() {
    let bsdf = |inside: &str| format!("<shape type=\"sphere\">{inside}</shape>");
    for (inside, words) in cases(
        r#"
        <bsdf type="diffuse"><rgb name="reflectance" value="1.5"/></bsdf>
        => reflectance goes up to 1.5; allowed: 0 to 1
        <bsdf type="diffuse"><texture name="reflectance" type="checkerboard"><rgb name="color0" value="2"/></texture></bsdf>
        => allowed: 0 to 1
        <bsdf type="roughconductor"><float name="specular_reflectance" value="1.1"/></bsdf>
        => allowed: 0 to 1
        <bsdf type="phong"><float name="diffuse_reflectance" value="0.7"/><float name="specular_reflectance" value="0.7"/></bsdf>
        => add up to 1.4
        "#,
    ) {
        assert_refused(&causes(&bsdf(inside)), &["text:2:", words]);
    }
    // White pictures and colours have the value 1 up to rounding.
    world(&bsdf(
        r#"<bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>"#,
    ));
    let pbrt = "WorldBegin\nTexture \"two\" \"spectrum\" \"scale\" \"float scale\" 2\nMaterial \"diffuse\" \"texture reflectance\" \"two\"\nShape \"sphere\"";
    assert_refused(&pbrt_causes(pbrt), &["a.pbrt:3:", "allowed: 0 to 1"]);
    let found = mtl_causes("newmtl a\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 20\nillum 2\n");
    assert_refused(&found, &["a.mtl:1:", "1.3000 of the light"]);
}

#[test]
fn maps_of_normals_are_refused() {
    let map = |plugin: &str| {
        format!(
            r#"<shape type="rectangle"><bsdf type="{plugin}"><texture type="checkerboard"/><bsdf type="diffuse"/></bsdf></shape>"#
        )
    };
    for plugin in ["bumpmap", "normalmap"] {
        assert_refused(&causes(&map(plugin)), &["text:2:", "is not supported"]);
    }
    for parameter in [
        "\"texture displacement\" \"t\"",
        "\"string normalmap\" \"n.png\"",
    ] {
        let text = format!("WorldBegin\nMaterial \"diffuse\" {parameter}\nShape \"sphere\"");
        assert_refused(&pbrt_causes(&text), &["a.pbrt:2:", "is not supported"]);
    }
    let found = mtl_causes("newmtl a\nmap_Bump -bm 1 bump.png\n");
    assert_refused(&found, &["a.mtl:2:", "is not supported"]);
}

#[test]
fn normal_maps_of_gltf_are_refused() {
    let json = br#"{"asset":{"version":"2.0"},"materials":[{"normalTexture":{"index":0}}],"textures":[{"source":0}],"images":[{"uri":"n.png"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],"buffers":[{"byteLength":36,"uri":"a.bin"}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;
    let points: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes = points.map(f32::to_le_bytes).concat();
    let found = file_causes(&[("a.gltf", json), ("a.bin", &bytes)]);
    assert_refused(&found, &["materials[0].normalTexture", "is not supported"]);
    let large = bytes.chunks(4).enumerate().flat_map(|(i, x)| match i {
        3 => 1e30_f32.to_le_bytes(),
        _ => [x[0], x[1], x[2], x[3]],
    });
    let found = file_causes(&[("a.gltf", json), ("a.bin", &large.collect::<Vec<u8>>())]);
    assert!(
        found
            .iter()
            .any(|cause| cause.contains("element 1 is out of range; allowed: up to 1e9")),
        "{found:?}"
    );
}

#[test]
fn a_second_environment_is_refused() {
    let one = r#"<emitter type="constant"/>"#;
    world(one);
    let two = format!("{one}\n{one}");
    let words = ["text:3:", "a second environment; allowed: one"];
    assert_refused(&causes(&two), &words);
}
