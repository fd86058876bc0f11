//! Tests typical mistakes in first scenes, and the messages about these mistakes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{etendue, scene};
use std::fs;
use std::process::Output;

const SCENE: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
    blockers: [
        JitteredSquares(
            name: "squares", center: (0, 0, 1), count: (20, 20),
            pitch: 0.2, fill: 0.6,
        ),
    ],
    surfaces: [
        Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6)),
    ],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [
        (name: "arrival", at: Before("floor")),
    ],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (rho: (max: 16), nu: (max: 32)),
    run: (photons: 1e6),
)
"#;

/// Runs `etendue check` on the scene in which `from` is replaced by `to`.
fn check(from: &str, to: &str, arguments: &[&str]) -> Output {
    assert!(SCENE.contains(from), "{from} is not in the scene");
    let folder = tempfile::tempdir().unwrap();
    let text = SCENE.replacen(from, to, 1);
    fs::write(folder.path().join("first.ron"), text).unwrap();
    let mut command = etendue();
    command
        .current_dir(folder.path())
        .args(["check", "first.ron"]);
    command.args(arguments).output().unwrap()
}

fn refused(output: &Output, message: &str) {
    let told = str::from_utf8(&output.stderr).unwrap();
    assert_eq!(told, format!("error: first.ron: {message}\n"));
    assert_eq!(output.status.code(), Some(2), "{told}");
}

/// For each mistake: the text in the scene, the beginner's text, and the entire message after the
/// file name.
const MISTAKES: &[[&str; 3]] = &[
    // A number in place of a vector.
    [
        "size: (0.2, 0.2)",
        "size: 0.2",
        "line 2, column 47: light.size is 0.2; allowed: side lengths along X and Y, in metres, such as (0.2, 0.1)",
    ],
    // Two coordinates instead of three.
    [
        "center: (0, 0, 1)",
        "center: (0, 1)",
        "line 5, column 38: blockers[0].center is (0, 1); allowed: a place in the world, in metres, such as (0, 0, 1)",
    ],
    // Brackets instead of parentheses.
    [
        "center: (0, 0, 2)",
        "center: [0, 0, 2]",
        "line 10, column 42: surfaces[0].center is [0, 0, 2]; allowed: a place in the world, in metres, such as (0, 0, 1)",
    ],
    // A half-width without the name of its profile.
    [
        "x: Hann(0.5)",
        "x: 0.5",
        "line 16, column 17: window.x is 0.5; allowed: a profile with its half-width in metres, such as Hann(0.5)",
    ],
    // A name in place of a position.
    [
        r#"Before("floor")"#,
        r#""floor""#,
        r#"line 14, column 31: planes[0].at is "floor"; allowed: Emission, Distance(…), Before(…) or After(…), such as Before("floor")"#,
    ],
    // A name without quotes.
    [
        r#"["floor"]"#,
        "[floor]",
        r#"line 12, column 62: path.visits[0] is floor; allowed: the name of a surface in quotes, such as "floor""#,
    ],
    // One name in place of a list of names.
    [
        r#"["floor"]"#,
        r#""floor""#,
        r#"line 12, column 61: path.visits is "floor"; allowed: a list of names of surfaces, such as ["floor"]"#,
    ],
    // The format of a later version, before the fields of that version.
    [
        "(\n    light:",
        "(\n    format: 2, later: 1, light:",
        "line 2, column 13: format is 2; allowed: a format that this version reads, such as 1",
    ],
    // A field spelt wrongly.
    [
        "pitch:",
        "pich:",
        "line 6, column 13: blockers[0].pich is no field (did you mean pitch?); allowed: name, center, count, pitch, fill, jitter, seed",
    ],
    // A missing field.
    [
        " pitch: 0.2,",
        "",
        "line 4, column 9: blockers[0].pitch is missing; allowed: a length in metres, such as 0.2",
    ],
    // A variant spelt wrongly.
    [
        "Rectangle(name",
        "Rectangel(name",
        r#"line 10, column 9: surfaces[0] is Rectangel (did you mean Rectangle?); allowed: Rectangle, Mesh, Smooth, such as Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))"#,
    ],
    // A variant in lower case.
    [
        "x: Hann",
        "x: hann",
        "line 16, column 17: window.x is hann (did you mean Hann?); allowed: Hann, Box, Gaussian, such as Hann(0.5)",
    ],
    // A surface spelt wrongly.
    [
        r#"["floor"]"#,
        r#"["flor"]"#,
        r#"line 12, column 62: path.visits[0] is "flor" (did you mean floor?); allowed: one of the surfaces: floor"#,
    ],
    // Blockers spelt wrongly.
    [
        r#"Before("floor")"#,
        r#"After("sqares")"#,
        r#"line 14, column 31: planes[0].at is After("sqares") (did you mean squares?); allowed: one of squares, floor"#,
    ],
    // A missing comma.
    [
        "(0.2, 0.2)),",
        "(0.2, 0.2))",
        "line 3, column 5: the scene: unexpected `blockers`; allowed: a comma before it, or a closing bracket",
    ],
    // A missing bracket.
    [
        "size: (6, 6)),",
        "size: (6, 6),",
        "line 11, column 5: surfaces[0]: unexpected `]`; allowed: the name of a field, or `)`",
    ],
    // A decimal comma.
    [
        "pitch: 0.2",
        "pitch: 0,2",
        "line 6, column 22: blockers[0]: unexpected `2`; allowed: the name of a field; decimals have a point, such as 0.1",
    ],
    // A number with a unit.
    [
        "pitch: 0.2",
        "pitch: 20cm",
        "line 6, column 22: blockers[0]: unexpected `cm`; allowed: a number without a unit",
    ],
    // A number in the notation of the command line.
    [
        "pitch: 0.2",
        "pitch: 2^20",
        "line 6, column 21: blockers[0]: unexpected `^20`; allowed: a number without the sign ^, such as 1_048_576 or 1e6",
    ],
    // A number in quotes.
    [
        "pitch: 0.2",
        r#"pitch: "0.2""#,
        r#"line 6, column 20: blockers[0].pitch is "0.2"; allowed: a length in metres, such as 0.2"#,
    ],
    // A percentage in place of a share.
    [
        "fill: 0.6",
        "fill: 60",
        "line 6, column 31: blockers[0].fill is 60; allowed: above 0, at most 1: a share of the pitch",
    ],
    // A floor that lies behind the light.
    [
        "(0, 0, 2)",
        "(0, 0, -2)",
        "line 10, column 42: surfaces[0].center is at distance -2 m from the light; allowed: a place in front of the light, along path.direction",
    ],
    // A floor of a negative size.
    [
        "(6, 6)",
        "(6, -6)",
        "line 10, column 63: surfaces[0].size[1] is -6; allowed: 1e-9 to 1e9",
    ],
    // No direction.
    [
        "direction: (0, 0, 1)",
        "direction: (0, 0, 0)",
        "line 12, column 23: path.direction and path.x_axis are (0, 0, 0) and (1, 0, 0); allowed: two directions that are not parallel, neither of length 0",
    ],
    // A plane that lies beyond the end of the path.
    [
        r#"Before("floor")"#,
        "Distance(4.5)",
        "line 14, column 31: planes[0].at is Distance(4.5); allowed: 0 m to the last surface at 2 m, or from this surface to 4 m, where an object ends the path",
    ],
    // A jitter that would make squares overlap.
    [
        "fill: 0.6",
        "fill: 0.6, jitter: 0.7",
        "line 6, column 44: blockers[0].jitter is 0.7; allowed: 0 to 1 − fill, which is 0.4",
    ],
    // A window of zero width.
    [
        "x: Hann(0.5)",
        "x: Hann(0)",
        "line 16, column 17: window.x is 0; allowed: 1e-9 to 1e9",
    ],
    // Two planes with the same name.
    [
        r#"Before("floor")),"#,
        r#"Before("floor")), (name: "arrival", at: Emission),"#,
        r#"line 14, column 56: planes[1].name is "arrival"; allowed: a name that no other plane has"#,
    ],
    // Blockers at the same distance as the floor.
    [
        "(0, 0, 1), count",
        "(0, 0, 2), count",
        "line 5, column 38: blockers[0].center is at distance 2 m from the light; allowed: a place before the first surface of the path, at 2 m",
    ],
    // Half a photon.
    [
        "1e6",
        "1.5",
        "line 18, column 20: run.photons is 1.5; allowed: a whole number, such as 1e7",
    ],
];

const CUT: &str = "line 15, column 7: the scene: the file ends here, but a bracket is still open; allowed: the missing fields and `)`";

/// Settings on the command line, and their messages.
const SET: &[[&str; 2]] = &[
    [
        "blockers.0.pich=0.1",
        "no field `pich` here (did you mean pitch?); allowed: center, count, fill, jitter, name, pitch, seed",
    ],
    [
        "blockers.0.fill=-1",
        "blockers[0].fill is -1; allowed: above 0, at most 1: a share of the pitch",
    ],
    [
        "light.size=0.3",
        "light.size: invalid type: floating point `0.3`, expected an array of length 2; allowed: side lengths along X and Y, in metres, such as (0.2, 0.1)",
    ],
    [
        "planes.0.at=Befor(floor)",
        r#"planes[0].at: unknown variant `Befor`, expected one of `Emission`, `Before`, `After`, `Distance` (did you mean Before?); allowed: Emission, Distance(…), Before(…) or After(…), such as Before("floor")"#,
    ],
];

#[test]
fn mistakes_are_told_with_their_place_and_what_is_wanted() {
    for [from, to, message] in MISTAKES {
        refused(&check(from, to, &[]), message);
    }
}

/// A scene file that ends too early.
#[test]
fn a_file_cut_short_is_told_where_it_ends() {
    let [_, end] = SCENE
        .split_once("\n    window")
        .map(|(_, end)| ["", end])
        .unwrap();
    let cut = format!("\n    window{end}");
    refused(&check(&cut, "", &[]), CUT);
}

#[test]
fn what_is_set_is_told_by_what_has_set_it() {
    for [set, message] in SET {
        let message = format!("--set {set}: {message}");
        refused(&check("", "", &["--set", set]), &message);
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("first.ron"), SCENE).unwrap();
    let mut command = etendue();
    command.current_dir(folder.path());
    let output = command.args(["run", "first.ron", "--photons", "3"]);
    let message = "--photons 3: run.photons is 3; allowed: 64 (one for each batch) to 10^12";
    refused(&output.output().unwrap(), message);
}

/// A likely mistake causes a warning; the scene is still described, and the command succeeds.
#[test]
fn likely_mistakes_are_warned_of() {
    for (from, to, warning) in [
        (
            "size: (6, 6)",
            "size: (6000, 6000)",
            "surfaces[0].size[1] is 6000 m, but other lengths are about 1 m: is this length in millimetres?",
        ),
        (
            "rho: (max: 16)",
            "rho: (max: 0.5)",
            "frequencies.rho.max is 0.5, but a step of the grid is already 1/(2 · half-width of the window) = 1",
        ),
        (
            "count: (20, 20)",
            "count: (20, 2)",
            "arrival: light that reaches this plane passes squares at up to (0.3, 0.3) m from the central ray. \
             The array ends at (2, 0.2) m, so nothing blocks the light beyond its edge",
        ),
    ] {
        let output = check(from, to, &[]);
        let told = str::from_utf8(&output.stderr).unwrap();
        assert_eq!(told, format!("warning: {warning}\n"));
        assert_eq!(output.status.code(), Some(0), "{told}");
        let described = str::from_utf8(&output.stdout).unwrap();
        assert!(described.starts_with("first: sound\n"), "{described}");
    }
}

/// The scenes of this repository cause no warnings, and `check` reports the cost of each scene.
#[test]
fn sound_scenes_are_not_warned_of() {
    for name in [
        "fig9b",
        "fig10",
        "two_layers",
        "table1/ggx_sphere",
        "table1/environment",
    ] {
        let path = scene(&format!("{name}.ron"));
        let output = etendue().arg("check").arg(path).output().unwrap();
        assert!(output.stderr.is_empty(), "{output:?}");
        let described = str::from_utf8(&output.stdout).unwrap();
        let last = described.lines().last().unwrap();
        assert!(
            last.starts_with("expected on ") && last.ends_with(" GB"),
            "{last}"
        );
    }
}
