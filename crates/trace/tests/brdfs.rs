//! Tests surfaces with BRDFs in three ways: photons aimed at the windows, photons emitted and
//! reflected without aiming, and backward rays.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::estimates;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Backward, Tracer};

/// A test case: the name of a scene, its surfaces, its path and its planes.
type Case = (&'static str, &'static str, &'static str, &'static str);

/// All kinds of virtual planes on one surface.
const ON_IT: &str = r#"(name: "incidence", at: Before("it"), orientation: Tangent), (name: "curvature", at: Before("it"), orientation: LocalNormals),
    (name: "mirrored", at: Before("it"), orientation: Mirrored), (name: "reflected", at: After("it"), orientation: LocalNormals),
    (name: "back", at: After("it"), orientation: Tangent, quantity: DifferentialIrradiance),
    (name: "outgoing", at: After("it")), (name: "beyond", at: Distance(1.5))"#;

const CASES: &[Case] = &[
    (
        "a GGX sphere at 37 degrees",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.605186406, 0, -0.796083799), form: Sphere(0.8), aperture: 0.5,
            event: Reflects(brdf: (lobe: Ggx(0.2), fresnel: Conductor(n: 0.96, k: 6.69))))"#,
        r#"visits: ["it"]"#,
        ON_IT,
    ),
    (
        "a Phong plane, two lobes on a checkerboard",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: Plane, aperture: 0.6, along: (0.4, 1, 0.3),
            event: Reflects(brdf: (lobe: Phong(40)), other: (lobe: Phong(8), albedo: 0.5), blend: Checkerboard(0.22)))"#,
        r#"visits: ["it"]"#,
        ON_IT,
    ),
    (
        "a textured Lambertian sphere",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.5, 0.2, -0.8), form: Sphere(1.5), aperture: 0.35,
            event: Reflects(brdf: (lobe: Lambertian, albedo: 0.9, fresnel: Dielectric(1.5)),
            texture: Cosine(axis: Y, frequency: 4, modulation: 0.8, phase: 1)))"#,
        r#"visits: ["it"], leaves: (0.7, 0.1, -0.8)"#,
        ON_IT,
    ),
    (
        "a Beckmann paraboloid, looked at from outside of the plane of incidence",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: Paraboloid(0.7, -0.5), aperture: 0.5,
            event: Reflects(brdf: (lobe: Beckmann(0.4), albedo: 0.8)))"#,
        r#"visits: ["it"], leaves: (0.7, 0.5, -0.4)"#,
        ON_IT,
    ),
    (
        "glass near grazing",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.966, 0, -0.259), form: Cylinder(0.1), aperture: 1.5,
            event: Reflects(brdf: (lobe: Ggx(0.15), fresnel: Dielectric(1.5))))"#,
        r#"visits: ["it"]"#,
        ON_IT,
    ),
    (
        "a narrow lobe in a bowl that hides a part of itself",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.8, 0, -0.6), form: Sphere(-1.6), aperture: 0.5,
            event: Reflects(brdf: (lobe: Beckmann(0.02))))"#,
        r#"visits: ["it"]"#,
        ON_IT,
    ),
    (
        "a mirror, a sphere with a broad lobe and a plane with a sharp one",
        r#"Smooth(name: "mirror", center: (0, 0, 0.8), facing: (0.6, 0, -0.8), form: Plane, aperture: 0.4, event: Mirror),
           Smooth(name: "broad", center: (0.768, 0, 0.576), facing: (-0.82, 0.93, 0.61), form: Sphere(0.5), aperture: 0.4,
            event: Reflects(brdf: (lobe: Ggx(0.5), albedo: 0.9))),
           Smooth(name: "sharp", center: (0.9, 0.9, 0.9), facing: (-1, -0.93, 0.17), form: Plane, aperture: 0.4,
            event: Reflects(brdf: (lobe: Phong(20))))"#,
        r#"visits: ["mirror", "broad", "sharp"]"#,
        r#"(name: "a", at: Before("broad"), orientation: LocalNormals), (name: "b", at: After("broad")),
           (name: "c", at: Before("sharp"), orientation: Tangent), (name: "d", at: After("sharp"), orientation: Tangent)"#,
    ),
    (
        "a floor that a glossy plane lights",
        r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: Plane, aperture: 0.5,
            event: Reflects(brdf: (lobe: Beckmann(0.3), fresnel: Dielectric(1.8)))),
           Rectangle(name: "floor", center: (0.768, 0, 0.776), size: (1, 1), facing: (-1, 0, 0.1), albedo: 0.5)"#,
        r#"visits: ["it", "floor"]"#,
        r#"(name: "a", at: After("it")), (name: "b", at: Before("floor")), (name: "c", at: After("floor"))"#,
    ),
    (
        "a wall, and a patch that it lights",
        r#"Rectangle(name: "wall", center: (0, 0, 1), size: (1, 1), facing: (0.6, 0, -0.8), albedo: 0.8),
           Smooth(name: "it", center: (0.8, 0, 0.4), facing: (-0.6, 0.1, 0.3), form: Sphere(0.4), aperture: 0.5,
            event: Reflects(brdf: (lobe: Ggx(0.3))))"#,
        r#"visits: ["wall", "it"], leaves: (-0.9, 0.1, -0.2)"#,
        r#"(name: "a", at: Before("it"), orientation: LocalNormals), (name: "b", at: After("it"), orientation: LocalNormals), (name: "c", at: After("it"))"#,
    ),
];

fn scene((_, surfaces, path, planes): &Case, emission: &str, photons: u32, seed: u32) -> Scene {
    // Angles to the normal stay well below 90 degrees, because the variance of the weights of
    // plain photons is infinite at 90 degrees.
    let u = if surfaces.contains("0.966") { 0.2 } else { 0.4 };
    let text = format!(
        r#"(
            light: Rectangle(center: (0, 0, 0), size: (0.3, 0.25), radiance: 2),
            surfaces: [{surfaces}],
            path: (direction: (0, 0, 1), x_axis: (1, 0.2, 0), {path}),
            planes: [{planes}],
            window: (x: Hann(0.25), y: Hann(0.2), u: Hann({u}), v: Hann(0.35)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: {photons}, emission: {emission}, seed: {seed}),
        )"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn all_ways_agree_behind_one_surface() {
    all_ways_agree(&CASES[..4]);
}

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn all_ways_agree_at_grazing_and_behind_several_surfaces() {
    all_ways_agree(&CASES[4..]);
}

fn all_ways_agree(cases: &[Case]) {
    let mut tests = 0;
    for case in cases {
        let aimed = scene(case, "Aimed", 1_000_000, 1);
        let plain = scene(case, "Plain", 1_600_000, 2);
        let (backward, _) = estimates(&Backward::new(&aimed).unwrap(), &aimed);
        let (photons, ledger) = estimates(&Tracer::new(&aimed), &aimed);
        // The tolerance is the rounding error of some 10^5 additions.
        assert!(ledger.imbalance().abs() < 1e-12, "{}: {ledger:?}", case.0);
        let (plain, ledger) = estimates(&Tracer::new(&plain), &plain);
        assert!(ledger.imbalance().abs() < 1e-12, "{}: {ledger:?}", case.0); // as above
        for (way, other) in [("aimed", &photons), ("plain", &plain)] {
            for (plane, (a, b)) in backward.iter().zip(other).enumerate() {
                let at = format!("{}: {way} at {}", case.0, aimed.planes[plane].name);
                for (a, b) in a.iter().zip(b) {
                    let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                    tests += 1;
                    // In one of 500 runs, at least one of some 300 tests exceeds 4.5 standard
                    // errors by chance.
                    assert!(z.abs() < 4.5, "{at}: {a:?} and {b:?}");
                }
                let most = if way == "aimed" { 0.04 } else { 0.3 };
                assert!(b[0][1] < most * b[0][0], "{at}: {b:?} is too noisy");
                assert!(a[0][1] < 0.03 * a[0][0], "{at}: {a:?} is too noisy");
            }
        }
    }
    assert!(tests > 120, "{tests} tests");
}

/// The light that leaves a mirror is the arriving light, rotated about the normals.
#[test]
fn mirrored_light_is_what_a_mirror_sends_on() {
    let surface = r#"Smooth(name: "it", center: (0, 0, 1), facing: (0.605, 0.1, -0.796), form: Sphere(0.8), aperture: 0.5, event: Mirror)"#;
    let planes = r#"(name: "a", at: Before("it"), orientation: Mirrored), (name: "b", at: After("it"), orientation: LocalNormals)"#;
    let case = ("mirror", surface, r#"visits: ["it"]"#, planes);
    let scene = scene(&case, "Aimed", 100_000, 1);
    let (photons, _) = estimates(&Tracer::new(&scene), &scene);
    for (a, b) in photons[0].iter().zip(&photons[1]) {
        // The photons at the two planes are the same, so the difference between the estimates is
        // rounding error.
        assert!(
            (a[0] - b[0]).abs() < 1e-9 * photons[0][0][0],
            "{a:?} and {b:?}"
        );
    }
}

/// A beam hits a rough plane. The ratio of leaving to arriving flux is the directional albedo,
/// which is known from a separate quadrature.
#[test]
fn exitant_over_incident_flux_is_the_directional_albedo() {
    // The albedos are ∫ f cos θ dω of GGX with α = 0.5, by Gauss-Legendre over cos θ and equal
    // steps in azimuth, converged to 7 digits.
    for (angle, albedo) in [(0.6_f64, 0.680_308_7), (1.2, 0.702_574_3)] {
        let (sin, cos) = angle.sin_cos();
        let text = format!(
            r#"(
                light: Beam(center: (0, 0, 0), image: (width: (0.05, 0.05))),
                surfaces: [Smooth(name: "it", center: (0, 0, 1), facing: ({sin}, 0, -{cos}), form: Plane, aperture: 3, event: Reflects(brdf: (lobe: Ggx(0.5))))],
                path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["it"], leaves: ({sin}, 0, -{cos})),
                planes: [
                    (name: "incident", at: Before("it"), orientation: Tangent, quantity: DifferentialIrradiance),
                    (name: "exitant", at: After("it"), orientation: Tangent, quantity: DifferentialIrradiance),
                ],
                window: (x: Box(2), u: Box(1.5707963)),
                frequencies: (rho: (max: 4), nu: (max: 4)),
                run: (photons: 400_000),
            )"#
        );
        let file = SceneFile::parse(&text).unwrap();
        let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
        let (photons, _) = estimates(&Tracer::new(&scene), &scene);
        let [incident, exitant] = [0, 1].map(|i| photons[i][0]);
        let error = exitant[1] / incident[0];
        let found = exitant[0] / incident[0];
        // Four standard errors.
        assert!(
            (found - albedo).abs() < 4.0 * error,
            "{found} ± {error}, {albedo}"
        );
        assert!(error < 3e-3, "{error} resolves nothing");
    }
}

/// The forward and the backward tracer agree on the sphere of table 1, an example scene of this
/// repository.
#[test]
fn both_ways_agree_on_the_sphere_of_table_1() {
    let file = SceneFile::parse(include_str!("../../../scenes/table1/ggx_sphere.ron")).unwrap();
    let file = file.with("run.photons", "300000").unwrap();
    let scene = resolve("test", file, ".".as_ref(), u64::MAX).unwrap();
    let (backward, _) = estimates(&Backward::new(&scene).unwrap(), &scene);
    let (photons, ledger) = estimates(&Tracer::new(&scene), &scene);
    // The tolerance is the rounding error of some 10^5 additions.
    assert!(ledger.imbalance().abs() < 1e-12, "{ledger:?}");
    for (plane, (a, b)) in backward.iter().zip(&photons).enumerate() {
        let name = &scene.planes[plane].name;
        for (a, b) in a.iter().zip(b) {
            let z = (a[0] - b[0]) / a[1].hypot(b[1]);
            // In one of 700 runs, at least one of 21 tests exceeds 4 standard errors by chance.
            assert!(z.abs() < 4.0, "{name}: {a:?} and {b:?}");
        }
        assert!(b[0][1] < 0.02 * b[0][0], "{name}: {b:?} is too noisy");
    }
}
