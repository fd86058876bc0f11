//! Mutated indices of results folders, and indices adapted to changed files.

use super::dice::Dice;
use super::text;
use serde_json::{Value, json};

/// The text that precedes the hash of an index; the hash covers all bytes before this text.
pub(crate) const TAIL: &str = ",\n  \"index_hash\": \"";

/// Tokens of JSON in general, and tokens of the indices of results folders.
const WORDS: &str = "null | true | [] | {} | \"\" | \\ | \"files\" | \"planes\" | \"batches\" | \
    \"photons\" | \"exact\" | \"reference\" | \"backward\" | \"../a\" | 1e400 | 0.1.1";

/// A mutated text of an index.
pub(crate) fn mutated(index: &str, dice: &mut Dice) -> Vec<u8> {
    text::mutated(index, WORDS, dice)
}

/// The index after a change of one value, with a hash that matches the changed text.
pub(crate) fn with_other_value(index: &str, dice: &mut Dice) -> Option<String> {
    let mut tree: Value = serde_json::from_str(index).ok()?;
    change(&mut tree, dice);
    Some(printed(&tree, index.contains(TAIL)))
}

/// The index after its scene file is replaced, with hashes that match.
pub(crate) fn with_scene(index: &str, scene: &Value) -> Option<String> {
    let mut tree: Value = serde_json::from_str(index).ok()?;
    tree["scene_file"] = scene.clone();
    // If the program could have written this scene, the hash of the scene is computed as the
    // program computes it.
    if let Ok(file) = serde_json::from_value::<etendue_scene::SceneFile>(scene.clone()) {
        let text = serde_json::to_vec(&file).ok()?;
        tree["scene_hash"] = json!(blake3::hash(&text).to_hex().as_str());
    }
    Some(printed(&tree, index.contains(TAIL)))
}

/// The scene file that an index contains, after a change of one value in the scene.
pub(crate) fn other_scene(index: &str, dice: &mut Dice) -> Option<Value> {
    let tree: Value = serde_json::from_str(index).ok()?;
    let mut scene = tree["scene_file"].clone();
    change(&mut scene, dice);
    Some(scene)
}

/// The index after the hash of the bytes `old` is replaced by the hash of the bytes
/// `new`. The index's own hash is updated to match.
pub(crate) fn with_hash_of(index: &str, old: &[u8], new: &[u8]) -> String {
    let [old, new] = [old, new].map(|bytes| blake3::hash(bytes).to_hex());
    sealed(&index.replace(old.as_str(), new.as_str()))
}

/// The index with a correct hash of its own, if the index has such a hash.
fn sealed(index: &str) -> String {
    match index.find(TAIL) {
        Some(at) => with_own_hash(&index[..at]),
        None => index.to_owned(),
    }
}

fn with_own_hash(body: &str) -> String {
    let hash = blake3::hash(body.as_bytes()).to_hex();
    format!("{body}{TAIL}{hash}\"\n}}\n")
}

fn printed(tree: &Value, seal: bool) -> String {
    let mut tree = tree.clone();
    if let Some(fields) = tree.as_object_mut() {
        fields.remove("index_hash");
    }
    let text = serde_json::to_string_pretty(&tree).unwrap_or_default();
    match text.strip_suffix("\n}") {
        Some(body) if seal => with_own_hash(body),
        _ => text + "\n",
    }
}

/// Changes a random value in the JSON tree below the given value.
fn change(value: &mut Value, dice: &mut Dice) {
    let here = dice.one_in(8);
    match value {
        Value::Object(fields) if !fields.is_empty() && !here => {
            let at = dice.below(fields.len());
            if dice.one_in(20) {
                let name = fields.keys().nth(at).cloned().unwrap_or_default();
                fields.remove(&name);
            } else if let Some(child) = fields.values_mut().nth(at) {
                change(child, dice);
            }
        }
        Value::Array(items) if !items.is_empty() && !here => {
            let at = dice.below(items.len());
            match dice.below(10) {
                0 => drop(items.remove(at)),
                1 => items.push(items[at].clone()),
                _ => change(&mut items[at], dice),
            }
        }
        _ => *value = other(value, dice),
    }
}

fn other(value: &Value, dice: &mut Dice) -> Value {
    let near = value.as_f64().filter(|_| dice.one_in(2));
    if let Some(near) = near {
        let factor = *dice.pick(&[0.5, 2.0, -1.0, 1.1, 1e6]);
        return match value.as_u64() {
            Some(whole) => json!(whole.saturating_add(dice.below(3) as u64).saturating_sub(1)),
            None => json!(near * factor),
        };
    }
    let values = [
        Value::Null,
        json!(0),
        json!(-1),
        json!(1),
        json!(1e308),
        json!(5e-324),
        json!(u64::MAX),
        json!([]),
        json!({}),
        json!(""),
        json!("../../a"),
        json!("/etc/passwd"),
        json!("\u{1b}[2J\n\u{0}"),
        json!("n".repeat(100_000)),
        json!(vec![0.0; 1000]),
        json!(true),
    ];
    dice.pick(&values).clone()
}
