//! Reduces a scene to a smaller scene with the same fault.
//!
//! Reduction treats the scene as a tree of values: it removes elements one at a time, and rounds
//! numbers. If a reduced scene is invalid, it does not have the same fault, and the reduction
//! does not accept it.

use super::judge::{SceneTrouble, persists};
use super::run::Runner;
use super::straight::straightened;
use etendue_scene::SceneFile;
use serde_json::{Value, json};
use std::io;
use std::time::{Duration, Instant};

/// Names of lists whose elements can be removed.
const LISTS: &str = "planes other_lights blockers visits surfaces shapes Lobes";
/// Names of fields that can be removed or disabled.
const OPTIONAL: &str = "y v window frequencies spacing texture leaves facing along grating \
    description";
/// Names of fields, each with its simplest variant. A reduction replaces the variant of a field by
/// the simplest variant.
const PLAIN: [(&str, &str); 6] = [
    ("quantity", "Radiance"),
    ("orientation", "Orthogonal"),
    ("emission", "Aimed"),
    ("fresnel", "White"),
    ("lobe", "Lambertian"),
    ("form", "Plane"),
];

/// The smallest scene with the same fault that is found in the given time.
pub(super) fn shrink(
    runner: &Runner,
    file: &SceneFile,
    trouble: &SceneTrouble,
    time: Duration,
) -> io::Result<SceneFile> {
    let begun = Instant::now();
    let mut best = serde_json::to_value(file).map_err(io::Error::other)?;
    let (mut taken, mut next) = (false, 0);
    while begun.elapsed() < time {
        let candidates = candidates(&best);
        let Some(candidate) = candidates.get(next) else {
            // The search ends after a pass over all reductions in which none is accepted.
            if !taken {
                break;
            }
            (taken, next) = (false, 0);
            continue;
        };
        let changed: Result<SceneFile, _> = serde_json::from_value(candidate.clone());
        match changed {
            Ok(changed) if persists(runner, &changed, trouble)? => {
                best = candidate.clone();
                taken = true;
            }
            _ => next += 1,
        }
    }
    serde_json::from_value(best).map_err(io::Error::other)
}

/// All scenes that are one reduction step smaller. Scenes from which the most was removed
/// come first.
fn candidates(tree: &Value) -> Vec<Value> {
    let mut found = Vec::new();
    let places = places(tree, String::new());
    for list in LISTS.split(' ') {
        for (place, value) in &places {
            let elements = value.as_array().filter(|all| {
                all.len() > usize::from(!["blockers", "other_lights"].contains(&list))
            });
            let Some(elements) = elements.filter(|_| name(place) == list) else {
                continue;
            };
            for i in 0..elements.len() {
                let mut less = elements.clone();
                less.remove(i);
                found.push(with(tree, place, Value::Array(less)));
            }
        }
    }
    found.extend(straightened(tree));
    found.extend(without_blends(tree, &places));
    for (place, value) in &places {
        let name = name(place);
        if OPTIONAL.split(' ').any(|field| field == name) && !value.is_null() {
            found.push(with(tree, place, Value::Null));
        }
        for (_, plain) in PLAIN.iter().filter(|(of, _)| *of == name) {
            if **value != json!(plain) {
                found.push(with(tree, place, json!(plain)));
            }
        }
    }
    found.extend(rounder(tree, &places));
    found
}

/// The scenes without a blend and without the second BRDF that this blend needs.
fn without_blends(tree: &Value, places: &[(String, &Value)]) -> Vec<Value> {
    let blends = places
        .iter()
        .filter(|(place, value)| name(place) == "blend" && !value.is_null());
    let without = |(place, _): &(String, &Value)| {
        let other = place.replace("/blend", "/other");
        with(&with(tree, place, Value::Null), &other, Value::Null)
    };
    blends.map(without).collect()
}

/// Returns scenes in which all numbers have fewer digits, then scenes in which one number has
/// fewer digits.
fn rounder(tree: &Value, places: &[(String, &Value)]) -> Vec<Value> {
    let numbers = places
        .iter()
        .filter(|(place, value)| value.is_f64() && !place.starts_with("/run"));
    let numbers: Vec<(&String, f64)> = numbers
        .filter_map(|(place, value)| Some((place, value.as_f64()?)))
        .collect();
    let all = |digits: usize| {
        let mut tree = tree.clone();
        for (place, x) in &numbers {
            tree = with(&tree, place, json!(short(*x, digits)));
        }
        tree
    };
    let mut found: Vec<Value> = [2, 1].map(all).into_iter().filter(|t| t != tree).collect();
    for (place, x) in &numbers {
        // Coordinates of centres are not rounded to 0 or 1, because an object at 0 would be in
        // the light.
        let moved = place.contains("/center/");
        let round = [0.0, 1.0].into_iter().filter(|_| !moved);
        for y in round.chain([short(*x, 0), short(*x, 1)]) {
            // Each rounding must reduce the number of digits, so that the search ends.
            if digits(y) < digits(*x) {
                found.push(with(tree, place, json!(y)));
            }
        }
    }
    found
}

fn short(x: f64, digits: usize) -> f64 {
    format!("{x:.digits$e}").parse().unwrap_or(x)
}

/// The number of characters of a number when written; 0 counts as the shortest number,
/// and 1 as the second shortest.
fn digits(x: f64) -> usize {
    match format!("{:e}", x.abs()).as_str() {
        "0e0" => 0,
        "1e0" => 1,
        other => other.len(),
    }
}

/// Every value of a tree, with its path.
fn places(tree: &Value, at: String) -> Vec<(String, &Value)> {
    let mut found = vec![(at.clone(), tree)];
    match tree {
        Value::Object(fields) => {
            for (key, value) in fields {
                found.extend(places(value, format!("{at}/{key}")));
            }
        }
        Value::Array(elements) => {
            for (i, value) in elements.iter().enumerate() {
                found.extend(places(value, format!("{at}/{i}")));
            }
        }
        _ => {}
    }
    found
}

fn name(place: &str) -> &str {
    place.rsplit('/').next().unwrap_or_default()
}

fn with(tree: &Value, place: &str, value: Value) -> Value {
    let mut tree = tree.clone();
    if let Some(at) = tree.pointer_mut(place) {
        *at = value;
    }
    tree
}

#[cfg(test)]
mod tests {
    use super::{candidates, digits};
    use serde_json::json;

    #[test]
    fn candidates_leave_out_and_round() {
        let tree = json!({"blockers": [{"pitch": 0.123}], "planes": [{"name": "a"}]});
        let found = candidates(&tree);
        assert!(found.contains(&json!({"blockers": [], "planes": [{"name": "a"}]})));
        assert!(found.contains(&json!({"blockers": [{"pitch": 0.1}], "planes": [{"name": "a"}]})));
        // The reduction keeps the last plane of a scene.
        assert!(found.iter().all(|tree| tree["planes"][0]["name"] == "a"));
    }

    #[test]
    fn rounding_ends() {
        assert!(digits(0.0) < digits(1.0) && digits(1.0) < digits(0.5));
        assert!(digits(0.5) < digits(0.52));
    }
}
