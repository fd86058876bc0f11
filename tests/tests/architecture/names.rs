//! Checks that each type name has one meaning, unless a reason for two meanings is stated.

use super::files;
use super::source::code;
use std::collections::BTreeMap;

/// Names that more than one type may have, each with the reason.
const SHARED_NAMES: &[(&str, &str)] = &[
    (
        "Conductor",
        "a word of worlds, and the BRDF that it stands for",
    ),
    (
        "MetallicRoughness",
        "a word of worlds, and the BRDF that it stands for",
    ),
    (
        "Plastic",
        "a word of worlds, and the BRDF that it stands for",
    ),
    (
        "Principled",
        "a word of worlds, and the BRDF that it stands for",
    ),
    ("Light", "of a bench scene, and of a world"),
    ("Shape", "of a bench scene, and of a world"),
    ("Triangles", "of a bench scene, and of a world"),
    ("Hit", "of a bench scene, and of a world"),
    (
        "Projection",
        "an integral of a light field, and how a camera sees",
    ),
    ("Fault", "of a scene file, and of a file of rays"),
    (
        "Picture",
        "a bitmap of a scene, of a camera, and of a figure",
    ),
];
/// Types in these files may share names with types in other files. The files are tests, the second
/// implementation (which is independent of the first), and the binding (which uses Python's names).
const APART: [&str; 3] = ["/src/tests/", "tests/src/second/", "python/src/"];

/// The names of the types that a source text defines outside its tests.
fn types(text: &str) -> Vec<String> {
    let text = code(text);
    let names = text.lines().filter_map(|line| {
        let line = match line.strip_prefix("pub") {
            Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
            Some(rest) => rest.strip_prefix(' ')?,
            None => line,
        };
        let (word, rest) = line.split_once(' ')?;
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let end = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        ["struct", "enum", "trait", "type"]
            .contains(&word)
            .then(|| rest[..end].to_owned())
    });
    names.collect()
}

/// The names shared by several types, with the files that define them.
fn shared<'a>(
    files: impl IntoIterator<Item = (&'a String, &'a String)>,
) -> BTreeMap<String, Vec<&'a str>> {
    let mut places: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for (file, text) in files {
        if APART.iter().any(|folder| file.contains(folder)) {
            continue;
        }
        for name in types(text) {
            places.entry(name).or_default().push(file);
        }
    }
    places.retain(|_, files| files.len() > 1);
    places
}

#[test]
fn types_have_names_of_their_own() {
    let files = files(&["src"]);
    let found = shared(&files);
    let listed = |name: &str| SHARED_NAMES.iter().any(|(known, _)| *known == name);
    let unknown: BTreeMap<_, _> = found.iter().filter(|(name, _)| !listed(name)).collect();
    assert!(
        unknown.is_empty(),
        "these names need a reason: {unknown:#?}"
    );
    for (name, _) in SHARED_NAMES {
        assert!(found.contains_key(*name), "{name} needs no reason any more");
    }
}

#[test]
fn a_planted_name_is_found() {
    let files = BTreeMap::from(
        [
            ("a.rs", "pub(super) enum Place<'a> {\n"),
            (
                "b.rs",
                "struct Place;\n#[cfg(test)]\nmod tests;\nstruct Other;\n",
            ),
            ("c.rs", "pub struct Other(u32);\n// struct Place\n"),
            ("python/src/d.rs", "struct Other;\n"),
        ]
        .map(|(name, text)| (name.to_owned(), text.to_owned())),
    );
    let expected = BTreeMap::from([
        ("Other".to_owned(), vec!["b.rs", "c.rs"]),
        ("Place".to_owned(), vec!["a.rs", "b.rs"]),
    ]);
    assert_eq!(shared(&files), expected);
}
