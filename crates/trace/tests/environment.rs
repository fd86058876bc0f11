//! Tests light from environments: compares aimed photons, plain photons and backward rays with
//! each other, and with known integrals.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::estimates;
use etendue_field::LatLong;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Backward, Tracer};
use exr::prelude::{SpecificChannels, WritableImage};
use std::f64::consts::{PI, TAU};
use std::path::Path;

const BLOB: &str = "Environment(center: (0, 0, 0), map: Lobes([(from: (0.05, 0.02, -1), width: 0.15, radiance: 3)]))";
const ASIDE: &str = "Environment(center: (0, 0, 0), map: Lobes([
    (from: (0.5, 0.2, -1), width: 0.2, radiance: 3), (from: (-0.2, 0.1, -1), width: 0.4)]))";
const BEHIND: &str =
    "Environment(center: (0, 0, 0), map: Lobes([(from: (0, 0.1, 1), width: 0.4, radiance: 3)]))";
const WALL: &str = r#"Rectangle(name: "wall", center: (0, 0, 2), size: (2.4, 2), albedo: 0.7)"#;
const TILTED: &str = r#"Rectangle(name: "wall", center: (0, 0, 2), size: (2.4, 2), facing: (0.5, 0.2, -1), albedo: 0.7)"#;
const PLANES: &str = r#"(name: "start", at: Emission), (name: "middle", at: Distance(0.8)), (name: "arrival", at: Before("wall")),
    (name: "leaving", at: After("wall")), (name: "back", at: Distance(2.4)),"#;

struct Bench<'a> {
    light: &'a str,
    blockers: &'a str,
    surfaces: &'a str,
    visits: &'a [&'a str],
    planes: &'a str,
    folder: &'a Path,
}

impl Default for Bench<'_> {
    fn default() -> Self {
        Self {
            light: BLOB,
            blockers: "",
            surfaces: WALL,
            visits: &["wall"],
            planes: PLANES,
            folder: Path::new("."),
        }
    }
}

impl Bench<'_> {
    fn scene(&self, emission: &str, photons: u32) -> Scene {
        let Self {
            light,
            blockers,
            surfaces,
            visits,
            planes,
            folder,
        } = self;
        let text = format!(
            r#"(
                light: {light},
                blockers: [{blockers}],
                surfaces: [{surfaces}],
                path: (direction: (0, 0, 1), x_axis: (1, 0.2, 0), visits: {visits:?}),
                planes: [{planes}],
                window: (x: Hann(0.4), y: Box(0.3), u: Hann(0.5), v: Hann(0.4)),
                frequencies: (rho: (max: 4), nu: (max: 4)),
                run: (photons: {photons}, emission: {emission}),
            )"#
        );
        resolve("test", SceneFile::parse(&text).unwrap(), folder, u64::MAX).unwrap()
    }

    /// Compares aimed photons, plain photons and backward rays at each virtual plane; returns the
    /// number of tests.
    fn agrees(&self, what: &str) -> usize {
        let aimed = self.scene("Aimed", 600_000);
        let plain = self.scene("Plain", 2_000_000);
        let (photons, ledger) = estimates(&Tracer::new(&aimed), &aimed);
        // The tolerance is the rounding error of some 10^5 additions.
        assert!(ledger.imbalance().abs() < 1e-12, "{what}: {ledger:?}");
        let (plain, ledger) = estimates(&Tracer::new(&plain), &plain);
        assert!(ledger.imbalance().abs() < 1e-12, "{what}: {ledger:?}"); // likewise
        let (backward, _) = estimates(&Backward::new(&aimed).unwrap(), &aimed);
        let mut tests = 0;
        for (way, other) in [("plain", &plain), ("backward", &backward)] {
            for (plane, (a, b)) in photons.iter().zip(other).enumerate() {
                let name = &aimed.planes[plane].name;
                let most = if way == "plain" { 0.1 } else { 0.03 };
                assert!(
                    b[0][1] < most * b[0][0] && a[0][1] < 0.03 * a[0][0],
                    "{what}: {name}: {a:?} or {way} {b:?} is too noisy"
                );
                for (a, b) in a.iter().zip(b) {
                    let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                    tests += 1;
                    // In one of 300 runs, at least one of some 200 tests exceeds 4.3 standard
                    // errors by chance.
                    assert!(z.abs() < 4.3, "{what}: {way} at {name}: {a:?} and {b:?}");
                }
            }
        }
        tests
    }
}

/// Writes a map of 24 × 12 pixels to a file; one pixel is bright and all others are faint.
fn write_map(folder: &Path, name: &str, bright: (usize, usize)) {
    let map = LatLong::from_fn(24, 12, |d| 0.1 + 0.05 * d.y);
    #[expect(clippy::cast_possible_truncation, reason = "what the file holds")]
    let pixel = |at: exr::math::Vec2<usize>| {
        let faint = map.raster().values()[at.1 * 24 + at.0] as f32;
        (if (at.0, at.1) == bright { 5.0 } else { faint },)
    };
    let channels = SpecificChannels::build()
        .with_channel("Y")
        .with_pixel_fn(pixel);
    let image = exr::prelude::Image::from_channels((24, 12), channels);
    image.write().to_file(folder.join(name)).unwrap();
}

/// Shifting the picture by a pixel changes the light, and rotating the axes back undoes the change.
#[test]
fn a_map_is_where_its_axes_put_it() {
    let folder = tempfile::tempdir().unwrap();
    write_map(folder.path(), "sky.exr", (0, 1));
    write_map(folder.path(), "turned.exr", (1, 1));
    // In a map, longitude grows to the left, and the longitude π/2 is along up × front.
    let (sin, cos) = (TAU / 24.0).sin_cos();
    let turned_back = format!("({sin}, {cos}, 0)");
    let found = [
        ("sky.exr", "(0, 1, 0)"),
        ("turned.exr", "(0, 1, 0)"),
        ("turned.exr", &turned_back),
    ]
    .map(|(file, front)| {
        let light = format!(
            r#"Environment(center: (0, 0, 0), up: (0, 0, -1), front: {front}, map: File("{file}"))"#
        );
        let bench = Bench {
            light: &light,
            folder: folder.path(),
            ..Bench::default()
        };
        let scene = bench.scene("Aimed", 300_000);
        estimates(&Tracer::new(&scene), &scene).0[1]
    });
    let differs = |a: usize, b: usize| {
        let pairs = found[a].iter().zip(&found[b]);
        let z = pairs.map(|(a, b)| (a[0] - b[0]).abs() / a[1].hypot(b[1]));
        z.fold(0.0, f64::max)
    };
    // Two estimates are different if their difference exceeds six standard errors. They are equal
    // if it is below four standard errors; the estimates that should be equal share their random
    // numbers. The faint pixels around the pole are equal.
    assert!(differs(0, 1) > 6.0, "{}: {found:?}", differs(0, 1));
    assert!(differs(0, 2) < 4.0, "{}: {found:?}", differs(0, 2));
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn all_ways_agree() {
    let folder = tempfile::tempdir().unwrap();
    write_map(folder.path(), "sky.exr", (0, 1));
    let map = r#"Environment(center: (0, 0, 0), up: (0.2, 0.1, -1), front: (0, 1, 0), map: File("sky.exr"))"#;
    let blockers = r#"Shapes(name: "half", center: (0, 0, 1), shapes: [HalfPlane(axis: X, edge: -0.1, opaque: Below)]),
        Grating(name: "grating", center: (0, 0, 1.5), axis: Y, frequency: 2, modulation: 0.8)"#;
    let mirror = r#"Smooth(name: "mirror", center: (0, 0, 1.5), facing: (0.3, 0.1, -1), form: Sphere(-0.5), aperture: 0.5, event: Mirror)"#;
    let mesh = r#"Mesh(name: "mirror", center: (0.1, 0, 1.5), mesh: Paraboloid(curvatures: (-0.3, 0.2), half: 0.7, cells: 7), event: Mirror)"#;
    let small =
        r#"Rectangle(name: "wall", center: (0, 0, 2), size: (0.3, 0.4), facing: (0.5, 0.2, -1))"#;
    let on_small = r#"(name: "on", at: Before("wall"), orientation: Tangent),
        (name: "narrow", at: Before("wall"), orientation: Mirrored, window: (x: Hann(0.1), u: Box(0.01)))"#;
    let off_mirror = r#"(name: "before", at: Before("mirror"), orientation: LocalNormals), (name: "tangent", at: Before("mirror"), orientation: Tangent),
        (name: "after", at: After("mirror")), (name: "on", at: After("mirror"), orientation: LocalNormals), (name: "beyond", at: Distance(2.2))"#;
    let star = r#"Mesh(name: "wall", center: (0, 0, 2), mesh: Star(radius: 0.5, relief: 0.3, lobes: 4, rings: 30), albedo: 0.8)"#;
    let floor = r#"Rectangle(name: "wall", center: (0, 0, 2), size: (2.4, 2), facing: (1, 0.2, -1), albedo: 0.7),
        Rectangle(name: "floor", center: (1.5, 0.3, 1.6), size: (2, 2), facing: (-1, 0, 0.1), albedo: 0.5)"#;
    let on_floor = r#"(name: "leaving", at: After("wall")), (name: "arriving", at: Before("floor")), (name: "last", at: After("floor"))"#;
    let default = Bench::default;
    let mut tests = 0;
    for (what, bench) in [
        ("a wall", default()),
        (
            "an oblique wall",
            Bench {
                light: ASIDE,
                surfaces: TILTED,
                ..default()
            },
        ),
        (
            "blockers",
            Bench {
                light: ASIDE,
                blockers,
                ..default()
            },
        ),
        (
            "what is left of light that goes back, by a mesh",
            Bench {
                light: BEHIND,
                surfaces: mesh,
                visits: &["mirror"],
                planes: "(name: \"after\", at: After(\"mirror\"))",
                ..default()
            },
        ),
        (
            "planes on a small wall, and beside it",
            Bench {
                light: ASIDE,
                surfaces: small,
                planes: on_small,
                ..default()
            },
        ),
        (
            "a hollow mirror",
            Bench {
                surfaces: mirror,
                visits: &["mirror"],
                planes: off_mirror,
                ..default()
            },
        ),
        (
            "a mesh",
            Bench {
                light: ASIDE,
                surfaces: star,
                ..default()
            },
        ),
        (
            "a bright pixel near the corner of a map",
            Bench {
                light: map,
                folder: folder.path(),
                ..default()
            },
        ),
        (
            "two walls",
            Bench {
                surfaces: floor,
                visits: &["wall", "floor"],
                planes: on_floor,
                ..default()
            },
        ),
    ] {
        tests += bench.agrees(what);
    }
    assert!(tests > 150, "{tests} tests");
}

/// Light that leaves a Lambertian wall has the radiance ρ E/π, so ∫ L W is ρ E/π times the
/// integral of the window W.
fn irradiance(light: &str) -> [[f64; 2]; 2] {
    let planes = r#"(name: "leaving", at: After("wall"), window: (x: Hann(0.4), u: Hann(0.4)))"#;
    let bench = Bench {
        light,
        planes,
        ..Bench::default()
    };
    let scene = bench.scene("Aimed", 400_000);
    // The integral of the Hann windows in x, y, u and v.
    let window = 0.4_f64.powi(4);
    let found = [
        estimates(&Tracer::new(&scene), &scene).0,
        estimates(&Backward::new(&scene).unwrap(), &scene).0,
    ];
    found.map(|planes| planes[0][0].map(|value| value * PI / (0.7 * window)))
}

#[test]
fn even_light_gives_a_wall_pi_times_its_radiance() {
    // The radiance of the light is uniform to a millionth.
    let even = "Environment(center: (0, 0, 0), map: Lobes([(from: (1, 2, -1), width: 1000, radiance: 1.5)]))";
    for [found, error] in irradiance(even) {
        assert!(error < 5e-3 * found, "{found} ± {error}");
        // Four standard errors.
        assert!((found - 1.5 * PI).abs() < 4.0 * error, "{found} ± {error}");
    }
}

#[test]
fn a_lobe_gives_a_wall_what_a_plain_sum_says() {
    let lobe = "Environment(center: (0, 0, 0), map: Lobes([(from: (2, 0, -1), width: 0.5, radiance: 1.5)]))";
    let axis = [2.0 / 5.0_f64.sqrt(), 1.0 / 5.0_f64.sqrt()];
    let n = 400;
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let [t, longitude] = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            let (polar, longitude) = (0.5 * PI * t, TAU * longitude);
            let cosine = axis[0] * polar.sin() * longitude.cos() + axis[1] * polar.cos();
            let radiance = 1.5 * ((cosine - 1.0) / 0.25).exp();
            sum += radiance * polar.cos() * polar.sin();
        }
    }
    sum *= 0.5 * PI * TAU / f64::from(n * n);
    for [found, error] in irradiance(lobe) {
        assert!(error < 5e-3 * found, "{found} ± {error}");
        // The tolerance is four standard errors. The relative error of the mid-point rule is
        // (step)²/24, 1e-6.
        assert!(
            (found - sum).abs() < 4.0 * error,
            "{found} ± {error}, {sum}"
        );
    }
}
