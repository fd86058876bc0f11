//! The page of the book that describes scene files, made from their schema.

use crate::schema::schema;
use serde_json::{Map, Value};

/// The text above the tables on the page.
const HEAD: &str = include_str!("page_head.md");

/// The page of the book that describes all types of scene files with their fields, in
/// Markdown. The types are in the order of their first use.
#[must_use]
pub fn page() -> String {
    let schema = schema();
    let mut types = vec![("Scene", schema)];
    let mut next = 0;
    while let Some((_, node)) = types.get(next) {
        let mut met = Vec::new();
        named(node, &mut met);
        for name in met {
            if types.iter().all(|(known, _)| *known != name) {
                types.push((name, &schema["$defs"][name]));
            }
        }
        next += 1;
    }
    let sections = types
        .iter()
        .map(|(name, node)| format!("\n## {name}\n\n{}\n{}", description(node), content(node)));
    format!("{HEAD}{}", sections.collect::<String>())
}

/// Collects the names of the types that a node refers to, in the order of the page.
fn named<'a>(node: &'a Value, met: &mut Vec<&'a str>) {
    if let Some(name) = node["$ref"].as_str().and_then(|at| at.rsplit('/').next()) {
        met.push(name);
    }
    for (_, below) in fields(node) {
        named(below, met);
    }
    named_below(&node["items"], met);
    for list in ["oneOf", "anyOf", "prefixItems"] {
        named_below(&node[list], met);
    }
}

fn named_below<'a>(node: &'a Value, met: &mut Vec<&'a str>) {
    match node {
        Value::Array(all) => all.iter().for_each(|below| named(below, met)),
        Value::Object(_) => named(node, met),
        _ => {}
    }
}

/// Iterates over the fields of a node. The required fields come first, and the other fields follow
/// by name.
fn fields(node: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let required = node["required"].as_array().into_iter().flatten();
    let required = required.filter_map(Value::as_str);
    let optional = node["properties"]
        .as_object()
        .into_iter()
        .flat_map(Map::keys);
    let optional = optional
        .map(String::as_str)
        .filter(|name| !is_required(node, name));
    let names = required.chain(optional);
    names.map(|name| (name, &node["properties"][name]))
}

fn is_required(node: &Value, name: &str) -> bool {
    let mut required = node["required"].as_array().into_iter().flatten();
    required.any(|known| known == name)
}

fn description(node: &Value) -> &str {
    node["description"].as_str().unwrap_or_default()
}

/// Describes the fields of a type, or its variants.
fn content(node: &Value) -> String {
    match node["oneOf"].as_array() {
        Some(variants) => variants.iter().map(variant).collect(),
        None => table(node),
    }
}

/// Describes a variant on one line, with its fields if they have names.
fn variant(node: &Value) -> String {
    let about = description(node);
    if let Some(name) = node["const"].as_str() {
        return format!("\n* `{name}`: {about}\n");
    }
    let mut variants = fields(node);
    let Some((name, inside)) = variants.next() else {
        return String::new();
    };
    if inside["properties"].is_object() {
        return format!("\n* `{name}(…)`: {about}\n{}", table(inside));
    }
    format!("\n* `{name}(…)`: {about}{}\n", holds(inside))
}

/// Describes the content of the parentheses of a variant with unnamed fields.
fn holds(node: &Value) -> String {
    let many = node["prefixItems"].as_array();
    let each = many.map_or(node, |many| &many[0]);
    let count = many.map_or(String::new(), |many| {
        format!("{} numbers, each ", many.len())
    });
    match (each["x-range"].as_str(), type_of(node)) {
        (Some(range), _) => format!(" The value in parentheses: {count}{range}."),
        (None, Some(name)) => format!(
            " The value in parentheses: a list of [{name}](#{}).",
            name.to_lowercase()
        ),
        (None, None) => " The value in parentheses: a text in quotes.".to_owned(),
    }
}

/// The named type of a node, or of the items if the node is a list.
fn type_of(node: &Value) -> Option<&str> {
    let mut met = Vec::new();
    named(node, &mut met);
    met.first().copied()
}

/// A table of the fields of a node, one per row.
fn table(node: &Value) -> String {
    let mut text = String::from("\n| field | meaning | value | default | example |\n");
    text.push_str("|---|---|---|---|---|\n");
    for (name, field) in fields(node) {
        let what = field["title"].as_str().unwrap_or_default();
        let value = match type_of(field) {
            Some(of) => format!("[{what}](#{})", of.to_lowercase()),
            None => what.to_owned(),
        };
        let range = field["x-range"]
            .as_str()
            .or(field["items"]["x-range"].as_str())
            .or(field["items"]["items"]["x-range"].as_str());
        let range = range.map_or(String::new(), |range| format!(", {range}"));
        let default = match is_required(node, name) {
            true => "required".to_owned(),
            false => default(&field["default"]),
        };
        let about = description(field);
        let example = field["x-ron"].as_str().unwrap_or_default();
        let row = [
            format!("`{name}`"),
            about.replace('\n', " "),
            value + &range,
            default,
        ];
        text.push_str(&format!("| {} | `{example}` |\n", row.join(" | ")));
    }
    text
}

/// A default value as it is written in a scene file.
fn default(value: &Value) -> String {
    match value {
        Value::Null => "left out".to_owned(),
        Value::Object(_) => "the default of each field".to_owned(),
        value => format!("`{}`", written(value)),
    }
}

fn written(value: &Value) -> String {
    match value {
        Value::String(text) if text.is_empty() => "\"\"".to_owned(),
        Value::String(text) => text.clone(),
        Value::Array(all) if all.is_empty() => "[]".to_owned(),
        Value::Array(all) => {
            let all: Vec<String> = all.iter().map(written).collect();
            format!("({})", all.join(", "))
        }
        value => value.to_string().trim_end_matches(".0").to_owned(),
    }
}
