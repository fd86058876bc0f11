//! Calibration over many seeds: p must be uniform, χ²/dof must be 1 and pulls must have unit
//! variance.

use crate::progress::in_parallel;
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{compared, named, predicted, sampled, traced, words};
use crate::statistics::{mean, uniformity};
use etendue_compare::{PlaneReport, Prediction};
use etendue_predict::test_of;
use etendue_scene::{Sampling, Scene};
use etendue_spectrum::{Batch, Measurement};
use std::ops::Range;

/// The scene in which faults are planted.
pub(crate) const MAIN: &str = "fig9b";

/// The results of all seeds at one plane.
struct CalibratedPlane {
    name: String,
    p_values: Vec<f64>,
    /// The p-values of the radial spectrum.
    of_power: Vec<f64>,
    chi2: Vec<f64>,
    /// The pull of every parameter: (measured − scene) / error.
    pulls: Vec<f64>,
}

/// A fault that makes batches dependent, although the computation of p assumes independent
/// batches.
#[derive(Clone, Copy)]
enum DependenceFault {
    /// The second half of the batches contains the same photons as the first half.
    SharedPhotons,
    /// The last batch is a copy of the first batch, which is thus counted twice.
    CountedTwice,
}

const FAULTS: [(DependenceFault, &str); 2] = [
    (
        DependenceFault::SharedPhotons,
        "half of the batches sharing the photons of the others",
    ),
    (
        DependenceFault::CountedTwice,
        "one batch of 64 counted twice",
    ),
];

/// Compares a scene, traced with `photons` photons for each seed, with its prediction,
/// and checks the statistics of the comparisons.
///
/// Then the function checks the same statistics with planted faults: σ that is 10 % too small or
/// too large, and dependent batches. Each of the planted faults must be detected.
pub(crate) fn calibration(
    name: &'static str,
    seeds: Range<u64>,
    photons: u64,
    sampling: Sampling,
) -> Vec<ReportSection> {
    // With fewer seeds, a change of the variance by 3 % cannot be detected.
    let count = seeds.end - seeds.start;
    let plants = count >= 1000 && seeds.start == 1 && name == MAIN;
    let faults = FAULTS.iter().filter(|_| plants);
    let faults: Vec<Option<DependenceFault>> = faults.map(|(fault, _)| Some(*fault)).collect();
    let scene = sampled(named(name, Some(photons), Some(1)), sampling);
    let all = sample(seeds, &scene, &[&[None], &faults[..]].concat());
    let seeds = count;
    let judged = |scale: f64| judge(&all[0], seeds, &scene, scale);
    let mut sections = vec![judged(1.0)];
    let sound = sections[0].passes();
    for scale in [0.9, 1.1].into_iter().filter(|_| name == MAIN) {
        let title = format!("The same with σ scaled by {scale}");
        let text = "A fault is planted in the stated errors. Required: the calibration fails by \
            the bounds above.";
        sections.push(judged(scale).planted(title, text, sound));
    }
    for (planes, (_, name)) in all[1..].iter().zip(FAULTS) {
        let section = judge(planes, seeds, &scene, 1.0);
        let title = format!("The same with {name}");
        let text = "The planted fault makes batches depend on each other. Required: p is not \
            uniform by the bounds above.";
        sections.push(section.planted(title, text, sound));
    }
    sections
}

/// A copy of the measurement in which batches are dependent.
fn planted(measurement: &Measurement, fault: DependenceFault) -> Measurement {
    let batches: Vec<&Batch> = measurement.batches().collect();
    let mut planted = Measurement::new(measurement.planes().to_vec());
    for (i, batch) in batches.iter().enumerate() {
        let half = batches.len() / 2;
        let copied = match fault {
            DependenceFault::SharedPhotons => i % half,
            DependenceFault::CountedTwice if i + 1 == batches.len() => 0,
            DependenceFault::CountedTwice => i,
        };
        let copy = Batch {
            index: batch.index,
            ..batches[copied].clone()
        };
        planted.insert(copy).expect("each number once");
    }
    planted
}

/// The results of all seeds, for each fault and for no fault.
fn sample(
    seeds: Range<u64>,
    scene: &Scene,
    faults: &[Option<DependenceFault>],
) -> Vec<Vec<CalibratedPlane>> {
    let predictions = predicted(scene, None);
    let reports = in_parallel(seeds, "seeds", |seed| {
        reports(scene.clone(), seed, &predictions, faults)
    });
    let plane = |fault: usize, i: usize| {
        let of_plane = || reports.iter().map(move |r| &r[fault][i]);
        CalibratedPlane {
            name: reports[0][fault][i].name.clone(),
            p_values: of_plane().filter_map(|r| r.p_value).collect(),
            of_power: of_plane().filter_map(|r| r.radial?.p_value).collect(),
            chi2: of_plane().filter_map(|r| r.chi2_per_dof).collect(),
            pulls: of_plane()
                .flat_map(|r| r.parameters.iter())
                .map(|p| (p.measured - p.scene) / p.error)
                .collect(),
        }
    };
    let planes = |fault: usize| (0..predictions.len()).map(|i| plane(fault, i)).collect();
    (0..faults.len()).map(planes).collect()
}

/// The reports on the planes of one seed, for each of the faults.
fn reports(
    mut scene: Scene,
    seed: u64,
    predictions: &[Prediction],
    faults: &[Option<DependenceFault>],
) -> Vec<Vec<PlaneReport>> {
    scene.run.seed = seed;
    let sound = traced(&scene);
    let level = test_of(&scene).level;
    let with = |fault: &Option<DependenceFault>| {
        let planted = fault.map(|fault| planted(&sound, fault));
        let measurement = planted.as_ref().unwrap_or(&sound);
        let report = |(i, prediction)| compared(&scene, measurement, i, prediction, level).report;
        predictions.iter().enumerate().map(report).collect()
    };
    faults.iter().map(with).collect()
}

fn judge(planes: &[CalibratedPlane], seeds: u64, scene: &Scene, scale: f64) -> ReportSection {
    let mut rows = Vec::new();
    let all: Vec<f64> = planes
        .iter()
        .flat_map(|p| p.p_values.iter().copied())
        .collect();
    // The binomial standard deviation of the fraction of p-values below 0.1 at one plane. All
    // planes of a seed have the same photons, so their p-values are correlated. Therefore the
    // average over the planes removes some of this deviation, but less than for independent
    // planes. The fraction of p-values below 0.1 may deviate by two of these standard
    // deviations over all planes, and by three at a single plane.
    let deviation = (0.1 * 0.9 / seeds as f64).sqrt();
    let [allowed, allowed_each] = [2.0, 3.0].map(|n| n * deviation);
    let below = |p: &[f64]| p.iter().filter(|p| **p < 0.1).count() as f64 / p.len() as f64;
    for plane in planes {
        let uniform = uniformity(&plane.p_values);
        let of_power = uniformity(&plane.of_power);
        let chi2: Vec<f64> = plane.chi2.iter().map(|t| t / (scale * scale)).collect();
        let [chi2, error] = mean(&chi2);
        let squares: Vec<f64> = plane.pulls.iter().map(|z| (z / scale).powi(2)).collect();
        let [pull, pull_error] = mean(&squares);
        // A pull from R = 64 batches has Student's distribution: the mean of its square is 63/61.
        let expected_pull = 63.0 / 61.0;
        let share = (below(&plane.p_values) - 0.1).abs();
        let share_of_power = (below(&plane.of_power) - 0.1).abs();
        let level = 1.0 - 0.99_f64.powf(1.0 / planes.len() as f64);
        let few = "four standard errors, and the few frequencies whose residual is real";
        let (apart, off) = ((chi2 - 1.0).abs(), (pull - expected_pull).abs());
        let checks = vec![
            Check::new("uniform p", uniform, AtLeast(level)).because("1 % over the planes"),
            Check::new("p of power", of_power, AtLeast(level)).because("1 % over the planes"),
            Check::new("p of power < 10 %", share_of_power, Below(allowed_each))
                .because("three deviations"),
            Check::new("p < 10 %", share, Below(allowed_each)).because("three deviations"),
            Check::new("χ²/dof", apart, Below(4.0 * error + 0.003)).because(few),
            Check::new("pull", off, Below(4.0 * pull_error)).because("four standard errors"),
        ];
        let cells = vec![
            plane.name.clone(),
            format!("{uniform:.3}"),
            format!("{:.1} %", 100.0 * below(&plane.p_values)),
            format!("{of_power:.3}"),
            format!("{:.1} %", 100.0 * below(&plane.of_power)),
            format!("{chi2:.4} ± {error:.4}"),
            format!("{pull:.3} ± {pull_error:.3}"),
        ];
        rows.push(Row::new(cells, checks));
    }
    let share = below(&all);
    let off = (share - 0.1).abs();
    let check = Check::new("p < 10 %", off, Below(allowed)).because("two deviations");
    let mut cells = vec![String::new(); 7];
    (cells[0], cells[2]) = ("all".into(), format!("{:.1} %", 100.0 * share));
    rows.push(Row::new(cells, vec![check]));
    ReportSection::new(
        format!(
            "Calibration of {} over {seeds} seeds at {:.0e} photons, {}",
            scene.name,
            scene.run.photons as f64,
            words(scene.run.sampling)
        ),
        format!(
            "A scene is measured with many seeds, to test whether p-values and stated errors are \
             correct: the p of the slices, and the p of power, which is that of the radial \
             spectrum. *KS p of uniformity* is the p-value of a Kolmogorov–Smirnov test of whether \
             p is uniform. *p < 10 %* is the share of seeds with such a p. A pull is the deviation \
             of a parameter from the scene, in units of its stated error. Required: p is uniform \
             by the Kolmogorov–Smirnov test at 1 % over all planes together. The share of p below \
             10 % is between {:.1} and {:.1} % over all planes: these are two binomial deviations \
             of a single plane, because planes share photons. It is between {:.1} and {:.1} % for \
             each plane, which is three deviations. The mean χ²/dof is 1 within four standard \
             errors and 0.003, because a few residuals are real numbers. The mean squared pull is \
             63/61 within four standard errors.",
            100.0 * (0.1 - allowed),
            100.0 * (0.1 + allowed),
            100.0 * (0.1 - allowed_each),
            100.0 * (0.1 + allowed_each)
        ),
        "plane | KS p of uniformity | p < 10 % | KS p of power | p of power < 10 % | mean χ²/dof | \
         mean squared pull",
        rows,
    )
}
