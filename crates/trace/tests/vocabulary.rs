//! Tests every kind of light, blocker and virtual plane: compares aimed photons, plain photons
//! and backward rays.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::estimates;
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Backward, Tracer};

/// A scene with a light, blockers, and virtual planes on both legs.
fn scene(light: &str, blockers: &str, emission: &str, photons: u32) -> Scene {
    let text = format!(
        r#"(
            light: {light},
            blockers: [{blockers}],
            surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6), albedo: 0.7)],
            path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
            planes: [
                (name: "middle", at: Distance(0.8)),
                (name: "arrival", at: Before("floor")),
                (name: "irradiance", at: Before("floor"), quantity: DifferentialIrradiance),
                (name: "leaving", at: After("floor")),
                (name: "back", at: Distance(2.4)),
            ],
            window: (x: Hann(0.6), y: Box(0.4), u: Hann(0.5), v: Hann(0.3)),
            frequencies: (rho: (max: 4), nu: (max: 4)),
            run: (photons: {photons}, emission: {emission}),
        )"#
    );
    let file = SceneFile::parse(&text).unwrap();
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

const SQUARE: &str = "Rectangle(center: (0, 0, 0), size: (0.3, 0.2), radiance: 2)";
const DISC: &str = "Disc(center: (0, 0, 0), radius: 0.25, radiance: 2)";
const SPOT: &str = "Spot(center: (0, 0, 0), bulb: Disc(0.2), radiance: 2, exponent: 12)";
const POINT: &str = "Point(center: (0, 0, 0), intensity: 0.5)";
const SHAPES: &str = r#"Shapes(name: "shapes", center: (0.1, 0, 1), shapes: [
    Rectangle(center: (-0.2, 0.1), size: (0.2, 0.1)),
    Disc(center: (0.1, 0), radius: 0.12),
    HalfPlane(axis: Y, edge: -0.25, opaque: Below),
])"#;
const GRATING: &str = r#"Grating(name: "grating", center: (0, 0, 1.2), axis: X, frequency: 3, modulation: 0.8, phase: 0.4)"#;
const MESH: &str = r#"Mesh(name: "mesh", center: (0.1, -0.1, 1.4), mesh: Star(radius: 0.2, relief: 0.3, lobes: 3, rings: 40))"#;

#[test]
#[ignore = "long: half a minute; .ci/long runs it"]
fn all_ways_agree() {
    let mut tests = 0;
    for light in [SQUARE, DISC, SPOT, POINT] {
        for blockers in [
            "".to_owned(),
            SHAPES.to_owned(),
            format!("{SHAPES}, {GRATING}"),
            MESH.to_owned(),
        ] {
            let of = format!("{light} behind [{blockers}]");
            let aimed = scene(light, &blockers, "Aimed", 400_000);
            let plain = scene(light, &blockers, "Plain", 1_500_000);
            let (reference, ledger) = estimates(&Tracer::new(&aimed), &aimed);
            // The tolerance is the rounding error of some 10^5 additions.
            assert!(ledger.imbalance().abs() < 1e-12, "{of}: {ledger:?}");
            let mut others = vec![("plain", estimates(&Tracer::new(&plain), &plain).0)];
            let backward = Backward::new(&aimed).unwrap();
            others.push(("backward", estimates(&backward, &aimed).0));
            for (way, other) in others {
                for (plane, (a, b)) in reference.iter().zip(&other).enumerate() {
                    assert!(
                        a[0][1] < 0.02 * a[0][0],
                        "{of}: plane {plane}: {a:?} is too noisy"
                    );
                    for (a, b) in a.iter().zip(b) {
                        let z = (a[0] - b[0]) / a[1].hypot(b[1]);
                        tests += 1;
                        // In one of 400 runs, at least one of some 400 tests exceeds 4.5 standard
                        // errors by chance.
                        assert!(
                            z.abs() < 4.5,
                            "{of}: {way} at plane {plane}: {a:?} and {b:?}"
                        );
                    }
                }
            }
        }
    }
    assert!(tests > 400, "{tests} tests");
}
