//! Finds the fields in which two JSON trees differ.

use serde_json::Value;

/// A field that differs, with its value in each of two trees. The field is named as messages name
/// it: `blockers[0].shapes[1].edge`, without the names of variants.
#[derive(Debug)]
pub struct FieldChange {
    /// Path of the field.
    pub field: String,
    /// The two values, shortened.
    pub values: [String; 2],
}

/// All fields in which two trees differ, in the order of the first tree. A missing field
/// counts as null, and another variant as one difference.
pub fn differences(a: &Value, b: &Value) -> Vec<FieldChange> {
    let mut found = Vec::new();
    collect(String::new(), a, b, &mut found);
    found
}

/// The first field that differs.
pub fn difference(a: &Value, b: &Value) -> Option<FieldChange> {
    differences(a, b).into_iter().next()
}

fn collect(field: String, a: &Value, b: &Value, found: &mut Vec<FieldChange>) {
    match (a, b) {
        _ if a == b => (),
        (Value::Object(of_a), Value::Object(of_b)) => match [a, b].map(variant) {
            // A plain value stays with its variant, as a scene file and `--set` have it.
            [Some((name, a)), Some((other, b))] if name == other && !is_plain(a) => {
                collect(field, a, b, found);
            }
            [None, None] => {
                let added = of_b.keys().filter(|name| !of_a.contains_key(*name));
                for name in of_a.keys().chain(added) {
                    let [a, b] = [of_a, of_b].map(|tree| tree.get(name).unwrap_or(&Value::Null));
                    let dot = if field.is_empty() { "" } else { "." };
                    collect(format!("{field}{dot}{name}"), a, b, found);
                }
            }
            _ => found.push(FieldChange::new(field, [a, b])),
        },
        (Value::Array(a), Value::Array(b)) => {
            for i in 0..a.len().max(b.len()) {
                let [a, b] = [a, b].map(|list| list.get(i).unwrap_or(&Value::Null));
                collect(format!("{field}[{i}]"), a, b, found);
            }
        }
        _ => found.push(FieldChange::new(field, [a, b])),
    }
}

/// The name and content of a variant such as `{"Disc": {…}}`.
fn variant(value: &Value) -> Option<(&str, &Value)> {
    let fields = value.as_object().filter(|fields| fields.len() == 1)?;
    let (name, content) = fields.iter().next()?;
    let is_name = name.starts_with(char::is_uppercase) && name.chars().all(char::is_alphanumeric);
    is_name.then_some((name, content))
}

/// Checks whether a value has no parts.
fn is_plain(value: &Value) -> bool {
    !value.is_object() && !value.is_array()
}

impl FieldChange {
    fn new(field: String, values: [&Value; 2]) -> Self {
        let values = values.map(brief);
        Self { field, values }
    }
}

/// A value as text that fits in a line: `Disc(…)`, `Before("floor")`, `0.1`.
fn brief(value: &Value) -> String {
    const MAX_CHARACTERS: usize = 40;
    if let Some((name, content)) = variant(value) {
        return match content {
            Value::Object(_) => format!("{name}(…)"),
            content => format!("{name}({})", brief(content)),
        };
    }
    match value {
        Value::Null => "none".to_owned(),
        Value::Object(_) => "(…)".to_owned(),
        Value::Array(_) => "[…]".to_owned(),
        Value::String(text) if text.chars().count() > MAX_CHARACTERS => {
            let start: String = text.chars().take(MAX_CHARACTERS).collect();
            Value::String(start + "…").to_string()
        }
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_field_that_differs_is_named() {
        let a = json!({
            "light": {"Disc": {"radius": 1}}, "blockers": [{"Bars": {"pitch": 0.12, "fill": 0.5}}],
            "planes": [{"at": {"After": "stop"}}], "x": {"Hann": 0.3}, "mask": "m".repeat(50),
            "run": null, "inputs": {"Wall.png": "a"},
        });
        let b = json!({
            "light": {"Beam": {"waist": 2}}, "blockers": [{"Bars": {"pitch": 0.1, "fill": 0.5}}, 7],
            "planes": [{"at": "Emission"}, {"Plain": {}}], "x": {"Hann": 0.2}, "mask": 1,
            "run": {"seed": 1}, "inputs": {"Wall.png": "b"},
        });
        let lines: Vec<String> = differences(&a, &b)
            .into_iter()
            .map(|change| format!("{}: {}", change.field, change.values.join(" and ")))
            .collect();
        let cut = format!("mask: \"{}…\" and 1", "m".repeat(40));
        let mut expected = vec![
            "light: Disc(…) and Beam(…)",
            "blockers[0].pitch: 0.12 and 0.1",
            "blockers[1]: none and 7",
            "planes[0].at: After(\"stop\") and \"Emission\"",
            "planes[1]: none and Plain(…)",
            &cut,
            "run: none and (…)",
            "x: Hann(0.3) and Hann(0.2)",
            "inputs.Wall.png: \"a\" and \"b\"",
        ];
        expected.sort_unstable();
        let mut lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        lines.sort_unstable();
        assert_eq!(lines, expected);
        assert!(differences(&a, &a).is_empty());
    }
}
