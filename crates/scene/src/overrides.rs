use crate::{SceneError, SceneFile};
use serde_json::Value;

impl SceneFile {
    /// The scene file with the field at `path` (such as `blockers.0.fill`) set to `value`.
    ///
    /// Names of variants (`Rectangle`, `JitteredSquares`) may be left out of the path.
    ///
    /// # Errors
    /// [`SceneError::Override`] when the path names no field or the value does not fit it.
    pub fn with(self, path: &str, value: &str) -> Result<Self, SceneError> {
        let fault = |message: String| SceneError::Override {
            path: format!("{path}={value}"),
            message,
        };
        let mut tree = serde_json::to_value(&self).map_err(|e| fault(e.to_string()))?;
        let mut place = &mut tree;
        for name in path.split('.') {
            let refusal = refusal(place, name);
            place = step(place, name).ok_or_else(|| fault(refusal))?;
        }
        *place = parsed(value);
        serde_json::from_value(tree).map_err(|e| fault(e.to_string()))
    }
}

/// The child `name` of a node, looking through a variant's name.
fn step<'a>(node: &'a mut Value, name: &str) -> Option<&'a mut Value> {
    match node {
        Value::Array(items) => items.get_mut(name.parse::<usize>().ok()?),
        Value::Object(fields) => {
            if is_variant(fields) && !fields.contains_key(name) {
                return step(fields.values_mut().next()?, name);
            }
            fields.get_mut(name)
        }
        _ => None,
    }
}

fn is_variant(fields: &serde_json::Map<String, Value>) -> bool {
    fields.len() == 1 && fields.keys().all(|k| is_name_of_variant(k))
}

fn is_name_of_variant(name: &str) -> bool {
    name.starts_with(char::is_uppercase)
}

/// Why `name` cannot stand below a node.
fn refusal(node: &Value, name: &str) -> String {
    let allowed = match node {
        Value::Array(items) => format!("0 to {}", items.len().saturating_sub(1)),
        Value::Object(fields) if is_variant(fields) && !is_name_of_variant(name) => {
            return fields.values().map(|below| refusal(below, name)).collect();
        }
        Value::Object(fields) => fields.keys().cloned().collect::<Vec<_>>().join(", "),
        Value::String(here) if is_name_of_variant(name) => here.clone(),
        _ => "nothing below a value".to_owned(),
    };
    let another = if is_name_of_variant(name) {
        ", or another set as a whole, such as blockers.0=\"Grating(…)\""
    } else {
        ""
    };
    format!("no field `{name}` here; allowed: {allowed}{another}")
}

/// A value as it is written in a scene file or in JSON; whole numbers such as 1e6 are integers, and what is
/// nothing else is text.
fn parsed(text: &str) -> Value {
    let text = text.trim();
    if let Ok(value) = serde_json::from_str(text) {
        return match value {
            Value::Number(n) => n
                .as_f64()
                .and_then(whole)
                .map_or(Value::Number(n), Value::from),
            value => value,
        };
    }
    let Some((name, inside)) = text.strip_suffix(')').and_then(|t| t.split_once('(')) else {
        return Value::String(text.to_owned());
    };
    match name.trim() {
        "" => fields(inside),
        variant => Value::Object(std::iter::once((variant.to_owned(), fields(inside))).collect()),
    }
}

/// What stands between parentheses: named fields, several values, or one.
fn fields(text: &str) -> Value {
    let parts = separated(text);
    let named: Option<serde_json::Map<String, Value>> = parts
        .iter()
        .map(|part| {
            part.split_once(':')
                .map(|(k, v)| (k.trim().to_owned(), parsed(v)))
        })
        .collect();
    match (named, parts.as_slice()) {
        (Some(map), [_, ..]) => Value::Object(map),
        (_, [one]) => parsed(one),
        _ => parts.into_iter().map(parsed).collect(),
    }
}

/// The parts of a list, at the commas outside of parentheses.
fn separated(text: &str) -> Vec<&str> {
    let mut depth = 0_i32;
    text.split(|c: char| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    })
    .filter(|part| !part.trim().is_empty())
    .collect()
}

/// A number as a whole one, where it is one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be a whole number below 2^53"
)]
pub(crate) fn whole(x: f64) -> Option<u64> {
    let small = (0.0..9_007_199_254_740_992.0).contains(&x);
    (small && x.fract() == 0.0).then_some(x as u64)
}
