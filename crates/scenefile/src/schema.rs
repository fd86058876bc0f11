//! Derives the JSON schema of scene files from their types.

use crate::SceneFile;
use crate::file::{is_number, positive};
use serde_json::{Map, Value};
use std::sync::LazyLock;

/// The JSON schema of scene files in JSON. In these files, a variant is an object with one
/// field. `title` describes a field, `x-ron` is an example in the notation of a scene file, and
/// `x-range` gives the allowed numbers of the field.
#[must_use]
pub fn schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
        let mut schema = schemars::schema_for!(SceneFile).to_value();
        let types = schema["$defs"].clone();
        complete(&mut schema, &types);
        schema
    });
    &SCHEMA
}

/// A field without a description has the description of its type, and a number without a range
/// must be positive.
fn complete(node: &mut Value, types: &Value) {
    if is_number(node) && node.get("x-range").is_none() {
        positive(node);
    }
    let fields = node.get_mut("properties").and_then(Value::as_object_mut);
    for field in fields.into_iter().flat_map(Map::values_mut) {
        let of_type = name_of_type(field).map(|name| &types[name]);
        if let Some(of_type) = of_type.filter(|_| field.get("title").is_none()) {
            for key in ["title", "x-ron"] {
                field[key] = of_type[key].clone();
            }
        }
    }
    match node {
        Value::Object(below) => below.values_mut().for_each(|below| complete(below, types)),
        Value::Array(below) => below.iter_mut().for_each(|below| complete(below, types)),
        _ => {}
    }
}

/// The name of the type of a node; the type may be optional.
fn name_of_type(node: &Value) -> Option<&str> {
    let types = [node, node.get("anyOf").map_or(node, |any| &any[0])];
    let mut references = types.iter().filter_map(|node| node.get("$ref")?.as_str());
    references.next()?.rsplit('/').next()
}

/// A node of the schema, with its reference resolved.
pub(crate) fn referred(node: &'static Value) -> &'static Value {
    name_of_type(node).map_or(node, |name| &schema()["$defs"][name])
}

/// The node of a variant's content; `node` is the node of the variant's type.
pub(crate) fn variant(node: &'static Value, name: &str) -> &'static Value {
    let variants = referred(node)["oneOf"].as_array();
    let mut contents = variants
        .into_iter()
        .flatten()
        .map(|v| &v["properties"][name]);
    contents
        .find(|content| content.is_object())
        .unwrap_or(&Value::Null)
}

/// The node of the element with the index `place`; `node` is the node of the list.
pub(crate) fn element(node: &'static Value, place: usize) -> &'static Value {
    let node = referred(node);
    match node.get("prefixItems") {
        Some(each) => &each[place],
        None => &node["items"],
    }
}

#[cfg(test)]
mod tests {
    use super::schema;
    use serde_json::{Map, Value};

    /// Collects the fields below a node that have no description.
    fn untold(node: &Value, found: &mut Vec<String>) {
        for (name, field) in node["properties"].as_object().into_iter().flatten() {
            let is_told = field["title"].is_string() && field["x-ron"].is_string();
            if name.starts_with(char::is_lowercase) && !is_told {
                found.push(format!("{name}: {field}"));
            }
        }
        let below = node.as_object().into_iter().flat_map(Map::values);
        let below = below.chain(node.as_array().into_iter().flatten());
        below.for_each(|below| untold(below, found));
    }

    #[test]
    fn each_field_says_what_it_is() {
        let mut found = Vec::new();
        untold(schema(), &mut found);
        assert!(found.is_empty(), "{found:#?}");
    }
}
