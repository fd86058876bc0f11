//! Checks of the rules in ARCHITECTURE.md: crates use only permitted crates, modules have no
//! cycles, and each file begins with a sentence that describes it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod functions;
mod lines;
mod modules;
mod names;
mod source;

use modules::{Modules, circles};
use source::code;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each crate, with the crates that it may use.
const MAY_USE: &[(&str, &str)] = &[
    ("field", ""),
    ("scenes", ""),
    ("transform", "field"),
    ("bvh", ""),
    ("meshfile", ""),
    ("rayfile", ""),
    ("theory", "field transform"),
    ("spectrum", "field transform"),
    ("figures", "field"),
    ("world", "field"),
    ("sampling", "field"),
    ("scatter", "field sampling"),
    ("explorer", "field theory transform"),
    ("scenefile", "field"),
    ("scene", "bvh field meshfile rayfile scenefile transform"),
    ("trace", "bvh field sampling scatter scene transform"),
    ("export", "field scene"),
    ("compare", "field spectrum theory transform"),
    ("predict", "compare field scene spectrum theory transform"),
    ("import", "field meshfile scene world"),
    ("paths", "bvh field sampling scatter transform world"),
    (
        "adaptive",
        "compare field paths sampling theory transform world",
    ),
    ("store", "compare field rayfile scene spectrum"),
    (
        "pipeline",
        "compare field predict rayfile scene spectrum store theory trace",
    ),
    (
        "report",
        "compare explorer field figures pipeline predict rayfile scene spectrum store",
    ),
    (
        "studies",
        "compare field figures pipeline predict rayfile report scene spectrum store theory trace \
         transform",
    ),
    (
        "view",
        "adaptive compare field figures import paths pipeline predict report spectrum store \
         studies theory world",
    ),
    (
        "paper",
        "adaptive compare field figures import paths pipeline predict report scene scenes \
         spectrum store theory transform world",
    ),
    (
        "cli",
        "adaptive compare export field figures import paper pipeline predict rayfile report \
         scene scenes spectrum store studies theory view",
    ),
];

/// Number of lines above which a file needs a reason.
const MAX_LINES: usize = 500;

/// Longer files, each with the reason not to split it.
const LONG_FILES: &[(&str, &str)] = &[
    (
        "crates/compare/src/plane.rs",
        "every number of a plane's report is made in one place",
    ),
    (
        "crates/trace/src/backward/tracer.rs",
        "one ray traced back: each kind of surface calls the next",
    ),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_owned()
}

/// The folders of all crates that the tool consists of, relative to the root.
fn crates() -> Vec<String> {
    let folders = ["crates", "crates/worlds"].map(|folder| {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        let places = entries.map(move |entry| {
            let name = entry.unwrap().file_name().into_string().unwrap();
            format!("{folder}/{name}")
        });
        places.filter(|place| root().join(place).join("Cargo.toml").exists())
    });
    let mut crates: Vec<String> = folders.into_iter().flatten().collect();
    crates.sort();
    crates
}

/// The name of the crate in a folder.
fn name_of(place: &str) -> &str {
    place.rsplit('/').next().unwrap_or(place)
}

/// The workspace crates among the dependencies of a manifest; dependencies of tests are
/// not included.
fn uses(manifest: &str) -> BTreeSet<String> {
    let own = manifest
        .split("\n[dependencies]")
        .nth(1)
        .unwrap_or_default();
    let own = own.split("\n[").next().unwrap_or_default();
    let names = own.lines().filter_map(|line| line.strip_prefix("etendue-"));
    names
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .map(str::to_owned)
        .collect()
}

fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().collect()
}

/// The crates in `found` that the crate `name` must not use.
fn forbidden(name: &str, found: &BTreeSet<String>) -> Vec<String> {
    let allowed = MAY_USE.iter().find(|(known, _)| *known == name);
    let allowed: Vec<&str> = allowed.map_or(Vec::new(), |(_, allowed)| words(allowed));
    let others = found
        .iter()
        .filter(|other| !allowed.contains(&other.as_str()));
    others.cloned().collect()
}

#[test]
fn crates_use_those_below_them() {
    for place in crates() {
        let name = name_of(&place);
        assert!(
            MAY_USE.iter().any(|(known, _)| *known == name),
            "{name} has no row in MAY_USE"
        );
        let manifest = fs::read_to_string(root().join(&place).join("Cargo.toml"));
        let found = uses(&manifest.unwrap());
        let forbidden = forbidden(name, &found);
        assert!(forbidden.is_empty(), "{name} may not use {forbidden:?}");
    }
    // The instrument stands without the worlds: the command and the figures that are rendered use
    // them, behind a feature.
    let crates = crates();
    let is_world = |name: &str| crates.contains(&format!("crates/worlds/{name}"));
    for (name, uses) in MAY_USE {
        let may = is_world(name) || ["cli", "paper"].contains(name);
        assert!(
            may || !words(uses).into_iter().any(is_world),
            "{name} may not use worlds"
        );
    }
    // In this table, the row of a crate must come after the rows of the crates that it uses.
    for (i, (name, uses)) in MAY_USE.iter().enumerate() {
        let is_later =
            |other: &&str| MAY_USE.iter().position(|(known, _)| known == other) >= Some(i);
        let later = words(uses).into_iter().find(is_later);
        assert_eq!(later, None, "{name} uses a crate that comes later");
    }
    let planted = "[package]\nname = \"etendue-theory\"\n\n[dependencies]\netendue-field.workspace = true\netendue-trace.workspace = true\n";
    assert_eq!(forbidden("theory", &uses(planted)), ["trace"]);
}

#[test]
fn architecture_names_every_crate() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    for place in crates() {
        let name = name_of(&place);
        assert!(
            text.contains(&format!("| `{name}` |")),
            "ARCHITECTURE.md has no row for {name}"
        );
    }
}

#[test]
fn modules_have_no_circles() {
    let mut all = Vec::new();
    for name in crates()
        .into_iter()
        .chain(["mpi", "python"].map(str::to_owned))
    {
        let found = modules::modules(&root().join(&name).join("src"));
        let circles = circles(&found).into_iter();
        all.extend(circles.map(|circle| (name.clone(), circle)));
    }
    assert!(all.is_empty(), "these modules use each other: {all:#?}");
}

#[test]
fn a_planted_circle_is_found() {
    let module = |name: &str| {
        name.split("::")
            .filter(|part| !part.is_empty())
            .map(str::to_owned)
            .collect()
    };
    // A planted crate is a text in which a line `== NAME` begins the module of that name.
    let planted = |crate_text: &str| -> Modules {
        let files = crate_text.split("== ").skip(1);
        files
            .map(|file| file.split_once('\n').unwrap())
            .map(|(name, text)| (module(name), code(text)))
            .collect()
    };
    let root = "== \nmod a;\nmod b;\npub use a::A;\n";
    for (count, files) in [
        (1, "== a\nuse crate::b::B;\n== b\nuse crate::a::A;\n"),
        // These imports use re-exports of the crate root, and are in nested groups.
        (
            1,
            "== a\nuse super::{b::{B, C}, d};\n== b\nfn f() { crate::A::new() }\n",
        ),
        (0, "== a\nuse crate::b::B;\n== b\n// use crate::a::A;\n"),
        (
            0,
            "== a\nuse crate::b::B;\n\
             == b\nfn f() {}\n#[cfg(test)]\nmod tests { use crate::a::A; }\n",
        ),
    ] {
        let found = circles(&planted(&format!("{root}{files}")));
        assert_eq!(found.len(), count, "{files}");
    }
    for (count, files) in [
        // Code after a module of tests counts, and so does a path that begins with an imported
        // module.
        (
            1,
            "== \nmod a;\nmod b;\n== a\nuse crate::b::c;\nfn f() { c::d::g() }\n\
             == b\npub mod c;\n== b::c\npub mod d;\n\
             == b::c::d\n#[cfg(test)]\nmod tests;\nuse crate::a::f;\n",
        ),
        (
            1,
            "== \nmod a;\n== a\nmod b;\nuse b::B;\n== a::b\nuse super::A;\n",
        ),
        (
            0,
            "== \nmod a;\n== a\nmod b;\npub use b::B;\n== a::b\nuse super::super::c;\n",
        ),
    ] {
        assert_eq!(circles(&planted(files)).len(), count, "{files}");
    }
}

/// The files of Rust in some folders of each crate, with their text.
fn files(folders: &[&str]) -> BTreeMap<String, String> {
    fn collect(folder: &Path, found: &mut BTreeMap<String, String>) {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() && !path.ends_with("target") {
                collect(&path, found);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(root()).unwrap().to_str().unwrap();
                found.insert(name.to_owned(), fs::read_to_string(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    let others = ["fuzz", "mpi", "python", "scenes", "tests"].map(str::to_owned);
    for place in crates().into_iter().chain(others) {
        for folder in folders {
            collect(&root().join(&place).join(folder), &mut found);
        }
    }
    found
}

/// Checks whether a text begins with a sentence that describes it.
fn has_head(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    first
        .strip_prefix("//! ")
        .is_some_and(|head| head.len() > 10)
}

#[test]
fn files_open_with_what_they_hold_and_are_short() {
    for (name, text) in files(&["src"]) {
        assert!(
            has_head(&text),
            "{name} does not open with a sentence on what it holds"
        );
        let is_long = text.lines().count() > MAX_LINES;
        let has_reason = LONG_FILES.iter().any(|(long, _)| *long == name);
        assert!(
            !is_long || has_reason,
            "{name} has more than {MAX_LINES} lines"
        );
        assert!(is_long || !has_reason, "{name} needs no reason any more");
    }
    assert!(!has_head("use std::fs;\n") && !has_head("//!\n"));
}
