//! Tests the comparison on synthetic batches, where the truth is known.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::made_up::{noise, plane};
use etendue_compare::{
    Class, PredictedParameter, Prediction, Residuals, Test, Verdict, compare, sidak,
};
use etendue_field::{Complex, Ledger, PlaneTally, Projection, ProjectionGrid, Slices};
use etendue_spectrum::{Batch, Measurement, PROJECTION_BINS, PlaneBatch};

const BATCHES: u32 = 64;

/// A smooth spectrum and its derivative with respect to its width.
fn spectrum(width: f64) -> [Slices; 2] {
    let grid = plane().grid;
    let mut value = Slices::zeros(grid);
    let mut derivative = Slices::zeros(grid);
    for ((k, m, n), f) in value.half.indexed_iter_mut() {
        let square = (m * m) as f64 + grid.nu.value(n).powi(2);
        let bell = (-square * width * width / 20.0).exp();
        *f = Complex::new(bell, 0.1 * m as f64 * bell);
        derivative.half[[k, m, n]] = *f * (-square * width / 10.0);
    }
    [value, derivative]
}

const TEST: Test = Test {
    level: 0.01,
    resolution: 0.5,
    seed: 1,
};

/// Returns batches around `truth` with noise of the given size on each.
fn measurement(truth: &Slices, size: f64, seed: u64) -> Measurement {
    noisy(truth, seed, |_| size)
}

/// A measurement with noise of the given size in each cell.
fn noisy(truth: &Slices, seed: u64, size: impl Fn(usize) -> f64) -> Measurement {
    let plane = plane();
    let mut measurement = Measurement::new(vec![plane.clone()]);
    for index in 0..BATCHES {
        let mut slices = truth.clone();
        for (cell, value) in slices.half.iter_mut().enumerate() {
            *value += noise(seed, u64::from(index) << 32 | cell as u64) * size(cell);
        }
        let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let values = ndarray::Array2::zeros((grid.bins, grid.bins));
        let inside = if size(1) > 0.0 { 100 } else { 0 };
        let batch = PlaneBatch {
            tally: PlaneTally {
                crossed: 100,
                inside,
                outside: 100 - inside,
            },
            moments: etendue_spectrum::RayMoments::default(),
            slices,
            projection: Projection { grid, values },
        };
        let (emitted, ledger) = (100, Ledger::default());
        measurement
            .insert(Batch {
                index,
                emitted,
                ledger,
                planes: vec![batch],
            })
            .unwrap();
    }
    measurement
}

fn prediction(width: f64) -> Prediction {
    let [slices, derivative] = spectrum(width);
    let grid = ProjectionGrid::new(&plane().window, PROJECTION_BINS);
    Prediction {
        class: Class::Exact,
        steps: Vec::new(),
        quadrature_error: None,
        mesh_error: None,
        rule_error: None,
        first_order: None,
        replicates: Vec::new(),
        depth: None,
        cuts: Vec::new(),
        projection: Projection {
            grid,
            values: ndarray::Array2::zeros((grid.bins, grid.bins)),
        },
        unblocked: slices.at_zero(),
        slices,
        parameters: vec![PredictedParameter {
            name: "width".into(),
            unit: "m".into(),
            value: width,
            derivative,
        }],
    }
}

/// If rays find no light, this does not prove that the plane is dark. Therefore the plane does not
/// fail if photons measure light there.
#[test]
fn rays_that_found_nothing_decide_nothing() {
    let [truth, _] = spectrum(0.3);
    let measurement = measurement(&truth, 0.02, 2);
    let mut nothing = prediction(0.3);
    nothing.slices = Slices::zeros(plane().grid);
    let verdict = |prediction: &Prediction| {
        let compared = compare(&measurement, 0, prediction, &TEST).unwrap();
        compared.report.verdict
    };
    // If a closed form is dark, no light arrives.
    assert_eq!(verdict(&nothing), Verdict::Fail);
    nothing.replicates = vec![Slices::zeros(plane().grid); 32];
    assert_eq!(verdict(&nothing), Verdict::Undecided);
}

/// Tests a reference that replaces theory. Its noise is taken into account, and a difference from
/// the reference is found.
#[test]
fn a_reference_is_judged_with_its_own_noise() {
    let verdict = |reference_width: f64, seed: u64| {
        let [truth, _] = spectrum(1.0);
        let [other, _] = spectrum(reference_width);
        let reference = measurement(&other, 0.02, seed + 1000);
        let mut expected = prediction(reference_width);
        expected.class = Class::Reference;
        expected.replicates = reference.at_plane(0).map(|b| b.slices.clone()).collect();
        let measured = measurement(&truth, 0.02, seed);
        compare(&measured, 0, &expected, &TEST).unwrap().report
    };
    let (mut chi2, mut seeds) = (0.0, 0.0);
    for seed in 1..=8 {
        let same = verdict(1.0, seed);
        assert_eq!(same.verdict, Verdict::Pass, "seed {seed}: {same:?}");
        chi2 += same.chi2_per_dof.unwrap();
        seeds += 1.0;
        assert_eq!(verdict(1.05, seed).verdict, Verdict::Fail);
    }
    // The mean over eight times 170 complex numbers has the standard deviation 1/√1360 = 0.027, and
    // the limit is four standard deviations. Without the reference's noise the value would be 2.
    assert!((chi2 / seeds - 1.0).abs() < 0.11, "{}", chi2 / seeds);
}

/// Returns replicates of a prediction around `truth`, with noise of the given size on each.
fn replicates(truth: &Slices, size: f64, count: u32, seed: u64) -> Vec<Slices> {
    let replicate = |index: u32| {
        let mut slices = truth.clone();
        for (cell, value) in slices.half.iter_mut().enumerate() {
            *value += noise(seed, u64::from(index) << 32 | cell as u64) * size;
        }
        slices
    };
    (0..count).map(replicate).collect()
}

/// A prediction of a spectrum of the given width, as the mean of replicates.
fn sampled(width: f64, size: f64, count: u32, seed: u64) -> Prediction {
    let [truth, _] = spectrum(width);
    let replicates = replicates(&truth, size, count, seed);
    let mut slices = Slices::zeros(truth.grid);
    for replicate in &replicates {
        slices.half += &replicate.half;
    }
    slices.half /= Complex::from(f64::from(count));
    let cells = slices.half.len() as f64;
    let error = size * (2.0 * cells / f64::from(count)).sqrt();
    let norm = slices.half.iter().map(|f| f.norm_sqr()).sum::<f64>().sqrt();
    Prediction {
        class: Class::FirstOrder,
        quadrature_error: Some(error / norm),
        slices,
        replicates,
        ..prediction(width)
    }
}

/// The numbers of replicates and batches differ. The test has cases with fewer replicates, with
/// more replicates, and with numbers that do not divide each other. The p-value is uniform if both
/// sides agree, and a spectrum 5 % too wide is detected.
#[test]
fn two_samples_are_compared_with_the_noise_of_both() {
    let [truth, _] = spectrum(1.0);
    for (count, size) in [(32, 0.01), (128, 0.03), (24, 0.01)] {
        let compared = |width: f64, seed: u64| {
            let measured = measurement(&truth, 0.02, seed + 10);
            let expected = sampled(width, size, count, seed + 5000);
            compare(&measured, 0, &expected, &TEST).unwrap().report
        };
        let (mut below, mut chi2) = (0, 0.0);
        for seed in 0..50 {
            let report = compared(1.0, seed);
            below += u32::from(report.p_value.unwrap() < 0.3);
            chi2 += report.chi2_per_dof.unwrap() / 50.0;
            // An error of the prediction that replicates show is part of the noise, and makes no
            // plane undecided.
            assert_ne!(report.verdict, Verdict::Undecided);
        }
        // The expected number is 15 ± 3.2 of 50; the limits are four standard deviations.
        assert!(
            (3..=27).contains(&below),
            "{count}: {below} of 50 below 0.3"
        );
        // The mean over 50 times 170 complex numbers has the standard deviation 1/√8500 = 0.011.
        // The limit is four standard deviations, plus the same amount for the variance of the
        // groups.
        assert!((chi2 - 1.0).abs() < 0.06, "{count}: {chi2}");
        for seed in 0..5 {
            assert_eq!(compared(1.05, seed).verdict, Verdict::Fail, "{count}");
        }
    }
}

/// A true prediction would be rejected if the noise of the replicates were left out.
#[test]
fn replicates_that_are_taken_for_exact_are_rejected() {
    let [truth, _] = spectrum(1.0);
    for seed in 0..5 {
        let measured = measurement(&truth, 0.02, seed + 10);
        let sampled = sampled(1.0, 0.03, 32, seed + 5000);
        let judged = |expected: &Prediction| {
            let report = compare(&measured, 0, expected, &TEST).unwrap();
            report.report.verdict
        };
        assert_eq!(judged(&sampled), Verdict::Pass);
        let exact = Prediction {
            replicates: Vec::new(),
            quadrature_error: None,
            ..sampled
        };
        assert_eq!(judged(&exact), Verdict::Fail);
    }
}

/// Residuals add up to the difference of the means, for any numbers of parts.
#[test]
fn residuals_have_the_mean_of_the_difference() {
    let [truth, _] = spectrum(1.0);
    let measured = measurement(&truth, 0.02, 3);
    let mean = |all: &mut dyn Iterator<Item = &Slices>| {
        let mut sum = Slices::zeros(truth.grid);
        let mut count = 0.0;
        for slices in all {
            sum.half += &slices.half;
            count += 1.0;
        }
        sum.half /= Complex::from(count);
        sum
    };
    let s = mean(&mut measured.at_plane(0).map(|batch| &batch.slices));
    for count in [16, 24, 64, 100, 128] {
        let replicates = replicates(&truth, 0.02, count, 7);
        let f = mean(&mut replicates.iter());
        let residuals = Residuals::between(&measured, 0, &f, &replicates);
        assert_eq!(residuals.count(), 64.min(count as usize));
        let off = residuals.mean() - (&s.half - &f.half);
        let most = off.iter().map(|c| c.norm()).fold(0.0, f64::max);
        assert!(most < 1e-14, "{count}: {most}"); // rounding of sums of 128
    }
}

#[test]
fn truth_passes_with_chi2_of_one_and_no_excess() {
    let [truth, _] = spectrum(1.0);
    let measurement = measurement(&truth, 0.02, 1);
    let report = compare(&measurement, 0, &prediction(1.0), &TEST)
        .unwrap()
        .report;
    assert_eq!(report.verdict, Verdict::Pass);
    // The mean over 170 independent complex numbers has the standard deviation 1/√170 = 0.077, and
    // the limit is four standard deviations.
    assert!(
        (report.chi2_per_dof.unwrap() - 1.0).abs() < 0.3,
        "{report:?}"
    );
    let excess = report.excess.unwrap();
    let squared = excess * excess.abs();
    assert!(
        squared.abs() < 4.0 * report.excess_squared_error.unwrap(),
        "{squared}"
    ); // four errors
}

/// A spectrum that is 2 % too wide is rejected, and the score test finds the size of this error.
#[test]
fn a_wrong_parameter_is_rejected_and_measured() {
    let [truth, _] = spectrum(1.02);
    let measurement = measurement(&truth, 0.02, 2);
    let report = compare(&measurement, 0, &prediction(1.0), &TEST)
        .unwrap()
        .report;
    assert_eq!(report.verdict, Verdict::Fail, "{report:?}");
    let width = &report.parameters[0];
    assert!(width.measured > 1.0 + width.detectable, "{width:?}");
    // The limit is four errors, plus the second-order effect of a step of 2 %.
    assert!(
        (width.measured - 1.02).abs() < 4.0 * width.error + 0.002,
        "{width:?}"
    );
}

/// If the error of a quadrature exceeds the resolution, the plane is undecided. If this error is
/// below the resolution, the plane passes if the error is as large as the disagreement, and fails
/// otherwise.
#[test]
fn a_coarse_quadrature_decides_nothing() {
    let judged = |truth: f64, share: f64| {
        let [truth, _] = spectrum(truth);
        let measurement = measurement(&truth, 0.02, 2);
        let compared = |quadrature_error| {
            let expected = Prediction {
                quadrature_error,
                ..prediction(1.0)
            };
            let compared = compare(&measurement, 0, &expected, &TEST);
            compared.unwrap().report
        };
        let plain = compared(None);
        let [noise, excess] = [plain.noise_limit, plain.excess].map(Option::unwrap);
        compared(Some(share * excess.max(noise)))
    };
    for (truth, share, verdict) in [
        (1.0, 0.4, Verdict::Pass),
        (1.0, 1.6, Verdict::Pass),
        (1.0, 70.0, Verdict::Undecided),
        (1.02, 0.9, Verdict::Fail),
        (1.02, 1.1, Verdict::Pass),
        (1.02, 30.0, Verdict::Undecided),
    ] {
        let report = judged(truth, share);
        assert_eq!(report.verdict, verdict, "{truth} {share}: {report:?}");
        assert_eq!(report.photons_needed, None);
    }
}

/// The possible error of a quadrature is included in the errors of measured numbers. In this test,
/// the noise is almost zero. The prediction is wrong by exactly its stated error, along a
/// derivative or by a shear.
#[test]
fn errors_of_measured_numbers_hold_that_of_a_quadrature() {
    const STATED: f64 = 1e-3;
    let [truth, derivative] = spectrum(1.0);
    let measurement = measurement(&truth, 1e-6, 2);
    let mut sheared = truth.clone();
    for ((_, m, n), f) in sheared.half.indexed_iter_mut() {
        *f *= m as f64 * truth.grid.nu.value(n);
    }
    let norm = |s: &Slices| s.half.iter().map(|f| f.norm_sqr()).sum::<f64>().sqrt();
    let pulls = |direction: &Slices, quadrature_error| {
        let mut expected = prediction(1.0);
        let scale = STATED * norm(&truth) / norm(direction);
        expected.slices.half += &(&direction.half * Complex::from(scale));
        expected.quadrature_error = quadrature_error;
        let report = compare(&measurement, 0, &expected, &TEST).unwrap().report;
        let (width, slope) = (&report.parameters[0], report.slope);
        let off = slope.measured.unwrap() - slope.predicted.unwrap();
        [
            (width.measured - width.scene) / width.error,
            off / slope.error.unwrap(),
        ]
    };
    for (direction, which) in [(&derivative, 0), (&sheared, 1)] {
        // Without the stated error, the only error is the noise of 10⁻⁶.
        assert!(pulls(direction, None)[which].abs() > 30.0);
        // Along a derivative with equal weights, the error equals the bound; it never exceeds the
        // bound. The weights have a noise of a few per cent.
        let held = pulls(direction, Some(STATED))[which].abs();
        assert!((0.3..1.1).contains(&held), "{which}: {held}");
    }
}

/// The fast transform of photons is off by up to 3·10⁻⁷ of the largest value. Where photons have
/// almost no noise, as at a beam, this is the only error of moments and bandwidths.
#[test]
fn errors_of_measured_numbers_hold_that_of_the_transform() {
    const OFF: f64 = 1e-7;
    let [truth, _] = spectrum(1.0);
    let peak = truth.at_zero();
    for is_even in [true, false] {
        let mut transformed = truth.clone();
        for ((_, m, n), f) in transformed.half.indexed_iter_mut() {
            let sign = (m as f64 * truth.grid.nu.value(n)).signum();
            let off = if is_even { OFF } else { OFF * sign };
            *f += *f / f.norm_sqr().sqrt() * off * peak;
        }
        let measurement = measurement(&transformed, 1e-15, 2);
        let report = compare(&measurement, 0, &prediction(1.0), &TEST)
            .unwrap()
            .report;
        let [rho, cross, nu] = report.spectral_moments;
        let pairs = [rho, cross, nu, report.slope].map(|p| (p.measured, p.predicted, p.error));
        let widths = [report.bandwidth_95.rho, report.bandwidth_95.nu];
        let widths = widths.map(|p| (p.measured, p.predicted, p.error));
        for (measured, predicted, error) in pairs.into_iter().chain(widths) {
            let off = (measured.unwrap() - predicted.unwrap()).abs();
            // Three times the planted error is stated; rounding is 10⁻¹⁴.
            assert!(off <= error.unwrap(), "{off} {error:?}");
            assert!(error.unwrap() < 1e-3, "{error:?}");
        }
    }
}

/// The error of the shear slope is the error of a difference, and includes the noise of replicates.
#[test]
fn errors_of_slopes_hold_the_noise_of_replicates() {
    let [truth, _] = spectrum(1.0);
    let pull = |seed: u64| {
        let measured = measurement(&truth, 0.01, seed + 10);
        let expected = sampled(1.0, 0.02, 32, seed + 5000);
        let slope = compare(&measured, 0, &expected, &TEST)
            .unwrap()
            .report
            .slope;
        (slope.measured.unwrap() - slope.predicted.unwrap()) / slope.error.unwrap()
    };
    let squares: f64 = (0..100).map(|seed| pull(seed).powi(2)).sum();
    // The mean of 100 squares of numbers with unit variance has the standard deviation √(2/100),
    // and four standard deviations are 0.57. Without the replicates, whose noise power is eight
    // times the photons', the mean would be 9.
    let mean = squares / 100.0;
    assert!((mean - 1.0).abs() < 0.57, "{mean}");
}

/// The total of photons of equal weight has no noise. A quadrature is never exact, and its error
/// does not count as a disagreement with such a total.
#[test]
fn a_quadrature_is_excused_where_photons_have_no_noise() {
    let [truth, _] = spectrum(1.0);
    let nu = truth.grid.nu.half;
    // The first cells belong to the first azimuth and frequency.
    let measurement = noisy(&truth, 2, |cell| if cell == nu { 1e-9 } else { 0.02 });
    let compared = |off: f64, quadrature_error| {
        let mut expected = prediction(1.0);
        expected.quadrature_error = quadrature_error;
        expected.slices.half[[0, 0, nu]] *= 1.0 + off;
        compare(&measurement, 0, &expected, &TEST).unwrap().report
    };
    let stated = compared(1e-4, None).noise_limit.map(|noise| 0.1 * noise);
    assert!(stated.unwrap() > 2e-4, "{stated:?}");
    assert_eq!(compared(1e-4, None).verdict, Verdict::Fail);
    assert_eq!(compared(1e-4, stated).verdict, Verdict::Pass);
    // The error of the photons' fast transform may be as large as this tolerance.
    let report = compared(1e-7, None);
    assert_eq!(report.verdict, Verdict::Pass);
    // With noise of 1e-9, an error of 1e-7 has χ² of 1e4 at its frequency.
    assert!(report.p_value.unwrap() >= TEST.level && report.chi2_per_dof.unwrap() < 2.0);
    assert_eq!(compared(0.01, stated).verdict, Verdict::Fail);
}

/// Where noise exceeds the spectrum, the plane is undecided for every p-value.
#[test]
fn noise_decides_nothing() {
    let [truth, _] = spectrum(1.0);
    for seed in 0..5 {
        let noisy = measurement(&truth, 3.0, seed);
        let report = compare(&noisy, 0, &prediction(1.0), &TEST).unwrap().report;
        assert!(report.noise_limit.unwrap() > 0.5, "{report:?}");
        assert_eq!(report.verdict, Verdict::Undecided);
        assert!(report.photons_needed.unwrap() > 6400.0);
    }
}

#[test]
fn p_is_uniform_where_the_truth_is_predicted() {
    let [truth, _] = spectrum(1.0);
    let below = (0..50)
        .map(|seed| Residuals::new(&measurement(&truth, 0.02, seed + 10), 0, &truth))
        .filter(|residuals| residuals.p_value(1).unwrap() < 0.3)
        .count();
    // The expected number is 15 ± 3.2 of 50; the limits are four standard deviations.
    assert!((3..=27).contains(&below), "{below} of 50 below 0.3");
}

#[test]
fn darkness_is_judged_by_what_a_prediction_can_tell() {
    let dark = Slices::zeros(plane().grid);
    let mut predicted = prediction(1.0);
    // Closed blockers leave only rounding errors.
    predicted.slices.half.mapv_inplace(|f| f * 1e-16);
    let silent = compare(&measurement(&dark, 0.0, 1), 0, &predicted, &TEST)
        .unwrap()
        .report;
    assert_eq!(silent.verdict, Verdict::Pass);
    assert_eq!(
        (silent.p_value, silent.relative_error, silent.chi2_per_dof),
        (None, None, None)
    );
    let lit = compare(&measurement(&dark, 0.02, 1), 0, &predicted, &TEST)
        .unwrap()
        .report;
    assert_eq!(lit.verdict, Verdict::Fail, "light where none is predicted");
    // The tail of a window holds photons that a closed form cannot distinguish from its rounding.
    let tail = compare(&measurement(&dark, 1e-15, 1), 0, &predicted, &TEST)
        .unwrap()
        .report;
    assert!(tail.in_window > 0);
    assert_eq!(tail.verdict, Verdict::Pass);
    let unlit = compare(&measurement(&dark, 0.0, 1), 0, &prediction(1.0), &TEST)
        .unwrap()
        .report;
    // The measurement may be dark by chance, or because the light misses the window. Without
    // photons, there is no noise to compare with.
    assert_eq!(unlit.verdict, Verdict::Undecided);
    assert_eq!(
        (unlit.p_value, unlit.noise_limit, unlit.chi2_per_dof),
        (None, None, None)
    );
    assert!(unlit.undecided.unwrap().contains("none of 6400 photons"));
}

/// If a batch has no photon, there are too few photons for a decision, whatever the p-value is.
#[test]
fn a_batch_without_photons_decides_nothing() {
    let [truth, _] = spectrum(1.02);
    let full = measurement(&truth, 0.02, 2);
    let judged = |measurement: &Measurement| {
        let compared = compare(measurement, 0, &prediction(1.0), &TEST);
        compared.unwrap().report
    };
    assert_eq!(judged(&full).verdict, Verdict::Fail);
    let mut holed = Measurement::new(full.planes().to_vec());
    for (i, batch) in full.batches().enumerate() {
        let mut batch = batch.clone();
        if i == 7 {
            batch.planes[0].tally.inside = 0;
        }
        holed.insert(batch).unwrap();
    }
    let report = judged(&holed);
    assert_eq!(report.verdict, Verdict::Undecided);
    assert!(report.photons_needed.is_some() && report.undecided.is_some());
    // The spread of such batches is no noise.
    assert_eq!((report.p_value, report.noise_limit), (None, None));
    assert!(report.parameters.is_empty() && report.chi2_per_dof.is_none());
}

/// One heavy photon carries half of the light of a batch, or half of the light of a replicate of
/// the prediction. Other heavy photons may still be missing.
#[test]
fn light_of_a_few_heavy_photons_decides_nothing() {
    let [truth, _] = spectrum(1.0);
    let [quiet, dim] = [1.0, 0.1].map(|share| {
        let mut truth = truth.clone();
        truth.half.mapv_inplace(|f| f * share);
        measurement(&truth, 0.002, 4)
    });
    let mut uneven = Measurement::new(dim.planes().to_vec());
    for (i, batch) in dim.batches().enumerate() {
        let mut batch = batch.clone();
        if i == 7 {
            batch.planes[0].slices.half.mapv_inplace(|f| f * 64.0);
        }
        uneven.insert(batch).unwrap();
    }
    let replicates = |of: &Measurement| {
        let batches = of.at_plane(0).map(|batch| batch.slices.clone());
        batches.collect::<Vec<Slices>>()
    };
    let judged = |measured: &Measurement, other: &Measurement| {
        let reference = Prediction {
            slices: etendue_spectrum::estimate::slices(other, 0).unwrap().mean,
            replicates: replicates(other),
            class: Class::Reference,
            ..prediction(1.0)
        };
        compare(measured, 0, &reference, &TEST).unwrap().report
    };
    assert_eq!(judged(&dim, &quiet).verdict, Verdict::Fail);
    for report in [judged(&uneven, &quiet), judged(&quiet, &uneven)] {
        assert_eq!(report.verdict, Verdict::Undecided, "{report:?}");
        let why = report.undecided.unwrap();
        assert!(why.contains("carry most of the light"), "{why}");
        assert!(report.photons_needed.unwrap() > 6400.0);
    }
}

/// Noise is compared with the larger of both spectra. A prediction ten times too dim fails where a
/// correct one passes. Agreement does not count if the noise exceeds the resolution.
#[test]
fn noise_is_a_share_of_the_larger_spectrum() {
    let [truth, _] = spectrum(1.0);
    let noisy = measurement(&truth, 0.15, 3);
    let judged = |factor: f64, resolution: f64| {
        let mut predicted = prediction(1.0);
        predicted.slices.half.mapv_inplace(|f| f * factor);
        let test = Test { resolution, ..TEST };
        compare(&noisy, 0, &predicted, &test).unwrap().report
    };
    let right = judged(1.0, 0.1);
    let noise = right.noise_limit.unwrap();
    assert!((0.04..0.1).contains(&noise), "{noise}");
    assert_eq!(right.verdict, Verdict::Pass);
    assert_eq!(judged(0.1, 0.1).verdict, Verdict::Fail);
    let coarse = judged(1.0, 0.03);
    assert_eq!(coarse.verdict, Verdict::Undecided);
    let needed = coarse.photons_needed.unwrap() / 6400.0;
    // Noise falls with the square root of the number of photons.
    assert!(
        (needed / (noise / 0.03).powi(2) - 1.0).abs() < 0.1,
        "{needed}"
    );
}

#[test]
fn sidak_keeps_the_level_of_the_run() {
    let level = sidak(0.01, 4);
    assert!((1.0 - (1.0 - level).powi(4) - 0.01).abs() < 1e-15); // rounding
    assert!((sidak(0.01, 1) - 0.01).abs() < 1e-15); // rounding
}
