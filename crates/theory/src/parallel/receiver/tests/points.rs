//! Tests of irradiance at points, against the literature and against plain sums over the light.

use super::spectra::cube;
use super::*;
use std::f64::consts::PI;

/// The documented accuracy of irradiance, relative to the irradiance without blockers.
const CLOSE: f64 = 1e-12;

fn alone(light: Light, distance: f64) -> TestReceiver {
    TestReceiver {
        distance,
        ..TestReceiver::new(light, vec![])
    }
}

#[test]
fn square_seen_from_below_its_corner() {
    // The form factor of a unit square at the distance of one unit is 1/π · 1/√2 · arctan(1/√2) =
    // 0.1385 (Howell 1982, section B).
    let bench = alone(area(rectangle([0.5, 0.5], [1.0, 1.0]), 0.0), 1.0);
    let factor = bench.receiver().irradiance(0.0, 0.0) / (1.7 * PI);
    assert!((factor - 0.5_f64.sqrt() * 0.5_f64.sqrt().atan() / PI).abs() < CLOSE);
}

#[test]
fn disc_seen_from_anywhere() {
    // The form factor of a disc is F = ½ (1 − (Z − 2R²) / √(Z² − 4R²)), with R = radius / offset, H
    // = distance / offset, Z = 1 + H² + R² (Howell 1982, section B).
    for (radius, distance) in [(0.3, 2.0), (1.5, 1.0), (20.0, 0.5), (0.01, 3.0)] {
        let receiver = alone(area(disc([0.2, -0.1], radius), 0.0), distance);
        let receiver = receiver.receiver();
        let axis = receiver.irradiance(0.2, -0.1) / (1.7 * PI);
        let expected = radius * radius / (radius * radius + distance * distance);
        assert!((axis / expected - 1.0).abs() < CLOSE, "{radius} {axis}");
        for offset in [0.1, 0.4, 1.0, 3.0] {
            let (r2, h2) = ((radius / offset).powi(2), (distance / offset).powi(2));
            let z = 1.0 + h2 + r2;
            let root = (z * z - 4.0 * r2).sqrt();
            // With `root` = √(Z² − 4R²), the difference 1 − (Z − 2R²)/`root` is computed without
            // cancellation, because root² − (Z − 2R²)² = 4R²(Z − 1 − R²) = 4R²H².
            let expected = 2.0 * r2 * h2 / (root * (root + z - 2.0 * r2));
            let got = receiver.irradiance(0.2, -0.1 + offset) / (1.7 * PI);
            // The square root in F has a large rounding error next to the edge of a large disc.
            assert!(
                (got / expected - 1.0).abs() < 1e-11,
                "{radius} {offset}: {got} {expected}"
            );
        }
    }
}

#[test]
fn white_sky() {
    let wide = |half: f64| alone(area(rectangle([0.0, 0.0], [2.0 * half; 2]), 0.0), 1.0);
    for half in [1.0_f64, 10.0, 1e3, 1e6] {
        let c = libm::hypot(half, 1.0);
        let factor = 4.0 / PI * (half / c) * libm::atan(half / c);
        let got = wide(half).receiver().irradiance(0.0, 0.0);
        assert!((got / (1.7 * PI * factor) - 1.0).abs() < CLOSE);
    }
    let got = wide(1e6).receiver().irradiance(3.0, -2.0);
    assert!((got / (1.7 * PI) - 1.0).abs() < 1e-11); // the part beyond 10⁶ is missing: 1/half²
    let round = alone(area(disc([0.0, 0.0], 1e4), 0.0), 1.0);
    let got = round.receiver().irradiance(3.0, -2.0);
    assert!((got / (1.7 * PI) - 1.0).abs() < 2e-8); // 1/radius²
}

#[test]
fn what_a_receiver_of_albedo_one_gives_off_is_what_it_receives() {
    let bench = alone(area(rectangle([0.0; 2], [0.3; 2]), 0.0), 1.0);
    let mut receiver = bench.receiver();
    receiver.albedo = 1.0;
    // A sky that covers all slopes and has the radiance that leaves the receiver causes the same
    // irradiance as the lamp.
    let sky = Light::Area {
        shape: rectangle([0.0; 2], [2e6; 2]),
        radiance: receiver.exitance() * receiver.irradiance(0.1, 0.2),
        exponent: 0.0,
    };
    let off = alone(sky, 1.0).receiver().irradiance(0.0, 0.0);
    assert!((off / receiver.irradiance(0.1, 0.2) - 1.0).abs() < 1e-11); // the sky ends at 10⁶
}

#[test]
fn benches_against_sums_over_the_light() {
    const POINTS: u32 = 1_000_000;
    // The points are quasi-random, because in a regular grid all points next to a vertical edge
    // would contribute errors of the same sign.
    let spread: Vec<_> = cube(POINTS).map(|[s, t, ..]| [s, t]).collect();
    for (number, bench) in benches().iter().enumerate() {
        let receiver = bench.receiver();
        let Light::Area { shape, .. } = bench.light else {
            unreachable!("area lights only")
        };
        let bounds = shape.bounds();
        let open = alone(bench.light.clone(), bench.distance);
        for point in [[0.0, 0.0], [0.21, -0.13], [-0.3, 0.17]] {
            let at =
                |s: &[f64; 2]| [0, 1].map(|k| bounds.center[k] + bounds.size[k] * (s[k] - 0.5));
            let sum: f64 = spread.iter().map(|s| bench.added(at(s), point)).sum();
            let brute = sum * bounds.area() / f64::from(POINTS);
            let got = receiver.irradiance(point[0], point[1]);
            let all = open.receiver().irradiance(point[0], point[1]);
            let error = (got - brute).abs() / all;
            // The tolerance is ten times POINTS^(−3/4).
            assert!(error < 3e-4, "{number} {point:?}: {got} {brute} {error:e}");
        }
    }
}

#[test]
fn tiles_that_fill_the_plane_leave_nothing() {
    let tiles = |size: f64| {
        let at = (-6..=6).flat_map(|i| (-6..=6).map(move |j| (f64::from(i), f64::from(j))));
        at.map(|(i, j)| rectangle([size * i, size * (j + 0.3)], [size; 2]))
            .collect()
    };
    for exponent in [0.0, 5.0] {
        let bench = TestReceiver::new(
            area(disc([-0.1, 0.12], 0.4), exponent),
            vec![(1.0, opaque(tiles(0.11)))],
        );
        let open = alone(bench.light.clone(), bench.distance);
        for [x, y] in [[0.0, 0.0], [0.21, -0.13], [-0.3, 0.17]] {
            let share = bench.receiver().irradiance(x, y) / open.receiver().irradiance(x, y);
            assert!(share.abs() < CLOSE, "{share:e}");
        }
    }
}

#[test]
fn two_discs_meet_in_a_lens() {
    // Without the cosine the integral is the area in slopes, and the area of the intersection of
    // two discs is the sum of two circular segments.
    let light = area(disc([0.0, 0.0], 0.5), 0.0);
    let segment = |r: f64, x: f64| r * r * libm::acos(x / r) - x * (r * r - x * x).sqrt();
    for (offset, radius) in [
        (0.3, 0.2),
        (0.4, 0.35),
        (0.1, 0.2),
        (0.1, 0.7),
        (0.6, 0.3),
        (0.0, 0.25),
    ] {
        let mask = opaque(vec![disc([0.6 * offset, 0.8 * offset], radius)]);
        let layers = [MaskLayer {
            distance: 1.0,
            mask: &mask,
        }];
        let stopped = |layers: &[MaskLayer<'_>]| {
            Receiver::new(closed_form(&light).unwrap(), layers, 2.0, false, 0.0, 1.0)
                .irradiance(0.0, 0.0)
                / 1.7
        };
        let (r, s, d) = (0.25, radius, offset);
        let expected = if d >= r + s {
            0.0
        } else if d <= (r - s).abs() {
            PI * r.min(s).powi(2)
        } else {
            let x = (d * d + r * r - s * s) / (2.0 * d);
            segment(r, x) + segment(s, d - x)
        };
        let got = stopped(&[]) - stopped(&layers);
        assert!(
            (got - expected).abs() < CLOSE * PI * r * r,
            "{offset} {radius}: {got} {expected}"
        );
    }
}

#[test]
fn half_planes_are_very_large_rectangles() {
    let light = area(disc([0.0, 0.0], 0.5), 2.0);
    let half_planes = vec![
        HalfPlane {
            axis: 0,
            edge: -0.1,
            above: false,
        },
        HalfPlane {
            axis: 1,
            edge: 0.12,
            above: true,
        },
    ];
    let corner = Mask::Opaque {
        shapes: vec![],
        half_planes,
    };
    let far = 100.0;
    let left = rectangle([-0.1 - far, 0.0], [2.0 * far, 4.0 * far]);
    let above = rectangle([far - 0.1, 0.12 + far], [2.0 * far; 2]);
    let [a, b] = [corner, opaque(vec![left, above])]
        .map(|mask| TestReceiver::new(light.clone(), vec![(1.0, mask)]));
    for [x, y] in [[0.0, 0.0], [0.3, 0.2]] {
        let [a, b] = [&a, &b].map(|bench| bench.receiver().irradiance(x, y));
        assert!((a - b).abs() < CLOSE * b && a > 0.0, "{a} {b}");
    }
}

#[test]
fn point_light() {
    let mask = opaque(vec![
        rectangle([0.1, 0.0], [0.1, 0.1]),
        disc([-0.1, 0.1], 0.03),
    ]);
    let bench = TestReceiver::new(Light::Point { intensity: 3.0 }, vec![(0.5, mask)]);
    let receiver = bench.receiver();
    let lit = |x: f64, y: f64| {
        let r2 = 4.0 + x * x + y * y;
        3.0 * (2.0 / r2.sqrt()) / r2
    };
    assert!((receiver.irradiance(0.4, 0.3) / lit(0.4, 0.3) - 1.0).abs() < CLOSE);
    // The shadow is 4/3 as large as the mask.
    for (x, y, share) in [
        (4.0 / 30.0, 0.06, 0.0),
        (0.199, 0.0, 0.0),
        (0.201, 0.0, 1.0),
        (-0.134, 0.134, 0.0),
        (-0.134, 0.134 + 0.041, 1.0),
    ] {
        let got = receiver.irradiance(x, y);
        assert!((got - share * lit(x, y)).abs() < CLOSE, "{x} {y}: {got}");
    }
    // A cell that is centred on the edge of a shadow is half lit.
    let mean = receiver.cell([0.2, 0.0], [1e-3; 2]);
    assert!((mean / lit(0.2, 0.0) - 0.5).abs() < 1e-4); // the light varies this much over a cell
}

#[test]
fn a_hole_passes_what_its_shape_would_block() {
    let light = area(disc([0.05, 0.0], 0.5), 2.0);
    let wide = rectangle([-0.1, 0.1], [0.5, 0.3]);
    for shape in [wide, disc([0.1, -0.05], 0.3)] {
        for light in [light.clone(), Light::Point { intensity: 1.7 }] {
            let open = alone(light.clone(), 2.0);
            let [hole, blocker] = [aperture(shape), opaque(vec![shape])].map(|mask| {
                let bench = TestReceiver::new(light.clone(), vec![(1.0, mask)]);
                assert!((bench.distance - open.distance).abs() < f64::EPSILON);
                bench
            });
            for [x, y] in [[0.0, 0.0], [0.3, -0.4], [-0.9, 0.1]] {
                let [hole, blocker, open] =
                    [&hole, &blocker, &open].map(|bench| bench.receiver().irradiance(x, y));
                assert!(
                    (hole + blocker - open).abs() < CLOSE * open,
                    "{hole} {blocker} {open}"
                );
            }
        }
    }
}
