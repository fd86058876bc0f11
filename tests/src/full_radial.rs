//! Tests of the full radial spectrum: over many seeds p must be uniform, and planted faults must
//! be rejected.

use crate::progress::in_parallel;
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{emit, read, sound};
use crate::statistics::{mean, uniformity};
use etendue_compare::{FullRadialComparison, FullRadialReport, PredictedField};
use etendue_field::{FieldGrid, PhotonSource};
use etendue_predict::{Applicability, predict_field};
use etendue_scene::Scene;
use etendue_spectrum::field::{FieldMeasurement, FieldOptions, measure_field};
use etendue_trace::{Backward, Tracer};

/// A plane of a scene, with the method that predicts its full radial spectrum.
struct Case {
    scene: &'static str,
    plane: &'static str,
    /// Fields of the scene file that are replaced, each with its new value.
    set: &'static [(&'static str, &'static str)],
    by: &'static str,
}

/// The spectra have fewer frequencies than in the scene files, so that 200 seeds take only
/// minutes.
const FEWER: &[(&str, &str)] = &[("frequencies.rho.max", "6"), ("frequencies.nu.max", "8")];

const CASES: &[Case] = &[
    Case {
        scene: "fig9b",
        plane: "receiver",
        set: FEWER,
        by: "closed form",
    },
    Case {
        scene: "tilted_card",
        plane: "receiver",
        set: FEWER,
        by: "nets of rays past an obstacle",
    },
    Case {
        scene: "table1/glossy",
        plane: "reflection",
        set: &[("frequencies.rho.max", "15"), ("frequencies.nu.max", "8")],
        by: "nets of scattered rays",
    },
];

/// Faults planted in predictions of the first case: each changes a field of the predicted scene
/// to the given value.
const FAULTS: &[(&str, &str, &str)] = &[
    ("surfaces.0.center", "(0, 0, 2.02)", "a shear 1 % too large"),
    ("blockers.0.pitch", "0.21", "blockers of another pitch"),
    ("light.radiance", "1.005", "a light 0.5 % too bright"),
    ("blockers.0.seed", "2", "blockers in other places"),
];

impl Case {
    /// The name of the scene, without its folder.
    fn name(&self) -> &'static str {
        self.scene.rsplit('/').next().unwrap_or(self.scene)
    }

    /// The scene of the case with only the plane of the case.
    fn scene(&self, photons: u64, seed: u64, set: &[(&str, &str)]) -> Scene {
        let set = self.set.iter().chain(set);
        let set: Vec<_> = set.map(|(k, v)| (*k, (*v).to_owned())).collect();
        let mut file = read(self.scene, &set);
        emit(&mut file.run, Some(photons));
        file.run.seed = seed;
        let scene = sound(self.name(), file);
        let mut planes = scene.planes.iter();
        let index = planes.position(|plane| plane.name == self.plane);
        let scene = scene.seen_at(&[index.expect("a plane of the scene")]);
        scene.on_grids()
    }
}

const OPTIONS: FieldOptions = FieldOptions {
    assignment: etendue_field::Assignment::Tsc,
    groups: 16,
    keep: true,
    spectra: true,
    covariance: false,
};

fn grid(scene: &Scene) -> FieldGrid {
    OPTIONS.grid(&scene.planes[0])
}

fn measured(scene: &Scene, source: &dyn PhotonSource) -> FieldMeasurement {
    let batches = 0..scene.run.batches;
    let field = measure_field(source, 0, &scene.planes[0], batches, &OPTIONS, &|_| ());
    field.expect("64 batches")
}

fn predicted(scene: &Scene) -> PredictedField {
    let plane = &scene.planes[0];
    let theory = Applicability::new(scene, plane);
    let over = (grid(scene), OPTIONS.assignment);
    let found = predict_field(scene, plane, &theory, over, OPTIONS.groups);
    found.expect("a plane that theory predicts")
}

fn compared(
    scene: &Scene,
    measured: &FieldMeasurement,
    predicted: &PredictedField,
) -> FullRadialReport {
    FullRadialComparison::new(measured, predicted, scene.run.seed).report
}

/// Three sections: the calibration over many seeds, faults planted in predictions, and a
/// fault planted in the calibration.
pub(crate) fn full_radial(seeds: u64, photons: u64) -> Vec<ReportSection> {
    let found: Vec<(String, Vec<FullRadialReport>)> = CASES
        .iter()
        .map(|case| over_seeds(case, seeds, photons))
        .chain([against_rays(&CASES[0], seeds, photons)])
        .collect();
    let calibrated = calibrated(&found, seeds, photons);
    let is_sound = calibrated.passes();
    vec![
        calibrated,
        faults(8 * photons),
        dependent(seeds, photons, is_sound),
    ]
}

/// Compares, for each seed, the photons of a case with the prediction of this case. Each seed turns
/// the axes of the planes by another angle, so that the noise of predictions by nets of rays, which
/// have no seed, differs too.
fn over_seeds(case: &Case, seeds: u64, photons: u64) -> (String, Vec<FullRadialReport>) {
    let title = format!("{} {}: {}", case.name(), case.plane, case.by);
    (
        title,
        in_parallel(1..=seeds, "seeds", |seed| {
            let (sin, cos) = libm::sincos(seed as f64);
            let axis = format!("({cos}, {sin}, 0)");
            let scene = case.scene(photons, seed, &[("path.x_axis", &axis)]);
            let measured = measured(&scene, &Tracer::new(&scene));
            compared(&scene, &measured, &predicted(&scene))
        }),
    )
}

/// Compares photons with backward rays, as a run does for planes without a theory.
fn against_rays(case: &Case, seeds: u64, photons: u64) -> (String, Vec<FullRadialReport>) {
    let title = format!("{} {}: backward rays", case.scene, case.plane);
    (
        title,
        in_parallel(1..=seeds, "seeds", |seed| {
            let scene = case.scene(photons, seed, &[]);
            let rays = Backward::new(&scene).expect("rays find an area light");
            let reference = PredictedField::reference(measured(&scene, &rays).groups);
            compared(&scene, &measured(&scene, &Tracer::new(&scene)), &reference)
        }),
    )
}

/// A table row that summarises the p-values of many seeds.
fn row(name: &str, found: &[FullRadialReport], level: f64) -> Row {
    let p: Vec<f64> = found
        .iter()
        .filter_map(|report| report.power.p_value)
        .collect();
    let chi2: Vec<f64> = found
        .iter()
        .filter_map(|report| report.power.chi2_per_bin)
        .collect();
    let uniform = uniformity(&p);
    let n = found.len() as f64;
    let low = p.iter().filter(|p| **p < 0.1).count() as f64 / n;
    let allowed = 3.0 * (0.1 * 0.9 / n).sqrt();
    let [chi2, error] = mean(&chi2);
    let checks = vec![
        Check::new("uniform p", uniform, AtLeast(level)).because("1 % over the rows"),
        Check::new("p < 10 %", (low - 0.1).abs(), Below(allowed))
            .because("three binomial deviations"),
        Check::new("χ²/bin", (chi2 - 1.0).abs(), Below(4.0 * error))
            .because("four standard errors"),
        Check::new("counted", n - p.len() as f64, Below(0.5)).because("each seed must have a p"),
    ];
    let cells = vec![
        name.to_owned(),
        found[0].power.bins.to_string(),
        format!("{uniform:.3}"),
        format!("{:.1} %", 100.0 * low),
        format!("{chi2:.3} ± {error:.3}"),
    ];
    Row::new(cells, checks)
}

const HEADER: &str = "plane | bins | KS p of uniformity | p < 10 % | mean χ²/bin";

fn calibrated(
    found: &[(String, Vec<FullRadialReport>)],
    seeds: u64,
    photons: u64,
) -> ReportSection {
    let level = 1.0 - 0.99_f64.powf(1.0 / found.len() as f64);
    let rows = found.iter().map(|(name, found)| row(name, found, level));
    ReportSection::new(
        format!("p of the full radial spectrum over {seeds} seeds"),
        format!(
            "For each seed, {photons} photons are compared with a prediction of its own. *KS p of \
             uniformity* is the p-value of a Kolmogorov–Smirnov test of whether p is uniform. \
             Required: p is uniform by this test at 1 % over all rows together. The share of seeds \
             with p < 10 % is 10 % within three binomial deviations. The mean χ²/bin is 1 within \
             four standard errors."
        ),
        HEADER,
        rows,
    )
}

/// Compares predictions that have a planted fault with photons that have no fault.
fn faults(photons: u64) -> ReportSection {
    const LEVEL: f64 = 0.002;
    let case = &CASES[0];
    let scene = case.scene(photons, crate::SEED, &[]);
    let field = measured(&scene, &Tracer::new(&scene));
    let sound = predicted(&scene);
    let found = |name: &str, prediction: &PredictedField, rejected: bool| {
        let report = compared(&scene, &field, prediction);
        let p = report.power.p_value.unwrap_or(f64::NAN);
        let check = if rejected {
            Check::new("rejected", p, Below(LEVEL)).because("a fault is planted")
        } else {
            Check::new("accepted", p, AtLeast(LEVEL)).because("no fault is planted")
        };
        let chi2 = report.power.chi2_per_bin.unwrap_or(f64::NAN);
        Row::new(
            vec![name.to_owned(), format!("{p:.5}"), format!("{chi2:.2}")],
            vec![check],
        )
    };
    let mut rows = vec![found("none", &sound, false)];
    for (word, value, name) in FAULTS {
        let other = case.scene(photons, crate::SEED, &[(word, value)]);
        rows.push(found(name, &predicted(&other), true));
    }
    rows.push(found("aliasing left out", &alias_free(&scene), true));
    ReportSection::new(
        "Faults planted in predictions of full radial spectra",
        format!(
            "Each fault is planted in the prediction for {} {}, which is compared with {photons} \
             photons. Required: p ≥ {LEVEL} without a fault, and p < {LEVEL} with each fault.",
            case.scene, case.plane
        ),
        "fault | p | χ²/bin | verdict",
        rows,
    )
}

/// Predicts the continuous spectrum, without the aliasing of a grid. This prediction is a planted
/// fault.
fn alias_free(scene: &Scene) -> PredictedField {
    use etendue_predict::Theory;
    let plane = &scene.planes[0];
    let Theory::Parallel(chain) = Applicability::new(scene, plane).theory else {
        panic!("a plane between parallel planes");
    };
    let grid = grid(scene);
    let axes = [0, 1, 2, 3];
    let spacing = axes.map(|axis| grid.spacing(axis));
    let half = axes.map(|axis| grid.cells[axis] / 2);
    let harmonics = etendue_theory::Harmonics::new(&chain, &plane.window, spacing, half);
    let harmonics = harmonics.expect("no receiver before the plane");
    let PredictedField::Exact { mut spectrum, .. } = predicted(scene) else {
        panic!("a closed form");
    };
    for ((x, y, u, v), value) in spectrum.values.indexed_iter_mut() {
        let index = [x, y, u, v];
        *value = harmonics.at(axes.map(|axis| grid.harmonic(axis, index[axis])));
    }
    PredictedField::Exact {
        spectrum,
        alias_free: None,
    }
}

/// The calibration must fail if groups of batches share photons.
fn dependent(seeds: u64, photons: u64, is_sound: bool) -> ReportSection {
    let case = &CASES[0];
    let prediction = predicted(&case.scene(photons, 1, &[]));
    let found = in_parallel(1..=seeds, "seeds", |seed| {
        let scene = case.scene(photons, seed, &[]);
        let mut field = measured(&scene, &Tracer::new(&scene));
        let half = field.groups.len() / 2;
        let copies = field.groups[..half].to_vec();
        field.groups[half..].clone_from_slice(&copies);
        compared(&scene, &field, &prediction)
    });
    let section = ReportSection::new("", "", HEADER, [row(case.plane, &found, 0.01)]);
    section.planted(
        "The same with half of the groups sharing the photons of the others".to_owned(),
        "The planted fault makes groups of batches depend on each other. Required: the \
        calibration fails by the bounds above.",
        is_sound,
    )
}
