//! Measures scenes by their difference from another scene with the same photons, over many seeds: the
//! gain over independent photons, and whether p-values and stated errors are right.

use crate::progress::in_parallel;
use crate::report::Bound::{Above, AtLeast, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{paired, predicted, read, sampled, sound, traced, words};
use crate::statistics::{mean, uniformity};
use etendue_compare::{MIN_DIFFERING, PredictedParameter, Prediction, Residuals, score};
use etendue_field::Slices;
use etendue_scene::{RunSettings, Sampling, Scene};

/// Options of the comparison.
#[derive(Debug, clap::Args)]
pub(crate) struct PairOptions {
    /// Seeds of each change.
    #[arg(long, default_value_t = 16)]
    seeds: u64,
    /// Photons of each run.
    #[arg(long, default_value_t = 1 << 17)]
    photons: u64,
}

/// A scene, one of its planes, and changes of its fields.
type ChangedScene = (
    &'static str,
    &'static str,
    &'static [(&'static str, &'static str)],
);

/// Scenes of six kinds.
const CHANGES: [ChangedScene; 6] = [
    (
        "fig9b",
        "receiver",
        &[
            ("blockers.0.fill", "0.600006"),
            ("blockers.0.fill", "0.60006"),
            ("blockers.0.fill", "0.6006"),
            ("blockers.0.fill", "0.606"),
            ("blockers.0.fill", "0.66"),
            ("blockers.0.center", "(0.001,0,1)"),
            ("blockers.0.center", "(0,0,1.001)"),
            ("blockers.0.seed", "2"),
            ("surfaces.0.center", "(0,0,2.001)"),
            ("light.size", "(0.2002,0.2)"),
        ],
    ),
    (
        "deep_mesh",
        "receiver",
        &[
            ("blockers.0.center", "(0.201,0,1)"),
            ("blockers.0.mesh.radius", "0.3003"),
        ],
    ),
    (
        "table1/concave_oblique",
        "beyond",
        &[
            ("surfaces.0.form", "Sphere(-0.5005)"),
            ("surfaces.0.center", "(0,0,1.001)"),
        ],
    ),
    (
        "table1/ggx_sphere",
        "outgoing",
        &[
            ("surfaces.0.event.brdf.lobe", "Ggx(0.1001)"),
            ("surfaces.0.event.brdf.lobe", "Beckmann(0.1)"),
            ("surfaces.0.form", "Sphere(0.5005)"),
        ],
    ),
    (
        "diffuse",
        "on_its_way",
        &[
            ("blockers.0.shapes.0.size", "(0.2002,0.3)"),
            ("surfaces.0.albedo", "0.5005"),
        ],
    ),
    (
        "two_lights",
        "arrival",
        &[
            ("other_lights.0.radius", "0.15015"),
            ("blockers.0.center", "(0.051,0,1)"),
        ],
    ),
];

/// The smallest share of the noise of independent photons that a change must save: pairs that gain
/// nothing are a fault of the tracers.
const LEAST_GAIN: f64 = 1.2;

/// The largest error of a prediction, as a share of the noise of the pairs, with which the
/// prediction is compared with them. An error of this size adds a hundredth to χ².
const UNSEEN: f64 = 0.1;

/// The level at which a change is seen.
const LEVEL: f64 = 0.01;

/// The change of one field of a scene that has one plane.
struct ChangedPair {
    scenes: [Scene; 2],
    /// The predictions of both scenes.
    predictions: [Prediction; 2],
}

/// What one seed finds.
struct PairStatistics {
    /// The noise of independent photons over the noise of pairs.
    gain: f64,
    p_value: Option<f64>,
    /// p of no change.
    p_nothing: Option<f64>,
    /// p with a predicted difference that is 10 % too large.
    p_planted: Option<f64>,
    chi2_per_dof: Option<f64>,
    /// The measured over the predicted difference, and its error.
    ratio: Option<[f64; 2]>,
}

/// Compares the differences of all changes with their predictions.
pub(crate) fn pairs(options: &PairOptions) -> Vec<ReportSection> {
    let kinds = [Sampling::Lattice, Sampling::Net, Sampling::Random];
    kinds.map(|sampling| section(options, sampling)).into()
}

fn section(options: &PairOptions, sampling: Sampling) -> ReportSection {
    let (mut rows, mut all) = (Vec::new(), Vec::new());
    for (name, plane, changes) in CHANGES {
        let scene = |fields: &[(&str, String)]| {
            let mut file = read(name, fields);
            file.run.photons = options.photons;
            let name = name.rsplit('/').next().unwrap_or(name);
            let scene = sampled(sound(name, file), sampling);
            let at = scene.plane_named(plane).expect("a plane of the scene");
            scene.seen_at(&[at])
        };
        let original = scene(&[]);
        let known = predicted(&original, None).swap_remove(0);
        for (field, value) in changes {
            let changed = scene(&[(*field, (*value).to_owned())]);
            let prediction = predicted(&changed, None).swap_remove(0);
            let change = ChangedPair {
                scenes: [original.clone(), changed],
                predictions: [known.clone(), prediction],
            };
            // Each change has seeds of its own, so that the numbers of all changes are independent.
            let first = 1 + all.len() as u64;
            let seeds = first..first + options.seeds;
            let found = in_parallel(seeds, "seeds", |seed| change.found(seed));
            rows.push(row(&[name, field, value], &found));
            all.extend(found);
        }
    }
    let of = |number: fn(&PairStatistics) -> Option<f64>| {
        all.iter().filter_map(number).collect::<Vec<_>>()
    };
    let uniform = uniformity(&of(|found| found.p_value));
    let planted = uniformity(&of(|found| found.p_planted));
    let pulls = of(|found| found.ratio.map(|[ratio, error]| (ratio - 1.0) / error));
    let (pull, of_pulls) = checks_of_pulls(&pulls);
    let mut checks = vec![
        Check::new("uniform p", uniform, AtLeast(0.01)).because("level of the test"),
        Check::new("planted", planted, Below(0.01)).because("a planted fault must be seen"),
    ];
    checks.extend(of_pulls);
    let cells = ["all", "", "", "", "", "", &pull, &format!("{uniform:.3}")];
    rows.push(Row::new(cells.map(str::to_owned).to_vec(), checks));
    let text = format!(
        "Two scenes are traced with the same photons, {} each, {}, with {} seeds. *Gain* is the \
         noise of the difference of independent runs over the noise of pairs. *Seen* is the share of the \
         seeds in which one plane tells the change from no change at the level of 1 %. *Measured over \
         predicted* is the size of the measured difference along the difference of the predictions; \
         a pull is its deviation from 1, in units of its stated error. A dash stands where \
         fewer than {MIN_DIFFERING} batches differ, or where the errors of the predictions are above a tenth of \
         the noise. *KS p* is the p-value of a \
         Kolmogorov–Smirnov test of whether p is uniform, where p tests the measured against the \
         predicted difference. Required, over all changes: p is uniform, the mean pull is 0 and the \
         mean squared pull is 63/61; and p is not uniform if the predicted differences are planted \
         10 % too large.",
        options.photons,
        words(sampling),
        options.seeds
    );
    let columns =
        "scene | field | value | gain | seen | mean χ²/dof | measured over predicted | KS p";
    ReportSection::new(format!("Pairs, {}", words(sampling)), text, columns, rows)
}

/// The mean and the mean square of pulls from 64 batches, as text, and the checks of both.
pub(crate) fn checks_of_pulls(pulls: &[f64]) -> (String, [Check; 2]) {
    let [average, error] = mean(pulls);
    let [square, error_of_square] = mean(&pulls.iter().map(|z| z * z).collect::<Vec<_>>());
    let four = "four standard errors";
    // A pull from R = 64 batches has Student's distribution: the mean of its square is 63/61.
    let off = (square - 63.0 / 61.0).abs();
    (
        format!("{average:.3} ± {error:.3}, square {square:.3} ± {error_of_square:.3}"),
        [
            Check::new("mean pull", average.abs(), Below(4.0 * error)).because(four),
            Check::new("square", off, Below(4.0 * error_of_square)).because(four),
        ],
    )
}

fn row(names: &[&str; 3], found: &[PairStatistics]) -> Row {
    let of = |number: fn(&PairStatistics) -> Option<f64>| {
        found.iter().filter_map(number).collect::<Vec<_>>()
    };
    let [gain, _] = mean(&of(|found| Some(found.gain)));
    let [chi2, _] = mean(&of(|found| found.chi2_per_dof));
    let [ratio, error] = mean(&of(|found| found.ratio.map(|[ratio, _]| ratio)));
    let uniform = uniformity(&of(|found| found.p_value));
    let [seen, _] = mean(&of(|found| {
        found.p_nothing.map(|p| f64::from(u8::from(p < LEVEL)))
    }));
    let numbers = [
        format!("{gain:.1}"),
        format!("{:.0} %", 100.0 * seen),
        format!("{chi2:.3}"),
        format!("{ratio:.4} ± {error:.4}"),
        format!("{uniform:.3}"),
    ];
    // Predictions of some scenes have errors above the noise of the pairs.
    let numbers = numbers.map(|text| match text {
        text if text.contains("NaN") => "–".to_owned(),
        text => text.replace("inf", "∞"),
    });
    let cells = names.iter().map(|name| (*name).to_owned()).chain(numbers);
    let check =
        Check::new("gain", gain, Above(LEAST_GAIN)).because("less is a fault of the tracers");
    Row::new(cells.collect(), vec![check])
}

impl ChangedPair {
    fn found(&self, seed: u64) -> PairStatistics {
        let seeded = |scene: &Scene| {
            let mut scene = scene.clone();
            scene.run.seed = seed;
            scene
        };
        let [a, b] = self.scenes.each_ref().map(seeded);
        let [of_a, of_b] = paired([&a, &b]);
        let grid = a.planes[0].grid;
        let [batches_of_a, batches_of_b] =
            [&of_a, &of_b].map(|of| of.at_plane(0).map(|batch| batch.slices.half.view()));
        let differences = Residuals::of_pairs(grid, batches_of_a, batches_of_b);
        let [known, prediction] = self.predictions.each_ref().map(|of| &of.slices);
        let expected = &prediction.half - &known.half;
        let rest = differences.without(&expected);
        let wrong = differences.without(&expected.mapv(|of| 1.1 * of));
        let variance = differences.variance();
        let run = RunSettings {
            seed: seed + 1_000_000,
            ..b.run
        };
        let independent = traced(&Scene { run, ..b });
        let [apart, alone] = [&of_a, &independent].map(|of| {
            let batches = of.at_plane(0).map(|batch| batch.slices.half.clone());
            Residuals::of(grid, batches.collect()).variance().sum()
        });
        let parameter = PredictedParameter {
            name: String::new(),
            unit: String::new(),
            value: 0.0,
            derivative: Slices {
                grid,
                half: expected,
            },
        };
        let noise = variance.sum().sqrt();
        let is_known = self.predictions.iter().all(|prediction| {
            let error = prediction.error().unwrap_or(0.0);
            error * prediction.slices.norm() < UNSEEN * noise
        });
        let ratio = score(&differences, &variance, &parameter, 0.0);
        let has_errors = differences.differing() >= MIN_DIFFERING;
        PairStatistics {
            gain: (apart + alone).sqrt() / noise,
            p_value: rest.p_value(seed).filter(|_| is_known && has_errors),
            p_nothing: differences.p_value(seed),
            p_planted: wrong.p_value(seed).filter(|_| is_known && has_errors),
            chi2_per_dof: rest
                .chi2_per_dof(&variance)
                .filter(|_| is_known && has_errors),
            ratio: ratio
                .filter(|_| is_known && has_errors)
                .map(|of| [of.measured, of.error]),
        }
    }
}
