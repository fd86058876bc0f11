//! Implements `etendue spectrum`, which measures the spectrum of the rays of a file.

use crate::args::SpectrumArgs;
use crate::measure::MeasureStage;
use crate::print::deliver;
use etendue_field::{VirtualPlane, brief, percent, uncertain};
use etendue_pipeline::Run;
use etendue_pipeline::load::{self, SceneSource};
use etendue_scene::Scene;
use etendue_spectrum::bandwidth::Along;
use etendue_spectrum::estimate::{self, TooFewBatches};
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
    let source = source(half_widths(
        &load::scene(&source([1.0; 2]), |_| ())?,
        &args.set,
    ));
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
    let power = CrossPower::new(measurement, index)?;
    let slices = estimate::slices(measurement, index)?;
    let noise = slices.variance.sum().sqrt() / slices.mean.norm();
    let number = |of: Option<Uncertain>, unit: &str| {
        let stated = |Uncertain { value, error }| format!("{} {unit}", uncertain(value, error));
        of.map_or_else(|| "not above the noise".to_owned(), stated)
    };
    let widest = |along: Along| power.bandwidth(along).map(|widest| widest.value);
    let (inside, all) = (measurement.tally(index).inside, measurement.emitted());
    let VirtualPlane { window, grid, .. } = plane;
    let rows = [
        ("rays", format!("{inside} of {all} in the window")),
        ("window", format!("x {:?}, u {:?}", window.x, window.u)),
        (
            "frequencies",
            format!(
                "rho to {} cycles/m, nu to {} cycles per unit slope",
                brief(grid.rho.max()),
                brief(grid.nu.max())
            ),
        ),
        ("noise", format!("{} of the spectrum", percent(noise, 1))),
        (
            "shear slope",
            number(power.statistic(|p| shear_slope(p, grid)), "m"),
        ),
        ("95 % along rho", number(widest(Along::Rho), "cycles/m")),
        (
            "95 % along nu",
            number(widest(Along::Nu), "cycles per unit slope"),
        ),
    ];
    Ok(rows
        .map(|(name, value)| format!("{name:<16}{value}"))
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

/// Half-widths of the window along positions and along slopes: those that are set, and otherwise
/// around the rays of the light.
fn half_widths(scene: &Scene, set: &[(String, String)]) -> [f64; 2] {
    let light = &scene.light;
    let reach = |axis: usize| {
        light
            .extent(axis)
            .map(f64::abs)
            .into_iter()
            .fold(0.0, f64::max)
    };
    let slope = light.steepest(0).max(light.steepest(1));
    let around = [
        reach(0).max(reach(1)).max(1e-6),
        slope.clamp(1e-6, MAX_SLOPE),
    ];
    let window = &scene.planes[0].window;
    let is_set = |name: &str| set.iter().any(|(path, _)| path == name || path == "window");
    let stated = [("window.x", window.x), ("window.u", window.u)];
    std::array::from_fn(|i| match stated[i] {
        (name, profile) if is_set(name) => profile.half_width(),
        _ => around[i],
    })
}
