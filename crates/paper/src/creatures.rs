//! Figs. 16 and 17: a picture from few shading samples, and the criteria that place them.

use crate::quality::Quality;
use crate::subject::FigureData;
use etendue_adaptive::{BLOCKER_RAYS, Rendered, SampleMethod, SamplePlan, render};
use etendue_figures::{
    Axis, AxisQuantity, Figure, Palette, Picture, Plate, PlateRow, Scale, Style, plate, stacked,
};
use etendue_import::{Options, import};
use etendue_paths::Paths;
use etendue_pipeline::Work;
use etendue_store::Failure;
use etendue_world::Camera;
use ndarray::{Array2, Axis as Along};
use std::fs;

/// The scene file and the files it needs.
const FILES: [(&str, &[u8]); 4] = [
    (
        "creatures.xml",
        include_bytes!("../../../scenes/worlds/creatures.xml"),
    ),
    (
        "hall.exr",
        include_bytes!("../../../scenes/worlds/hall.exr"),
    ),
    (
        "hunter.ply",
        include_bytes!("../../../scenes/worlds/hunter.ply"),
    ),
    (
        "grazer.ply",
        include_bytes!("../../../scenes/worlds/grazer.ply"),
    ),
];

/// Pixels for each shading sample, as in the paper.
const SPARSE: usize = 20;

/// Paths of each shading sample.
const PATHS_PER_SAMPLE: u32 = 128;

/// Paths of each pixel of the reference.
const REFERENCE: u32 = 64;

struct CreatureScene {
    paths: Paths,
    camera: Camera,
    samples: usize,
}

impl CreatureScene {
    /// The creatures scene, at the size for this quality.
    fn new(quality: Quality) -> Result<Self, Failure> {
        let folder = tempfile::tempdir().map_err(Failure::cannot_run)?;
        for (name, bytes) in FILES {
            fs::write(folder.path().join(name), bytes).map_err(Failure::cannot_run)?;
        }
        let file = folder.path().join(FILES[0].0);
        let world = import(&file, &Options::default())
            .map_err(Failure::bad_input)?
            .world;
        let size = match quality {
            Quality::Print => [800, 500],
            Quality::Draft => [400, 250],
            #[cfg(test)]
            Quality::Sketch => [48, 30],
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

    /// The values of pixels in the layout of figures: columns first, and rows from below.
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
            y: Axis::edges("row from below", "pixels", [0.0, h]),
            values: values.view(),
        }
    }
}

/// Two pictures side by side.
struct PicturePair<'a> {
    title: &'a str,
    note: &'a str,
    heads: [&'a str; 2],
    values: [&'a Array2<f64>; 2],
    quantity: AxisQuantity,
    scale: Scale,
    feet: Vec<Vec<String>>,
}

impl PicturePair<'_> {
    fn drawn(self, scene: &CreatureScene, style: &Style) -> Result<Figure, Failure> {
        let of = Plate {
            title: self.title,
            note: self.note,
            heads: self.heads.map(str::to_owned).to_vec(),
            rows: vec![PlateRow {
                name: "",
                quantity: self.quantity,
                scale: self.scale,
                shared: false,
                pictures: self.values.map(|values| scene.shown(values)).to_vec(),
            }],
            feet: self.feet,
            bars: None,
        };
        plate(&of, style).map_err(Failure::cannot_run)
    }
}

/// Fig. 16.
pub(crate) fn criteria(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let scene = CreatureScene::new(taken.quality)?;
    let layers = scene.rendered(SampleMethod::Predicted, false).layers;
    let squares = |values: &[f64]| scene.picture(values.iter().map(|x| x * x).collect());
    let [blockers, bandwidth] = [squares(&layers.blockers)?, squares(&layers.bandwidth)?];
    let density = scene.picture(layers.density.clone())?;
    let dots = scene.picture(layers.samples.iter().map(|n| n.min(1.0)).collect())?;
    let above = PicturePair {
        title: "Criteria and shading samples",
        note: "Left: the nearness of what is reflected, 1/*d'*, the inverse of its harmonic mean. Right: the bandwidth by Eq. 21, corrected, in the direction of its largest.",
        heads: ["blockers", "bandwidth"],
        values: [&blockers, &bandwidth],
        quantity: AxisQuantity::new("square", ""),
        scale: Scale::Decibel { floor: -50.0 },
        feet: Vec::new(),
    };
    let below = PicturePair {
        title: "",
        note: "Left: requested samples per pixel, up to one. Right: pixels that have a sample.",
        heads: ["density", "samples"],
        values: [&density, &dots],
        quantity: AxisQuantity::new("samples per pixel", ""),
        scale: Scale::Linear,
        feet: Vec::new(),
    };
    Ok(stacked(&[
        above.drawn(&scene, &taken.style)?,
        below.drawn(&scene, &photographs(&taken.style))?,
    ]))
}

/// Fig. 17.
pub(crate) fn pictures(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let scene = CreatureScene::new(taken.quality)?;
    let stage = taken.reporter.begin(Work::Stage("rendering"));
    let ways = [
        (SampleMethod::Uniform, true),
        (SampleMethod::Predicted, true),
        (SampleMethod::Predicted, false),
    ];
    let few = ways.map(|(method, is_even)| scene.rendered(method, is_even).radiance);
    let reference = scene.paths.picture(&scene.camera, REFERENCE, 2, &|_| {});
    drop(stage);
    let reference = reference.mean;
    let white = bright(&reference);
    let foot = |radiance: &Vec<f64>| vec![format!("relMSE {:.4}", error(radiance, &reference))];
    let [even, round, along] = few.each_ref().map(foot);
    let shown = |of: &[f64]| scene.picture(of.iter().map(|x| (x / white).min(1.0)).collect());
    let [a, b, c] = few.each_ref().map(|of| shown(of));
    let [a, b, c, d] = [a?, b?, c?, shown(&reference)?];
    let note = format!(
        "{} shading samples of {PATHS_PER_SAMPLE} paths, 0.05 a pixel. relMSE: the mean of (*x* − *r*)²/(*r*² + *ε*²), *ε* a hundredth of the mean, noise of the reference *r* included.",
        scene.samples
    );
    let radiance = || AxisQuantity::new("radiance of white", "");
    let above = PicturePair {
        title: "A picture of few shading samples",
        note: &note,
        heads: ["even samples", "by the criteria, alike in all directions"],
        values: [&a, &b],
        quantity: radiance(),
        scale: Scale::Linear,
        feet: vec![even, round],
    };
    let below = PicturePair {
        title: "",
        note: "",
        heads: ["by the criteria, along each direction", "reference"],
        values: [&c, &d],
        quantity: radiance(),
        scale: Scale::Linear,
        feet: vec![along, vec![format!("{REFERENCE} paths a pixel")]],
    };
    let style = photographs(&taken.style);
    Ok(stacked(&[
        above.drawn(&scene, &style)?,
        below.drawn(&scene, &style)?,
    ]))
}

/// The relative mean square error of a picture.
fn error(radiance: &[f64], reference: &[f64]) -> f64 {
    let count = reference.len() as f64;
    let least = 0.01 * reference.iter().sum::<f64>() / count;
    let of = |(x, r): (&f64, &f64)| (x - r).powi(2) / (r * r + least * least);
    radiance.iter().zip(reference).map(of).sum::<f64>() / count
}

/// The radiance exceeded by a hundredth of the pixels.
fn bright(radiance: &[f64]) -> f64 {
    let mut sorted = radiance.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[sorted.len() * 99 / 100].max(f64::MIN_POSITIVE)
}

/// The style with a grey scale for photographs.
fn photographs(style: &Style) -> Style {
    Style {
        palette: Palette::Grey,
        ..*style
    }
}
