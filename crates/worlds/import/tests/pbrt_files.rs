//! Files of pbrt-v4: syntax, includes and messages.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::{assert_first, cases, folder};
use crate::pbrt_scenes::{causes, notes, read_in, scene, unsettled, world};
use etendue_import::{Color, Options, import};

#[test]
fn unused_parameters_are_noted_with_their_line() {
    let inside =
        "Material \"diffuse\"\n  \"float shininess\" 3\nShape \"sphere\" \"string name\" \"ball\"";
    assert_eq!(
        notes(inside),
        [
            "text:4:3: `shininess` of material `diffuse` is left out",
            "text:5:16: `name` of shape `sphere` is left out",
        ]
    );
    let spare = "Material \"diffuse\"\nMakeNamedMaterial \"x\" \"string type\" \"diffuse\"\nTexture \"t\" \"float\" \"constant\"\nOption \"seed\" 3";
    assert_eq!(
        notes(spare),
        [
            "text:6:1: option `seed` is left out",
            "text:3:1: material `diffuse` is not used",
            "text:4:1: material is not used",
            "text:5:1: texture `constant` is not used",
        ]
    );
}

#[test]
fn attributes_are_defaults() {
    let radius = |inside: &str| world(inside).shapes[0].to_world.matrix3.x_axis.x;
    let inside = "Attribute \"shape\" \"float radius\" 3 Shape \"sphere\"";
    assert!((radius(inside) - 3.0).abs() < 1e-12);
    let own = "Attribute \"shape\" \"float radius\" 3 Shape \"sphere\" \"float radius\" 2";
    assert!((radius(own) - 2.0).abs() < 1e-12);
    let block =
        "AttributeBegin Attribute \"shape\" \"float radius\" 3 AttributeEnd Shape \"sphere\"";
    assert!((radius(block) - 1.0).abs() < 1e-12);
    assert_eq!(
        notes(block),
        ["text:3:34: `radius` of attributes is left out"]
    );
}

#[test]
fn all_faults_are_found_with_their_places() {
    let found = causes(
        "Shape \"sphere\" \"float radius\" [1 x]\nGizmo 3 4\nTranslate 1 2\nShape \"disk\" \"colour c\" 1\nMaterial \"diffuse\" \"rgb reflectance\" [1 0]\nAttributeBegin\nShape \"sphere\" \"float radius\" \"3\" # ]\nShape \"sphere\" \"float radius\" [1",
    );
    let places: Vec<&str> = found
        .iter()
        .map(|c| c.split(": ").next().unwrap())
        .collect();
    assert_eq!(
        places,
        [
            "text:3:34",
            "text:4:1",
            "text:5:1",
            "text:6:14",
            "text:7:20",
            "text:9:16",
            "text:10:16",
            "text:8:1"
        ],
        "{found:#?}"
    );
    assert!(found[1].contains("directive `Gizmo` is not known"));
    assert!(found[7].contains("AttributeBegin without AttributeEnd"));
    let early = unsettled("Shape \"sphere\"");
    assert_first(&early, "Shape stands before WorldBegin");
    assert_first(&causes("Film \"rgb\""), "Film stands after WorldBegin");
    let medium = causes(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nMediumInterface \"fog\" \"\"",
    );
    assert_eq!(medium.len(), 2, "{medium:?}");
}

#[test]
fn types_must_fit() {
    for (inside, what) in cases(
        r#"
        Shape "sphere" "integer radius" 2 => radius is of type integer; allowed: float
        Shape "sphere" "float radius" [1 2] => radius has 2 numbers; allowed: 1
        Material "dielectric" "bool remaproughness" "true" Shape "disk" => without quotation marks
        Shape "trianglemesh" "integer indices" [0.5] => integers of 32 bits
        LightSource "point" "spectrum I" [400 1 300 1] => not in rising order
        LightSource "point" "spectrum I" "none.spd" => spectrum `none.spd` is not found
        Shape "sphere" "float radius" -1 => radius is -1; allowed: above 0
        "#,
    ) {
        let found = causes(inside);
        assert_first(&found, what);
    }
}

#[test]
fn strings_have_escapes_and_text_is_counted_in_characters() {
    let found = causes("Shape \"ä\\\"b\" \"float c\" nan");
    assert_eq!(found[0], "text:3:24: `nan` is not a finite number");
    assert!(
        found[1].starts_with("text:3:1: shape `ä\\\"b` is not supported"),
        "{found:?}"
    );
}

#[test]
fn files_are_read_in_place_and_cycles_are_found() {
    let files: [(&str, &[u8]); 5] = [
        ("part.pbrt", b"Translate 1 0 0\nShape \"sphere\"\n"),
        ("a/up.pbrt", b"Include \"part.pbrt\""),
        ("one.pbrt", b"Include \"two.pbrt\""),
        ("two.pbrt", b"\nInclude \"one.pbrt\""),
        ("bad.pbrt", b"\n Shape \"cube\""),
    ];
    let folder = folder(&files);
    let read = |inside: &str| read_in(&scene("", inside), folder.path(), Color::Luminance);
    let places = |inside: &str| -> Vec<f64> {
        let world = read(inside).unwrap().world;
        world
            .shapes
            .iter()
            .map(|s| s.to_world.translation.x)
            .collect()
    };
    // Names are relative to the folder of the scene.
    assert_eq!(places("Include \"a/up.pbrt\" Shape \"disk\""), [1.0, 1.0]);
    assert_eq!(places("Import \"part.pbrt\" Shape \"disk\""), [1.0, 0.0]);
    let cycle = read("Include \"one.pbrt\"").unwrap_err();
    assert_eq!(cycle, ["two.pbrt:2:1: file `one.pbrt` includes itself"]);
    let bad = read("Import \"bad.pbrt\"").unwrap_err();
    assert!(bad[0].starts_with("bad.pbrt:2:2: shape `cube`"), "{bad:?}");
}

#[test]
fn files_lie_below_the_root() {
    let outside = folder(&[("secret.pbrt", b""), ("secret.ply", b"")]);
    let folder = folder(&[]);
    let link = folder.path().join("link.pbrt");
    std::os::unix::fs::symlink(outside.path().join("secret.pbrt"), link).unwrap();
    let secret = outside.path().join("secret.ply");
    let inside = format!(
        "Include \"link.pbrt\"\nShape \"plymesh\" \"string filename\" \"{}\"",
        secret.display()
    );
    let found = read_in(&scene("", &inside), folder.path(), Color::Luminance).unwrap_err();
    assert_eq!(found.len(), 2);
    assert!(
        found
            .iter()
            .all(|cause| cause.contains("is outside of the folder")),
        "{found:?}"
    );
}

#[test]
fn formats_are_told_by_their_extension() {
    let folder = folder(&[("a.PBRT", b"WorldBegin Shape \"sphere\""), ("a.c4d", b"")]);
    let open = |name: &str| import(&folder.path().join(name), &Options::default());
    assert_eq!(open("a.PBRT").unwrap().world.shapes.len(), 1);
    assert!(
        open("a.c4d")
            .unwrap_err()
            .to_string()
            .contains("pbrt (pbrt-v4)")
    );
}
