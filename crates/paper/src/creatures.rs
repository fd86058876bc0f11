//! Figs. 16 and 17: a picture from few shading samples, and the criteria that place these
//! samples.

use crate::quality::Quality;
use crate::subject::FigureData;
use etendue_adaptive::{Layers, SampleMethod, SamplePlan, render};
use etendue_figures::{
    Axis, AxisQuantity, Figure, Palette, Picture, Plate, PlateRow, Scale, Style, plate, stacked,
};
use etendue_import::{Options, import};
use etendue_paths::Paths;
use etendue_pipeline::{Reporter, Work};
use etendue_store::Failure;
use etendue_world::Camera;
use ndarray::{Array2, Axis as Along, stack};
use std::fs;

/// Number of pixels per shading sample, as in the paper.
const SPARSE: usize = 20;

/// Number of paths per shading sample.
const PATHS_PER_SAMPLE: u32 = 128;

/// Number of runs from which the standard errors of criteria are estimated.
const RUNS: u64 = 4;

/// If the difference of a pixel, relative to white, exceeds this limit, the color of the pixel no
/// longer changes.
const MAX_DIFFERENCE: f64 = 0.2;

struct CreatureScene {
    paths: Paths,
    camera: Camera,
    samples: usize,
    /// Number of paths per pixel of the reference.
    reference: u32,
}

impl CreatureScene {
    /// The creatures scene, at the size for this quality.
    fn new(quality: Quality) -> Result<Self, Failure> {
        let folder = tempfile::tempdir().map_err(Failure::cannot_run)?;
        for (name, bytes) in etendue_scenes::CREATURES {
            fs::write(folder.path().join(name), bytes).map_err(Failure::cannot_run)?;
        }
        let file = folder.path().join(etendue_scenes::CREATURES[0].0);
        let world = import(&file, &Options::default())
            .map_err(Failure::bad_input)?
            .world;
        let (size, reference) = match quality {
            Quality::Print => ([800, 500], 512),
            Quality::Draft => ([400, 250], 512),
            #[cfg(test)]
            Quality::Sketch => ([48, 30], 16),
        };
        let camera = world
            .cameras
            .first()
            .ok_or_else(|| Failure::cannot_run("no camera"))?;
        Ok(Self {
            camera: Camera {
                size,
                ..camera.clone()
            },
            samples: size[0] * size[1] / SPARSE,
            reference,
            paths: Paths::new(&world),
        })
    }

    fn rendered(&self, method: SampleMethod, each: u32, seed: u64) -> (Vec<f64>, Layers) {
        let plan = SamplePlan {
            method,
            samples: self.samples,
            each,
            blocker_rays: method.blocker_rays(),
            is_even: method == SampleMethod::Paper,
            seed,
        };
        let found = render(&self.paths, &self.camera, &plan, &|_, _| {}, &|_| {});
        (found.radiance, found.layers)
    }

    /// A quantity of the first run as a picture, and its standard error from all runs.
    fn with_error(
        &self,
        runs: &[Layers],
        of: impl Fn(&Layers) -> Vec<f64>,
    ) -> Result<[Array2<f64>; 2], Failure> {
        let each = runs.iter().map(|run| self.picture(of(run)));
        let each: Vec<Array2<f64>> = each.collect::<Result<_, _>>()?;
        let all: Vec<_> = each.iter().map(|array| array.view()).collect();
        let all = stack(Along(0), &all).map_err(Failure::cannot_run)?;
        Ok([each[0].clone(), all.std_axis(Along(0), 1.0)])
    }

    /// The values of pixels as an array [column, row] whose first row is the lowest, as
    /// figures require.
    fn picture(&self, values: Vec<f64>) -> Result<Array2<f64>, Failure> {
        let [w, h] = self.camera.size;
        let mut rows = Array2::from_shape_vec((h, w), values).map_err(Failure::cannot_run)?;
        rows.invert_axis(Along(0));
        Ok(rows.reversed_axes())
    }

    fn shown<'a>(&self, values: &'a Array2<f64>) -> Picture<'a> {
        let [w, h] = self.camera.size.map(|n| n as f64);
        let columns = Axis::edges("column", "pixels", [0.0, w]);
        let rows = Axis::edges("row", "pixels", [0.0, h]).reversed();
        Picture::new([columns, rows], values.view())
    }
}

/// The heading of a picture, its values, and a line below it, which may be empty.
type PicturePanel<'a> = (&'a str, &'a Array2<f64>, String);

/// Returns pictures without lines below them.
fn plain<'a>(
    pictures: impl IntoIterator<Item = (&'a str, &'a Array2<f64>)>,
) -> Vec<PicturePanel<'a>> {
    let each = pictures.into_iter();
    each.map(|(head, values)| (head, values, String::new()))
        .collect()
}

impl CreatureScene {
    /// Draws pictures side by side, with a title and a note. All pictures share the range of
    /// colors, unless the scale is in decibels.
    fn side_by_side(
        &self,
        style: &Style,
        [title, note]: [&str; 2],
        (quantity, scale): (&str, Scale),
        panels: &[PicturePanel<'_>],
    ) -> Result<Figure, Failure> {
        let is_shared = !matches!(scale, Scale::Decibel { .. });
        let pictures = panels
            .iter()
            .map(|(_, values, _)| self.shown(values))
            .collect();
        let quantity = AxisQuantity::new(quantity, "");
        let feet = panels.iter().map(|(.., foot)| vec![foot.clone()]);
        let of = Plate {
            title,
            note,
            heads: panels.iter().map(|(head, ..)| (*head).to_owned()).collect(),
            rows: vec![PlateRow::new("", quantity, scale, is_shared, pictures)],
            feet: feet.filter(|lines| !lines[0].is_empty()).collect(),
            ..Plate::default()
        };
        plate(&of, style).map_err(Failure::cannot_run)
    }
}

/// Draws Fig. 16.
pub(crate) fn criteria(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let scene = CreatureScene::new(taken.quality)?;
    // Criteria do not depend on the number of paths.
    let runs = |method| -> Vec<Layers> {
        let each = (1..=RUNS).map(|seed| scene.rendered(method, 1, seed).1);
        each.collect()
    };
    let [paper, corrected] = [SampleMethod::Paper, SampleMethod::Predicted].map(runs);
    let squares = |runs: &[Layers], of: fn(&Layers) -> &Vec<f64>| {
        scene.with_error(runs, |run| of(run).iter().map(|x| x * x).collect())
    };
    let up_to_one = |of: fn(&Layers) -> &Vec<f64>| {
        let clamped = |run: &Layers| of(run).iter().map(|n| n.clamp(0.0, 1.0)).collect();
        scene.with_error(&paper, clamped)
    };
    let curvature = squares(&paper, |run| &run.unoccluded)?;
    let blockers = squares(&paper, |run| &run.blockers)?;
    let printed = squares(&paper, |run| &run.bandwidth)?;
    let corrected = squares(&corrected, |run| &run.bandwidth)?;
    let [density, dots] = [
        up_to_one(|run| &run.density)?,
        up_to_one(|run| &run.samples)?,
    ];
    let squared = |words, panels: [(&str, &Array2<f64>); 2]| {
        let scale = Scale::Decibel { floor: -50.0 };
        scene.side_by_side(&taken.style, words, ("square", scale), &plain(panels))
    };
    let of_samples = plain([("(e) density", &density[0]), ("(f) samples", &dots[0])]);
    let mut figure = stacked(&[
        squared(
            [
                "Criteria and shading samples",
                "(a) The bandwidth by Eq. 20, from finite differences on the screen. (b) 1/*d'*, the harmonic mean over the hemisphere. (a) to (d) are squared, in decibels below the largest value of each picture.",
            ],
            [("(a) curvature", &curvature[0]), ("(b) blockers", &blockers[0])],
        )?,
        squared(
            [
                "",
                "(c) The bandwidth by Eq. 21, as printed. (d) The same, corrected, in the direction where it is largest.",
            ],
            [("(c) Eq. 21", &printed[0]), ("(d) Eq. 21, corrected", &corrected[0])],
        )?,
        scene.side_by_side(
            &photographs(&taken.style),
            [
                "",
                "(e) Requested samples per pixel by (c), shown up to one. (f) Pixels that have a sample.",
            ],
            ("samples per pixel", Scale::Linear),
            &of_samples,
        )?,
    ]);
    let estimated = [blockers, printed, corrected, density];
    for (picture, [_, error]) in figure.pictures[1..].iter_mut().zip(estimated) {
        picture.sigma = Some(error);
    }
    Ok(figure)
}

/// The pictures of Fig. 17: radiance in rows from the top.
struct ComparedPictures {
    /// The pictures from few samples: uniform samples, the paper's algorithm, and samples by the
    /// corrected criteria.
    few: [Vec<f64>; 3],
    reference: etendue_paths::Picture,
    /// The radiance shown as white.
    white: f64,
}

impl ComparedPictures {
    fn new(scene: &CreatureScene, reporter: &dyn Reporter) -> Self {
        let _stage = reporter.begin(Work::Stage("rendering"));
        let methods = [
            SampleMethod::Uniform,
            SampleMethod::Paper,
            SampleMethod::Predicted,
        ];
        let few = methods.map(|method| scene.rendered(method, PATHS_PER_SAMPLE, 1).0);
        let paths = &scene.paths;
        let reference = paths.picture(&scene.camera, scene.reference, 2, &|_| {});
        Self {
            few,
            white: bright(&reference.mean),
            reference,
        }
    }

    /// The relative luminance, which is radiance divided by the radiance of white, and at
    /// most 1.
    fn luminance(&self, scene: &CreatureScene, of: &[f64]) -> Result<Array2<f64>, Failure> {
        scene.picture(of.iter().map(|x| (x / self.white).min(1.0)).collect())
    }

    /// The standard error of the reference's relative luminance.
    fn reference_error(&self, scene: &CreatureScene) -> Result<Array2<f64>, Failure> {
        let variance = self.reference.variance.iter();
        scene.picture(variance.map(|v| v.sqrt() / self.white).collect())
    }

    /// The difference from the reference, relative to white.
    fn difference(&self, scene: &CreatureScene, of: &[f64]) -> Result<Array2<f64>, Failure> {
        let both = of.iter().zip(&self.reference.mean);
        scene.picture(both.map(|(x, r)| (x - r) / self.white).collect())
    }

    /// The relative mean square error of a picture, and this error without the thousandth
    /// of the pixels that have the largest errors. The noise of the reference is subtracted.
    fn errors(&self, of: &[f64]) -> [f64; 2] {
        let reference = &self.reference.mean;
        let both = of.iter().zip(reference).zip(&self.reference.variance);
        let squares = self.relative(both.map(|((x, r), noise)| [(x - r).powi(2), *noise]));
        mean_errors(squares)
    }

    /// The relative mean square error of the reference due to its noise.
    fn noise(&self) -> f64 {
        let squares = self.reference.variance.iter().map(|noise| [*noise, 0.0]);
        mean_errors(self.relative(squares))[0]
    }

    /// Divides squares, such as (x − r)², by r² + ε².
    fn relative(&self, squares: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
        let reference = &self.reference.mean;
        let least = 0.01 * reference.iter().sum::<f64>() / reference.len() as f64;
        let each = squares.zip(reference);
        each.map(|(squares, r)| squares.map(|square| square / (r * r + least * least)))
            .collect()
    }
}

/// The mean of differences between errors and their noise, over all pixels and without the
/// thousandth of the pixels that have the largest errors.
fn mean_errors(mut each: Vec<[f64; 2]>) -> [f64; 2] {
    each.sort_unstable_by(|[a, _], [b, _]| a.total_cmp(b));
    let count = each.len();
    [count, count - count / 1000].map(|count| {
        let sum: f64 = each[..count]
            .iter()
            .map(|[error, noise]| error - noise)
            .sum();
        sum / count as f64
    })
}

/// Draws Fig. 17.
pub(crate) fn pictures(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    const HEADS: [&str; 3] = [
        "(a) uniform",
        "(b) the paper's algorithm",
        "(c) corrected criteria",
    ];
    let scene = CreatureScene::new(taken.quality)?;
    let found = ComparedPictures::new(&scene, taken.reporter);
    let few = found.few.iter().chain([&found.reference.mean]);
    let shown: Vec<Array2<f64>> = few
        .map(|of| found.luminance(&scene, of))
        .collect::<Result<_, _>>()?;
    let off: Vec<Array2<f64>> = found
        .few
        .iter()
        .map(|of| found.difference(&scene, of))
        .collect::<Result<_, _>>()?;
    let noise = found.noise();
    let errors = found.few.iter().map(|of| found.errors(of));
    let feet = errors.map(|[error, robust]| format!("relMSE {error:.4}, robust {robust:.4}"));
    let feet = feet.chain([format!("noise: relMSE {noise:.4}")]);
    let heads = HEADS.into_iter().chain(["(d) reference"]);
    let panels = heads.zip(&shown).zip(feet);
    let panels = panels.map(|((head, values), foot)| (head, values, foot));
    let panels: Vec<PicturePanel<'_>> = panels.collect();
    let note = format!(
        "(a) to (c): {} shading samples of {PATHS_PER_SAMPLE} paths, 0.05 per pixel. (d): {} paths in each pixel. relMSE: the mean of (*x* − *r*)²/(*r*² + *ε*²) over the reference *r*, less its noise; *ε* is a hundredth of the mean. Robust: without the thousandth of the pixels with the largest errors.",
        scene.samples, scene.reference
    );
    let style = photographs(&taken.style);
    let luminance = |words, panels| {
        scene.side_by_side(&style, words, ("relative luminance", Scale::Linear), panels)
    };
    let scale = Scale::Signed {
        most: MAX_DIFFERENCE,
    };
    let title = "Difference from the reference, in relative luminance";
    let differences = plain(HEADS.into_iter().zip(&off));
    let mut figure = stacked(&[
        luminance(["A picture of few shading samples", &note], &panels[..2])?,
        luminance(["", ""], &panels[2..])?,
        scene.side_by_side(&style, [title, ""], ("difference", scale), &differences)?,
    ]);
    figure.pictures[HEADS.len()].sigma = Some(found.reference_error(&scene)?);
    Ok(figure)
}

/// The radiance that a hundredth of the pixels exceed.
fn bright(radiance: &[f64]) -> f64 {
    let mut sorted = radiance.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[sorted.len() * 99 / 100].max(f64::MIN_POSITIVE)
}

/// The style with a grey scale for photographs.
fn photographs(style: &Style) -> Style {
    let mut style = *style;
    style.palette = Palette::Grey;
    style
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rays that find blockers differ between runs; the criterion without blockers has no rays.
    #[test]
    fn only_criteria_with_blockers_have_errors() {
        let scene = CreatureScene::new(Quality::Sketch).unwrap();
        let largest = |runs: [Layers; 2], of: fn(&Layers) -> &Vec<f64>| {
            let [_, errors] = scene.with_error(&runs, |run| of(run).clone()).unwrap();
            errors.into_iter().fold(0.0, f64::max)
        };
        let run = |each, seed| scene.rendered(SampleMethod::Paper, each, seed).1;
        let seeds = || [run(1, 1), run(1, 2)];
        assert!(largest(seeds(), |run| &run.unoccluded) == 0.0);
        assert!(largest(seeds(), |run| &run.bandwidth) > 0.0);
        assert!(largest([run(1, 1), run(16, 1)], |run| &run.bandwidth) == 0.0);
    }

    /// One bright pixel of a thousand dominates the mean, but not the robust mean.
    #[test]
    fn the_robust_error_omits_the_largest_thousandth() {
        let errors = (0..2000).map(|i| [if i % 1000 == 7 { 1e6 } else { 3.0 }, 1.0]);
        let [all, robust] = mean_errors(errors.collect());
        assert!((all - 1001.997).abs() < 1e-9, "{all}"); // rounding
        assert!((robust - 2.0).abs() < 1e-12, "{robust}"); // rounding
    }
}
