//! Compares the slices of the fast transform with plain sums, over random scenes.

use crate::progress::progress;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use crate::wild;
use etendue_field::{Complex, Crossing, PhotonSource, SliceGrid, Slices, VirtualPlane};
use etendue_scene::{Scene, resolve};
use etendue_trace::Tracer;
use etendue_transform::random::{self, Stream};
use etendue_transform::{SliceTransform, direct};
use std::io;

/// Options that select the scenes.
#[derive(Debug, clap::Args)]
pub(crate) struct TransformOptions {
    /// Number of scenes in which light reaches a window.
    #[arg(long, default_value_t = 20)]
    scenes: usize,
    /// Seed of the random scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Photons per scene.
    #[arg(long, default_value_t = 1_000_000)]
    photons: u64,
}

/// Number of frequencies of a plane at which sums are compared.
const FREQUENCIES: u64 = 64;
/// Number of rays of a plane that are transformed one by one.
const SINGLE: usize = 200;

/// Single rays with a smaller share of the weight of all rays are left out: the transform of six
/// taps counts light below 2⁻⁹⁰⁰ as darkness, which narrow Gaussian windows reach.
const DARK: f64 = 1e-30;

/// Errors of one transform at one plane.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    /// Largest error for one ray, as a share of its weight.
    single: f64,
    /// Largest error for all rays, as a share of the sum of weights.
    all: f64,
    /// The same error in standard errors of as many photons from random numbers.
    noise: f64,
}

impl Errors {
    fn max(self, other: Self) -> Self {
        Self {
            single: self.single.max(other.single),
            all: self.all.max(other.all),
            noise: self.noise.max(other.noise),
        }
    }
}

/// The errors with eight taps in f64 and with six taps in whole numbers.
pub(crate) fn transform(options: &TransformOptions) -> io::Result<ReportSection> {
    let bar = progress(options.scenes as u64, "scenes");
    let mut rows = Vec::new();
    let mut largest = [Errors::default(); 2];
    let mut largest_used = 0.0_f64;
    for index in 0.. {
        if rows.len() == options.scenes {
            break;
        }
        let folder = tempfile::tempdir()?;
        let file = wild::scene(options.seed, index, options.photons, folder.path())?;
        let Ok(scene) = resolve("scene", file, folder.path(), u64::MAX) else {
            continue;
        };
        let tracer = Tracer::new(&scene);
        let Some(errors) = of_scene(&scene, &tracer) else {
            continue;
        };
        let used = if tracer.is_precise() { "8" } else { "6" };
        largest = [0, 1].map(|i| largest[i].max(errors[i]));
        if !tracer.is_precise() {
            largest_used = largest_used.max(errors[1].noise);
        }
        rows.push(Row::new(
            cells(&index.to_string(), used, &errors),
            Vec::new(),
        ));
        bar.one();
    }
    bar.end();
    let [full, reduced] = largest;
    let checks = vec![
        Check::new("full", full.single, Below(2e-7)).because("the documented error"),
        Check::new("reduced", reduced.single, Below(2e-5)).because("the documented error"),
        Check::new("noise", largest_used, Below(0.1)).because("a tenth of the noise"),
    ];
    rows.push(Row::new(cells("largest", "", &largest), checks));
    Ok(ReportSection::new(
        "Errors of the slice transform",
        format!(
            "Slices of {} random scenes (seed {}) are compared with plain sums at {FREQUENCIES} \
             frequencies of each plane. *One ray* is the largest error of {SINGLE} single rays \
             inside the window, divided by the weight of the ray. *All* is the error for the rays \
             of {} photons, divided by the sum of their weights, and *noise* is this error in \
             standard errors of as many photons from random numbers. *Taps used* is the number \
             with which a run of the scene spreads its photons: eight in f64, or six in whole \
             numbers.",
            options.scenes, options.seed, options.photons
        ),
        "scene | taps used | 8 taps: one ray | all | noise | 6 taps: one ray | all | noise",
        rows,
    ))
}

fn cells(name: &str, used: &str, errors: &[Errors; 2]) -> Vec<String> {
    let mut cells = vec![name.to_owned(), used.to_owned()];
    for errors in errors {
        let errors = [errors.single, errors.all, errors.noise];
        cells.extend(errors.map(|error| format!("{error:.1e}")));
    }
    cells
}

/// The largest errors of both transforms over the planes of a scene; `None` if too few rays
/// are in the windows.
fn of_scene(scene: &Scene, tracer: &Tracer) -> Option<[Errors; 2]> {
    let mut rays: Vec<Vec<Crossing>> = vec![Vec::new(); scene.planes.len()];
    for batch in 0..scene.run.batches {
        tracer.emit(
            batch,
            &mut |plane, crossings| {
                let window = &scene.planes[plane].window;
                let inside = crossings.iter().filter(|c| window.contains(&c.ray));
                rays[plane].extend(inside.map(|c| Crossing {
                    ray: c.ray,
                    weight: c.weight * window.value(&c.ray),
                }));
            },
            &|_| (),
        );
    }
    let lit = scene
        .planes
        .iter()
        .zip(&rays)
        .filter(|(_, rays)| rays.len() > SINGLE);
    let errors = lit.map(|(plane, rays)| of_plane(plane, rays));
    errors.reduce(|a, b| [0, 1].map(|i| a[i].max(b[i])))
}

fn of_plane(plane: &VirtualPlane, rays: &[Crossing]) -> [Errors; 2] {
    let grid = plane.grid;
    let plans = [SliceTransform::new(&grid), SliceTransform::reduced(&grid)];
    let at = places(&grid);
    let step = rays.len() / SINGLE;
    let single: Vec<&[Crossing]> = rays.chunks(step.max(1)).map(|few| &few[..1]).collect();
    let weight: f64 = rays.iter().map(|c| c.weight).sum();
    let noise = rays.iter().map(|c| c.weight * c.weight).sum::<f64>().sqrt();
    let exact = plain(&grid, &at, rays);
    let exact_single: Vec<Vec<Complex>> = single.iter().map(|one| plain(&grid, &at, one)).collect();
    plans.each_ref().map(|plan| {
        let all = error(&fast(plan, rays), &at, &exact);
        let single = single
            .iter()
            .zip(&exact_single)
            .filter(|(one, _)| one[0].weight > DARK * weight);
        let single = single.map(|(one, exact)| error(&fast(plan, one), &at, exact) / one[0].weight);
        Errors {
            single: single.fold(0.0, f64::max),
            all: all / weight,
            noise: all / noise,
        }
    })
}

/// The four corners of the half-plane of frequencies at azimuth 0, and frequencies drawn at
/// random, as indices [azimuth, ρ ≥ 0, ν].
fn places(grid: &SliceGrid) -> Vec<[usize; 3]> {
    let shape = grid.half_shape();
    let [_, rho, nu] = shape.map(|count| count - 1);
    let corners = [[0, 0, 0], [0, rho, 0], [0, 0, nu], [0, rho, nu]];
    let drawn = (0..FREQUENCIES - 4).map(|i| {
        let words = random::words(0, Stream::Points, i, 0);
        [0, 1, 2].map(|axis| random::index(words[axis], shape[axis]))
    });
    corners.into_iter().chain(drawn).collect()
}

fn plain(grid: &SliceGrid, at: &[[usize; 3]], rays: &[Crossing]) -> Vec<Complex> {
    let frequency = |&[k, m, n]: &[usize; 3]| {
        grid.frequency(k, grid.rho.value(grid.rho.half + m), grid.nu.value(n))
    };
    at.iter()
        .map(|at| direct::at(rays, |_| 1.0, frequency(at)))
        .collect()
}

fn fast(plan: &SliceTransform, rays: &[Crossing]) -> Slices {
    let mut sum = plan.accumulator();
    for Crossing { ray, weight } in rays {
        sum.deposit(ray, *weight);
    }
    sum.finish(1.0)
}

fn error(slices: &Slices, at: &[[usize; 3]], exact: &[Complex]) -> f64 {
    let pairs = at.iter().zip(exact);
    let errors = pairs.map(|(at, exact)| (slices.half[*at] - exact).norm());
    errors.fold(0.0, f64::max)
}
