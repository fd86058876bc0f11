//! Tests of slices and projections against plain sums, and against rays that are sampled over all
//! six variables.

use super::*;
use crate::quadrature::integrate;
use crate::testing::{blockers, window};
use etendue_field::{Complex, FrequencyAxis, Profile, ProjectionGrid, SliceGrid, TwoPlane, Window};
use std::f64::consts::{PI, TAU};

fn grid(azimuths: usize, half: usize, [rho, nu]: [f64; 2]) -> SliceGrid {
    let axis = |spacing| FrequencyAxis { half, spacing };
    SliceGrid {
        azimuths,
        rho: axis(rho),
        nu: axis(nu),
    }
}

fn hann() -> Window {
    window(Profile::Hann(0.5), Profile::Hann(0.4))
}

#[test]
fn fast_and_plain_sums_agree() {
    let uneven = Window {
        x: Profile::Box(0.3),
        y: Profile::Hann(0.4),
        u: Profile::Gaussian {
            width: 0.3,
            cut: 0.4,
        },
        v: Profile::Box(0.2),
    };
    let grid = grid(3, 3, [2.0, 3.0]);
    for after in [0.0, 0.7] {
        for window in [hann(), uneven] {
            let bench = &benches()[2];
            let receiver = bench.after(after);
            let table = receiver.table(&window, 100);
            let slices = table.slices(&grid);
            for [k, m, n] in [[0, 0, 3], [0, 3, 0], [1, 2, 5], [2, 1, 6], [2, 3, 1]] {
                let (rho, nu) = (m as f64 * grid.rho.spacing, grid.nu.value(n));
                let plain = table.at(grid.frequency(k, rho, nu));
                let error = (slices.half[[k, m, n]] - plain).norm() / slices.at_zero();
                // The tolerance covers rounding errors and the error of Gauss rules that are
                // accurate to 1e-14.
                assert!(error < 1e-12, "{after} {k} {m} {n}: {error:e}");
            }
        }
    }
}

/// Returns points that fill a cube of six dimensions evenly: multiples of square roots of primes
/// (Richtmyer 1951).
pub(super) fn cube(count: u32) -> impl Iterator<Item = [f64; 6]> {
    let steps = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0].map(f64::sqrt);
    (1..=count).map(move |n| steps.map(|s| (0.5 + s * f64::from(n)).fract()))
}

/// Estimates the spectrum at some frequencies from random rays. Each ray is sampled in the window,
/// followed back, and connected to a random point of the light.
fn drawn(bench: &TestReceiver, after: f64, window: &Window, rays: u32) -> Vec<Complex> {
    let Light::Area { shape, .. } = bench.light else {
        unreachable!("area lights only")
    };
    let bounds = shape.bounds();
    let halves = [window.x, window.y, window.u, window.v].map(|p| p.half_width());
    let volume = bounds.area() * halves.iter().map(|h| 2.0 * h).product::<f64>();
    let mut sums = vec![Complex::ZERO; FREQUENCIES.len()];
    for point in cube(rays) {
        let [x, y, u, v] = [0, 1, 2, 3].map(|k| halves[k] * (2.0 * point[k] - 1.0));
        let weight = window.value(&TwoPlane { x, y, u, v });
        // The frame of reflected light has D' = −D, X' = −X and Y' = D' × X' = Y, so the
        // coordinate x in the frame of arriving light is −x'.
        let floor = [-(x - after * u), y - after * v];
        let at = [0, 1].map(|k| bounds.center[k] + bounds.size[k] * (point[4 + k] - 0.5));
        let radiance = 0.6 / PI * bench.added(at, floor) * weight;
        for (sum, [ox, oy, ou, ov]) in sums.iter_mut().zip(&FREQUENCIES) {
            *sum += Complex::from_polar(radiance, -TAU * (ox * x + oy * y + ou * u + ov * v));
        }
    }
    sums.into_iter()
        .map(|s| s * volume / f64::from(rays))
        .collect()
}

const FREQUENCIES: [[f64; 4]; 5] = [
    [0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 1.0, -0.5],
    [1.5, -1.0, -1.0, 1.2],
    [-2.0, 1.5, 1.0, 0.7],
];

/// The largest deviation of the receiver's spectrum from the spectrum of sampled rays,
/// divided by the largest value.
fn deviation(receiver: &Receiver<'_>, drawn: &[Complex]) -> f64 {
    let table = receiver.table(&hann(), 128);
    let pairs = FREQUENCIES.iter().zip(drawn);
    let worst = pairs.map(|(k, d)| (table.at(*k) - d).norm());
    worst.fold(0.0, f64::max) / drawn[0].norm()
}

/// Number of sampled rays.
const RAYS: u32 = 2_000_000;
/// The relative sampling error of `RAYS` rays in six dimensions.
const DRAWN: f64 = 1e-3;

#[test]
fn spectra_of_rays_drawn_over_all_variables() {
    for (number, after) in [(2, 0.0), (2, 0.7), (4, 0.7), (7, 0.3)] {
        let bench = &benches()[number];
        let drawn = drawn(bench, after, &hann(), RAYS);
        let deviation = deviation(&bench.after(after), &drawn);
        assert!(
            deviation < DRAWN,
            "bench {number} after {after}: {deviation:e}"
        );
    }
}

#[test]
fn planted_faults_are_seen() {
    let bench = &benches()[2];
    let drawn = drawn(bench, 0.7, &hann(), RAYS);
    let wrong = |cosine, after, albedo| {
        let layers = bench.layers();
        let distance = bench.distance;
        deviation(
            &Receiver::new(
                closed_form(&bench.light).unwrap(),
                &layers,
                distance,
                cosine,
                after,
                albedo,
            ),
            &drawn,
        )
    };
    assert!(wrong(true, 0.7, 0.6) < DRAWN);
    let no_cosine = wrong(false, 0.7, 0.6);
    assert!(no_cosine > 10.0 * DRAWN, "{no_cosine}");
    let no_pi = wrong(true, 0.7, 0.6 * PI);
    assert!(no_pi > 1.0, "{no_pi}");
    let no_travel = wrong(true, 0.0, 0.6);
    assert!(no_travel > 10.0 * DRAWN, "{no_travel}");
    // If the frame were not reversed by the reflection, the result would be the spectrum at (−Ωx,
    // −Ωu).
    let receiver = bench.after(0.7);
    let [x, y, u, v] = FREQUENCIES[3];
    let turned = receiver.at(&hann(), [-x, y, -u, v]);
    assert!((turned - drawn[3]).norm() > 10.0 * DRAWN * drawn[0].norm());
}

#[test]
fn error_falls_with_the_square_of_the_spacing() {
    let mask = opaque(
        blockers(5, 0.1, 0.06)
            .into_iter()
            .map(Shape::Rectangle)
            .collect(),
    );
    let bench = TestReceiver::new(
        area(Shape::Rectangle(square([0.0; 2], 0.2)), 0.0),
        vec![(1.0, mask)],
    );
    let grid = grid(4, 8, [2.0, 2.0]);
    for after in [0.0, 0.5] {
        let receiver = bench.after(after);
        let slices = |nodes| receiver.table(&hann(), nodes).slices(&grid);
        let fine = slices(1024);
        let errors = [32, 64, 128, 256].map(|n| slices(n).relative_difference(&fine));
        let order = libm::log2(errors[0] / errors[3]) / 3.0;
        // The error is of second order in the spacing, apart from fluctuations due to the positions
        // of kinks between nodes.
        assert!((1.6..3.5).contains(&order), "{after}: {errors:?} {order}");
        assert!(errors[3] < 1e-4, "{errors:?}"); // the requested error, with the fewest nodes
    }
}

#[test]
fn error_is_told() {
    let window = hann();
    let grid = grid(2, 6, [2.0, 2.0]);
    for number in [2, 6] {
        let bench = &benches()[number];
        let receiver = bench.receiver();
        let slices = receiver.slices(&window, &grid);
        let nodes = receiver.nodes(&window, grid.rho.max());
        let zero = receiver.table(&window, nodes).at([0.0; 4]);
        assert!((slices.at_zero() - zero).norm() < 1e-12 * zero.norm()); // rounding of two sums
        let told = receiver.quadrature_error(&window, &grid, &slices).unwrap();
        let truth = slices.relative_difference(&receiver.table(&window, 1000).slices(&grid));
        // The estimate is not a bound on the error, but it is correct to a factor of a few and is
        // below the requested error.
        assert!(
            truth < 3.0 * told + 1e-9 && told < 1e-4,
            "{number}: {told:e} {truth:e}"
        );
    }
    let dark = TestReceiver::new(
        area(Shape::Rectangle(square([0.0; 2], 0.2)), 0.0),
        vec![(1.0, opaque(vec![rectangle([0.0; 2], [4.0; 2])]))],
    );
    let slices = dark.receiver().slices(&window, &grid);
    assert!(slices.half.iter().all(|s| s.norm() < 1e-17)); // rounding of a difference that is zero
}

#[test]
fn projection_is_the_other_side_of_the_slice() {
    for (number, after) in [(2, 0.0), (3, 0.7)] {
        let bench = &benches()[number];
        let receiver = bench.after(after);
        let table = receiver.table(&hann(), receiver.nodes(&hann(), 0.0));
        let cells = ProjectionGrid::new(&hann(), 128);
        let projection = receiver.projection(&hann(), &cells);
        let zero = table.at([0.0; 4]).re;
        for [rho, nu] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, -1.5]] {
            let values = projection.values.indexed_iter();
            let sum: Complex = values
                .map(|((i, j), p)| {
                    let (x, u) = (cells.center(i, cells.half_x), cells.center(j, cells.half_u));
                    Complex::from_polar(*p, -TAU * (rho * x + nu * u))
                })
                .sum();
            let expected = table.at([rho, 0.0, nu, 0.0]);
            let error = (sum * cells.cell_area() - expected).norm() / zero;
            // The mean over a cell reduces the spectrum by (π f width)²/6 < 4e-4 at 2 cycles and
            // 128 cells.
            assert!(error < 4e-4, "{number} {rho} {nu}: {error:e}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let bench = &benches()[4];
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let slices = |after| {
            bench
                .after(after)
                .table(&hann(), 60)
                .slices(&grid(3, 4, [2.0, 2.0]))
        };
        let run = || [0.0, 0.3].map(slices);
        pool.build().unwrap().install(run)
    };
    let one = on(1);
    assert!(one.iter().flat_map(|s| &s.half).all(|s| s.is_finite()));
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

#[test]
fn hard_shadows_of_a_point_light() {
    let mask = opaque(vec![rectangle([0.1, -0.05], [0.2, 0.15])]);
    let bench = TestReceiver::new(Light::Point { intensity: 3.0 }, vec![(0.5, mask)]);
    let receiver = bench.receiver();
    let [x, y, u, v] = [2.0, -3.0, 1.0, 0.5];
    // The frame of reflected light is reversed along x, the integral is over a rectangle of the
    // receiver, and the shadow is 4/3 as large as the mask.
    let lit = |along_x: [f64; 2], along_y: [f64; 2]| -> Complex {
        integrate(40, along_x, |s| {
            integrate(40, along_y, |t| {
                let window = Profile::Hann(0.5).value(s) * Profile::Hann(0.5).value(t);
                let irradiance = 3.0 * 2.0 * libm::pow(4.0 + s * s + t * t, -1.5);
                Complex::from_polar(0.6 / PI * irradiance * window, -TAU * (x * s + y * t))
            })
        })
    };
    let slope = |frequency: f64| -> Complex {
        integrate(40, [-0.4, 0.4], |u| {
            Complex::from_polar(Profile::Hann(0.4).value(u), -TAU * frequency * u)
        })
    };
    let shadow = lit(
        [-4.0 / 3.0 * 0.2, 0.0],
        [-4.0 / 3.0 * 0.125, 4.0 / 3.0 * 0.025],
    );
    let expected = (lit([-0.5, 0.5], [-0.5, 0.5]) - shadow) * slope(u) * slope(v);
    let errors = [128, 256, 512].map(|nodes| {
        let got = receiver.table(&hann(), nodes).at([x, y, u, v]);
        (got - expected).norm() / expected.norm()
    });
    let order = libm::log2(errors[0] / errors[2]) / 2.0;
    // Means over cells converge at second order even if edges cross the cells.
    assert!(errors[2] < 2e-4 && order > 1.6, "{errors:?}");
    assert_eq!(receiver.nodes(&hann(), 0.0), 1024);
}
