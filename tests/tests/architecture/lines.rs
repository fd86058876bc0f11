//! Counts the lines of each crate, so that a crate grows only for a stated reason.

use super::files;
use super::source::{code, test_modules};
use std::collections::BTreeMap;

/// Each crate, with its number of lines when this table was made, the number that it may have now,
/// and the reason if that is more. Comments and empty lines count; tests do not.
///
/// The second number may be lowered freely. Where a crate becomes smaller, it must be lowered.
const LINES: &[(&str, usize, usize, &str)] = &[
    ("bvh", 1261, 1211, ""),
    (
        "cli",
        4109,
        4632,
        "`spectrum`; `compare --theory`, `--save explorer`, and the words on noise that pipeline had; `run --against`; `fit`; `sweep --derivative`; `diff --pairs`",
    ),
    (
        "compare",
        2927,
        3446,
        "no slope is known without photons; a warning names the convention that a failed prediction mistakes; differences of batches in pairs; steps of several parameters, and their Fisher information; residuals that are scaled and subtracted, and paired changes of bandwidths; differences within the error of the transform; guards of frequencies",
    ),
    (
        "explorer",
        1050,
        1255,
        "masks of a path have names; glossy lobes came from theory",
    ),
    ("export", 1413, 1410, "its head says what it leaves out"),
    (
        "field",
        3031,
        3229,
        "lights say which rays they emit; shapes move; lobes have names; light fields of slices came from report; what triangles with \
         interpolated normals do to radiance; `grouped` from pipeline; corners of a hole in the scene's order",
    ),
    (
        "figures",
        4650,
        4664,
        "bars for errors of changes; pages have a height; texts that cannot be read are found; a third line; one size for texts beside each other, room for texts beside low pictures; keys below each other",
    ),
    ("fuzz", 125, 126, "meshes come from a crate of their own"),
    ("meshfile", 1657, 1658, "an empty line"),
    ("mpi", 77, 77, ""),
    ("paper", 3243, 3184, ""),
    (
        "pipeline",
        5436,
        3446,
        "a scene is measured against another one; a run with batches is a measurement; batches of a run of a known scene; differences are continued and shared by processes",
    ),
    (
        "predict",
        2917,
        2974,
        "chains have steps that Python changes; a smooth mesh stops light on other legs; masks of a path have names; lights have positions; \
         a rim that changes no light is no parameter; `converge` names dark neighbourhoods",
    ),
    (
        "python",
        1640,
        2003,
        "theories of the user, as arrays and as functions; chains of scenes; `difference` compares pairs; `fit`; `load` and `derivative`",
    ),
    ("rayfile", 2394, 2394, ""),
    (
        "report",
        2599,
        4573,
        "tables, texts, times of stages and `diff` came from pipeline; `diff` says when nothing is named; `diff` compares pairs, and measurements",
    ),
    ("sampling", 495, 497, "its head says what it leaves out"),
    ("scatter", 1291, 1291, ""),
    ("scene", 4796, 4811, "memory of pictures is counted"),
    (
        "scenefile",
        3036,
        3062,
        "the value at a path; lobes of files become lobes here, not twice above",
    ),
    ("scenes", 52, 52, ""),
    (
        "spectrum",
        3218,
        3378,
        "errors of bandwidths hold where noise is strong; noise of pictures without power; \
         long functions say why; measurements by their difference from another scene; paired changes of a statistic",
    ),
    (
        "store",
        3185,
        3873,
        "predictions of other programs are read, and written; a method; measurements of other programs are read; runs of scenes with pictures give their batches; names of repeated arguments; planes of both scenes of a difference; results are read in one place, also of other versions",
    ),
    (
        "studies",
        4009,
        6334,
        "differences of neighbouring points; `fit`, and its plan; derivatives from pairs; fits without dark planes and endless fields; one step of a search; derivatives at the ends of ranges, from scenes that are read once; bandwidths and slopes of derivatives",
    ),
    (
        "theory",
        15390,
        15_845,
        "derivatives use the rays of the prediction for masks, and stop when accurate; surfaces have \
         positions, and so have objects beside the path; models of lobes in 2D came from compare; steps of chains have maps and masks; factors are shared with derivatives",
    ),
    (
        "trace",
        6797,
        6874,
        "backward rays on triangles with interpolated normals; two scenes are traced with the same photons",
    ),
    ("transform", 1685, 1687, "its head says what it leaves out"),
    ("worlds", 22_217, 21_792, ""),
    (
        "tests of all kinds",
        69_203,
        69_747,
        "conventions that are mistaken are planted, and found; pairs over many seeds; fits, in Rust, in Python and over many seeds; runs against another scene are continued and shared; texts of figures are searched; paths are drawn in their plane",
    ),
];

/// A crate may be smaller than its row says by one line in this many, so that not every change needs
/// another row.
const SLACK: usize = 50;

/// The number of lines of each crate outside its tests, and the lines of all tests.
fn counted(files: &BTreeMap<String, String>) -> BTreeMap<String, usize> {
    let mut tests: Vec<String> = Vec::new();
    for (name, text) in files {
        let folder = name.strip_suffix("mod.rs").or(name.strip_suffix("lib.rs"));
        let folder = folder.unwrap_or(name.strip_suffix(".rs").unwrap_or(name));
        let folder = folder.trim_end_matches('/');
        let modules = test_modules(text).into_iter();
        tests.extend(modules.map(|module| format!("{folder}/{module}")));
    }
    let is_test = |name: &str| {
        let of_module = |test: &String| {
            let rest = name.strip_prefix(test.as_str());
            rest.is_some_and(|rest| rest.starts_with(['.', '/']))
        };
        let folders = ["/tests/", "/benches/", "/examples/"];
        name.starts_with("tests/")
            || folders.iter().any(|folder| name.contains(folder))
            || tests.iter().any(of_module)
    };
    let mut counted = BTreeMap::new();
    for (name, text) in files {
        let all = text.lines().count();
        let source = if is_test(name) {
            0
        } else {
            code(text).lines().count()
        };
        let place = name.strip_prefix("crates/").unwrap_or(name);
        let place = place.split('/').next().unwrap_or_default().to_owned();
        if source > 0 {
            *counted.entry(place).or_default() += source;
        }
        *counted.entry("tests of all kinds".to_owned()).or_default() += all - source;
    }
    counted
}

/// What is wrong with the rows of a table.
fn wrong(table: &[(&str, usize, usize, &str)], counted: &BTreeMap<String, usize>) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, lines) in counted {
        let Some((_, before, most, reason)) = table.iter().find(|(known, ..)| known == name) else {
            wrong.push(format!("{name} has no row; it has {lines} lines"));
            continue;
        };
        let least = most - most / SLACK;
        if lines > most {
            wrong.push(format!("{name} has {lines} lines, more than {most}: make it smaller, or state a reason in its row"));
        } else if *lines < least {
            wrong.push(format!(
                "{name} has only {lines} lines: lower the {most} of its row"
            ));
        }
        if most > before && reason.is_empty() {
            wrong.push(format!(
                "the row of {name} rose from {before} to {most} without a reason"
            ));
        }
    }
    wrong
}

#[test]
fn crates_grow_only_for_a_reason() {
    let wrong = wrong(LINES, &counted(&files(&[""])));
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn planted_lines_are_found() {
    let files = BTreeMap::from(
        [
            (
                "crates/a/src/lib.rs",
                "mod b;\n#[cfg(test)]\nmod c;\nstruct A;\n",
            ),
            ("crates/a/src/b.rs", "struct B;\n"),
            ("crates/a/src/c.rs", "struct C;\n"),
            ("crates/a/tests/d.rs", "struct D;\nstruct E;\n"),
        ]
        .map(|(name, text)| (name.to_owned(), text.to_owned())),
    );
    let counted = counted(&files);
    assert_eq!(counted["a"], 3);
    assert_eq!(counted["tests of all kinds"], 5);
    let of = |a: (usize, usize, &'static str)| {
        wrong(
            &[("a", a.0, a.1, a.2), ("tests of all kinds", 5, 5, "")],
            &counted,
        )
        .len()
    };
    assert_eq!(
        [
            of((3, 3, "")),
            of((2, 2, "")),
            of((9, 9, "")),
            of((2, 3, "")),
            of((2, 3, "a reason"))
        ],
        [0, 1, 1, 1, 0]
    );
}
