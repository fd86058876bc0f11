//! Short glTF scenes for tests.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "helpers of tests, of which each takes what it needs"
)]

use crate::common::{all_notes, png, read_files};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use etendue_import::Imported;
use etendue_world::World;

/// A texture of two rows: white above, level 188 below.
pub(crate) const BASE: &str =
    r#","textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,PICTURE"}]"#;

/// The text of a glTF file with the given nodes and other members.
pub(crate) fn with(nodes: &str, more: &str) -> String {
    format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],{more}}}"#)
}

/// A triangle with X to the right and Y up, and texture coordinates.
fn buffer() -> Vec<u8> {
    let places = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let uvs = [[0.0_f32, 1.0], [1.0, 1.0], [0.0, 0.0]];
    let numbers = places.as_flattened().iter().chain(uvs.as_flattened());
    let mut bytes: Vec<u8> = numbers.flat_map(|v| v.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0]);
    bytes
}

/// A file whose mesh 0 is a triangle of one material.
pub(crate) fn mesh(nodes: &str, material: &str, more: &str) -> String {
    let material = if material.is_empty() { "{}" } else { material };
    let data = STANDARD.encode(buffer());
    let more = more.replace(
        "PICTURE",
        &STANDARD.encode(png([1, 2], &[255, 255, 255, 188, 188, 188])),
    );
    with(
        nodes,
        &format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0}}]}}],
"materials":[{material}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}},{{"bufferView":2,"componentType":5121,"count":3,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}},{{"buffer":0,"byteOffset":60,"byteLength":4}}],
"buffers":[{{"byteLength":64,"uri":"data:application/octet-stream;base64,{data}"}}]{more}"#
        ),
    )
}

/// The text of a file, with its embedded buffer, as a binary file.
pub(crate) fn binary(text: &str) -> Vec<u8> {
    let uri = format!(
        r#","uri":"data:application/octet-stream;base64,{}""#,
        STANDARD.encode(buffer())
    );
    let mut json = text.replace(&uri, "").into_bytes();
    assert!(json.len() < text.len());
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| u32::try_from(n).unwrap().to_le_bytes();
    let mut bytes = b"glTF".to_vec();
    bytes.extend(word(2));
    bytes.extend(word(28 + json.len() + buffer().len()));
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", buffer())] {
        bytes.extend(word(chunk.len()));
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// Imports the bytes of a file.
pub(crate) fn read(bytes: &[u8]) -> Result<Imported, Vec<String>> {
    read_files(&[("a.gltf", bytes)])
}

pub(crate) fn world(text: &str) -> World {
    read(text.as_bytes())
        .unwrap_or_else(|causes| panic!("{causes:#?}\n{text}"))
        .world
}

pub(crate) fn causes(text: &str) -> Vec<String> {
    read(text.as_bytes()).map(|read| read.world).unwrap_err()
}

pub(crate) fn notes(text: &str) -> Vec<String> {
    all_notes(&read(text.as_bytes()).unwrap_or_else(|causes| panic!("{causes:#?}")))
}
