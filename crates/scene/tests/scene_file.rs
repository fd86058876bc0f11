//! Tests scene files: which are read, which are refused, and with which message.

#![allow(
    clippy::float_cmp,
    reason = "numbers of the file must arrive as they are written"
)]

use etendue_field::{Light, Mask, Profile, Rectangle, Shape};
use etendue_scene::{Fault, Scene, SceneError, SceneFile, resolve};

const FIG9B: &str = include_str!("../../../scenes/fig9b.ron");

fn scene(text: &str) -> Result<Scene, SceneError> {
    resolve("test", SceneFile::parse(text)?, ".".as_ref(), u64::MAX)
}

fn faults(text: &str) -> Vec<Fault> {
    match scene(text) {
        Err(SceneError::Values(faults)) => faults,
        other => panic!("expected faults of value, got {other:?}"),
    }
}

/// The scene file fig9b with `from` replaced by `to`; `from` must occur in the file.
fn edited(from: &str, to: &str) -> String {
    assert!(FIG9B.contains(from), "{from} is not in the scene");
    FIG9B.replacen(from, to, 1)
}

/// The rectangles of the scene's first layer of blockers.
fn squares_of(scene: &Scene) -> Vec<Rectangle> {
    let Mask::Opaque { shapes, .. } = &scene.blockers[0].mask else {
        panic!("the layer is opaque");
    };
    shapes.iter().map(Shape::bounds).collect()
}

#[test]
fn fig9b_resolves_to_what_it_says() {
    let scene = scene(FIG9B).unwrap();
    let distances: Vec<f64> = scene.planes.iter().map(|p| p.distance).collect();
    assert_eq!(distances, [0.0, 1.0, 1.0, 2.0, 2.0]);
    assert_eq!(scene.path.first_hit(), 2.0);
    assert_eq!(squares_of(&scene).len(), 400);
    assert_eq!(scene.planes[0].grid.full_shape(), [8, 33, 65]);
}

#[test]
fn jitter_keeps_squares_apart_and_follows_its_seed() {
    let squares = |seed: &str| {
        let text =
            edited("jitter: 0.3, //", "jitter: 0.4, //").replace("seed: 1,\n        )", seed);
        squares_of(&scene(&text).unwrap())
    };
    let (a, b) = (squares("seed: 1)"), squares("seed: 2)"));
    assert_ne!(a, b);
    for (i, p) in a.iter().enumerate() {
        for q in &a[..i] {
            let apart = (0..2).any(|k| (p.center[k] - q.center[k]).abs() >= 0.12 - 1e-12); // rounding
            assert!(apart, "{p:?} overlaps {q:?}");
        }
    }
}

/// If a scene is moved and rotated in the world, the experiment does not change.
#[test]
fn rotation_of_the_world_changes_nothing() {
    let turned = FIG9B
        .replace("center: (0, 0, 0)", "center: (1, 2, 3)")
        .replace("center: (0, 0, 1)", "center: (2, 2, 3)")
        .replace("center: (0, 0, 2)", "center: (3, 2, 3)")
        .replace(
            "direction: (0, 0, 1), x_axis: (1, 0, 0)",
            "direction: (5, 0, 0), x_axis: (1, 1, 0)",
        );
    let (a, b) = (scene(FIG9B).unwrap(), scene(&turned).unwrap());
    assert_eq!(a.blockers, b.blockers);
    assert_eq!(a.path.first_hit(), b.path.first_hit());
    assert_eq!(b.planes[3].frame.origin.to_array(), [3.0, 2.0, 3.0]);
}

#[test]
fn faults_are_reported_together_with_field_value_and_range() {
    let text = edited("fill: 0.6, ", "fill: -1, ")
        .replace("albedo: 0.5", "albedo: NaN")
        .replace("size: (0.2, 0.2)", "size: (0.2, inf)")
        .replace("photons: 8_388_608", "photons: 3");
    let fields: Vec<String> = faults(&text).into_iter().map(|f| f.field).collect();
    for field in [
        "light.size[1]",
        "surfaces[0].albedo",
        "blockers[0].fill",
        "run.photons",
    ] {
        assert!(
            fields.iter().any(|f| f == field),
            "{field} not in {fields:?}"
        );
    }
}

#[test]
fn a_number_beyond_its_range_is_told_with_it() {
    let smooth = |form: &str| {
        let floor = "Smooth(name: \"floor\", center: (0, 0, 2), facing: (0, 0, -1), aperture: 3, event: Mirror,";
        FIG9B.replace(
            "Rectangle(name: \"floor\", center: (0, 0, 2), size: (6, 6), albedo: 0.5",
            &format!("{floor} form: {form}"),
        )
    };
    for (text, told) in [
        (
            edited("center: (0, 0, 1)", "center: (0, -inf, 1)"),
            "blockers[0].center[1] is -inf; allowed: -1e9 to 1e9",
        ),
        (
            edited("batches: 64", "batches: 31"),
            "run.batches is 31; allowed: 32 to 1024: errors are estimated from the spread between batches",
        ),
        (
            edited("rho: (max: 16)", "rho: (max: 16, spacing: NaN)"),
            "frequencies.rho.spacing is NaN; allowed: 1e-9 to 1e9",
        ),
        (
            smooth("Sphere(-2e6)"),
            "surfaces[0].form is -2e6; allowed: -1e6 to 1e6",
        ),
        (
            smooth("Paraboloid(0, 3e6)"),
            "surfaces[0].form[1] is 3e6; allowed: -1e6 to 1e6",
        ),
    ] {
        let told_all: Vec<String> = faults(&text).iter().map(ToString::to_string).collect();
        assert!(
            told_all.iter().any(|fault| fault == told),
            "{told}: {told_all:?}"
        );
    }
}

#[test]
fn each_bad_value_is_named() {
    for (from, to, field) in [
        ("at: Emission", "at: Distance(-0.5)", "planes[0].at"),
        ("at: Emission", "at: Distance(4.5)", "planes[0].at"),
        ("at: Emission", "at: Distance(1)", "planes[0].at"),
        ("at: Emission", "at: Distance(NaN)", "planes[0].at"),
        ("Before(\"floor\")", "Before(\"roof\")", "planes[3].at"),
        ("visits: [\"floor\"]", "visits: []", "path.visits"),
        (
            "visits: [\"floor\"]",
            "visits: [\"blockers\"]",
            "path.visits[0]",
        ),
        (
            "x_axis: (1, 0, 0)",
            "x_axis: (0, 0, 2)",
            "path.direction and path.x_axis",
        ),
        (
            "center: (0, 0, 1)",
            "center: (0, 0, 3)",
            "blockers[0].center",
        ),
        (
            "center: (0, 0, 1)",
            "center: (0, 0, -1)",
            "blockers[0].center",
        ),
        ("center: (0, 0, 2)", "center: (9, 0, 2)", "path.visits[0]"),
        ("count: (20, 20)", "count: (0, 20)", "blockers[0].count"),
        ("jitter: 0.3", "jitter: 0.5", "blockers[0].jitter"),
        ("x: Hann(0.5)", "x: Hann(0)", "window.x"),
        (
            "rho: (max: 16)",
            "rho: (max: 16, spacing: 2)",
            "frequencies.rho.spacing",
        ),
        ("rho: (max: 16)", "rho: (max: -1)", "frequencies.rho.max"),
        ("rho: (max: 16)", "rho: (max: 1e300)", "frequencies.rho.max"),
        ("azimuths: 8", "azimuths: 0", "frequencies.azimuths"),
        ("name: \"light\"", "name: \"../light\"", "planes[0].name"),
        ("name: \"light\"", "name: \"receiver\"", "planes[3].name"),
        ("alpha: 0.01", "alpha: 0", "run.alpha"),
        ("alpha: 0.01", "alpha: 1e-4", "run.alpha"),
        ("batches: 64", "batches: 8", "run.batches"),
    ] {
        let found = faults(&edited(from, to));
        assert!(found.iter().any(|f| f.field == field), "{to}: {found:?}");
    }
}

#[test]
fn syntax_faults_say_where_and_what_is_allowed() {
    for (text, parts) in [
        (
            edited("pitch: 0.2", "pich: 0.2"),
            vec!["line 11", "pich", "pitch"],
        ),
        (edited("fill: 0.6", "fill: \"much\""), vec!["line 12"]),
        (edited("Hann(0.5)", "Han(0.5)"), vec!["Han", "Hann"]),
        (FIG9B[..500].to_owned(), vec!["line", "column"]),
    ] {
        let message = scene(&text).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{part} not in: {message}");
        }
    }
}

#[test]
fn a_grid_larger_than_memory_says_how_large() {
    let file = SceneFile::parse(&edited("rho: (max: 16)", "rho: (max: 1e6)")).unwrap();
    match resolve("test", file, ".".as_ref(), 24_000_000_000) {
        Err(SceneError::Values(faults)) => {
            assert!(faults.iter().all(|f| f.memory), "{faults:?}");
            assert!(faults[0].value.contains("7.6 TB"), "{faults:?}");
        }
        other => panic!("{other:?}"),
    }
}

/// A value on the command line has the notation of a file, lists of variants included.
#[test]
fn lists_are_set_as_they_are_written() {
    let fields = [
        ("light", "Point(center: (0, 0, 0))"),
        ("other_lights", "[]"),
        ("blockers", "[]"),
    ];
    let written = |path: &str, value: &str| {
        let of = |(name, default): &(&str, &str)| {
            let value = if *name == path { value } else { default };
            format!("{name}: {value},")
        };
        SceneFile::parse(&format!(
            "({} path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: []), planes: [],
            window: (x: Hann(1), u: Hann(1)), frequencies: (rho: (max: 4), nu: (max: 4)))",
            fields.iter().map(of).collect::<String>()
        ))
        .unwrap()
    };
    let file = written("", "");
    for (path, value) in [
        (
            "other_lights",
            "[Disc(center: (0.5, 0, 0), radius: 0.1), Point(center: (0, 0, 0))]",
        ),
        (
            "light",
            "Environment(center: (0, 0, 0), map: Lobes([(from: (0, 1, -1), width: 0.3), (from: (0, 0, -1), width: 1)]))",
        ),
        (
            "blockers",
            r#"[Shapes(name: "a", center: (0, 0, 1), shapes: [HalfPlane(axis: X, edge: 0.5, opaque: Above), Disc(center: (0, 0), radius: 1)])]"#,
        ),
    ] {
        let set = file.clone().with(path, value).unwrap();
        assert_eq!(set, written(path, value), "{value}");
        assert_ne!(set, file);
    }
    for bad in ["[Disc(center: (0, 0, 0), radius: 0.1)", "[[[[", "[Disc(]"] {
        assert!(file.clone().with("other_lights", bad).is_err(), "{bad}");
    }
}

#[test]
fn overrides_reach_every_kind_of_field() {
    let file = SceneFile::parse(FIG9B).unwrap();
    let set = |path: &str, value: &str| file.clone().with(path, value);
    let scene = |path: &str, value: &str| {
        resolve("test", set(path, value).unwrap(), ".".as_ref(), u64::MAX).unwrap()
    };
    assert_eq!(scene("run.photons", "1e6").run.photons, 1_000_000);
    let area = |path: &str, value: &str| match scene(path, value).light {
        Light::Area {
            shape, radiance, ..
        } => (shape, radiance),
        other => panic!("an area light became {other:?}"),
    };
    assert_eq!(area("light.radiance", "2").1, 2.0);
    // A field is named as in `--set`, or as in messages.
    for path in ["blockers.0.count.1", "blockers[0].count[1]"] {
        assert_eq!(squares_of(&scene(path, "3")).len(), 60);
    }
    assert_eq!(
        scene("frequencies.rho.spacing", "0.5").planes[0]
            .grid
            .rho
            .half,
        32
    );
    assert_eq!(
        scene("planes.3.at", "Distance(1.5)").planes[3].distance,
        1.5
    );
    assert_eq!(
        scene("planes.3.at", "After(blockers)").planes[3].distance,
        1.0
    );
    assert_eq!(area("light.size", "(0.3, 0.1)").0.bounds().size, [0.3, 0.1]);
    let gaussian = Profile::Gaussian {
        width: 0.2,
        cut: 0.4,
    };
    assert_eq!(
        scene("window.x", "Gaussian(width: 0.2, cut: 0.4)").planes[0]
            .window
            .x,
        gaussian
    );
    for (path, value, part) in [
        ("run.photon", "3", "photons"),
        ("planes.9.name", "a", "0 to 4"),
        ("planes[9].name", "a", "0 to 4"),
        ("run.photons", "many", "invalid type"),
        ("window.x.Box", "0.2", "allowed: Hann, or the whole item"),
        ("description.a", "b", "nothing: a value has no fields"),
    ] {
        let message = set(path, value).unwrap_err().to_string();
        assert!(message.contains(part), "{part} not in: {message}");
    }
}
