//! Binary glTF files, and files with inconsistent content.

use crate::common::{assert_first, cases};
use crate::gltf_scene;
use crate::gltf_scene::{causes, mesh, read};

#[test]
fn accessors_stay_within_their_buffers() {
    let sound = mesh(r#"{"mesh":0}"#, "", "");
    for (from, change) in cases(
        r#"
        "byteOffset":0,"byteLength":36 => "byteOffset":99999,"byteLength":36 => reaches beyond
        "count":3,"type":"VEC3" => "count":18446744073709551615,"type":"VEC3" => reaches beyond
        "POSITION":0 => "POSITION":77 => an index out of bounds
        "type":"VEC3" => "type":"VEC2" => has type Vec2
        "buffer":0 => "buffer":9 => an index out of bounds
        "bufferView":0,
        => "bufferView":0,"sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}, => sparse
        "#,
    ) {
        let (to, expected) = change.split_once(" => ").unwrap();
        let file = sound.replace(from, to);
        assert_ne!(file, sound, "{from}");
        let found = causes(&file);
        let is_there = found.iter().any(|cause| cause.contains(expected));
        assert!(is_there, "{expected}: {found:?}");
    }
    let wrong = sound.replace("\"version\":\"2.0\"", "\"version\":\"1.0\"");
    assert_first(&causes(&wrong), "asset.version");
    assert!(read(b"glTF\x01\0\0\0").is_err());
}

#[test]
fn binary_files_bring_their_buffer() {
    let text = mesh(r#"{"mesh":0}"#, "", "");
    let bytes = gltf_scene::binary(&text);
    let imported = read(&bytes).unwrap_or_else(|causes| panic!("{causes:?}"));
    assert_eq!(imported.world.shapes.len(), 1);
}
