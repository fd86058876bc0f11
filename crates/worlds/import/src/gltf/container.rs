//! The checked JSON of a glTF file and, if the file is binary, its buffer.

use crate::report::{Report, SourcePlace, quoted};
use ::gltf::json::validation::{Error, Validate};
use ::gltf::json::{Path, Root};

/// The first bytes of a binary glTF file.
const MAGIC: &[u8] = b"glTF";

/// Supported required extensions.
const KNOWN: &[&str] = &[
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// A glTF file whose indices are valid.
pub(super) struct Document {
    pub(super) root: Root,
    /// The buffer, if the file is binary.
    pub(super) chunk: Option<Vec<u8>>,
}

/// Reads the bytes of a file; `None` if a cause of refusal was reported.
pub(super) fn read(bytes: &[u8], place: &SourcePlace, report: &Report) -> Option<Document> {
    let refuse = |message: String| report.cause(place, message);
    let (json, chunk) = match bytes.starts_with(MAGIC) {
        true => chunks(bytes).map_err(refuse).ok()?,
        false => (bytes, None),
    };
    let root = Root::from_slice(json)
        .map_err(|error| refuse(format!("is not glTF: {error}")))
        .ok()?;
    check(&root, place, report).then(|| Document {
        root,
        chunk: chunk.map(<[u8]>::to_vec),
    })
}

/// The JSON and the buffer of a binary file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let word = |at: usize| {
        let four = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(four.try_into().ok()?))
    };
    if word(4) != Some(2) {
        return Err("is binary glTF of another version; allowed: 2".to_owned());
    }
    let length = word(8).and_then(|n| usize::try_from(n).ok());
    let bytes = length
        .and_then(|length| bytes.get(..length))
        .ok_or("is binary glTF that is shorter than its header says")?;
    let mut found = Vec::new();
    let mut at = 12;
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let start = at + 8;
        let end = usize::try_from(length)
            .ok()
            .and_then(|length| start.checked_add(length));
        let chunk = end.and_then(|end| bytes.get(start..end));
        let chunk = chunk.ok_or("has a chunk that is longer than the file")?;
        found.push((kind.to_le_bytes(), chunk));
        at = start + chunk.len();
        if found.len() == 2 {
            break;
        }
    }
    match found[..] {
        [(kind, json), ref rest @ ..] if &kind == b"JSON" => {
            let buffer = rest.first().filter(|(kind, _)| kind == b"BIN\0");
            Ok((json, buffer.map(|(_, chunk)| *chunk)))
        }
        _ => Err("is binary glTF that does not begin with JSON".to_owned()),
    }
}

/// Whether all indices are within range and all keywords are known; adds causes of
/// refusal otherwise.
fn check(root: &Root, place: &SourcePlace, report: &Report) -> bool {
    let version = &root.asset.version;
    if version.split('.').next() != Some("2") {
        let message = format!("asset.version: {}; allowed: 2.0", quoted(version));
        report.cause(place, message);
    }
    for name in &root.extensions_required {
        if !KNOWN.contains(&name.as_str()) {
            let message = format!("extensionsRequired: {} is not supported", quoted(name));
            report.cause(place, message);
        }
    }
    // Accessors are checked first, because the gltf crate uses the accessors of positions before
    // it checks that they exist.
    if !has_positions(root, place, report) {
        return false;
    }
    root.validate(root, Path::new, &mut |path, error| {
        let path = path();
        let path = path.as_str();
        // Errors about minima and maxima are ignored because minima and maxima are not needed.
        // Errors about extensions are ignored because extensions were already checked.
        let is_bound = path.ends_with(".min") || path.ends_with(".max");
        if error == Error::Unsupported || (error == Error::Missing && is_bound) {
            return;
        }
        let what = match error {
            Error::IndexOutOfBounds => "an index out of bounds",
            Error::Missing => "is missing",
            Error::Oversize => "too large",
            _ => "not allowed",
        };
        report.cause(place, format!("{path}: {what}"));
    });
    !report.has_causes()
}

fn has_positions(root: &Root, place: &SourcePlace, report: &Report) -> bool {
    let count = root.accessors.len();
    let mut is_sound = true;
    for (i, mesh) in root.meshes.iter().enumerate() {
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            if primitive.attributes.values().any(|at| at.value() >= count) {
                let message =
                    format!("meshes[{i}].primitives[{j}].attributes: an index out of bounds");
                report.cause(place, message);
                is_sound = false;
            }
        }
    }
    is_sound
}
