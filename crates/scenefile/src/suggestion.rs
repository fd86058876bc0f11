//! Suggests a known name in place of an unknown name that is similar to it.

use crate::limits;
use strsim::osa_distance;

/// Returns ` (did you mean …?)` with the known name that is most similar to `name`, or an empty
/// text if no known name is similar.
#[must_use]
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    match nearest(name, known) {
        Some(other) => format!(" (did you mean {}?)", crate::shown(other, limits::NAME)),
        None => String::new(),
    }
}

/// The known name that is most similar to `name`, or `None` if no known name is similar.
#[must_use]
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = |name: &str| -> String {
        // Names are compared only up to the largest length of a name.
        let start = name.chars().take(limits::NAME);
        start.flat_map(char::to_lowercase).collect()
    };
    let name = lower(name);
    // One letter in three may differ, and at least one letter.
    let most = (name.chars().count() / 3).max(1);
    let known = known.into_iter();
    let known = known.map(|other| (osa_distance(&name, &lower(other)), other));
    // A known name is not suggested if all of its characters would have to change.
    let near = known.filter(|(distance, other)| {
        *distance <= most && *distance < other.chars().take(limits::NAME).count()
    });
    let nearest = near.min_by_key(|(distance, _)| *distance);
    nearest.map(|(_, other)| other)
}
