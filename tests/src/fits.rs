//! Measures the errors of fits over many seeds: pulls, p, the Cramér–Rao bound, starts that are far
//! off, degenerate scenes and wrong models.

use crate::progress::in_parallel;
use crate::report::Bound::{AtLeast, AtMost, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{predicted, traced};
use crate::statistics::{mean, uniformity};
use etendue_compare::{Verdict, solved};
use etendue_field::Slices;
use etendue_scene::{Scene, SceneFile};
use etendue_spectrum::Measurement;
use etendue_store::Failure;
use etendue_studies::fit::{FitData, FitModel, FitStarts, Fitted, fit};
use etendue_transform::random::{Stream, unit, words};
use ndarray::{Array1, Array2, Axis, stack};

/// The number of seeds.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct FitOptions {
    /// Number of seeds of each scene; where predictions are nets, a sixth.
    #[arg(long, default_value_t = 240)]
    pub(crate) seeds: u64,
}

/// A scene with free fields, whose values are their start.
#[derive(Clone, Copy)]
struct FitScene {
    name: &'static str,
    text: &'static str,
    free: &'static [&'static str],
    photons: u64,
}

const FLOOR: &str = "surfaces: [Rectangle(name: \"floor\", center: (0, 0, 2), size: (6, 6))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"floor\"]),";

const SCENES: [FitScene; 5] = [
    FitScene {
        name: "light and distance",
        text: "(light: Rectangle(center: (0, 0, 0), size: (0.2, 0.3), radiance: 1.0), FLOOR
    planes: [(name: \"at\", at: Distance(1.2))],
    window: (x: Hann(0.5), u: Hann(0.5)), frequencies: (azimuths: 2, rho: (max: 6), nu: (max: 6)),",
        free: &["light.size.0", "planes.0.at.Distance"],
        photons: 1 << 14,
    },
    FitScene {
        name: "grating",
        text: "(light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: 1.0), FLOOR
    blockers: [Grating(name: \"bars\", center: (0, 0, 1), axis: X, frequency: 5)],
    planes: [(name: \"at\", at: Before(\"floor\"))],
    window: (x: Hann(0.5), u: Hann(0.5)), frequencies: (azimuths: 2, rho: (max: 6), nu: (max: 12)),",
        free: &["blockers.0.center.2", "blockers.0.frequency", "surfaces.0.center.2"],
        photons: 1 << 14,
    },
    FitScene {
        name: "discs",
        text: "(light: Disc(center: (0, 0, 0), radius: 0.15, radiance: 1.0), FLOOR
    blockers: [Shapes(name: \"discs\", center: (0, 0, 1), shapes: [Disc(center: (-0.12, 0.05), radius: 0.1)])],
    planes: [(name: \"behind\", at: After(\"discs\")), (name: \"at\", at: Before(\"floor\"))],
    window: (x: Hann(0.5), u: Hann(0.5)), frequencies: (azimuths: 2, rho: (max: 6), nu: (max: 6)),",
        free: &["light.radius", "blockers.0.shapes.0.radius", "light.radiance"],
        photons: 1 << 14,
    },
    FitScene {
        name: "mirror",
        text: "(light: Rectangle(center: (0, 0, 0), size: (0.3, 0.3), radiance: 1.0),
    surfaces: [Smooth(name: \"mirror\", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: Sphere(0.4), aperture: 0.6, event: Mirror)],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"mirror\"]),
    planes: [(name: \"at\", at: Distance(1.5))],
    window: (x: Hann(0.2), u: Hann(0.3)), frequencies: (azimuths: 2, rho: (max: 15), nu: (max: 10)),",
        free: &["surfaces.0.form.Sphere", "light.size.0"],
        photons: 1 << 14,
    },
    FitScene {
        name: "glossy",
        text: "(light: Rectangle(center: (0, 0, 0), size: (0.3, 0.3), radiance: 1.0),
    surfaces: [Smooth(name: \"mirror\", center: (0, 0, 1), facing: (0.6, 0, -0.8), form: Plane, aperture: 0.6, event: Reflects(brdf: (lobe: Beckmann(0.2), albedo: 0.8)))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"mirror\"]),
    planes: [(name: \"at\", at: Distance(1.3))],
    window: (x: Hann(0.2), u: Hann(0.4)), frequencies: (azimuths: 2, rho: (max: 10), nu: (max: 6)),",
        free: &["surfaces.0.event.Reflects.brdf.lobe.Beckmann", "light.radiance"],
        photons: 1 << 14,
    },
];

impl FitScene {
    fn with(&self, values: &[f64], seed: u64) -> Result<Scene, Failure> {
        let text = self.text.replace("FLOOR", FLOOR);
        let text = format!(
            "{text} run: (photons: {}, seed: {seed}, batches: 64))",
            self.photons
        );
        let file = SceneFile::parse(&text).map_err(Failure::bad_input)?;
        let fields = self.free.iter().zip(values);
        let fields: Vec<_> = fields
            .map(|(path, v)| ((*path).to_owned(), format!("{v:?}")))
            .collect();
        let file = file.with_all(&fields).map_err(Failure::bad_input)?;
        etendue_scene::resolve("fit", file, ".".as_ref(), u64::MAX).map_err(Failure::bad_input)
    }

    /// The number of seeds out of `all`: fits of predictions by nets take long.
    fn seeds(&self, all: u64) -> u64 {
        match self.text.contains("Reflects") {
            true => (all / 6).max(1),
            false => all,
        }
    }

    fn truth(&self) -> Vec<f64> {
        let scene = self.with(&[], 1).expect("a sound scene");
        let value = |path: &&str| scene.file.value(path).ok().and_then(|value| value.as_f64());
        self.free
            .iter()
            .map(|path| value(path).expect("a number"))
            .collect()
    }

    fn fitted(&self, measurement: &Measurement, starts: &FitStarts) -> Result<Fitted, Failure> {
        let scene = self.with(&[], 1)?;
        let data = FitData::of_measurement(measurement, &scene)?;
        let fields: Vec<String> = self.free.iter().map(|path| (*path).to_owned()).collect();
        let model = FitModel {
            scene_at: &|values| self.with(values, 1),
            fields: &fields,
            planes: &data.planes,
        };
        fit(&model, &data, starts, (0.01, 1), &|| ())
    }
}

/// The number of seeds is divided by this number where a fit takes long: from far starts, and of
/// wrong models.
const FEWER: u64 = 40;

/// All sections.
pub(crate) fn sections(options: FitOptions) -> Vec<ReportSection> {
    let seeds = options.seeds;
    let all: Vec<SeedFits> = SCENES
        .iter()
        .map(|scene| SeedFits::new(scene, seeds))
        .collect();
    vec![
        errors(&all),
        starts(seeds / FEWER),
        degenerate(),
        wrong(seeds / FEWER),
    ]
}

/// The fits of a scene over many seeds.
struct SeedFits {
    scene: &'static FitScene,
    truth: Vec<f64>,
    fits: Vec<Fitted>,
    /// The Cramér–Rao bound for the covariance of the batches of all seeds, [n, n].
    bound: Array2<f64>,
}

impl SeedFits {
    fn new(scene: &'static FitScene, seeds: u64) -> Self {
        let truth = scene.truth();
        let starts = near(&truth);
        let all = in_parallel(1..=scene.seeds(seeds), "seeds", |seed| {
            let measurement = traced(&scene.with(&[], seed).expect("sound"));
            let fitted = scene.fitted(&measurement, &starts).expect("a fit");
            (fitted, BatchSums::new(&measurement))
        });
        let (fits, sums): (Vec<Fitted>, Vec<BatchSums>) = all.into_iter().unzip();
        let sums = sums.into_iter().reduce(BatchSums::plus).expect("a seed");
        Self {
            bound: sums.bound(&derivatives(scene, &truth)),
            scene,
            truth,
            fits,
        }
    }
}

/// A search that starts at the truth.
fn near(truth: &[f64]) -> FitStarts {
    FitStarts {
        values: truth.to_vec(),
        ranges: truth.iter().map(|v| [0.5 * v, 1.5 * v]).collect(),
        count: 1,
    }
}

/// Sums over batches of the real and imaginary parts of their slices, and of products of these.
struct BatchSums {
    batches: f64,
    each: f64,
    sum: Array1<f64>,
    products: Array2<f64>,
}

impl BatchSums {
    fn new(measurement: &Measurement) -> Self {
        let mut rows: Vec<Vec<f64>> = vec![Vec::new(); measurement.batches().len()];
        for plane in 0..measurement.planes().len() {
            for (row, batch) in rows.iter_mut().zip(measurement.at_plane(plane)) {
                row.extend(numbers(&batch.slices));
            }
        }
        let rows: Vec<Array1<f64>> = rows.into_iter().map(Array1::from).collect();
        let views: Vec<_> = rows.iter().map(|row| row.view()).collect();
        let rows = stack(Axis(0), &views).expect("equal lengths");
        Self {
            batches: rows.nrows() as f64,
            each: rows.nrows() as f64,
            sum: rows.sum_axis(Axis(0)),
            products: rows.t().dot(&rows),
        }
    }

    fn plus(mut self, other: Self) -> Self {
        self.batches += other.batches;
        self.sum += &other.sum;
        self.products += &other.products;
        self
    }

    /// (DᵀC⁻¹D)⁻¹ for the mean of the batches of one seed.
    fn bound(&self, derivatives: &Array2<f64>) -> Array2<f64> {
        let mean = &self.sum / self.batches;
        let outer = mean.clone().insert_axis(Axis(1)) * &mean;
        let mut covariance = &self.products / self.batches - outer;
        // Numbers that are real by symmetry have no noise in their imaginary parts.
        let largest = covariance.diag().iter().copied().fold(0.0, f64::max);
        covariance
            .diag_mut()
            .mapv_inplace(|of| of.max(1e-9 * largest) * (1.0 + 1e-9));
        let solved_for = solved(&covariance, derivatives).expect("a covariance");
        let information = derivatives.t().dot(&solved_for) * self.each;
        solved(&information, &Array2::eye(information.nrows())).expect("fields that are told")
    }
}

/// The real and imaginary parts of the independent frequencies.
fn numbers(slices: &Slices) -> impl Iterator<Item = f64> {
    let grid = slices.grid;
    let cells = slices.half.indexed_iter();
    let cells = cells.filter(move |((_, m, n), _)| grid.is_independent(*m, *n));
    cells.flat_map(|(_, value)| [value.re, value.im])
}

/// The derivatives of the numbers of all planes by each field, [numbers, n].
fn derivatives(scene: &FitScene, truth: &[f64]) -> Array2<f64> {
    let at = |values: &[f64]| {
        let planes = predicted(&scene.with(values, 1).expect("sound"), None);
        let all = planes.iter().flat_map(|plane| numbers(&plane.slices));
        all.collect::<Array1<f64>>()
    };
    let column = |i: usize| {
        let moved = |by: f64| {
            let mut moved = truth.to_vec();
            moved[i] *= 1.0 + by;
            at(&moved)
        };
        (moved(STEP) - moved(-STEP)) / (2.0 * STEP * truth[i])
    };
    let columns: Vec<Array1<f64>> = (0..truth.len()).map(column).collect();
    let views: Vec<_> = columns.iter().map(|column| column.view()).collect();
    stack(Axis(1), &views).expect("equal lengths")
}

/// The step of the derivatives, as a share of the value.
const STEP: f64 = 1e-3;

/// The section on pulls, p and bounds.
fn errors(all: &[SeedFits]) -> ReportSection {
    let rows = all
        .iter()
        .flat_map(|fits| (0..fits.truth.len()).map(|i| error_row(fits, i)));
    ReportSection::new(
        "Errors of fits",
        "Each seed measures the scene with 64 batches of lattices, and fits it from the true values. A pull is \
         the error of an estimate in units of its stated error; required: mean 0 and deviation 1, within 0.05 or three \
         standard errors, and p that is uniform. *Bound* is the Cramér–Rao bound for normal noise with the covariance of \
         the batches of all seeds; *stated bound* is the mean of what fits state, from 64 batches each.",
        "scene | field | mean pull | deviation of pulls | error/bound | stated bound/bound | \
         KS p of uniformity | p < 10 %",
        rows,
    )
}

fn error_row(fits: &SeedFits, i: usize) -> Row {
    let count = fits.fits.len() as f64;
    let of = |value: &dyn Fn(&Fitted) -> f64| fits.fits.iter().map(value).collect::<Vec<f64>>();
    let deviation = |values: &[f64]| mean(values)[1] * count.sqrt();
    let pulls =
        of(&|fit| (fit.fields[i].value - fits.truth[i]) / fit.fields[i].error.unwrap_or(f64::NAN));
    let [pull, pull_error] = mean(&pulls);
    let spread = deviation(&pulls);
    let error = deviation(&of(&|fit| fit.fields[i].value));
    let bound = fits.bound[[i, i]].sqrt();
    let [stated, _] = mean(&of(&|fit| fit.fields[i].bound.unwrap_or(f64::NAN)));
    let p: Vec<f64> = fits.fits.iter().filter_map(|fit| fit.p_value).collect();
    let uniform = uniformity(&p);
    let below = p.iter().filter(|p| **p < 0.1).count() as f64 / count;
    // Errors of the mean and of the deviation of normal numbers.
    let allowed = |error: f64| 0.05_f64.max(3.0 * error);
    let loose = "0.05, or three standard errors";
    let checks = vec![
        Check::new("mean", pull.abs(), Below(allowed(pull_error))).because(loose),
        Check::new(
            "deviation",
            (spread - 1.0).abs(),
            Below(allowed(1.0 / (2.0 * count).sqrt())),
        )
        .because(loose),
        Check::new("uniform p", uniform, AtLeast(0.01)).because("1 %"),
    ];
    let cells = vec![
        fits.scene.name.to_owned(),
        fits.scene.free[i].to_owned(),
        format!("{pull:+.3} ± {pull_error:.3}"),
        format!("{spread:.3}"),
        format!("{:.3}", error / bound),
        format!("{:.3}", stated / bound),
        format!("{uniform:.3}"),
        format!("{:.1} %", 100.0 * below),
    ];
    Row::new(cells, checks)
}

/// The section on searches from far starts.
fn starts(seeds: u64) -> ReportSection {
    let row = |scene: &'static FitScene| {
        let truth = scene.truth();
        let seeds = scene.seeds(seeds);
        let arrived = in_parallel(1..=seeds, "starts", |seed| {
            let measurement = traced(&scene.with(&[], seed).expect("sound"));
            let word = |i: usize| unit(words(seed, Stream::Flip, i as u64, 0)[0]);
            // Half of the value to either side.
            let side = |i: usize| if word(i) < 0.5 { 0.5 } else { 1.5 };
            let values = truth.iter().enumerate().map(|(i, v)| v * side(i));
            let starts = FitStarts {
                values: values.collect(),
                ranges: truth
                    .iter()
                    .enumerate()
                    .map(|(i, v)| [0.5 * side(i) * v, 1.5 * side(i) * v])
                    .collect(),
                count: 8,
            };
            let Ok(fitted) = scene.fitted(&measurement, &starts) else {
                return [false; 2];
            };
            let mut fields = fitted.fields.iter().zip(&truth);
            let is_near = fields.all(|(field, truth)| {
                field
                    .error
                    .is_some_and(|error| (field.value - truth).abs() < 5.0 * error)
            });
            [is_near, fitted.verdict == Verdict::Undecided]
        });
        let share = |k: usize| arrived.iter().filter(|of| of[k]).count() as f64 / seeds as f64;
        let cells = vec![
            scene.name.to_owned(),
            seeds.to_string(),
            format!("{:.1} %", 100.0 * share(0)),
            format!("{:.1} %", 100.0 * share(1)),
        ];
        Row::new(
            cells,
            vec![Check::new("arrive", share(0), AtLeast(0.9)).because("nine in ten")],
        )
    };
    ReportSection::new(
        "Starts that are half of the value off",
        "Each field starts at half or at one and a half of its true value, with eight starts within \
         ± 50 % of that. A fit arrives if all fields are within five errors of the truth. Required: nine \
         in ten arrive.",
        "scene | fits | arrive | undecided",
        SCENES.iter().map(row),
    )
}

/// Two scenes with fields that change the spectra alike.
const DEGENERATE: [FitScene; 2] = [
    FitScene {
        name: "radiance and albedo",
        text: "(light: Rectangle(center: (0, 0, 0), size: (0.3, 0.3), radiance: 1.0),
    surfaces: [Rectangle(name: \"floor\", center: (0, 0, 2), size: (6, 6), albedo: 0.5)],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"floor\"]),
    planes: [(name: \"leaving\", at: After(\"floor\"))],
    window: (x: Hann(0.5), u: Hann(0.5)), frequencies: (azimuths: 2, rho: (max: 6), nu: (max: 6)),",
        free: &["light.radiance", "surfaces.0.albedo", "light.size.0"],
        photons: 1 << 16,
    },
    FitScene {
        name: "radiance and size of a far light",
        text: "(light: Rectangle(center: (0, 0, 0), size: (0.02, 0.2), radiance: 1.0), FLOOR
    planes: [(name: \"at\", at: Before(\"floor\"))],
    window: (x: Hann(0.5), u: Hann(0.5)), frequencies: (azimuths: 2, rho: (max: 6), nu: (max: 6)),",
        free: &["light.radiance", "light.size.0", "light.size.1"],
        photons: 1 << 16,
    },
];

fn degenerate() -> ReportSection {
    let row = |scene: &'static FitScene| {
        let measurement = traced(&scene.with(&[], 1).expect("sound"));
        let fitted = scene
            .fitted(&measurement, &near(&scene.truth()))
            .expect("a fit");
        let named = fitted.degeneracy.as_ref().map(|found| {
            let names: Vec<&str> = found
                .changes
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            names == scene.free[..2]
        });
        let words = fitted
            .degeneracy
            .map(|found| (found.words, format!("{:.1e}", found.information)));
        let (words, information) = words.unwrap_or_default();
        let cells = vec![
            scene.name.to_owned(),
            words,
            information,
            format!("{:?}", fitted.verdict),
        ];
        Row::new(
            cells,
            vec![Check::fact(
                "named",
                named == Some(true),
                "the fields that are alike",
            )],
        )
    };
    ReportSection::new(
        "Fields that change the spectra alike",
        "The first two of three free fields change the spectra alike: exactly in the first scene, and \
         nearly in the second, whose light is narrower than what the frequencies resolve. Required: these \
         two are named, and no other.",
        "scene | hard to tell apart | information | verdict",
        DEGENERATE.iter().map(row),
    )
}

/// The section on a lobe of another kind.
fn wrong(seeds: u64) -> ReportSection {
    let beckmann = SCENES[4];
    let text: &'static str = Box::leak(beckmann.text.replace("Beckmann", "Ggx").into_boxed_str());
    let ggx = FitScene {
        name: "GGX for Beckmann",
        text,
        free: &["surfaces.0.event.Reflects.brdf.lobe.Ggx", "light.radiance"],
        ..beckmann
    };
    let seeds = beckmann.seeds(seeds);
    let row = |(model, is_right): (FitScene, bool)| {
        let rejected = in_parallel(1..=seeds, "fits", |seed| {
            let measured = FitScene {
                photons: 1 << 22,
                ..beckmann
            };
            let measurement = traced(&measured.with(&[], seed).expect("sound"));
            let model = FitScene {
                photons: 1 << 22,
                ..model
            };
            let fitted = model
                .fitted(&measurement, &near(&model.truth()))
                .expect("a fit");
            fitted.p_value.is_some_and(|p| p < 0.01)
        });
        let share = rejected.iter().filter(|rejected| **rejected).count() as f64 / seeds as f64;
        let name = if is_right { "Beckmann" } else { model.name };
        let cells = vec![
            name.to_owned(),
            seeds.to_string(),
            format!("{:.1} %", 100.0 * share),
        ];
        let check = match is_right {
            true => {
                Check::new("accepted", share, AtMost(0.05)).because("1 %, and four standard errors")
            }
            false => Check::new("rejected", share, AtLeast(0.99)).because("a wrong model"),
        };
        Row::new(cells, vec![check])
    };
    ReportSection::new(
        "A lobe of another kind",
        "Photons of a Beckmann lobe are fitted with the roughness of a lobe and the radiance. Required: a \
         GGX lobe has p < 0.01, and a Beckmann lobe has not.",
        "model | fits | p < 0.01",
        [(beckmann, true), (ggx, false)].into_iter().map(row),
    )
}
