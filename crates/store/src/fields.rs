//! Finds the fields in which two JSON trees differ.

use serde_json::Value;

/// A field that differs, with its value in each of two trees. The field is named in the notation of
/// `--set`.
#[derive(Debug)]
pub struct FieldChange {
    /// Path of the field, with dots.
    pub field: String,
    /// The two values, shortened.
    pub values: [String; 2],
}

/// Returns all fields in which two trees differ, in the order of the first tree. A missing field
/// counts as null.
pub fn differences(a: &Value, b: &Value) -> Vec<FieldChange> {
    let mut found = Vec::new();
    collect(String::new(), a, b, &mut found);
    found
}

/// Returns the first field that differs.
pub fn difference(a: &Value, b: &Value) -> Option<FieldChange> {
    differences(a, b).into_iter().next()
}

fn collect(field: String, a: &Value, b: &Value, found: &mut Vec<FieldChange>) {
    let child = |name: &str| {
        let dot = if field.is_empty() { "" } else { "." };
        format!("{field}{dot}{name}")
    };
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|name| !a.contains_key(*name));
            for name in a.keys().chain(added) {
                let [a, b] = [a, b].map(|tree| tree.get(name).unwrap_or(&Value::Null));
                collect(child(name), a, b, found);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            for i in 0..a.len().max(b.len()) {
                let [a, b] = [a, b].map(|list| list.get(i).unwrap_or(&Value::Null));
                collect(child(&i.to_string()), a, b, found);
            }
        }
        _ if a != b => found.push(FieldChange {
            field,
            values: [brief(a), brief(b)],
        }),
        _ => (),
    }
}

/// Returns a value as text, shortened so that it fits in a line.
fn brief(value: &Value) -> String {
    const MAX_CHARACTERS: usize = 60;
    let text = value.to_string();
    if text.chars().count() <= MAX_CHARACTERS {
        return text;
    }
    text.chars()
        .take(MAX_CHARACTERS)
        .chain("…".chars())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_field_that_differs_is_named() {
        let a = json!({"light": 1, "blockers": [{"pitch": 0.12, "fill": 0.5}], "only": true});
        let b = json!({"light": 1, "blockers": [{"pitch": 0.1, "fill": 0.5}, 7]});
        let lines: Vec<String> = differences(&a, &b)
            .into_iter()
            .map(|change| format!("{}: {}", change.field, change.values.join(" and ")))
            .collect();
        let mut expected = vec![
            "blockers.0.pitch: 0.12 and 0.1",
            "blockers.1: null and 7",
            "only: true and null",
        ];
        expected.sort_unstable();
        let mut lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        lines.sort_unstable();
        assert_eq!(lines, expected);
        assert!(differences(&a, &a).is_empty());
    }
}
