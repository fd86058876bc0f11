//! Finds the description and an example of each field of a scene file in the schema.

use crate::place::steps;
use crate::schema::{element, referred, schema};
use serde_json::Value;

/// The description of the field at a path, and an example.
fn field(path: &str) -> [&'static str; 2] {
    let nodes = below(schema(), &steps(path));
    told(path, nodes.first().copied().unwrap_or(&Value::Null))
}

/// The description of a node of the schema, and an example.
fn told(path: &str, node: &'static Value) -> [&'static str; 2] {
    let words = |node: &'static Value| Some([node["title"].as_str()?, node["x-ron"].as_str()?]);
    match words(node).or_else(|| words(referred(node))) {
        Some(words) => words,
        None if path.is_empty() => [
            "a scene",
            "(light: …, path: …, planes: …, window: …, frequencies: …)",
        ],
        None if node["type"] == "integer" => ["a whole number", "20"],
        None if node["type"] == "string" => ["the name of a surface in quotes", "\"floor\""],
        None if node["type"] == "array" => ["a list of numbers", "(0.1, 0.2)"],
        None => ["a number", "0.1"],
    }
}

/// Follows the steps of a path in the schema, also through variants, and returns the nodes at the
/// end. Several variants may have the field.
fn below(node: &'static Value, steps: &[&str]) -> Vec<&'static Value> {
    let [step, rest @ ..] = steps else {
        return vec![node];
    };
    let node = referred(node);
    let child = match step.parse() {
        Ok(place) => element(node, place),
        Err(_) => &node["properties"][*step],
    };
    if child.is_object() {
        return below(child, rest);
    }
    let variants = node["oneOf"].as_array().into_iter().flatten();
    let contents = variants.filter_map(|variant| variant["properties"].as_object());
    let contents = contents.flat_map(|content| content.values());
    contents.flat_map(|content| below(content, steps)).collect()
}

/// The unit of the number at a path such as `blockers.0.pitch`; empty if the schema
/// states no unit.
#[must_use]
pub fn unit(path: &str) -> &'static str {
    match field(path)[0] {
        what if what.contains("cycles per metre") => "cycles/m",
        what if what.contains("per metre") => "1/m",
        what if what.contains("radians") => "rad",
        what if what.contains("metres") => "m",
        _ => "",
    }
}

/// A description of the values that the field at a path accepts. A path does not name the
/// variant, so the text describes each type that the field has in any variant.
pub(crate) fn wanted(path: &str) -> String {
    let each = kinds(path).into_iter();
    let each = each.map(|[what, example]| format!("{what}, such as {example}"));
    each.collect::<Vec<_>>().join(", or ")
}

/// The description and the example of the first field of each type at a path.
fn kinds(path: &str) -> Vec<[&'static str; 2]> {
    let mut types = Vec::new();
    let mut nodes = below(schema(), &steps(path));
    nodes.retain(|node| {
        let its = &referred(node)["type"];
        let is_new = !types.contains(&its);
        types.push(its);
        is_new
    });
    if nodes.is_empty() {
        return vec![field(path)];
    }
    nodes.into_iter().map(|node| told(path, node)).collect()
}

/// An example of the field at a path.
pub(crate) fn example(path: &str) -> &'static str {
    field(path)[1]
}

/// Checks whether the value at a path has named fields.
pub(crate) fn has_fields(path: &str) -> bool {
    example(path).contains(": ")
}

#[cfg(test)]
mod tests {
    use super::{kinds, wanted};
    use crate::SceneFile;
    use crate::place::find;
    use serde_json::Value;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    #[test]
    fn units_are_those_of_the_descriptions() {
        assert_eq!(super::unit("blockers.0.shapes.1.edge"), "m");
        assert_eq!(super::unit("blockers.0.pitch"), "m");
        assert_eq!(super::unit("blockers.0.fill"), "");
        assert_eq!(super::unit("surfaces.0.albedo"), "");
    }

    /// The texts of the scenes in this repository.
    fn scenes() -> Vec<String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let below = ["table1", "wild", "words"].map(|name| folder.join(name));
        let folders = below.iter().chain([&folder]);
        let files = folders.flat_map(|folder| fs::read_dir(folder).unwrap());
        let mut paths: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
        paths.retain(|path| path.extension().is_some_and(|e| e == "ron"));
        paths.sort();
        paths
            .iter()
            .map(|path| fs::read_to_string(path).unwrap())
            .collect()
    }

    /// Collects the paths of all fields below a node, whether or not the scene states them.
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

    /// Checks that each field written in a scene accepts an example of the field, and that the
    /// error for an impossible value names the field.
    #[test]
    fn examples_can_be_read_where_they_are_told() {
        let mut tried = BTreeSet::new();
        for text in scenes() {
            let file = serde_json::to_value(SceneFile::parse(&text).unwrap()).unwrap();
            let mut paths = Vec::new();
            fields(&file, "", &mut paths);
            for path in paths {
                let (around, _) = path.rsplit_once(['.', '[']).unwrap_or_default();
                // If a field is not written in the text, `find` returns the position of the
                // enclosing field or none.
                let written = find(&text, &path);
                let Some(place) = written.filter(|_| written != find(&text, around)) else {
                    continue;
                };
                let start = place.value.as_ptr().addr() - text.as_ptr().addr();
                let (before, after) = (&text[..start], &text[start + place.value.len()..]);
                let changed = |value: &str| SceneFile::parse(&format!("{before}{value}{after}"));
                let (examples, is) = (
                    kinds(&path).into_iter().map(|[_, example]| example),
                    place.value,
                );
                let errors: Vec<_> = examples.map(|example| changed(example).err()).collect();
                assert!(
                    errors.iter().any(Option::is_none),
                    "{path} is {is}: {errors:?}"
                );
                let told = changed("{}").unwrap_err().to_string();
                let named = format!("line {}, column {}: {path}", place.line, place.column);
                assert!(told.starts_with(&named), "{path}: {told}");
                assert!(told.ends_with(&wanted(&path)), "{path}: {told}");
                tried.insert(path);
            }
        }
        assert!(tried.len() > 200, "{} fields", tried.len());
    }
}
