//! Binary glTF files, and files with inconsistent content.

use crate::gltf_scene;
use crate::gltf_scene::{causes, mesh, read};

#[test]
fn accessors_stay_within_their_buffers() {
    let sound = mesh(r#"{"mesh":0}"#, "", "");
    for (from, to, expected) in [
        (
            r#""byteOffset":0,"byteLength":36"#,
            r#""byteOffset":99999,"byteLength":36"#,
            "reaches beyond",
        ),
        (
            r#""count":3,"type":"VEC3""#,
            r#""count":18446744073709551615,"type":"VEC3""#,
            "reaches beyond",
        ),
        (
            r#""POSITION":0"#,
            r#""POSITION":77"#,
            "an index out of bounds",
        ),
        (r#""type":"VEC3""#, r#""type":"VEC2""#, "has type Vec2"),
        (r#""buffer":0"#, r#""buffer":9"#, "an index out of bounds"),
        (
            r#""bufferView":0,"#,
            r#""bufferView":0,"sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}},"#,
            "sparse",
        ),
    ] {
        let file = sound.replace(from, to);
        assert_ne!(file, sound, "{from}");
        let found = causes(&file);
        assert!(
            found.iter().any(|cause| cause.contains(expected)),
            "{expected}: {found:?}"
        );
    }
    let wrong = sound.replace("\"version\":\"2.0\"", "\"version\":\"1.0\"");
    assert!(causes(&wrong)[0].contains("asset.version"));
    assert!(read(b"glTF\x01\0\0\0").is_err());
}

#[test]
fn binary_files_bring_their_buffer() {
    let text = mesh(r#"{"mesh":0}"#, "", "");
    let bytes = gltf_scene::binary(&text);
    let imported = read(&bytes).unwrap_or_else(|causes| panic!("{causes:?}"));
    assert_eq!(imported.world.shapes.len(), 1);
}
