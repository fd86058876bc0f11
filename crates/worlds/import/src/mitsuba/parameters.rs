//! Values of `$parameters`.

use crate::report::quoted;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of bytes that substitution may produce for a file, over all values. Defaults may
/// contain other parameters, so values could grow without limit.
const MOST_BYTES: usize = 16 << 20;

/// Parameters by name, set by the caller or by `<default>`.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    values: BTreeMap<String, String>,
    /// The parameters that the caller has set, and that the file did not use so far. The file must
    /// use all of them.
    pub(super) unused: BTreeSet<String>,
    made: usize,
}

impl Parameters {
    /// Creates the parameters set by the caller.
    pub(super) fn new(set: &[(String, String)]) -> Self {
        Self {
            values: set.iter().cloned().collect(),
            unused: set.iter().map(|(name, _)| name.clone()).collect(),
            made: 0,
        }
    }

    /// Sets the value of a parameter, unless the parameter already has a value.
    pub(super) fn default(&mut self, name: &str, value: &str) {
        let known = self.values.entry(name.to_owned());
        known.or_insert_with(|| value.to_owned());
    }

    /// The text after parameters are replaced by their values. `\$` stands for a dollar
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
            if let Some(value) = self.values.get(&name) {
                self.unused.remove(&name);
                self.made += value.len();
                made.push_str(value);
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
