//! Mutations of text by tokens. Many of these mutations keep the syntax valid.

use super::bytes;
use super::dice::Dice;

/// Critical numbers, for any format.
const NUMBERS: &str = "0 -0.0 -1 1 2 3 0.5 33 1e-9 1e-300 5e-324 1000000 1e9 -1e9 1e308 -1e308 \
    NaN inf -inf 2147483648 4294967296 18446744073709551616";

/// Invalid file names, and terminal control sequences.
const NAMES: [&str; 14] = [
    "",
    ".",
    "..",
    "../out",
    "a/b",
    "/tmp",
    "CON",
    " ",
    "a\\nb",
    "\\u{1b}[2J",
    "\\u{0}",
    "\\u{202e}txt",
    "summary.json",
    "ä€𝄞",
];

/// The text after one to three mutations, which replace, remove, double or swap tokens,
/// repeat blocks, or make larger changes. The tokens `words` belong to the format of the text, and
/// are separated by ` | `.
pub(crate) fn mutated(text: &str, words: &str, dice: &mut Dice) -> Vec<u8> {
    let words: Vec<&str> = words.split(" | ").collect();
    let mut tokens = split(text);
    let mut raw = false;
    for _ in 0..*dice.pick(&[1, 1, 2, 3]) {
        let at = dice.below(tokens.len());
        match dice.below(64) {
            0 => drop(tokens.remove(at)),
            1 => tokens.insert(at, tokens[at].clone()),
            2 => tokens.truncate(at.max(1)),
            3 => {
                let other = dice.below(tokens.len());
                tokens.swap(at, other);
            }
            4 => repeat_block(&mut tokens, at, dice),
            5 => nest(&mut tokens, at, dice),
            6 => tokens[at] = "1".repeat(dice.length(10_000)),
            7 => tokens[at] = "a".repeat(dice.length(100_000)),
            8 => replace_name(&mut tokens, dice),
            9 => raw = true,
            10..14 => tokens[at] = (*dice.pick(&words)).to_owned(),
            14..30 => replace_number(&mut tokens, dice, critical),
            _ => replace_number(&mut tokens, dice, another),
        }
    }
    let mut text = tokens.concat().into_bytes();
    if raw {
        bytes::mutate(&mut text, dice);
    }
    text
}

/// A critical number.
fn critical(_: &str, dice: &mut Dice) -> String {
    let numbers: Vec<&str> = NUMBERS.split(' ').collect();
    (*dice.pick(&numbers)).to_owned()
}

/// A number near the old number, or a valid number of any size.
fn another(old: &str, dice: &mut Dice) -> String {
    if let (Ok(old), true) = (old.parse::<f64>(), dice.one_in(2)) {
        return format!("{:.4}", old * (0.5 + dice.unit()));
    }
    let size = [0.01, 0.1, 1.0, 10.0, 100.0];
    let value = dice.unit() * dice.pick(&size);
    if dice.one_in(3) {
        format!("{value:.0}")
    } else {
        format!("{value:.3}")
    }
}

fn replace_number(tokens: &mut [String], dice: &mut Dice, new: fn(&str, &mut Dice) -> String) {
    let digit = |token: &String| token.starts_with(|c: char| c.is_ascii_digit());
    let numbers: Vec<usize> = (0..tokens.len()).filter(|i| digit(&tokens[*i])).collect();
    if !numbers.is_empty() {
        let at = *dice.pick(&numbers);
        tokens[at] = new(&tokens[at], dice);
    }
}

/// Replaces a name in quotes by another name.
fn replace_name(tokens: &mut Vec<String>, dice: &mut Dice) {
    let quotes: Vec<usize> = (0..tokens.len()).filter(|i| tokens[*i] == "\"").collect();
    if let [.., _] = quotes[..] {
        let open = dice.below(quotes.len() / 2) * 2;
        let close = quotes.get(open + 1).copied().unwrap_or(tokens.len());
        let name = match dice.below(4) {
            0 => "n".repeat(dice.length(100_000)),
            _ => (*dice.pick(&NAMES)).to_owned(),
        };
        tokens.splice(quotes[open] + 1..close, [name]);
    }
}

/// Repeats some tokens many times, up to about a megabyte.
fn repeat_block(tokens: &mut Vec<String>, at: usize, dice: &mut Dice) {
    let end = (at + dice.length(200)).min(tokens.len());
    let block = tokens[at..end].to_vec();
    let most = 100_000 / block.len().max(1);
    let times = dice.length(most.max(1));
    let copies = std::iter::repeat_n(block, times).flatten();
    tokens.splice(at..at, copies);
}

/// Inserts opening brackets, with or without the matching closing brackets.
fn nest(tokens: &mut Vec<String>, at: usize, dice: &mut Dice) {
    let depth = dice.length(100_000);
    let [open, close] = *dice.pick(&[["(", ")"], ["[", "]"], ["{", "}"], ["Some(", ")"]]);
    if dice.one_in(2) {
        tokens.insert(at + 1, close.repeat(depth));
    }
    tokens.insert(at, open.repeat(depth));
}

/// Splits a text into words, numbers and single characters.
fn split(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    for c in text.chars() {
        match tokens.last_mut() {
            Some(last) if word(c) && last.ends_with(word) => last.push(c),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens
}
