//! Tests of the fast transform against the plain sum.

use crate::random::{Random, boxed, grid, hann};
use etendue_field::{Complex, Crossing, SliceGrid, Slices, TwoPlane, Window};
use etendue_transform::{SliceTransform, direct};

/// The plans, each with the error bound that the documentation of `SliceTransform` states.
type Plan = (fn(&SliceGrid) -> SliceTransform, f64);
const PLANS: [Plan; 2] = [(SliceTransform::new, 2e-7), (SliceTransform::reduced, 2e-5)];

fn fast(plan: &SliceTransform, crossings: &[Crossing], window: &Window) -> Slices {
    let mut sum = plan.accumulator();
    for crossing in crossings {
        sum.deposit(&crossing.ray, crossing.weight * window.value(&crossing.ray));
    }
    sum.finish(1.0)
}

/// The largest difference over all frequencies, relative to Σ|w|.
fn error(a: &Slices, b: &Slices, crossings: &[Crossing], window: &Window) -> f64 {
    let differences = a.half.iter().zip(&b.half).map(|(a, b)| (a - b).norm());
    let largest = differences.fold(0.0, f64::max);
    let weight = |c: &Crossing| (c.weight * window.value(&c.ray)).abs();
    largest / crossings.iter().map(weight).sum::<f64>()
}

#[test]
fn the_transform_is_the_plain_sum() {
    let mut random = Random(1);
    for window in [hann(), boxed()] {
        for (azimuths, half, fineness) in [
            (8, [16, 32], 1.0),
            (8, [9, 7], 2.5),
            (3, [5, 12], 1.3),
            (1, [0, 1], 1.0),
            (5, [31, 16], 1.0),
        ] {
            let grid = grid(&window, azimuths, half, fineness);
            let many: Vec<_> = (0..1000).map(|_| random.crossing(&window, 1.0)).collect();
            // At the corners, x cos φ + y sin φ exceeds a period. There is only a single ray, so
            // errors do not average out.
            let corner = |sign: f64| Crossing {
                ray: TwoPlane {
                    x: 0.999_999 * window.x.half_width(),
                    y: 0.999 * sign * window.y.half_width(),
                    u: -0.999_999 * window.u.half_width(),
                    v: 0.99 * sign * window.v.half_width(),
                },
                weight: 1e9,
            };
            let sets = [
                many,
                vec![corner(1.0)],
                vec![corner(-1.0), random.crossing(&window, 0.5)],
            ];
            for crossings in sets {
                let plain = direct::slices(&crossings, |z| window.value(z), &grid);
                for (plan, bound) in PLANS {
                    let found = fast(&plan(&grid), &crossings, &window);
                    let error = error(&found, &plain, &crossings, &window);
                    assert!(error < bound, "{error} of {bound}");
                }
            }
        }
    }
}

#[test]
fn a_wrong_spacing_is_seen() {
    let window = hann();
    let right = grid(&window, 4, [8, 8], 1.0);
    let mut wrong = right;
    wrong.rho.spacing *= 1.0 + 1e-5;
    let mut random = Random(2);
    let crossings: Vec<_> = (0..100).map(|_| random.crossing(&window, 1.0)).collect();
    let plain = direct::slices(&crossings, |z| window.value(z), &wrong);
    // The phase error is 2π · 8 · 1e-5 · 0.3 periods, averaged over a hundred rays.
    let found = fast(&SliceTransform::new(&right), &crossings, &window);
    assert!(error(&found, &plain, &crossings, &window) > 3e-6);
}

/// With many rays of a light with extent, the error of reduced precision is far below its bound.
/// Half of the rays are weak, so most of their shares are below one whole number.
#[test]
fn errors_of_reduced_precision_average_out() {
    let window = hann();
    let grid = grid(&window, 2, [16, 32], 1.0);
    let mut random = Random(5);
    let crossings: Vec<_> = (0..60_000)
        .map(|i| {
            let crossing = random.crossing(&window, 1.0);
            let weight = crossing.weight * [1.0, 1e-6][i % 2];
            Crossing { weight, ..crossing }
        })
        .collect();
    let full = fast(&SliceTransform::new(&grid), &crossings, &window);
    let reduced = fast(&SliceTransform::reduced(&grid), &crossings, &window);
    let error = error(&reduced, &full, &crossings, &window);
    // The kernel lets 1.3e-5 of the noise beyond the grid through. This noise is 1 / √30,000 of the
    // sum, and four times as much at the worst of 2,000 frequencies: 3e-7, plus other aliases.
    // Shares that are rounded to the nearest whole number lose 3e-6.
    assert!(error < 6e-7, "{error}");
}

/// A pencil of equal rays lies in the same cells, which then hold the largest sums.
#[test]
fn a_pencil_of_rays_does_not_overflow() {
    let window = hann();
    let grid = grid(&window, 2, [16, 32], 1.0);
    let one = Random(6).crossing(&window, 0.5);
    // The sum of 16,384 weights just below 2 is as close to overflow as any sum.
    for weight in [1.0, 2.0_f64.next_down(), 1e-250, 1e250] {
        let crossings = vec![Crossing { weight, ..one }; 20_000];
        let plain = direct::slices(&[Crossing { weight, ..one }], |z| window.value(z), &grid);
        let mut scaled = plain.clone();
        scaled.half.mapv_inplace(|s| s * 20_000.0);
        let found = fast(&SliceTransform::reduced(&grid), &crossings, &window);
        let error = error(&found, &scaled, &crossings, &window);
        assert!(error < 2e-5, "{error} at {weight}"); // the bound stated at `SliceTransform`
    }
    let infinite = [Crossing {
        weight: f64::INFINITY,
        ..one
    }];
    let found = fast(&SliceTransform::reduced(&grid), &infinite, &window);
    assert!(found.at_zero().is_nan());
    assert_eq!(
        fast(&SliceTransform::reduced(&grid), &[], &window),
        Slices::zeros(grid)
    );
}

#[test]
fn an_accumulator_is_used_again() {
    for (plan, bound) in PLANS {
        use_again(plan, bound);
    }
}

fn use_again(plan: fn(&SliceGrid) -> SliceTransform, bound: f64) {
    let window = hann();
    let grid = grid(&window, 2, [4, 4], 1.0);
    let plan = plan(&grid);
    let mut random = Random(3);
    let crossings: Vec<_> = (0..40_000) // several blocks
        .map(|_| random.crossing(&window, 1.0))
        .collect();
    let mut sum = plan.accumulator();
    let mut twice = Vec::new();
    for _ in 0..2 {
        for crossing in &crossings {
            sum.deposit(&crossing.ray, crossing.weight);
        }
        twice.push(sum.finish(0.25));
    }
    assert_eq!(twice[0], twice[1]);
    let mut plain = direct::slices(&crossings, |_| 1.0, &grid);
    plain.half.mapv_inplace(|s| s * 0.25);
    let tolerance = bound * plain.at_zero(); // weights are ≥ 0
    for (a, b) in twice[0].half.iter().zip(&plain.half) {
        assert!((a - b).norm() < tolerance);
    }
    assert!((sum.finish(1.0).at_zero()).abs() < f64::MIN_POSITIVE);
}

/// Tests the discrete Parseval identity: the mean of |S|² over n successive frequencies of spacing
/// 1/(n a) is the sum of the squared weights. The identity is exact if positions are on a lattice
/// of n positions with the spacing a.
#[test]
fn power_over_all_frequencies_is_the_sum_of_squares() {
    let (half, step) = ([10, 7], [0.05, 0.03]);
    let axis = |half, step| etendue_field::FrequencyAxis {
        half,
        spacing: 1.0 / ((2 * half + 1) as f64 * step),
    };
    let grid = SliceGrid {
        azimuths: 1,
        rho: axis(half[0], step[0]),
        nu: axis(half[1], step[1]),
    };
    let plan = SliceTransform::new(&grid);
    let mut sum = plan.accumulator();
    let mut random = Random(4);
    let mut squares = 0.0;
    for i in 0..grid.rho.count() {
        for j in 0..grid.nu.count() {
            let ray = TwoPlane {
                x: (i as f64 - 4.0) * step[0],
                y: random.within(1.0), // azimuth 0 does not see it
                u: (j as f64 - 7.0) * step[1],
                v: random.within(1.0),
            };
            let weight = random.unit();
            squares += weight * weight;
            sum.deposit(&ray, weight);
        }
    }
    let power = sum.finish(1.0).radial_power();
    let mean = power.sum() / power.len() as f64;
    // The error of each |S|² is 2 · 1e-7 Σw |S|. There are 21 · 15 rays with the mean weight 1/2,
    // so Σw = 158, and |S| is about √Σw² at all but a few frequencies.
    assert!((mean / squares - 1.0).abs() < 1e-5, "{mean} {squares}");
}

#[test]
fn one_ray_is_one_exponential() {
    let window = hann();
    let grid = grid(&window, 6, [3, 3], 1.0);
    let ray = TwoPlane {
        x: 0.21,
        y: -0.13,
        u: 0.11,
        v: 0.07,
    };
    let one = [Crossing { ray, weight: 2.0 }];
    let k = 2;
    let (rho, nu) = (grid.rho.value(5), grid.nu.value(1));
    let (sin, cos) = grid.azimuth(k).sin_cos();
    let cycles = rho * (ray.x * cos + ray.y * sin) + nu * (ray.u * cos + ray.v * sin);
    let expected = Complex::from_polar(2.0, -std::f64::consts::TAU * cycles);
    let found = direct::slices(&one, |_| 1.0, &grid).half[[k, 2, 1]];
    assert!((found - expected).norm() < 1e-14); // rounding of a phase of a few turns
}
