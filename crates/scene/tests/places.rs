//! Tests that fields of a scene file are located in its text.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_scene::{Fault, SceneError, SceneFile};

/// The line and column that a message gives for a field.
fn place(text: &str, field: &str) -> Option<[usize; 2]> {
    let fault = Fault {
        field: field.to_owned(),
        value: "bad".to_owned(),
        allowed: "good".to_owned(),
        memory: false,
    };
    let told = SceneError::Values(vec![fault]).in_text(text, &[]);
    let (line, rest) = told.strip_prefix("line ")?.split_once(", column ")?;
    let (column, rest) = rest.split_once(": ")?;
    assert_eq!(rest, format!("{field} is bad; allowed: good"));
    Some([line.parse().unwrap(), column.parse().unwrap()])
}

#[test]
fn fields_are_found_whatever_stands_around_them() {
    let text = r##"( // light: 1
        /* light: /* 2 */ 3 */ description: "a \" light: 4, ( \\", other: r#"" light: 5"#,
        ö: "ö", light: Spot(center: (0, [1, 2], 3), bulb: Square(0.1)), planes: [
            (at: Before("floor")), Two(3, 4),
            (window: Some((x: Hann(0.5), y: Gaussian(width: 1, cut: 2)))),
        ],
        map: Lobes([(from: 1), (from: 2)]),
    )"##;
    for (field, place_of) in [
        ("light", [3, 24]),
        ("light.center[1][1]", [3, 45]),
        ("light.bulb", [3, 59]),
        ("planes[0].at", [4, 18]),
        ("planes[1]", [4, 36]),
        ("planes[2].window.x", [5, 31]),
        ("planes[2].window.y.cut", [5, 69]),
        ("planes[2].window.y.cut: some", [5, 69]),
        ("map[1].from", [7, 39]),
        // If a field is not written in the file, its position is the position of the enclosing
        // field.
        ("planes[0].window.x", [4, 13]),
        ("planes[7].at", [3, 81]),
    ] {
        assert_eq!(place(text, field), Some(place_of), "{field}");
    }
    for field in ["run.photons", "the scene", "triangles of all meshes"] {
        assert_eq!(place(text, field), None, "{field}");
    }
    assert_eq!(place("", "light"), None);
}

#[test]
fn no_text_is_too_odd_to_be_searched() {
    let odd = [
        "(",
        ")",
        "))((",
        "\"",
        "r#\"",
        "/*",
        "//",
        "/",
        "r",
        "r##",
        "\\",
        "ä",
        "light:",
        ":::",
        ",,,",
        "a:b:c",
        "light: (size: ",
        "[",
        "'",
        "\u{feff}",
        "{light: 1}",
        "light light (",
        "\"\\",
        "Some(light:",
    ];
    for a in odd {
        for b in odd {
            for c in odd {
                let text = [a, b, c].concat();
                place(&text, "light.size[1]");
                let _ = SceneFile::parse(&text).map_err(|e| e.to_string());
            }
        }
    }
    let deep = "(".repeat(1_000_000);
    assert_eq!(place(&deep, "light.size"), None);
}
