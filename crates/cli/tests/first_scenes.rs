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

/// Mistakes. Each has a line that describes it, a line `-` with the text in the scene, a line `+`
/// with the beginner's text, and a line `!` with the entire message after the file name.
const MISTAKES: &str = include_str!("first_scenes.txt");

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
    let mut found = 0;
    for mistake in MISTAKES.split("\n\n") {
        let line = |mark: char| {
            mistake
                .lines()
                .find_map(|line| line.strip_prefix(mark))
                .unwrap()
        };
        let [from, to, message] = ['-', '+', '!'].map(line);
        refused(
            &check(&from.replace("\\n", "\n"), &to.replace("\\n", "\n"), &[]),
            message,
        );
        found += 1;
    }
    assert_eq!(found, 30);
}

/// A scene file that ends too early.
#[test]
fn a_file_cut_short_is_told_where_it_ends() {
    let (_, end) = SCENE.split_once("\n    window").unwrap();
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
