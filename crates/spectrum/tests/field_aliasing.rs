//! Tests the aliasing of a 4D grid against the direct sum over the same rays.

use crate::common::{Random, boxed, grid, hann};
use etendue_field::{Assignment, Complex, Crossing, FieldGrid, TwoPlane, Window};
use etendue_spectrum::field::{FieldSpectrum, FieldTransform};
use etendue_transform::SliceTransform;
use etendue_transform::direct;

const ALL: [Assignment; 3] = [Assignment::Nearest, Assignment::Cic, Assignment::Tsc];

fn gridded(crossings: &[Crossing], grid: FieldGrid, assignment: Assignment) -> FieldSpectrum {
    let plan = FieldTransform::new(grid, assignment);
    let mut cells = plan.cells();
    for Crossing { ray, weight } in crossings {
        cells.deposit(ray, *weight);
    }
    plan.spectrum(cells)
}

fn small(window: &Window) -> FieldGrid {
    FieldGrid {
        cells: [8, 10, 8, 12],
        half_widths: [window.x, window.y, window.u, window.v].map(|p| p.half_width()),
    }
}

/// The largest ratio of |grid − direct sum| to the bound, over all frequencies below
/// Nyquist in one half of the spectrum.
fn over_bound(spectrum: &FieldSpectrum, crossings: &[Crossing]) -> f64 {
    let grid = spectrum.grid;
    let mut largest = 0.0_f64;
    let below = |axis: usize| {
        let n = grid.cells[axis];
        let indices = (0..n).filter(move |i| 2 * i != n);
        indices.map(move |i| grid.harmonic(axis, i))
    };
    for x in below(0) {
        for y in below(1) {
            for u in below(2) {
                for v in below(3).filter(|v| *v >= 0) {
                    let harmonics = [x, y, u, v];
                    let frequency =
                        std::array::from_fn(|axis| harmonics[axis] as f64 * grid.spacing(axis));
                    let plain = direct::at(crossings, |_| 1.0, frequency);
                    let off = (spectrum.at(harmonics) - plain).norm();
                    // The rounding error of the two sums is 1e-13.
                    let bound = spectrum.alias_bound(harmonics) + 1e-13 * spectrum.at_zero();
                    largest = largest.max(off / bound);
                }
            }
        }
    }
    largest
}

/// Returns sets of rays: many random rays, one random ray, and one ray at the position with the
/// largest alias. The position with the largest alias is half-way between the centres of two
/// cells on one axis, and at a cell's centre on the other axes.
fn sets(window: &Window) -> Vec<Vec<Crossing>> {
    let grid = small(window);
    let mut random = Random(11);
    let mut rays = |n: usize| {
        (0..n)
            .map(|_| random.crossing(window, 1.0))
            .collect::<Vec<_>>()
    };
    let worst = |offset: f64| {
        let at = |axis: usize| grid.center(axis, 5) + offset * grid.cell_width(axis);
        let ray = TwoPlane {
            x: at(0),
            y: at(1),
            u: at(2),
            v: at(3),
        };
        vec![Crossing { ray, weight: 3.0 }]
    };
    vec![
        rays(25),
        rays(1),
        rays(1),
        worst(0.0),
        worst(0.5),
        worst(0.499),
    ]
}

#[test]
fn no_frequency_is_beyond_its_bound() {
    for window in [hann(), boxed()] {
        for assignment in ALL {
            let mut nearest = 0.0_f64;
            for crossings in sets(&window) {
                let spectrum = gridded(&crossings, small(&window), assignment);
                let found = over_bound(&spectrum, &crossings);
                assert!(found <= 1.0, "{assignment:?}: {found}");
                nearest = nearest.max(found);
            }
            // The bound is tight: the alias of a single ray comes near it.
            assert!(nearest > 0.7, "{assignment:?}: {nearest}");
        }
    }
}

/// Tests that a faulty spectrum exceeds the bound. The spectrum has one fault at a time: a wrong
/// power of the sinc, a shift by half a cell along x, or a wrong sign of the transform.
#[test]
fn wrong_compensations_are_beyond_it() {
    let window = hann();
    let sinc = |f: f64| {
        let t = std::f64::consts::PI * f;
        if f == 0.0 { 1.0 } else { t.sin() / t }
    };
    for assignment in ALL {
        // Multiplies each spectrum by `factor`, a function of the frequency in cycles per cell, and
        // returns the largest ratio over the sets of rays.
        let with = |factor: &dyn Fn([f64; 4]) -> Complex| {
            let sets = sets(&window).into_iter();
            sets.map(|crossings| {
                let mut wrong = gridded(&crossings, small(&window), assignment);
                let grid = wrong.grid;
                for ((x, y, u, v), value) in wrong.values.indexed_iter_mut() {
                    let index = [x, y, u, v];
                    let cycles = |axis: usize| {
                        grid.harmonic(axis, index[axis]) as f64 / grid.cells[axis] as f64
                    };
                    *value *= factor(std::array::from_fn(cycles));
                }
                over_bound(&wrong, &crossings)
            })
            .fold(0.0, f64::max)
        };
        let power = |p: i32| {
            let factor = |f: [f64; 4]| f.map(|f| sinc(f).powi(p)).iter().product::<f64>();
            with(&|f| Complex::from(factor(f)))
        };
        assert!(power(0) <= 1.0);
        assert!(power(-1) > 1.2, "{assignment:?}: {}", power(-1));
        // The spectrum is compensated by too low a power of the sinc. The power is lower by one for
        // TSC. For CIC, the power is lower by two, because the bound is as wide as the effect of
        // one power. For assignment to the nearest cell, the bound is so wide that it holds even
        // without any compensation.
        match assignment {
            Assignment::Nearest => assert!(power(1) <= 1.0),
            Assignment::Cic => assert!(power(2) > 1.2, "{}", power(2)),
            Assignment::Tsc => assert!(power(1) > 1.2, "{}", power(1)),
        }
        let shifted = with(&|[f, ..]| Complex::cis(-std::f64::consts::PI * f));
        assert!(shifted > 1.2, "{assignment:?}: {shifted}");
        let conjugate = sets(&window).into_iter().map(|crossings| {
            let mut wrong = gridded(&crossings, small(&window), assignment);
            wrong.values.mapv_inplace(|s| s.conj());
            over_bound(&wrong, &crossings)
        });
        assert!(conjugate.fold(0.0, f64::max) > 2.0);
    }
}

#[test]
fn nothing_is_lost_on_the_grid() {
    let mut random = Random(13);
    for window in [hann(), boxed()] {
        let crossings: Vec<_> = (0..500).map(|_| random.crossing(&window, 1.0)).collect();
        let total: f64 = crossings.iter().map(|c| c.weight).sum();
        for assignment in ALL {
            let grid = small(&window);
            let plan = FieldTransform::new(grid, assignment);
            let mut cells = plan.cells();
            for Crossing { ray, weight } in &crossings {
                cells.deposit(ray, *weight);
            }
            let sum = cells.field().sum() * grid.cell_volume();
            assert!((sum / total - 1.0).abs() < 1e-13); // rounding of 500 · 81 shares
            assert!((plan.spectrum(cells).at_zero() / total - 1.0).abs() < 1e-13);
        }
    }
}

/// The expected difference due to aliasing is exact for white noise, and too large for a smooth
/// field.
#[test]
fn the_slices_tell_the_aliasing() {
    let window = boxed();
    let slice_grid = grid(&window, 4, [8, 10], 1.0);
    let field_grid = FieldGrid::new(&window, &slice_grid);
    assert_eq!(field_grid.cells, [16, 16, 20, 20]);
    let mut random = Random(14);
    let mut crossings: Vec<_> = (0..4000).map(|_| random.crossing(&window, 1.0)).collect();
    for smooth in [false, true] {
        if smooth {
            for Crossing { ray, weight } in &mut crossings {
                *weight = hann().value(ray) * 1e3;
            }
        } else {
            // The weights have both signs and a mean of zero, so the spectrum contains only
            // noise.
            crossings.iter_mut().for_each(|c| c.weight -= 1.0);
        }
        let slices = {
            let plan = SliceTransform::new(&slice_grid);
            let mut sum = plan.accumulator();
            crossings.iter().for_each(|c| sum.deposit(&c.ray, c.weight));
            sum.finish(1.0)
        };
        let mut last = f64::INFINITY;
        for assignment in ALL {
            let spectrum = gridded(&crossings, field_grid, assignment);
            let aliasing = spectrum.aliasing(&slices, 1.0).unwrap();
            // Each of two lines has one half of 15 × 19 frequencies, and both lines contain zero.
            assert_eq!(aliasing.compared, 15 * 19 + 1);
            let ratio = aliasing.difference / aliasing.expected;
            if smooth {
                assert!(aliasing.difference < aliasing.bound);
                assert!(ratio < 1.5, "{ratio}");
            } else {
                // A few of the 286 frequencies cause most of the difference, and only 150
                // frequencies serve to estimate the power beyond Nyquist.
                assert!((0.6..1.5).contains(&ratio), "{assignment:?}: {ratio}");
            }
            assert!(aliasing.difference < last, "{assignment:?}"); // a smoother spline aliases less
            last = aliasing.difference;
            let low = spectrum.aliasing(&slices, 0.5).unwrap();
            assert!(low.compared < aliasing.compared && low.difference < aliasing.difference);
        }
    }
}

#[test]
fn what_is_not_shared_is_not_compared() {
    let window = boxed();
    let crossings = [Random(15).crossing(&window, 0.5)];
    let spectrum = |slice_grid| {
        let field_grid = FieldGrid::new(&window, &slice_grid);
        gridded(&crossings, field_grid, Assignment::Tsc)
    };
    // If the spacing of the slices is half as large, they share every other frequency with the
    // grid. If the number of azimuths is odd, the slices share one line with the grid.
    for (azimuths, fineness, compared) in [
        (3, 1.0, 7 * 7 / 2 + 1),
        (3, 2.0, 7 * 7 / 2 + 1),
        (2, 1.0, 49 + 1),
    ] {
        let half = if fineness > 1.0 { [8, 8] } else { [4, 4] };
        let slice_grid = grid(&window, azimuths, half, fineness);
        let slices = direct::slices(&crossings, |_| 1.0, &slice_grid);
        let aliasing = spectrum(slice_grid).aliasing(&slices, 1.0).unwrap();
        assert_eq!(aliasing.compared, compared);
        assert!(aliasing.difference < aliasing.bound);
    }
    let slice_grid = grid(&window, 2, [4, 4], 1.0);
    let dark = etendue_field::Slices::zeros(slice_grid);
    assert!(spectrum(slice_grid).aliasing(&dark, 1.0).is_none());
}
