//! Tests three limits: on the size of a scene file, on the names in it, and on the parts of it that
//! messages show.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::{Fault, Scene, SceneError, SceneFile, resolve};
use std::fmt::Write;
use std::time::{Duration, Instant};

const LIGHT: &str = "Rectangle(center: (0, 0, 0), size: (0.2, 0.2))";
const BLOCKERS: &str =
    r#"Shapes(name: "some", center: (0, 0, 1), shapes: [Disc(center: (0, 0), radius: 1)])"#;
const SURFACE: &str = r#"Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))"#;
const VISITS: &str = r#"visits: ["floor"]"#;
const PLANE: &str = r#"(name: "a", at: Before("floor"))"#;

fn text() -> String {
    format!(
        "(
            light: {LIGHT},
            blockers: [{BLOCKERS}],
            surfaces: [{SURFACE}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), {VISITS}),
            planes: [{PLANE}],
            window: (x: Hann(0.5), u: Hann(0.5)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
        )"
    )
}

fn file() -> SceneFile {
    SceneFile::parse(&text()).unwrap()
}

fn resolved(text: &str) -> Result<Scene, SceneError> {
    resolve("test", SceneFile::parse(text)?, ".".as_ref(), u64::MAX)
}

/// The error that results if `from` is replaced by `to` in the scene.
fn error(from: &str, to: &str) -> SceneError {
    assert!(text().contains(from), "{from} is not in the scene");
    resolved(&text().replacen(from, to, 1)).unwrap_err()
}

fn faults(from: &str, to: &str) -> Vec<Fault> {
    match error(from, to) {
        SceneError::Values(faults) => faults,
        other => panic!("{other}"),
    }
}

/// A layer of `count` shapes, each written by `shape` from its number.
fn layer(count: u32, shape: impl Fn(u32) -> String) -> String {
    let shapes: String = (0..count).map(|i| shape(i) + ",").collect();
    format!(r#"Shapes(name: "some", center: (0, 0, 1), shapes: [{shapes}])"#)
}

/// Checks that `work` takes far less time than a comparison of every pair would take.
fn quickly<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    let took = start.elapsed();
    assert!(took < Duration::from_secs(2), "{what} took {took:?}");
    done
}

#[test]
fn one_pair_that_overlaps_is_named_and_found_at_once() {
    let same = layer(20_000, |_| {
        "Rectangle(center: (0, 0), size: (1, 1))".to_owned()
    });
    let half_planes = layer(20_000, |i| {
        format!("HalfPlane(axis: X, edge: {i}, opaque: Above)")
    });
    for shapes in [same, half_planes] {
        let told = quickly("an overlap", || error(BLOCKERS, &shapes).to_string());
        let first = "shapes[0] and shapes[1] overlap; allowed: shapes that do not overlap";
        assert!(told.contains(first), "{told}");
    }
}

#[test]
fn the_last_pair_that_overlaps_is_found() {
    let apart = |moved: &str| {
        layer(15_000, |i| match i {
            14_999 => moved.to_owned(),
            i => format!("Disc(center: ({}, {}), radius: 0.5)", i % 122, i / 122),
        })
    };
    // The disc of the first radius fits in the gap between four discs; the disc of the second
    // radius does not.
    for (radius, told) in [(0.207, None), (0.208, Some("shapes[17] and shapes[14999]"))] {
        let shapes = apart(&format!("Disc(center: (17.5, 0.5), radius: {radius})"));
        let text = text().replacen(BLOCKERS, &shapes, 1);
        let error = quickly("shapes apart", || resolved(&text).err());
        assert_eq!(error.is_some(), told.is_some(), "{radius}: {error:?}");
        if let (Some(error), Some(told)) = (error, told) {
            assert!(error.to_string().contains(told), "{error}");
        }
    }
}

/// The fault of a layer of two squares and the given half-planes, if there is a fault.
fn overlap_of(half_planes: &str) -> Option<String> {
    let squares =
        "Rectangle(center: (0, 0), size: (1, 1)), Rectangle(center: (2, 0), size: (1, 1)),";
    let blockers =
        format!(r#"Shapes(name: "some", center: (0, 0, 1), shapes: [{squares} {half_planes}])"#);
    let error = resolved(&text().replacen(BLOCKERS, &blockers, 1)).err()?;
    let told = error.to_string();
    let at = told.find("shapes[").unwrap();
    let pair = told[at..].split("overlap").next().unwrap();
    Some(pair.replace("shapes", "")[..].trim().to_owned())
}

#[test]
fn half_planes_overlap_unless_they_are_two_that_face_away() {
    let right = "HalfPlane(axis: X, edge: 3, opaque: Above)";
    let left = "HalfPlane(axis: X, edge: -1, opaque: Below)";
    let top = "HalfPlane(axis: Y, edge: 9, opaque: Above)";
    let facing = "HalfPlane(axis: X, edge: 4, opaque: Below)";
    let middle = "HalfPlane(axis: X, edge: 2, opaque: Above)";
    for (half_planes, pair) in [
        (format!("{right}, {left}"), None),
        (format!("{left}, {right}"), None),
        (format!("{left}, {right}, {top}"), Some("[2] and [4]")),
        (format!("{right}, {top}"), Some("[2] and [3]")),
        (format!("{left}, {middle}"), Some("[1] and [3]")),
        (format!("{facing}, {right}"), Some("[2] and [3]")),
    ] {
        let told = overlap_of(&half_planes);
        assert_eq!(told.as_deref(), pair, "{half_planes}");
    }
}

#[test]
fn many_faults_are_counted_and_ten_are_told() {
    let lobes = "(from: (0, 0, 0), width: 0, radiance: 0),".repeat(10_000);
    let light = format!("Environment(center: (0, 0, 0), map: Lobes([{lobes}]))");
    let told = quickly("30000 faults", || error(LIGHT, &light).to_string());
    assert_eq!(told.lines().count(), 11, "{told}");
    let last = told.lines().last().unwrap();
    assert_eq!(last, "and 29990 more: 30000 faults in all");
}

#[test]
fn a_fault_that_planes_share_is_told_once() {
    let planes = format!("{PLANE}, {}", PLANE.replace("\"a\"", "\"b\""));
    let text = text()
        .replacen(PLANE, &planes, 1)
        .replacen("Hann(0.5)", "Hann(-1)", 1);
    let told = resolved(&text).unwrap_err().to_string();
    assert_eq!(told.lines().count(), 1, "{told}");
}

/// A list of `count` items, each written with its number.
fn list(count: u32, thing: impl Fn(u32) -> String) -> String {
    (0..count).fold(String::new(), |mut all, i| {
        write!(all, "{},", thing(i)).unwrap();
        all
    })
}

#[test]
fn what_there_is_too_much_of_is_one_fault() {
    let lobe = "(from: (0, 0, -1), width: 1)";
    let star = |i: u32| {
        let mesh = "mesh: Star(radius: 0.1, relief: 0, lobes: 0, rings: 2048)";
        format!(r#"Mesh(name: "m{i}", center: (0, 0, 3), {mesh})"#)
    };
    let squares = |i: u32| {
        let grid = "count: (1000, 100), pitch: 1, fill: 0.5";
        format!(r#"JitteredSquares(name: "s{i}", center: (0, 0, 1), {grid})"#)
    };
    for (from, to, field) in [
        (
            BLOCKERS,
            list(1001, |i| BLOCKERS.replace("some", &format!("b{i}"))),
            "blockers",
        ),
        (
            SURFACE,
            list(1001, |i| SURFACE.replace("floor", &format!("f{i}"))),
            "surfaces",
        ),
        (
            PLANE,
            list(1025, |i| PLANE.replace("\"a\"", &format!("\"p{i}\""))),
            "planes",
        ),
        (
            VISITS,
            format!("visits: [{}]", list(65, |_| "\"floor\"".to_owned())),
            "path.visits",
        ),
        (
            LIGHT,
            format!(
                "Environment(center: (0, 0, 0), map: Lobes([{}]))",
                list(10_001, |_| lobe.to_owned())
            ),
            "light.map",
        ),
        (BLOCKERS, list(2, squares), "blockers: shapes of all layers"),
        (
            BLOCKERS,
            list(2, star),
            "triangles of all Star and Paraboloid meshes",
        ),
    ] {
        let faults = quickly(field, || faults(from, &to));
        let fields: Vec<&str> = faults.iter().map(|f| f.field.as_str()).collect();
        assert_eq!(fields, [field]);
    }
}

#[test]
fn a_layer_of_no_squares_does_not_hide_the_others() {
    let squares = |i: u32| {
        let count = if i == 999 { "(0, 1)" } else { "(1000, 100)" };
        format!(
            r#"JitteredSquares(name: "s{i}", center: (0, 0, 1), count: {count}, pitch: 1, fill: 0.5)"#
        )
    };
    let faults = quickly("a thousand layers", || {
        faults(BLOCKERS, &list(1000, squares))
    });
    assert_eq!(faults[0].field, "blockers: shapes of all layers");
}

#[test]
fn names_are_64_characters_that_print() {
    let long = "ñ".repeat(64);
    for name in ["床 2", "पटल", "a", "שלום", long.as_str()] {
        let text = text().replace("floor", name);
        assert!(resolved(&text).is_ok(), "{name:?}");
    }
    for name in [
        "",
        &format!("{long}n"),
        "a\\u{fffe}b",
        "a\\u{1b}[31mb",
        "a\\u{7}b",
        "a\\u{202e}b",
        "a\\u{2028}b",
        "a\\u{e000}b",
        "a\\nb",
    ] {
        for (named, field) in [("floor", "surfaces[0].name"), ("some", "blockers[0].name")] {
            let text = text().replace(named, name);
            let Err(SceneError::Values(faults)) = resolved(&text) else {
                panic!("{name} was accepted");
            };
            let fields: Vec<&str> = faults.iter().map(|f| f.field.as_str()).collect();
            assert_eq!(fields, [field], "{name}");
            assert!(faults[0].allowed.starts_with("1 to 64 "), "{faults:?}");
        }
    }
}

#[test]
fn the_scene_itself_has_a_name_that_can_be_a_folder() {
    let long = "s".repeat(65);
    for name in ["..", ".", "", "a\u{1b}b", "../up", &long] {
        let Err(SceneError::Values(faults)) = resolve(name, file(), ".".as_ref(), u64::MAX) else {
            panic!("{name:?} was accepted");
        };
        let fields: Vec<&str> = faults.iter().map(|f| f.field.as_str()).collect();
        assert_eq!(fields, ["the name of the scene file"], "{name:?}");
    }
    for name in ["fig 9b", "...", "сцена"] {
        assert!(resolve(name, file(), ".".as_ref(), u64::MAX).is_ok());
    }
}

/// Checks whether a message is short and has no characters that control a terminal.
fn is_plain(message: &str) -> bool {
    let printable = |c: char| !c.is_control() && !matches!(c, '\u{202a}'..='\u{202e}' | '\u{fffe}');
    message.chars().count() < 3_000 && message.lines().all(|line| line.chars().all(printable))
}

#[test]
fn messages_show_little_of_a_file_and_nothing_that_a_terminal_obeys() {
    let long = "n".repeat(1_000_000);
    let codes = "\\u{1b}[2J\\u{202e}";
    for name in [long.as_str(), codes] {
        let unknown = format!("\"{name}\"");
        let mesh = format!(r#"Mesh(name: "m", center: (0, 0, 1), mesh: File("{name}"))"#);
        for (from, to) in [
            (VISITS, format!("visits: [{unknown}]")),
            (PLANE, format!("(name: {unknown}, at: Emission)")),
            (PLANE, format!(r#"(name: "a", at: Before({unknown}))"#)),
            (SURFACE, SURFACE.replace("floor", name)),
            (BLOCKERS, mesh),
        ] {
            let told = quickly("a long name", || error(from, &to).to_string());
            assert!(is_plain(&told), "{told:.500}");
        }
    }
    let surfaces = list(1000, |i| {
        SURFACE.replace("floor", &format!("{}{i}", "f".repeat(50)))
    });
    let told = error(SURFACE, &surfaces).to_string();
    assert!(is_plain(&told), "{told:.500}");
}

#[test]
fn faults_of_syntax_show_little_of_a_file() {
    let long = "z".repeat(1_000_000);
    for (from, to) in [
        ("size:", format!("{long}:")),
        ("Rectangle", long.clone()),
        ("(0.2, 0.2)", format!("\"{long}\"")),
        ("(0.2, 0.2)", "\"\\u{1b}[2J\"".to_owned()),
        ("0.2", "9".repeat(1_000_000)),
    ] {
        let told = quickly("syntax", || error(from, &to).to_string());
        assert!(is_plain(&told), "{told:.500}");
    }
}

#[test]
fn a_byte_order_mark_is_no_fault() {
    assert_eq!(
        SceneFile::parse(&format!("\u{feff}{}", text())).unwrap(),
        file()
    );
}

#[test]
fn a_value_that_is_set_is_nested_no_deeper_than_a_scene() {
    let (open, close) = (|by: &str| by.repeat(20_000), ")".repeat(20_000));
    for value in [
        open("(") + &close,
        open("a(") + &close,
        open("(a:") + &close,
        // The brackets of this text are closed one by one, or all together at the end.
        open("(a)") + &close,
    ] {
        let told = quickly("a nested value", || {
            file().with("light", &value).unwrap_err().to_string()
        });
        assert!(told.contains("nested at most 32 deep"), "{told:.500}");
        assert!(is_plain(&told), "{told:.500}");
    }
    let told = file()
        .with("light", &"[".repeat(20_000))
        .unwrap_err()
        .to_string();
    assert!(is_plain(&told), "{told:.500}");
}

/// If each of the thirty brackets in this test doubled the work, the test would take a billion
/// times as long as without brackets.
#[test]
fn each_part_of_a_value_that_is_set_is_read_once() {
    let value = format!("{}1{}", "(a:".repeat(30), ",b)".repeat(30));
    quickly("a value of pairs", || {
        file().with("light", &value).unwrap_err()
    });
}

fn sets(fields: &[(&str, &str)]) -> Vec<(String, String)> {
    let owned = fields.iter();
    owned
        .map(|(path, value)| ((*path).to_owned(), (*value).to_owned()))
        .collect()
}

#[test]
fn fields_set_together_are_as_set_one_after_the_other() {
    let fields = sets(&[
        ("run.photons", "1e6"),
        // The scene file does not state the phase of this grating. The next edit sets the phase of
        // the grating.
        (
            "blockers.0",
            "Grating(name: bars, center: (0, 0, 1), axis: X, frequency: 3)",
        ),
        ("blockers.0.phase", "0.5"),
        ("run.photons", "2e6"),
    ]);
    let each = fields.iter().fold(file(), |file, (path, value)| {
        file.with(path, value).unwrap()
    });
    assert_eq!(each.run.photons, 2_000_000);
    assert_eq!(file().with_all(&fields).unwrap(), each);
}

#[test]
fn of_fields_set_together_the_one_at_fault_is_named() {
    for wrong in ["run.photon=3", "run.seed=some", "planes.3.name=a"] {
        let (path, value) = wrong.split_once('=').unwrap();
        let fields = sets(&[("run.photons", "1e6"), (path, value), ("run.alpha", "0.1")]);
        let told = file().with_all(&fields).unwrap_err().to_string();
        assert!(told.starts_with(&format!("{wrong}: ")), "{told}");
    }
    let many = sets(&[("run.photons", "1e6")].repeat(101));
    let told = file().with_all(&many).unwrap_err().to_string();
    assert_eq!(told, "101 fields set: allowed: at most 100");
}
