//! Sets fields given on the command line.

use crate::display::shown;
use crate::hints::wanted;
use crate::messages::{path_of, unfit};
use crate::place::dotted;
use crate::suggestion::did_you_mean;
use crate::whole_number::whole;
use crate::{SceneError, SceneFile, limits};
use serde_json::Value;

impl SceneFile {
    /// The scene file with the field at `path` (such as `blockers.0.fill`, or
    /// `blockers[0].fill` as in messages) set to `value`.
    ///
    /// Names of variants (`Rectangle`, `JitteredSquares`) may be left out of the path.
    ///
    /// # Errors
    /// [`SceneError::Override`] when the path names no field, or when the value does not fit the
    /// field.
    pub fn with(self, path: &str, value: &str) -> Result<Self, SceneError> {
        let fault = |message: String| SceneError::Override {
            path: shown(format_args!("{path}={value}"), limits::VALUE),
            message: shown(message, limits::ALLOWED),
        };
        let mut tree = self.tree().map_err(|e| fault(e.to_string()))?;
        set(&mut tree, path, value).map_err(fault)?;
        serde_path_to_error::deserialize(tree).map_err(|error| {
            let count = |brackets: &str| value.chars().filter(|c| brackets.contains(*c)).count();
            fault(match count("([") > count(")]") {
                true => format!(
                    "a bracket is still open; allowed: {}",
                    wanted(&path_of(error.path()))
                ),
                false => unfit(&error),
            })
        })
    }

    /// The scene file after several fields have been set, one after the other, by
    /// [`Self::with`].
    ///
    /// # Errors
    /// [`SceneError::Override`] for the first field that cannot be set, or if there are more than
    /// [`limits::OVERRIDES`] fields.
    pub fn with_all(self, fields: &[(String, String)]) -> Result<Self, SceneError> {
        if fields.len() > limits::OVERRIDES {
            return Err(SceneError::Override {
                path: format!("{} fields set", fields.len()),
                message: format!("allowed: at most {}", limits::OVERRIDES),
            });
        }
        if let Some(file) = self.with_all_at_once(fields) {
            return Ok(file);
        }
        // Fields are set one after the other, so an error names the faulty setting, and a later
        // setting can change a field that an earlier setting has created.
        let mut fields = fields.iter();
        fields.try_fold(self, |file, (path, value)| file.with(path, value))
    }

    /// The value of the field at `path`, which may be a list or an item with fields.
    ///
    /// # Errors
    /// A message if the path names no field.
    pub fn value(&self, path: &str) -> Result<Value, String> {
        let mut tree = self.tree().map_err(|e| e.to_string())?;
        place(&mut tree, path).cloned()
    }

    /// The file as a tree of values with all fields, which includes fields that a file does
    /// not write because they were added later.
    fn tree(&self) -> serde_json::Result<Value> {
        let mut tree = serde_json::to_value(self)?;
        if let Value::Object(fields) = &mut tree {
            let lights = fields.entry("other_lights");
            lights.or_insert_with(|| Value::Array(Vec::new()));
        }
        tree["run"]["color"] = serde_json::to_value(self.run.color)?;
        Ok(tree)
    }

    fn with_all_at_once(&self, fields: &[(String, String)]) -> Option<Self> {
        let mut tree = self.tree().ok()?;
        for (path, value) in fields {
            set(&mut tree, path, value).ok()?;
        }
        serde_json::from_value(tree).ok()
    }
}

/// Sets the value at `path` below a node.
fn set(tree: &mut Value, path: &str, value: &str) -> Result<(), String> {
    *place(tree, path)? = parsed(value, limits::NESTING)
        .ok_or_else(|| format!("allowed: brackets nested at most {} deep", limits::NESTING))?;
    Ok(())
}

/// The place of the value at `path` below a node.
fn place<'a>(tree: &'a mut Value, path: &str) -> Result<&'a mut Value, String> {
    let mut place = tree;
    for name in dotted(path).split('.') {
        let refusal = refusal(place, name);
        place = step(place, name).ok_or(refusal)?;
    }
    Ok(place)
}

/// The child called `name`. If the node is a variant of an enum, looks inside the variant.
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

/// The message for a node that has no field `name`. The message lists the fields that the
/// node has.
fn refusal(node: &Value, name: &str) -> String {
    let allowed = match node {
        Value::Array(items) => match items.len() {
            0 => "nothing: the list is empty".to_owned(),
            1 => "0".to_owned(),
            n => format!("0 to {}", n - 1),
        },
        Value::Object(fields) if is_variant(fields) && !is_name_of_variant(name) => {
            return fields.values().map(|below| refusal(below, name)).collect();
        }
        Value::Object(fields) => fields.keys().cloned().collect::<Vec<_>>().join(", "),
        Value::String(here) if is_name_of_variant(name) => here.clone(),
        _ => "nothing: a value has no fields".to_owned(),
    };
    let another = if is_name_of_variant(name) {
        ", or the whole item, such as blockers.0=\"Grating(…)\""
    } else {
        ""
    };
    let known = node
        .as_object()
        .into_iter()
        .flat_map(|fields| fields.keys());
    let meant = did_you_mean(name, known.map(String::as_str));
    format!("no field `{name}` here{meant}; allowed: {allowed}{another}")
}

/// Parses a value in the notation of a scene file or of JSON. Whole numbers such as 1e6 become
/// integers, and a value in neither notation becomes text. Returns `None` if the brackets of the
/// value are nested deeper than `deepest`.
fn parsed(text: &str, deepest: usize) -> Option<Value> {
    let text = text.trim();
    if let Ok(value) = serde_json::from_str(text) {
        return Some(match value {
            Value::Number(n) => n
                .as_f64()
                .and_then(whole)
                .map_or(Value::Number(n), Value::from),
            value => value,
        });
    }
    let list = text.strip_prefix('[').and_then(|t| t.strip_suffix(']'));
    if let Some(list) = list {
        let items = separated(list).into_iter();
        let items = items.map(|item| parsed(item, deepest.checked_sub(1)?));
        return items.collect::<Option<_>>().map(Value::Array);
    }
    let Some((name, inside)) = text.strip_suffix(')').and_then(|t| t.split_once('(')) else {
        return Some(Value::String(text.to_owned()));
    };
    let inside = fields(inside, deepest.checked_sub(1)?)?;
    Some(match name.trim() {
        "" => inside,
        variant => Value::Object(std::iter::once((variant.to_owned(), inside)).collect()),
    })
}

/// Parses the content of parentheses: named fields, several values, or one value.
fn fields(text: &str, deepest: usize) -> Option<Value> {
    let parts = separated(text);
    let named: Option<Vec<_>> = parts.iter().map(|part| named(part)).collect();
    match (named, parts.as_slice()) {
        (Some(named), [_, ..]) => {
            let fields = named.into_iter();
            let fields =
                fields.map(|(name, v)| Some((name.trim().to_owned(), parsed(v, deepest)?)));
            fields.collect::<Option<_>>().map(Value::Object)
        }
        (_, [one]) => parsed(one, deepest),
        _ => {
            let values = parts.into_iter().map(|part| parsed(part, deepest));
            values.collect::<Option<_>>().map(Value::Array)
        }
    }
}

/// The name and the value of a named field.
fn named(text: &str) -> Option<(&str, &str)> {
    let (name, value) = text.split_once(':')?;
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    name.trim().chars().all(is_name).then_some((name, value))
}

/// The elements of a list, separated at the commas that are outside of brackets.
fn separated(text: &str) -> Vec<&str> {
    let mut depth = 0_i32;
    text.split(|c: char| {
        depth += i32::from("([".contains(c)) - i32::from(")]".contains(c));
        c == ',' && depth == 0
    })
    .filter(|part| !part.trim().is_empty())
    .collect()
}
