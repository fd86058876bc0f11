//! The JSON schema of scene files: what the types say, with what each field is, how it is written
//! and how large its numbers may be.

use crate::SceneFile;
use crate::examples::field;
use serde_json::{Map, Value};

/// End of a field's path with the names of variants, and the numbers it may hold as messages tell
/// them; the first line that fits counts. A test holds each against the resolver.
const RANGES: &str = "
fill | above 0, at most 1
jitter | 0 to 1 − fill
count | 1 to 100000 squares in all
blockers[0].Grating.phase | -1000 to 1000
modulation | 0 to 1
albedo | 0 to 1
exponent | 0 to 10000
map.Lobes[0].width | 0.0001 to 1000
Star.radius | 1e-9 to 1e8
relief | -0.9 to 0.9
lobes | 0 to half the rings
rings | 2 to 2048
curvatures | -1e6 to 1e6
half | 1e-9 to 1e8
cells | 1 to 2048
form.Sphere | curvatures of -1e6 to 1e6
form.Cylinder | curvatures of -1e6 to 1e6
form.Paraboloid | curvatures of -1e6 to 1e6
event.Refraction.front | 0.1 to 10
event.Refraction.back | 0.1 to 10
event.ThinLens | a focal length in metres, negative if the lens spreads light, not 0
incoming | 0 to 1
outgoing | 0 to 1
lobe.Phong | 0 to 10000
lobe.Beckmann | 0.001 to 1
lobe.Ggx | 0.001 to 1
fresnel.Dielectric | 0.05 to 20
Conductor.n | 0.05 to 20
Conductor.k | 0 to 20
at.Distance | 0 to the end of the path
azimuths | 1 to 1024
photons | one for each batch to 10^12
batches | 32 to 1024
alpha | 1e-6 to 0.5
resolution | 0.0001 to 1
seed | 0 to 2^64 − 1
center | -1e9 to 1e9
edge | -1e9 to 1e9
phase | -1e9 to 1e9
up | -1e9 to 1e9
front | -1e9 to 1e9
from | -1e9 to 1e9
direction | -1e9 to 1e9
x_axis | -1e9 to 1e9
leaves | -1e9 to 1e9
facing | -1e9 to 1e9
along | -1e9 to 1e9
";

/// The JSON schema of a scene as JSON, in which a variant is an object of one field. `title` is what
/// a field is, `x-ron` one way to write it in a scene file, `x-range` the numbers it may hold.
#[must_use]
pub fn schema() -> Value {
    let mut root = schemars::schema_for!(SceneFile).to_value();
    let defs = root.as_object_mut().and_then(|root| root.remove("$defs"));
    let mut types = Types {
        waiting: object(defs.unwrap_or_default()),
        done: Map::new(),
    };
    types.annotate(&mut root, "");
    root["$defs"] = Value::Object(types.done);
    root
}

/// The named types of a schema: each is annotated where it is met first.
struct Types {
    waiting: Map<String, Value>,
    done: Map<String, Value>,
}

impl Types {
    fn annotate(&mut self, node: &mut Value, path: &str) {
        let name = node.get("$ref").and_then(Value::as_str);
        let name = name.and_then(|at| at.rsplit('/').next());
        if let Some((name, mut of)) = name.and_then(|name| self.waiting.remove_entry(name)) {
            self.annotate(&mut of, path);
            self.done.insert(name, of);
        }
        let fields = node.get_mut("properties").and_then(Value::as_object_mut);
        for (name, below) in fields.into_iter().flatten() {
            let path = format!("{path}.{name}");
            self.annotate(below, &path);
            if !name.starts_with(char::is_uppercase) {
                let [what, example] = field(&path);
                below["title"] = what.into();
                below["x-ron"] = example.into();
            }
        }
        for list in ["oneOf", "anyOf", "prefixItems"] {
            let all = node.get_mut(list).and_then(Value::as_array_mut);
            for below in all.into_iter().flatten() {
                self.annotate(below, path);
            }
        }
        let is_vector = node.get("maxItems").is_some() || node.get("items").is_some_and(is_number);
        if let Some(items) = node.get_mut("items").filter(|items| items.is_object()) {
            let element = if is_vector { "" } else { "[0]" };
            self.annotate(items, &format!("{path}{element}"));
        }
        if is_number(node) {
            bound(node, range(path));
        }
    }
}

/// Whether a node of a schema stands for a number, which may be left out.
fn is_number(node: &Value) -> bool {
    let is = |name: &Value| name == "number" || name == "integer";
    let names = node.get("type");
    names.is_some_and(|name| is(name) || name.as_array().is_some_and(|names| names.iter().any(is)))
}

/// Tells the numbers that a node may hold, and their ends where they are numbers.
fn bound(node: &mut Value, range: &str) {
    node["x-range"] = range.into();
    let ends = range.split_once(" to ");
    let ends = ends.map(|(least, most)| [least, most].map(str::parse::<f64>));
    if let Some([Ok(least), Ok(most)]) = ends {
        node["minimum"] = least.into();
        node["maximum"] = most.into();
    }
}

/// The numbers that the field at a path may hold, in words.
fn range(path: &str) -> &'static str {
    let fits = |end: &str| {
        path.strip_suffix(end)
            .is_some_and(|start| start.ends_with('.'))
    };
    let mut lines = RANGES.lines().filter_map(|line| line.split_once(" | "));
    lines
        .find_map(|(end, range)| fits(end).then_some(range))
        .unwrap_or(POSITIVE)
}

/// Sizes, widths, frequencies and strengths.
const POSITIVE: &str = "1e-9 to 1e9";

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(fields) => fields,
        _ => Map::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::{RANGES, range};
    use crate::{SceneError, SceneFile, resolve};
    use serde_json::Value;
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    /// Ranges that depend on other fields or have no end that can be set.
    const OTHERS: [&str; 4] = ["lobes", "at.Distance", "photons", "seed"];

    /// The numbers of a scene: their paths with and without places in lists.
    fn numbers(node: &Value, path: [String; 2], found: &mut Vec<[String; 2]>) {
        let [at, kind] = &path;
        match node {
            Value::Number(_) => found.push(path),
            Value::Array(items) => {
                let is_vector = items.iter().all(Value::is_number);
                let element = if is_vector { "" } else { "[0]" };
                for (i, item) in items.iter().enumerate() {
                    numbers(
                        item,
                        [format!("{at}.{i}"), format!("{kind}{element}")],
                        found,
                    );
                }
            }
            Value::Object(fields) => {
                for (name, item) in fields {
                    numbers(item, [at, kind].map(|path| format!("{path}.{name}")), found);
                }
            }
            _ => {}
        }
    }

    /// The allowed values that are told of a field that is set to a number.
    fn told(file: &SceneFile, folder: &Path, path: &str, value: f64) -> Vec<String> {
        let Ok(changed) = file.clone().with(path, &format!("{value:e}")) else {
            return Vec::new();
        };
        match resolve("scene", changed, folder, u64::MAX) {
            Err(SceneError::Values(faults)) => faults.into_iter().map(|f| f.allowed).collect(),
            _ => Vec::new(),
        }
    }

    /// Just below and above what a range tells.
    fn beyond(range: &str) -> Vec<f64> {
        let words: Vec<f64> = range
            .split([' ', ','])
            .filter_map(|word| word.parse().ok())
            .collect();
        match words[..] {
            [refused] => vec![refused],
            [least, most] => {
                // Whole numbers stay whole.
                let step = |end: f64| if end.fract() == 0.0 { 1.0 } else { end.abs() };
                vec![
                    least - step(least),
                    most + step(most).max((1e-3 * most).trunc()),
                ]
            }
            _ => panic!("{range}"),
        }
    }

    /// What a range is of: the end of a path that has one of its own, or the name of a field.
    fn owner(kind: &str) -> &str {
        let fits = |end: &&str| kind.ends_with(&format!(".{end}"));
        let mut ends = RANGES.lines().filter_map(|line| line.split(" | ").next());
        let name = kind.rsplit('.').next().unwrap();
        ends.find(fits).unwrap_or(name)
    }

    #[test]
    fn ranges_are_those_of_the_resolver() {
        let mut tried: BTreeSet<String> = OTHERS.map(str::to_owned).into();
        let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        for folder in [top.join("wild"), top.join("table1"), top] {
            let files = fs::read_dir(&folder).unwrap();
            for path in files.map(|entry| entry.unwrap().path()) {
                if path.extension().is_none_or(|e| e != "ron") {
                    continue;
                }
                let file = SceneFile::parse(&fs::read_to_string(&path).unwrap()).unwrap();
                let mut found = Vec::new();
                let tree = serde_json::to_value(&file).unwrap();
                numbers(&tree, [String::new(), String::new()], &mut found);
                for [at, kind] in found {
                    if !tried.insert(owner(&kind).to_owned()) {
                        continue;
                    }
                    let range = range(&kind);
                    for value in beyond(range) {
                        let allowed = told(&file, &folder, &at[1..], value);
                        assert!(
                            allowed.iter().any(|allowed| allowed.starts_with(range)),
                            "{at} = {value:e}: {allowed:?}, not {range}"
                        );
                    }
                }
            }
        }
        for line in RANGES.lines().filter(|line| !line.is_empty()) {
            let end = line.split(" | ").next().unwrap();
            assert!(tried.contains(end), "{end} is in no scene");
        }
    }
}
