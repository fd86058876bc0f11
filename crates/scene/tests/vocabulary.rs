//! Tests lights, blockers, surfaces and planes of every kind: which objects they resolve to, and
//! which are refused.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Mask, Quantity, Side};
use etendue_scene::{Scene, SceneError, SceneFile, resolve};

const LIGHT: &str = "Spot(center: (0, 0, 0), bulb: Disc(0.1), radiance: 2, exponent: 8)";
const BLOCKERS: &str = r#"
    Shapes(name: "shapes", center: (0.5, 0, 1), shapes: [
        Rectangle(center: (0, 0), size: (0.2, 0.1)),
        Disc(center: (0.3, 0), radius: 0.1),
        HalfPlane(axis: Y, edge: -0.5, opaque: Below),
    ]),
    Grating(name: "grating", center: (0.25, 0, 1.2), axis: X, frequency: 2, modulation: 0.5, phase: 0.1),
    Mesh(name: "star", center: (0, 0, 0.5), mesh: Star(radius: 0.2, relief: 0.1, lobes: 3, rings: 10), scale: 0.5)"#;
const SURFACES: &str = r#"Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6), albedo: 0.5)"#;
const PLANES: &str = r#"
    (name: "star", at: Before("star")),
    (name: "behind", at: After("star")),
    (name: "irradiance", at: Before("floor"), quantity: DifferentialIrradiance),
    (name: "leaving", at: After("floor")),
    (name: "back", at: Distance(2.5))"#;

fn text() -> String {
    format!(
        r#"(
            light: {LIGHT},
            blockers: [{BLOCKERS}],
            surfaces: [{SURFACES}],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
            planes: [{PLANES}],
            window: (x: Hann(0.5), u: Hann(0.5)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
        )"#
    )
}

fn resolved(text: &str) -> Result<Scene, SceneError> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    resolve("test", SceneFile::parse(text)?, folder.as_ref(), u64::MAX)
}

#[test]
fn everything_resolves_to_what_it_says() {
    let scene = resolved(&text()).unwrap();
    let [shapes, grating] = scene.blockers.as_slice() else {
        panic!("two layers: {:?}", scene.blockers);
    };
    let Mask::Opaque {
        shapes: each,
        half_planes,
    } = &shapes.mask
    else {
        panic!("opaque: {shapes:?}");
    };
    assert_eq!(each.len(), 2);
    assert!((each[1].bounds().center[0] - 0.8).abs() < 1e-15); // rounding
    assert!(half_planes[0].contains(9.0, -0.6) && !half_planes[0].contains(9.0, -0.4));
    let Mask::Grating(grating) = grating.mask else {
        panic!("a grating: {grating:?}");
    };
    // The expected transmittance is ½ (1 + m cos(2πf (x − 0.25) + p)) about the grating's own
    // origin.
    assert!((grating.transmittance(0.25, 7.0) - 0.5 * (1.0 + 0.5 * 0.1_f64.cos())).abs() < 1e-14); // rounding
    let star = &scene.meshes[0];
    assert_eq!(star.triangles.len(), 4 * 10 * 9);
    assert!((star.extent[0] - 0.4).abs() < 1e-12 && (star.extent[1] - 0.6).abs() < 1e-12); // rounding at the poles
    let places: Vec<_> = scene
        .planes
        .iter()
        .map(|p| (p.side, p.leg, p.quantity))
        .collect();
    assert_eq!(
        places[2],
        (Side::Before, 0, Quantity::DifferentialIrradiance)
    );
    assert_eq!(places[3], (Side::After, 1, Quantity::Radiance));
    // On its way back, the light reaches the grating.
    assert!((scene.path.legs[1].length - 0.8).abs() < 1e-15); // rounding
    let back = &scene.planes[4].frame;
    assert!((back.origin.z - 1.5).abs() < 1e-15 && back.d.z < 0.0 && back.x.x < 0.0); // rounding
    assert!((back.x.cross(back.y) - back.d).length() < 1e-15); // rounding
}

/// For each case: the text that is replaced, its replacement, and the reported field.
const BAD: &[(&str, &str, &str)] = &[
    ("bulb: Disc(0.1)", "bulb: Disc(0)", "light.bulb"),
    ("bulb: Disc(0.1)", "bulb: Square(-1)", "light.bulb"),
    ("exponent: 8", "exponent: -1", "light.exponent"),
    ("exponent: 8", "exponent: NaN", "light.exponent"),
    ("radiance: 2", "radiance: inf", "light.radiance"),
    (LIGHT, "Disc(center: (0, 0, 0), radius: 0)", "light.radius"),
    (
        LIGHT,
        "Disc(center: (0, NaN, 0), radius: 1)",
        "light.center[1]",
    ),
    (
        LIGHT,
        "Point(center: (0, 0, 0), intensity: 0)",
        "light.intensity",
    ),
    (
        LIGHT,
        "Point(center: (0, 0, 0), intensity: NaN)",
        "light.intensity",
    ),
    (
        "radius: 0.1)",
        "radius: -0.1)",
        "blockers[0].shapes[1].radius",
    ),
    (
        "size: (0.2, 0.1)",
        "size: (0.2, 0)",
        "blockers[0].shapes[0].size[1]",
    ),
    (
        "center: (0.3, 0)",
        "center: (0.3, NaN)",
        "blockers[0].shapes[1].center[1]",
    ),
    ("center: (0.3, 0)", "center: (0.1, 0)", "blockers[0].shapes"),
    ("edge: -0.5", "edge: 0", "blockers[0].shapes"),
    ("edge: -0.5", "edge: NaN", "blockers[0].shapes[2].edge"),
    (
        "center: (0.5, 0, 1)",
        "center: (0.5, 0, 2)",
        "blockers[0].center",
    ),
    (
        "center: (0.5, 0, 1)",
        "center: (0.5, 0, 1.2)",
        "blockers[0].center and blockers[1].center",
    ),
    ("name: \"grating\"", "name: \"shapes\"", "blockers[1].name"),
    ("frequency: 2", "frequency: 0", "blockers[1].frequency"),
    (
        "modulation: 0.5",
        "modulation: 1.5",
        "blockers[1].modulation",
    ),
    (
        "modulation: 0.5",
        "modulation: -0.5",
        "blockers[1].modulation",
    ),
    ("phase: 0.1", "phase: inf", "blockers[1].phase"),
    ("scale: 0.5", "scale: 0", "blockers[2].scale"),
    ("rings: 10", "rings: 1", "blockers[2].mesh.rings"),
    ("relief: 0.1", "relief: 1", "blockers[2].mesh.relief"),
    ("lobes: 3", "lobes: 30", "blockers[2].mesh.lobes"),
    (
        "center: (0, 0, 0.5)",
        "center: (0, 0, 0.05)",
        "blockers[2].center",
    ),
    (
        "center: (0, 0, 0.5)",
        "center: (0, inf, 0.5)",
        "blockers[2].center[1]",
    ),
    // A grating stands at 1.2 m, and shapes stand at 1 m beside the central ray.
    ("Distance(2.5)", "Distance(2.9)", "planes[4].at"),
    ("Distance(2.5)", "Distance(2)", "planes[4].at"),
    ("After(\"star\")", "After(\"moon\")", "planes[1].at"),
    ("albedo: 0.5", "albedo: 1.1", "surfaces[0].albedo"),
];

/// Further scenes that are refused. Their path leads over an oblique wall to a floor.
const BAD_PATHS: &[(&str, &str, &str)] = &[
    (FACING, "facing: (0, 0, 0)", "surfaces[0].facing"),
    (FACING, "facing: (1, NaN, -1)", "surfaces[0].facing[1]"),
    ("size: (2, 2)", "size: (2, 0)", "surfaces[0].size[1]"),
    (VISITS, "visits: []", "path.visits"),
    (VISITS, "visits: [\"floor\"]", "path.visits[0]"),
    (VISITS, "visits: [\"wall\", \"roof\"]", "path.visits[1]"),
    // The refused directions point behind the floor or along the floor, or are the zero vector.
    (VISITS, LEAVES[0], "path.leaves"),
    (VISITS, LEAVES[1], "path.leaves"),
    (VISITS, LEAVES[2], "path.leaves"),
    (VISITS, LEAVES[3], "path.leaves[2]"),
    // In these cases the floor lies behind the wall or behind a card.
    (
        "center: (1.5, 0, 2)",
        "center: (-1.5, 0, 2)",
        "path.visits[1]",
    ),
    ("surfaces: [", CARD, "path.visits[1]"),
    // The last leg goes straight back, and meets the wall at a distance of 5 m.
    ("Distance(4)", "Distance(5)", "planes[5].at"),
    ("Distance(4)", "Distance(3.5)", "planes[5].at"),
    ("After(\"wall\")", "After(\"roof\")", "planes[1].at"),
    // A floor that lies behind the light, and that the path does not visit.
    (FLOOR, BEHIND, "planes[3].at"),
];
const TWO_BOUNCES: &str = include_str!("../../../scenes/two_bounces.ron");
const FACING: &str = "facing: (1, 0, -1)";
const VISITS: &str = "visits: [\"wall\", \"floor\"]";
const LEAVES: [&str; 4] = [
    "visits: [\"wall\", \"floor\"], leaves: (1, 0, 0)",
    "visits: [\"wall\", \"floor\"], leaves: (0, 1, 0)",
    "visits: [\"wall\", \"floor\"], leaves: (0, 0, 0)",
    "visits: [\"wall\", \"floor\"], leaves: (-1, 0, inf)",
];
const FLOOR: &str = r#"(1.5, 0, 2), size: (3, 3), facing: (-1, 0, 0), albedo: 0.5),
    ],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["wall", "floor"]),"#;
const BEHIND: &str = r#"(0, 0, -0.5), size: (3, 3), facing: (0, 0, 1), albedo: 0.5),
    ],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["wall"]),"#;
const CARD: &str =
    r#"surfaces: [Rectangle(name: "card", center: (0.7, 0, 2), size: (1, 1), facing: (-1, 0, 0)),"#;

#[test]
fn each_bad_value_is_named() {
    let scenes = BAD.iter().map(|case| (text(), case));
    let paths = BAD_PATHS.iter().map(|case| (TWO_BOUNCES.to_owned(), case));
    for (text, (from, to, field)) in scenes.chain(paths) {
        assert!(text.contains(from), "{from} is not in the scene");
        match resolved(&text.replacen(from, to, 1)) {
            Err(SceneError::Values(faults)) => {
                let named = faults.iter().any(|f| f.field == *field);
                assert!(named, "{to}: {faults:?} instead of {field}");
            }
            Err(other) => panic!("{to}: {other}"),
            Ok(_) => panic!("{to} was accepted"),
        }
    }
}

#[test]
fn a_mesh_that_cannot_be_read_is_a_fault_of_its_field() {
    let star = "Star(radius: 0.2, relief: 0.1, lobes: 3, rings: 10)";
    let hill = r#"Mesh(name: "floor", center: (0, 0, 2), mesh: File("nowhere.ply"))"#;
    for (from, to, told) in [
        (
            star,
            "File(\"nowhere.ply\")",
            "blockers[2].mesh is \"nowhere.ply\" (No such file or directory (os error 2)); allowed: a regular file",
        ),
        (
            star,
            "File(\"vocabulary.rs\")",
            "blockers[2].mesh, \"vocabulary.rs\": the extension is `rs`; allowed: obj, ply",
        ),
        (
            SURFACES,
            hill,
            "surfaces[0].mesh is \"nowhere.ply\" (No such file or directory (os error 2)); allowed: a regular file",
        ),
    ] {
        let error = resolved(&text().replacen(from, to, 1))
            .unwrap_err()
            .to_string();
        // Planes and visits that refer to a faulty object are not reported as faulty too.
        assert!(
            error.starts_with(told) && error.lines().count() == 1,
            "{error}"
        );
    }
}

/// The scene with an aperture as its only blockers.
fn with_hole(hole: &str) -> Result<Scene, SceneError> {
    let aperture = format!(r#"Aperture(name: "star", center: (0.3, -0.2, 1), hole: {hole})"#);
    resolved(&text().replacen(BLOCKERS, &aperture, 1))
}

#[test]
fn an_aperture_is_open_in_its_hole() {
    for hole in [
        "Rectangle(center: (0.1, 0), size: (0.2, 0.4))",
        "Polygon(corners: [(0, -0.2), (0.2, -0.2), (0.2, 0.2), (0, 0.2)])",
        "Polygon(corners: [(0, -0.2), (0, 0.2), (0.2, 0.2), (0.2, -0.2)])",
    ] {
        let scene = with_hole(hole).unwrap();
        let mask = &scene.blockers[0].mask;
        for (x, y, passes) in [
            (0.31, -0.39, 1.0),
            (0.49, -0.01, 1.0),
            (0.29, -0.2, 0.0),
            (0.51, -0.2, 0.0),
            (0.4, 0.01, 0.0),
            (0.4, -0.41, 0.0),
            (1e8, 0.0, 0.0),
        ] {
            let found = mask.transmittance(x, y);
            assert!(found.total_cmp(&passes).is_eq(), "{hole}: ({x}, {y})");
        }
    }
    let scene = with_hole("Disc(center: (0.1, 0), radius: 0.2)").unwrap();
    let mask = &scene.blockers[0].mask;
    let passes = |x: f64| mask.transmittance(x, -0.2) > 0.5;
    assert!(passes(0.21) && passes(0.59) && !passes(0.19) && !passes(0.61));
}

#[test]
fn holes_have_limits() {
    let many = "(0, 1),".repeat(33);
    let many = format!("Polygon(corners: [{many}])");
    let order = "corners in order around a convex polygon, no three of them on a line";
    for (hole, told) in [
        (
            "Disc(center: (0, 0), radius: 0)",
            "hole.radius is 0; allowed: 1e-9 to 1e9".to_owned(),
        ),
        (
            "Rectangle(center: (0, 0), size: (1, -1))",
            "hole.size[1] is -1; allowed: 1e-9 to 1e9".to_owned(),
        ),
        (
            "Polygon(corners: [(0, 0), (1, 1)])",
            "hole.corners is 2 corners; allowed: 3 to 32 corners".to_owned(),
        ),
        (
            many.as_str(),
            "hole.corners is 33 corners; allowed: 3 to 32 corners".to_owned(),
        ),
        (
            "Polygon(corners: [(0, 0), (1, NaN), (1, 1)])",
            "hole.corners[1][1] is NaN; allowed: -1e9 to 1e9".to_owned(),
        ),
        (
            "Polygon(corners: [(0, 0), (1, 1), (1, 0), (0, 1)])",
            format!("hole.corners is 4 corners that form no convex polygon; allowed: {order}"),
        ),
        (
            "Polygon(corners: [(0, 0), (1, 0), (2, 0)])",
            format!("hole.corners is 3 corners that form no convex polygon; allowed: {order}"),
        ),
    ] {
        let error = with_hole(hole).unwrap_err().to_string();
        assert!(
            error.contains(&format!("blockers[0].{told}")) && error.lines().count() == 1,
            "{hole}: {error}"
        );
    }
}

/// The scene with bars as its only blockers, of which some fields are given.
fn with_bars(center: &str, axis: &str, fields: &str) -> Result<Scene, SceneError> {
    let bars = format!(r#"Bars(name: "star", center: {center}, axis: {axis}, {fields})"#);
    resolved(&text().replacen(BLOCKERS, &bars, 1))
}

#[test]
fn bars_stand_a_pitch_apart_about_their_center() {
    for (axis, count, middles) in [
        ("X", 1, vec![0.3]),
        ("X", 3, vec![0.1, 0.3, 0.5]),
        ("Y", 4, vec![-0.5, -0.3, -0.1, 0.1]),
    ] {
        let fields = format!("count: {count}, pitch: 0.2, fill: 0.25");
        let scene = with_bars("(0.3, -0.2, 1)", axis, &fields).unwrap();
        assert_eq!(scene.blockers[0].pitch, Some(0.2));
        for i in -1500..1500 {
            // No point lies on an edge.
            let across = 0.001 * (f64::from(i) + 0.5);
            let blocked = middles.iter().any(|middle| (across - middle).abs() < 0.025);
            for along in [-1e6, 0.0, 0.4, 1e8] {
                let [x, y] = if axis == "X" {
                    [across, along]
                } else {
                    [along, across]
                };
                let passed = scene.blockers[0].mask.transmittance(x, y) > 0.5;
                assert_ne!(passed, blocked, "{count} along {axis}: ({x}, {y})");
            }
        }
    }
}

#[test]
fn bars_have_limits() {
    for (fields, told) in [
        (
            "count: 0, pitch: 1, fill: 1",
            "count is 0; allowed: 1 to 100000",
        ),
        (
            "count: 100_001, pitch: 1, fill: 1",
            "count is 100001; allowed: 1 to 100000",
        ),
        (
            "count: 5, pitch: 1, fill: 0",
            "fill is 0; allowed: 1e-9 to 1",
        ),
        (
            "count: 5, pitch: 1, fill: 1.01",
            "fill is 1.01; allowed: 1e-9 to 1",
        ),
        (
            "count: 5, pitch: 1, fill: NaN",
            "fill is NaN; allowed: 1e-9 to 1",
        ),
        (
            "count: 5, pitch: inf, fill: 1",
            "pitch is inf; allowed: 1e-9 to 1e9",
        ),
    ] {
        let error = with_bars("(0, 0, 1)", "X", fields).unwrap_err().to_string();
        assert!(
            error.contains(&format!("blockers[0].{told}")) && error.lines().count() == 1,
            "{fields}: {error}"
        );
    }
    let most = "count: 100_000, pitch: 1e-5, fill: 1";
    assert!(with_bars("(0, 0, 1)", "X", most).is_ok());
}

/// Light passes beside the outermost bars, but not beyond the ends of bars.
#[test]
fn a_warning_names_bars_that_are_too_few() {
    for (count, warns) in [(8, true), (20, false)] {
        let fields = format!("count: {count}, pitch: 0.1, fill: 0.5");
        let scene = with_bars("(0, 0, 1)", "Y", &fields).unwrap();
        let told = scene
            .warnings()
            .iter()
            .any(|told| told.contains("passes star"));
        assert_eq!(told, warns, "{count}: {:?}", scene.warnings());
    }
}

#[test]
fn counts_are_written_as_people_write_them() {
    for (count, photons) in [
        ("1e6", Some(1_000_000)),
        ("2_000", Some(2_000)),
        ("1.5", None),
        ("-1", None),
    ] {
        let run = format!("run: (photons: {count}), window:");
        let file = SceneFile::parse(&text().replacen("window:", &run, 1));
        match photons {
            Some(photons) => assert_eq!(file.unwrap().run.photons, photons, "{count}"),
            None => {
                let message = file.unwrap_err().to_string();
                assert!(message.contains("whole number"), "{message}");
            }
        }
    }
    let counts = "run: (batches: 1.28e2), window:";
    let text = text().replacen("window:", counts, 1);
    let rings = text.replacen("rings: 10", "rings: 1e1", 1);
    assert_ne!(text, rings);
    let file = SceneFile::parse(&rings).unwrap();
    assert_eq!(file, SceneFile::parse(&text).unwrap());
    assert_eq!(file.run.batches, 128);
    let message = SceneFile::parse(&text.replacen("rings: 10", "rings: 5e9", 1));
    let message = message.unwrap_err().to_string();
    assert!(
        message.contains("rings is 5e9; allowed: a whole number"),
        "{message}"
    );
}

#[test]
fn unknown_words_are_named_with_the_known_ones() {
    for (from, to, part) in [
        ("exponent: 8", "exponnt: 8", "exponent"),
        ("axis: X", "axis: Z", "allowed: X, Y"),
        ("opaque: Below", "opaque: Left", "Above"),
        (
            "quantity: DifferentialIrradiance",
            "quantity: Irradiance",
            "Radiance",
        ),
        ("Disc(center", "Circle(center", "HalfPlane"),
    ] {
        let error = resolved(&text().replacen(from, to, 1))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(part) && error.starts_with("line ") && !error.contains("File"),
            "{to}: {error}"
        );
    }
}

/// On its way back, light may pass beside blockers and beside a light, but a virtual plane must not
/// lie in the planes of these objects.
#[test]
fn a_plane_beyond_blockers_that_the_central_ray_misses() {
    let at = |distance: f64| {
        let plane = format!("Distance({distance})");
        let text = text().replace("Distance(2.5)", &plane);
        let grating = text.find("    Grating(").unwrap();
        let star = text.find("    Mesh(name: \"star\"").unwrap();
        let planes = text.find("    (name: \"star\", at").unwrap();
        let irradiance = text.find("    (name: \"irradiance\"").unwrap();
        // Without the grating and the mesh, the central ray meets only the light.
        let text = [
            &text[..grating],
            &text[text[star..].find("],").unwrap() + star..planes],
            &text[irradiance..],
        ];
        resolved(&text.concat()).map(|scene| scene.planes[2].distance)
    };
    assert_eq!(at(3.2).unwrap().to_bits(), 3.2_f64.to_bits());
    for refused in [3.0, 4.5] {
        let error = at(refused).unwrap_err().to_string();
        assert!(error.contains("planes[2].at"), "{error}");
    }
}
