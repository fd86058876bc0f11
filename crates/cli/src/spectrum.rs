//! Implements `etendue spectrum`, which measures the spectrum of the rays of a file.

use crate::args::SpectrumArgs;
use crate::measure::MeasureStage;
use crate::print::deliver;
use etendue_field::{VirtualPlane, brief};
use etendue_pipeline::Run;
use etendue_pipeline::load::{self, SceneSource};
use etendue_scene::Scene;
use etendue_spectrum::bandwidth::Along;
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::moments::shear_slope;
use etendue_spectrum::{CrossPower, Measurement, Uncertain};
use etendue_store::{Failure, Method};

/// Number of frequencies on either side of zero. Adjacent frequencies differ by one cycle over the
/// width of the window.
const FREQUENCIES: f64 = 12.0;

/// The largest default half-width along slopes, which is 45°.
const MAX_SLOPE: f64 = 1.0;

/// Runs `etendue spectrum`; returns the exit code.
pub(crate) fn spectrum(args: &SpectrumArgs) -> Result<u8, Failure> {
    let source = |half: [f64; 2]| SceneSource {
        text: Some(text(args, half)),
        ..SceneSource::file(&args.file, &args.set)
    };
    // The default window is around the rays, whose extent is known when they have been read.
    let half = half_widths(&load::scene(&source([1.0; 2]), |_| ())?);
    let source = source(half);
    let run = Run::read(&source, Method::Given, |_| ())?;
    let folder = args.out.or_named(&run.scene.name);
    let stage = MeasureStage {
        run: &run,
        source: &source,
        out: &folder,
        batches: 0..run.scene.run.batches,
        work: &args.work,
    };
    let measurement = stage.write()?;
    for (plane, at) in run.scene.planes.iter().enumerate() {
        let few = |_| Failure::bad_input("the rays have too few groups for errors");
        deliver(&numbers(&measurement, plane, at).map_err(few)?)?;
    }
    deliver(&format!("measurement in {}", folder.display()))?;
    Ok(0)
}

/// What the spectrum of a plane tells, with standard errors.
fn numbers(
    measurement: &Measurement,
    index: usize,
    plane: &VirtualPlane,
) -> Result<String, TooFewBatches> {
    let (power, tally) = (
        CrossPower::new(measurement, index)?,
        measurement.tally(index),
    );
    let number = |name: &str, unit: &str, of: Option<Uncertain>| match of {
        Some(Uncertain { value, error }) => {
            format!("{name:<16}{} ± {} {unit}", brief(value), brief(error))
        }
        None => format!("{name:<16}–"),
    };
    let widest = |along: Along| power.bandwidth(along).map(|widest| widest.value);
    let rays = format!(
        "{} of {} rays in the window",
        tally.inside,
        measurement.emitted()
    );
    Ok([
        format!("{:<16}{rays}", plane.name),
        number(
            "shear slope",
            "m",
            power.statistic(|p| shear_slope(p, &plane.grid)),
        ),
        number("95 % along rho", "cycles/m", widest(Along::Rho)),
        number("95 % along nu", "cycles per unit slope", widest(Along::Nu)),
    ]
    .join("\n"))
}

/// A scene with the rays as its light, and one plane at the origin of the file.
fn text(args: &SpectrumArgs, [x, u]: [f64; 2]) -> String {
    let name = args.file.file_name().unwrap_or_default().to_string_lossy();
    let flux = args
        .flux
        .map_or(String::new(), |flux| format!(", flux: {flux:?}"));
    let [rho, nu] = [x, u].map(|half| FREQUENCIES * 0.5 / half);
    format!(
        "(light: Rays(center: (0, 0, 0), file: {name:?}{flux}), \
         surfaces: [Rectangle(name: \"screen\", center: (0, 0, 10), size: (1, 1))], \
         path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"screen\"]), \
         planes: [(name: \"rays\", at: Distance(0))], \
         window: (x: Hann({x}), u: Hann({u})), \
         frequencies: (rho: (max: {rho}), nu: (max: {nu})))",
        x = brief(x),
        u = brief(u),
        rho = brief(rho),
        nu = brief(nu),
    )
}

/// Half-widths of a window along positions and along slopes around the rays of a light.
fn half_widths(scene: &Scene) -> [f64; 2] {
    let light = &scene.light;
    let reach = |axis: usize| {
        light
            .extent(axis)
            .map(f64::abs)
            .into_iter()
            .fold(0.0, f64::max)
    };
    let [x, u] = [
        reach(0).max(reach(1)),
        light.steepest(0).max(light.steepest(1)),
    ];
    [x.max(1e-6), u.clamp(1e-6, MAX_SLOPE)]
}
