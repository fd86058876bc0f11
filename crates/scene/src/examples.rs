//! What each field of a scene file is, and one way to write it.

use crate::place::steps;

/// End of a field's path, what it is, how it may be written; the first line that fits counts.
const FIELDS: &str = r#"
description | a text in quotes | "my first scene"
blockers[].name | a name in quotes, 1 to 64 characters | "bars"
planes[].name | a name in quotes, 1 to 64 letters, digits, - and _ | "arrival"
name | a name in quotes, 1 to 64 characters | "floor"
light | a light | Rectangle(center: (0, 0, 0), size: (0.2, 0.2))
light.bulb | a bulb | Square(0.1)
light.image | a picture | (width: (0.2, 0.2))
image.width | two numbers, along X and along Y | (0.2, 0.2)
grating | a grating | (axis: X, frequency: 5)
light.map | what comes from where | Lobes([(from: (0, 0, -1), width: 0.3)])
light.map[] | a lobe | (from: (0, 0, -1), width: 0.3)
light.front | a direction | (0, 0, 1)
light.file | a ray file in quotes | "led.tm25ray"
light.flux | a flux in watts | 0.5
up | a direction | (0, 1, 0)
from | a direction | (0, 0, -1)
direction | a direction | (0, 0, 1)
x_axis | a direction | (1, 0, 0)
leaves | a direction | (0, 0, -1)
facing | a direction | (0, 0, -1)
along | a direction | (1, 0, 0)
blockers | a list of blockers | [Grating(name: "bars", center: (0, 0, 1), axis: X, frequency: 5)]
blockers[] | blockers | Grating(name: "bars", center: (0, 0, 1), axis: X, frequency: 5)
shapes | a list of shapes | [Disc(center: (0, 0), radius: 0.1)]
shapes[] | a shape | Rectangle(center: (0, 0), size: (0.1, 0.1))
shapes[].center | a place along X and Y, metres | (0.1, 0.2)
center | a place in the world, metres | (0, 0, 1)
size | side lengths along X and Y, metres | (0.2, 0.1)
count | whole numbers along X and Y | (20, 20)
count[] | a whole number | 20
pitch | a length in metres | 0.2
radius | a length in metres | 0.2
edge | a place in metres | 0.2
half | a length in metres | 0.2
aperture | a length in metres | 0.2
axis | an axis, X or Y | X
opaque | a side, Below or Above | Below
mesh | a mesh | File("mesh.obj")
curvatures | curvatures along X and Y, per metre | (1, 0.5)
cells | a whole number | 16
lobes | a whole number | 5
rings | a whole number | 32
surfaces | a list of surfaces | [Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))]
surfaces[] | a surface | Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))
form | a form with its curvature | Sphere(0.5)
event | what happens to light | Refraction(front: 1, back: 1.5)
brdf | a BRDF | (lobe: Phong(100))
other | a BRDF | (lobe: Phong(100))
lobe | a lobe | Phong(100)
fresnel | a Fresnel factor | Dielectric(1.5)
blend | a pattern | Checkerboard(0.1)
terms | a list of BRDFs with weights | [(brdf: (lobe: Phong(100)), weight: Checkerboard(0.1))]
terms[] | a BRDF with its weight | (brdf: (lobe: Phong(100)), weight: Checkerboard(0.1))
weight | a pattern | Checkerboard(0.1)
incoming | factors from 0 to 1, from the normal to 90 degrees | [1, 0.7, 0]
outgoing | factors from 0 to 1, from the normal to 90 degrees | [1, 0.7, 0]
incoming[] | a factor from 0 to 1 | 0.7
outgoing[] | a factor from 0 to 1 | 0.7
texture | a pattern | Checkerboard(0.1)
file | a file in quotes | "picture.exr"
path | the central ray | (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"])
visits | a list of names of surfaces | ["floor"]
visits[] | the name of a surface in quotes | "floor"
planes | a list of planes | [(name: "arrival", at: Before("floor"))]
planes[] | a plane | (name: "arrival", at: Before("floor"))
at | Emission, Distance(…), or a place before or after something | Before("floor")
quantity | Radiance or DifferentialIrradiance | Radiance
orientation | Orthogonal, Tangent, LocalNormals or Mirrored | Orthogonal
window | a window | (x: Hann(0.5), u: Hann(0.5))
window.x | a profile with its half-width in metres | Hann(0.5)
window.y | a profile with its half-width in metres | Hann(0.5)
window.u | a profile with its half-width in slope | Hann(0.5)
window.v | a profile with its half-width in slope | Hann(0.5)
frequencies | frequencies | (rho: (max: 16), nu: (max: 32))
azimuths | a whole number | 8
rho | frequencies in cycles per metre | (max: 16)
nu | frequencies in cycles per unit slope | (max: 32)
as_printed | true or false | true
run | how the scene is measured | (photons: 1e7)
photons | a whole number | 1e7
seed | a whole number | 1
batches | a whole number | 64
emission | Aimed or Plain | Aimed
sampling | Net or Random | Net
alpha | a share of sound scenes | 0.01
resolution | a share of the spectrum | 0.1
radiance | a radiance, W m⁻² sr⁻¹ | 1
intensity | an intensity, W sr⁻¹ | 1
irradiance | an irradiance, W m⁻² | 1
map[].width | an angle in radians | 0.3
exponent | an exponent | 20
fill | a share of the pitch | 0.6
jitter | a share of the pitch | 0.3
relief | a share of the radius | 0.3
frequency | cycles per metre | 5
modulation | a contrast | 0.9
phase | an angle in radians | 0.3
scale | a factor | 2
albedo | a share of the light | 0.5
front | an index of refraction | 1
back | an index of refraction | 1.5
n | an index of refraction | 1.5
k | an index of absorption | 3
max | a frequency in the unit of its axis | 16
spacing | a frequency in the unit of its axis | 0.5
width | a width in the unit of its coordinate | 0.3
cut | a half-width in the unit of its coordinate | 0.5
"#;

/// What the field at a path is, and one way to write it.
pub(crate) fn field(path: &str) -> [&'static str; 2] {
    let mut plain = String::new();
    for step in steps(path) {
        match step.parse::<usize>() {
            Ok(_) => plain.push_str("[]"),
            Err(_) => plain.extend([".", step]),
        }
    }
    let fits = |end: &str| {
        plain
            .strip_suffix(end)
            .is_some_and(|start| start.ends_with('.'))
    };
    let mut fields = FIELDS.lines().filter_map(|line| {
        let mut parts = line.split(" | ");
        Some((parts.next()?, [parts.next()?, parts.next()?]))
    });
    let known = fields.find_map(|(end, field)| fits(end).then_some(field));
    known.unwrap_or(match plain.as_str() {
        "" => [
            "a scene",
            "(light: …, path: …, planes: …, window: …, frequencies: …)",
        ],
        _ => ["a number", "0.1"],
    })
}

/// How the field at a path may be written, in words.
pub(crate) fn wanted(path: &str) -> String {
    let [what, example] = field(path);
    format!("{what}, such as {example}")
}

/// One way to write the field at a path.
pub(crate) fn example(path: &str) -> &'static str {
    field(path)[1]
}

/// Whether the value at a path has named fields.
pub(crate) fn has_fields(path: &str) -> bool {
    example(path).contains(": ")
}

#[cfg(test)]
mod tests {
    use super::example;
    use crate::SceneFile;
    use crate::place::find;
    use serde_json::Value;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    /// The texts of the scenes of this repository.
    fn scenes() -> Vec<String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let folders = [folder.clone(), folder.join("table1"), folder.join("wild")];
        let files = folders
            .iter()
            .flat_map(|folder| fs::read_dir(folder).unwrap());
        let mut paths: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
        paths.retain(|path| path.extension().is_some_and(|e| e == "ron"));
        paths.sort();
        paths
            .iter()
            .map(|path| fs::read_to_string(path).unwrap())
            .collect()
    }

    /// The paths of all fields, written or not.
    fn fields(node: &Value, path: &str, found: &mut Vec<String>) {
        if !path.is_empty() {
            found.push(path.to_owned());
        }
        match node {
            Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    fields(item, &format!("{path}[{i}]"), found);
                }
            }
            Value::Object(below) => {
                for (name, item) in below {
                    match name.starts_with(char::is_uppercase) {
                        true => fields(item, path, found),
                        false if path.is_empty() => fields(item, name, found),
                        false => fields(item, &format!("{path}.{name}"), found),
                    }
                }
            }
            _ => {}
        }
    }

    /// Each field that is written in a scene takes the example instead, and is named when it holds
    /// what nothing can be.
    #[test]
    fn examples_can_be_read_where_they_are_told() {
        let mut tried = BTreeSet::new();
        for text in scenes() {
            let file = serde_json::to_value(SceneFile::parse(&text).unwrap()).unwrap();
            let mut paths = Vec::new();
            fields(&file, "", &mut paths);
            for path in paths {
                let (around, _) = path.rsplit_once(['.', '[']).unwrap_or_default();
                // What is not written is found as what is around it, if at all.
                let written = find(&text, &path);
                let Some(place) = written.filter(|_| written != find(&text, around)) else {
                    continue;
                };
                let start = place.value.as_ptr().addr() - text.as_ptr().addr();
                let (before, after) = (&text[..start], &text[start + place.value.len()..]);
                let changed = |value: &str| SceneFile::parse(&format!("{before}{value}{after}"));
                let (example, is) = (example(&path), place.value);
                if let Err(error) = changed(example) {
                    panic!("{path} is {is}, not {example}: {error}");
                }
                let told = changed("{}").unwrap_err().to_string();
                let named = format!("line {}, column {}: {path}", place.line, place.column);
                assert!(told.starts_with(&named), "{path}: {told}");
                assert!(told.ends_with(example), "{path}: {told}");
                tried.insert(path);
            }
        }
        assert!(tried.len() > 200, "{} fields", tried.len());
    }
}
