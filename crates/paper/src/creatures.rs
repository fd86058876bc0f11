//! Figs. 16 and 17: a picture from few shading samples, and the criteria that place these
//! samples.

use crate::quality::Quality;
use crate::subject::FigureData;
use etendue_adaptive::{BLOCKER_RAYS, Rendered, SampleMethod, SamplePlan, render};
use etendue_figures::{
    Axis, AxisQuantity, Figure, Palette, Picture, Plate, PlateRow, Scale, Style, plate, stacked,
};
use etendue_import::{Options, import};
use etendue_paths::Paths;
use etendue_pipeline::{Reporter, Work};
use etendue_store::Failure;
use etendue_world::Camera;
use ndarray::{Array2, Axis as Along};
use std::fs;

/// Number of pixels per shading sample, as in the paper.
const SPARSE: usize = 20;

/// Number of paths per shading sample.
const PATHS_PER_SAMPLE: u32 = 128;

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
    /// Returns the creatures scene, at the size for this quality.
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

    fn rendered(&self, method: SampleMethod, is_even: bool) -> Rendered {
        let plan = SamplePlan {
            method,
            samples: self.samples,
            each: PATHS_PER_SAMPLE,
            blocker_rays: BLOCKER_RAYS,
            is_even,
            seed: 1,
        };
        render(&self.paths, &self.camera, &plan, &|_, _| {}, &|_| {})
    }

    /// Returns the values of pixels as an array [column, row] whose first row is the lowest, as
    /// figures require.
    fn picture(&self, values: Vec<f64>) -> Result<Array2<f64>, Failure> {
        let [w, h] = self.camera.size;
        let mut rows = Array2::from_shape_vec((h, w), values).map_err(Failure::cannot_run)?;
        rows.invert_axis(Along(0));
        Ok(rows.reversed_axes())
    }

    fn shown<'a>(&self, values: &'a Array2<f64>) -> Picture<'a> {
        let [w, h] = self.camera.size.map(|n| n as f64);
        Picture {
            x: Axis::edges("column", "pixels", [0.0, w]),
            y: Axis {
                is_reversed: true,
                ..Axis::edges("row", "pixels", [0.0, h])
            },
            values: values.view(),
        }
    }
}

/// A picture with its heading and a line below it, which may be empty.
struct PicturePanel<'a> {
    head: &'a str,
    values: &'a Array2<f64>,
    foot: String,
}

impl<'a> PicturePanel<'a> {
    fn new(head: &'a str, values: &'a Array2<f64>) -> Self {
        Self {
            head,
            values,
            foot: String::new(),
        }
    }
}

/// Pictures side by side.
struct CreatureRow<'a> {
    title: &'a str,
    note: &'a str,
    panels: &'a [PicturePanel<'a>],
    quantity: AxisQuantity,
    scale: Scale,
    /// Whether all pictures share the quantity's range of colors; otherwise, each picture has the
    /// range of its own values.
    shared: bool,
}

impl CreatureRow<'_> {
    fn drawn(&self, scene: &CreatureScene, style: &Style) -> Result<Figure, Failure> {
        let pictures = self.panels.iter().map(|panel| scene.shown(panel.values));
        let heads = self.panels.iter().map(|panel| panel.head.to_owned());
        let feet = self.panels.iter().map(|panel| vec![panel.foot.clone()]);
        let of = Plate {
            title: self.title,
            note: self.note,
            heads: heads.collect(),
            rows: vec![PlateRow {
                name: "",
                quantity: self.quantity.clone(),
                scale: self.scale,
                shared: self.shared,
                pictures: pictures.collect(),
            }],
            feet: feet.filter(|lines| !lines[0].is_empty()).collect(),
            bars: None,
            side: None,
        };
        plate(&of, style).map_err(Failure::cannot_run)
    }
}

/// Draws Fig. 16.
pub(crate) fn criteria(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let scene = CreatureScene::new(taken.quality)?;
    let layers = scene.rendered(SampleMethod::Predicted, false).layers;
    let squares = |values: &[f64]| scene.picture(values.iter().map(|x| x * x).collect());
    let [blockers, bandwidth] = [squares(&layers.blockers)?, squares(&layers.bandwidth)?];
    let up_to_one =
        |values: &[f64]| scene.picture(values.iter().map(|n| n.clamp(0.0, 1.0)).collect());
    let [density, dots] = [up_to_one(&layers.density)?, up_to_one(&layers.samples)?];
    let above = CreatureRow {
        title: "Criteria and shading samples",
        note: "(a) 1/*d'*, the nearness of what is reflected. (b) The bandwidth by Eq. 21, corrected, in the direction where it is largest. Both squared, in decibels below the largest value of each picture.",
        panels: &[
            PicturePanel::new("(a) blockers", &blockers),
            PicturePanel::new("(b) bandwidth", &bandwidth),
        ],
        quantity: AxisQuantity::new("square", ""),
        scale: Scale::Decibel { floor: -50.0 },
        shared: false,
    };
    let below = CreatureRow {
        title: "",
        note: "(c) Requested samples per pixel, shown up to one. (d) Pixels that have a sample.",
        panels: &[
            PicturePanel::new("(c) density", &density),
            PicturePanel::new("(d) samples", &dots),
        ],
        quantity: AxisQuantity::new("samples per pixel", ""),
        scale: Scale::Linear,
        shared: true,
    };
    Ok(stacked(&[
        above.drawn(&scene, &taken.style)?,
        below.drawn(&scene, &photographs(&taken.style))?,
    ]))
}

/// The pictures of Fig. 17: radiance in rows from the top.
struct ComparedPictures {
    /// The pictures from few samples: uniform samples, isotropic samples by the criteria, and
    /// anisotropic samples by the criteria.
    few: [Vec<f64>; 3],
    reference: etendue_paths::Picture,
    /// The radiance shown as white.
    white: f64,
}

impl ComparedPictures {
    fn new(scene: &CreatureScene, reporter: &dyn Reporter) -> Self {
        let _stage = reporter.begin(Work::Stage("rendering"));
        let methods = [
            (SampleMethod::Uniform, true),
            (SampleMethod::Predicted, true),
            (SampleMethod::Predicted, false),
        ];
        let few = methods.map(|(method, is_even)| scene.rendered(method, is_even).radiance);
        let paths = &scene.paths;
        let reference = paths.picture(&scene.camera, scene.reference, 2, &|_| {});
        Self {
            few,
            white: bright(&reference.mean),
            reference,
        }
    }

    /// Returns the relative luminance, which is radiance divided by the radiance of white, and at
    /// most 1.
    fn luminance(&self, scene: &CreatureScene, of: &[f64]) -> Result<Array2<f64>, Failure> {
        scene.picture(of.iter().map(|x| (x / self.white).min(1.0)).collect())
    }

    /// Returns the standard error of the reference's relative luminance.
    fn reference_error(&self, scene: &CreatureScene) -> Result<Array2<f64>, Failure> {
        let variance = self.reference.variance.iter();
        scene.picture(variance.map(|v| v.sqrt() / self.white).collect())
    }

    /// Returns the difference from the reference, relative to white.
    fn difference(&self, scene: &CreatureScene, of: &[f64]) -> Result<Array2<f64>, Failure> {
        let both = of.iter().zip(&self.reference.mean);
        scene.picture(both.map(|(x, r)| (x - r) / self.white).collect())
    }

    /// Returns the mean of `squares`, such as (x − r)², each divided by r² + ε².
    fn relative(&self, squares: impl Iterator<Item = f64>) -> f64 {
        let reference = &self.reference.mean;
        let count = reference.len() as f64;
        let least = 0.01 * reference.iter().sum::<f64>() / count;
        let each = squares.zip(reference);
        each.map(|(square, r)| square / (r * r + least * least))
            .sum::<f64>()
            / count
    }

    /// Returns the relative mean square error of a picture.
    fn error(&self, of: &[f64]) -> f64 {
        let both = of.iter().zip(&self.reference.mean);
        self.relative(both.map(|(x, r)| (x - r).powi(2)))
    }

    /// Returns the relative mean square error of the reference due to its noise.
    fn noise(&self) -> f64 {
        self.relative(self.reference.variance.iter().copied())
    }
}

/// Draws Fig. 17.
pub(crate) fn pictures(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    const HEADS: [&str; 3] = [
        "(a) uniform",
        "(b) criteria, isotropic",
        "(c) criteria, anisotropic",
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
    let errors = found.few.iter().map(|of| found.error(of) - noise);
    let feet = errors.map(|error| format!("relMSE {error:.4}"));
    let feet = feet.chain([format!("noise: relMSE {noise:.4}")]);
    let heads = HEADS.into_iter().chain(["(d) reference"]);
    let panels = heads.zip(&shown).zip(feet);
    let panels: Vec<PicturePanel<'_>> = panels
        .map(|((head, values), foot)| PicturePanel { head, values, foot })
        .collect();
    let differences = HEADS.into_iter().zip(&off);
    let differences: Vec<PicturePanel<'_>> = differences
        .map(|(head, values)| PicturePanel::new(head, values))
        .collect();
    let note = format!(
        "(a) to (c): {} shading samples of {PATHS_PER_SAMPLE} paths, 0.05 per pixel. (d): {} paths in each pixel. relMSE: the mean of (*x* − *r*)²/(*r*² + *ε*²) over the reference *r*, less its noise; *ε* is a hundredth of the mean.",
        scene.samples, scene.reference
    );
    let style = photographs(&taken.style);
    let luminance = |title, note, panels| CreatureRow {
        title,
        note,
        panels,
        quantity: AxisQuantity::new("relative luminance", ""),
        scale: Scale::Linear,
        shared: true,
    };
    let below = CreatureRow {
        title: "Difference from the reference, in relative luminance",
        note: "",
        panels: &differences,
        quantity: AxisQuantity::new("difference", ""),
        scale: Scale::Signed {
            most: MAX_DIFFERENCE,
        },
        shared: true,
    };
    let mut figure = stacked(&[
        luminance("A picture of few shading samples", &note, &panels[..2]).drawn(&scene, &style)?,
        luminance("", "", &panels[2..]).drawn(&scene, &style)?,
        below.drawn(&scene, &style)?,
    ]);
    figure.pictures[HEADS.len()].sigma = Some(found.reference_error(&scene)?);
    Ok(figure)
}

/// Returns the radiance that a hundredth of the pixels exceed.
fn bright(radiance: &[f64]) -> f64 {
    let mut sorted = radiance.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[sorted.len() * 99 / 100].max(f64::MIN_POSITIVE)
}

/// Returns the style with a grey scale for photographs.
fn photographs(style: &Style) -> Style {
    Style {
        palette: Palette::Grey,
        ..*style
    }
}
