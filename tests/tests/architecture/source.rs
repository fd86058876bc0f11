//! Source text without its tests, comments and literals.

use std::collections::BTreeSet;
use std::ops::Range;

/// A text without tests, comments, and the contents of strings and characters.
pub(crate) fn code(text: &str) -> String {
    let blanked = blanked(text);
    let tests: Vec<Range<usize>> = tests(&blanked)
        .into_iter()
        .map(|(lines, _)| lines)
        .collect();
    let lines = blanked.lines().enumerate();
    let lines = lines.filter(|(i, _)| !tests.iter().any(|test| test.contains(i)));
    lines.map(|(_, line)| line).collect::<Vec<_>>().join("\n")
}

/// The names of the modules in other files that a text declares for tests alone.
pub(crate) fn test_modules(text: &str) -> BTreeSet<String> {
    let tests = tests(&blanked(text)).into_iter();
    tests.filter_map(|(_, module)| module).collect()
}

/// The lines of each item that is compiled for tests alone, with its attributes. If the
/// item is a module in another file, its name comes with it.
fn tests(blanked: &str) -> Vec<(Range<usize>, Option<String>)> {
    let lines: Vec<&str> = blanked.lines().map(str::trim).collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let start = at;
        let is_test = |line: &str| {
            ["#[cfg(test", "#[cfg(all(test"]
                .iter()
                .any(|attribute| line.starts_with(attribute))
        };
        at += 1;
        if !is_test(lines[start]) {
            continue;
        }
        while lines.get(at).is_some_and(|line| line.starts_with("#[")) {
            at += 1;
        }
        let first = lines.get(at).copied().unwrap_or_default();
        at += item(&lines[at..]);
        let module = first
            .split_once("mod ")
            .and_then(|(_, rest)| rest.strip_suffix(';'));
        found.push((start..at, module.map(str::to_owned)));
    }
    found
}

/// The number of lines of the item with which the lines begin. It ends with the brace that
/// closes its body, or with a semicolon.
fn item(lines: &[&str]) -> usize {
    let mut depth = 0_usize;
    let mut has_body = false;
    for (i, line) in lines.iter().enumerate() {
        for c in line.chars() {
            match c {
                '{' => (depth, has_body) = (depth + 1, true),
                '}' => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        if depth == 0 && (has_body || line.ends_with(';')) {
            return i + 1;
        }
    }
    lines.len()
}

/// A text without comments, and without the contents of strings and characters. Line breaks
/// stay.
fn blanked(text: &str) -> String {
    let mut blanked = String::new();
    let mut left = text;
    while let Some(c) = left.chars().next() {
        let is_word = blanked
            .chars()
            .next_back()
            .is_some_and(|c| c.is_alphanumeric() || c == '_');
        match literal(left, is_word) {
            Some(length) => {
                blanked.extend(left[..length].chars().filter(|c| *c == '\n'));
                left = &left[length..];
            }
            None => {
                blanked.push(c);
                left = &left[c.len_utf8()..];
            }
        }
    }
    blanked
}

/// The length in bytes of the comment, string or character with which a text begins, if it
/// does. An `r` that ends a word begins no string.
fn literal(text: &str, is_word: bool) -> Option<usize> {
    // The position after `end`, from byte `start` on.
    let after = |start: usize, end: &str| {
        let found = text[start..].find(end);
        found.map_or(text.len(), |at| start + at + end.len())
    };
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    if text.starts_with("/*") {
        return Some(after(2, "*/"));
    }
    if let Some(string) = text.strip_prefix('"') {
        let mut escaped = false;
        let end = string.find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        return Some(end.map_or(text.len(), |at| at + 2));
    }
    if let Some(raw) = text.strip_prefix('r').filter(|_| !is_word) {
        let marks = raw.len() - raw.trim_start_matches('#').len();
        return raw[marks..]
            .starts_with('"')
            .then(|| after(marks + 2, &format!("\"{}", "#".repeat(marks))));
    }
    let character = text.strip_prefix('\'')?;
    let mut characters = character.char_indices();
    match characters.next()? {
        (_, '\\') => Some(after(3, "'")),
        // Anything else with one quote is a lifetime.
        _ => characters
            .next()
            .filter(|(_, c)| *c == '\'')
            .map(|(at, _)| at + 2),
    }
}

#[test]
fn tests_and_literals_are_left_out_wherever_they_stand() {
    let text = "use a::b; // c\n#[cfg(test)]\nmod tests;\n#[cfg(test)]\nuse d::{\n    e,\n};\n\
                fn f<'a>() -> char { '{' }\n#[cfg(test)]\nfn g() {\n    \"}\\\"\";\n    r#\"}\"#;\n}\n\
                /* h */ struct I;\n";
    assert_eq!(
        code(text),
        "use a::b; \nfn f<'a>() -> char {  }\n struct I;"
    );
    assert_eq!(test_modules(text), BTreeSet::from(["tests".to_owned()]));
}
