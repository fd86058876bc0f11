//! Values of `$parameters`.

use crate::report::quoted;
use std::collections::BTreeMap;

/// Maximum number of bytes that substitution may produce for a file, over all values. Defaults may
/// contain other parameters, so values could grow without limit.
const MOST_BYTES: usize = 16 << 20;

/// Parameters by name, set by the caller or by `<default>`.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    values: BTreeMap<String, MitsubaParameter>,
    made: usize,
}

#[derive(Debug)]
struct MitsubaParameter {
    value: String,
    /// Whether the caller has set the parameter. The file must use every parameter that the caller
    /// has set.
    is_set: bool,
    is_used: bool,
}

impl Parameters {
    /// Creates the parameters set by the caller.
    pub(super) fn new(set: &[(String, String)]) -> Self {
        let values = set.iter().map(|(name, value)| {
            let parameter = MitsubaParameter {
                value: value.clone(),
                is_set: true,
                is_used: false,
            };
            (name.clone(), parameter)
        });
        Self {
            values: values.collect(),
            made: 0,
        }
    }

    /// Sets the value of a parameter, unless the parameter already has a value.
    pub(super) fn default(&mut self, name: &str, value: &str) {
        self.values
            .entry(name.to_owned())
            .or_insert_with(|| MitsubaParameter {
                value: value.to_owned(),
                is_set: false,
                is_used: false,
            });
    }

    /// Returns the names that the caller has set but the file does not use.
    pub(super) fn unused(&self) -> impl Iterator<Item = &str> {
        let all = self.values.iter();
        all.filter(|(_, p)| p.is_set && !p.is_used)
            .map(|(name, _)| name.as_str())
    }

    /// Returns the text after parameters are replaced by their values. `\$` stands for a dollar
    /// sign. If the names of several parameters match, the longest name is used.
    pub(super) fn substitute(&mut self, text: &str) -> Result<String, String> {
        let mut made = String::new();
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            let (before, after) = rest.split_at(at);
            let after = &after[1..];
            if let Some(before) = before.strip_suffix('\\') {
                made.push_str(before);
                made.push('$');
                rest = after;
                continue;
            }
            made.push_str(before);
            let name = self.longest(after).ok_or_else(|| undefined(after))?;
            rest = &after[name.len()..];
            if let Some(parameter) = self.values.get_mut(&name) {
                parameter.is_used = true;
                self.made += parameter.value.len();
                made.push_str(&parameter.value);
            }
            if self.made > MOST_BYTES {
                return Err(format!(
                    "the scene has more than {MOST_BYTES} bytes after parameters are inserted"
                ));
            }
        }
        made.push_str(rest);
        Ok(made)
    }

    fn longest(&self, text: &str) -> Option<String> {
        let fits = self.values.keys().filter(|name| text.starts_with(*name));
        fits.max_by_key(|name| name.len()).cloned()
    }
}

fn undefined(after: &str) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let end = after.find(|c| !is_name(c)).unwrap_or(after.len());
    let name = quoted(&after[..end]);
    format!("parameter {name} has no value: no <default> precedes it, and the user sets no value")
}
