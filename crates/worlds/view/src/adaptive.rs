//! Renders pictures with few shading samples, and writes their maps and the time of each stage.

use crate::layers::{require_finite, write_exr};
use crate::picture_request::PictureRequest;
use etendue_adaptive::{Layers, Rendered, SampleMethod, SamplePlan, Stage};
use etendue_paths::Paths;
use etendue_pipeline::{Progress, Reporter, Work};
use etendue_store::sealed::json;
use etendue_store::{ArgumentStyle, Failure, Results, TIMING};
use etendue_world::{Camera, Projection};
use ndarray::Array2;
use serde_json::{Value, json as tree_of};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Maximum number of shading samples per pixel. The time to place the samples grows with the
/// square of their number per pixel.
const MAX_EACH: usize = 4;

/// The files that are written in addition to the files of a reference picture.
pub(crate) const FILES: &[&str] = &["bandwidth.png", "samples.png", TIMING];

/// Renders and writes a picture; returns a text that states the number of samples and the time.
pub(crate) fn render(
    request: &PictureRequest,
    method: SampleMethod,
    (paths, camera): (&Paths, &Camera),
    (results, made_from): (&mut Results, &mut Value),
    reporter: &dyn Reporter,
) -> Result<String, Failure> {
    if let Projection::Perspective { lens: Some(_), .. } = camera.projection {
        let allowed = match request.source.arguments {
            ArgumentStyle::Command => "--method reference",
            ArgumentStyle::Python => "method='reference'",
        };
        return Err(Failure::bad_input(format!(
            "the camera has a lens, but rendering from few shading samples assumes a pinhole; allowed: {allowed}"
        )));
    }
    let samples = shading_samples(request, camera)?;
    let plan = SamplePlan {
        method,
        samples,
        each: request.paths,
        blocker_rays: request.blocker_rays.unwrap_or(method.blocker_rays()),
        is_even: request.isotropic || method == SampleMethod::Paper,
        seed: request.seed,
    };
    let watch = StageWatch::new(reporter);
    let bar = &watch.bar;
    let rendered = etendue_adaptive::render(
        paths,
        camera,
        &plan,
        &|stage, steps| watch.begin(stage, steps),
        &|done| advance(bar, done),
    );
    let seconds = watch.end();
    made_from["method"] = tree_of!(format!("{method:?}").to_lowercase());
    made_from["shading_samples"] = tree_of!(samples);
    made_from["shading_samples_added"] = tree_of!(rendered.added);
    made_from["paths"] = tree_of!(request.paths);
    made_from["blocker_rays"] = tree_of!(plan.blocker_rays);
    made_from["isotropic"] = tree_of!(plan.is_even);
    write(results, &rendered, made_from)?;
    let total: f64 = seconds.values().sum();
    results.write_unlisted(
        TIMING,
        &json(&tree_of!({
            "seconds": seconds,
            "threads": rayon::current_num_threads(),
        })),
    )?;
    Ok(format!(
        " from {} shading samples in {total:.1} s",
        rendered.points.len()
    ))
}

/// The number of shading samples, if it is low enough to place the samples.
fn shading_samples(request: &PictureRequest, camera: &Camera) -> Result<usize, Failure> {
    let pixels = camera.size[0] * camera.size[1];
    let Some(samples) = request.shading_samples else {
        return Ok(pixels.div_ceil(20));
    };
    let samples = samples as usize;
    let most = MAX_EACH * pixels;
    if samples > most {
        let arguments = request.source.arguments;
        return Err(Failure::bad_input(format!(
            "{}; allowed: at most {most}, {MAX_EACH} for each of the {pixels} pixels; the method \"reference\" renders with more",
            arguments.with("shading_samples", samples)
        )));
    }
    Ok(samples)
}

/// Advances a progress bar by the given number of steps.
fn advance(bar: &Mutex<Option<Box<dyn Progress + '_>>>, steps: u64) {
    let bar = bar.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(bar) = bar.as_ref() {
        bar.advance(steps);
    }
}

/// The current stage, and the durations of the previous ones.
struct StageWatch<'a> {
    reporter: &'a dyn Reporter,
    bar: Mutex<Option<Box<dyn Progress + 'a>>>,
    now: RefCell<Option<(String, Instant)>>,
    seconds: RefCell<BTreeMap<String, f64>>,
}

impl<'a> StageWatch<'a> {
    fn new(reporter: &'a dyn Reporter) -> Self {
        Self {
            reporter,
            bar: Mutex::new(None),
            now: RefCell::new(None),
            seconds: RefCell::new(BTreeMap::new()),
        }
    }

    fn begin(&self, stage: Stage, steps: usize) {
        self.lap();
        let name = format!("{stage:?}").to_lowercase();
        let bar = self.reporter.begin(Work::Steps {
            verb: "rendering",
            total: steps,
            things: "steps",
        });
        bar.name(&name);
        *self.now.borrow_mut() = Some((name, Instant::now()));
        *self.bar() = Some(bar);
    }

    fn bar(&self) -> MutexGuard<'_, Option<Box<dyn Progress + 'a>>> {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lap(&self) {
        if let Some((name, begun)) = self.now.borrow_mut().take() {
            *self.seconds.borrow_mut().entry(name).or_default() += begun.elapsed().as_secs_f64();
        }
    }

    fn end(self) -> BTreeMap<String, f64> {
        self.lap();
        self.bar().take();
        self.seconds.into_inner()
    }
}

fn write(results: &mut Results, rendered: &Rendered, made_from: &Value) -> Result<(), Failure> {
    require_finite(rendered.size, &rendered.radiance)?;
    let Layers {
        bandwidth,
        unoccluded,
        curvature,
        blockers,
        shadow,
        density,
        samples,
        variance,
    } = &rendered.layers;
    let layers = [
        ("radiance", &rendered.radiance),
        ("bandwidth", bandwidth),
        ("unoccluded", unoccluded),
        ("curvature", curvature),
        ("blockers", blockers),
        ("shadow", shadow),
        ("density", density),
        ("samples", samples),
        ("variance", variance),
    ];
    // A method produces only the maps that it needs.
    let layers = layers.into_iter().filter(|(_, of)| !of.is_empty());
    let layers = layers.map(|(name, of)| (name, &of[..]));
    let npz = write_exr(results, "picture.exr", rendered.size, layers, made_from)?;
    let points = rendered.points.concat();
    let points = Array2::from_shape_vec((rendered.points.len(), 2), points);
    let npz = npz.add("points", &points.map_err(Failure::cannot_run)?)?;
    results.write("picture.npz", &npz.bytes()?)?;
    let mut photograph = |name: &str, values: &[f64]| {
        let png = etendue_figures::photograph(rendered.size, values);
        let png = png.map_err(Failure::cannot_run)?;
        results.write(name, &png)
    };
    photograph("picture.png", &rendered.radiance)?;
    photograph("samples.png", samples)?;
    let shown = if bandwidth.is_empty() {
        density
    } else {
        bandwidth
    };
    let shown: Vec<f64> = shown
        .iter()
        .map(|x| if x.is_nan() { 0.0 } else { *x })
        .collect();
    photograph("bandwidth.png", &shown)
}
