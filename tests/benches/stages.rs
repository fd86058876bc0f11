//! Benchmarks of the stages of a run: tracing photons, adding them to spectral slices, and
//! Fourier transforms.
//!
//!     cargo bench -p etendue-validation
//!     cargo bench -p etendue-validation -- photons      # only those with this word in their name
//!
//! Throughput is in photons, crossings or cells per second, on one thread except for the 4D
//! transform.

#![allow(clippy::unwrap_used, reason = "a benchmark may panic")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use etendue_field::{Crossing, PhotonSource};
use etendue_scene::{Scene, SceneFile, resolve};
use etendue_trace::{Emitter, PHOTONS_PER_GROUP, Tracer};
use etendue_transform::Net;
use etendue_transform::RealFft4;
use etendue_transform::SliceTransform;
use etendue_transform::random::Stream;
use std::hint::black_box;
use std::path::Path;

/// Photons per batch. Each batch of photons is one net. The net is so large that the cost of its
/// first block is negligible.
const PHOTONS: u64 = 1 << 16;

/// A scene of the repository whose batches have [`PHOTONS`] photons each.
fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{name}.ron"));
    let text = std::fs::read_to_string(&path).unwrap();
    let mut file = SceneFile::parse(&text).unwrap();
    file.run.photons = PHOTONS * u64::from(file.run.batches);
    resolve(name, file, path.parent().unwrap(), u64::MAX).unwrap()
}

/// Measures the emission of a batch: points of a net, the rays aimed from them, and their weights.
fn emission(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("emission");
    group.sample_size(20);
    group.throughput(Throughput::Elements(PHOTONS));
    let net = Net::new(1, Stream::Net, 0, 2);
    let points = 0..u32::try_from(PHOTONS).unwrap();
    group.bench_function("points", |bencher| {
        bencher.iter(|| {
            let groups = points.clone().step_by(PHOTONS_PER_GROUP);
            let words = groups.map(|first| net.columns::<PHOTONS_PER_GROUP>(first, 0)[0]);
            words.fold(0, |all, words| all ^ words[0])
        });
    });
    for name in ["travel", "fig9b", "table1/environment"] {
        let emitter = Emitter::new(&scene(name));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let groups = points.clone().step_by(PHOTONS_PER_GROUP).map(|first| {
                    let photons = emitter.emit(|block| net.columns(first, block));
                    photons.weights[0]
                });
                groups.sum::<f64>()
            });
        });
    }
    group.finish();
}

/// Measures the tracing of a batch: emission, hits, bounces and crossings of all planes.
fn photons(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("photons");
    group.sample_size(20);
    group.throughput(Throughput::Elements(PHOTONS));
    for name in ["travel", "bench_peer", "fig9b", "fig10", "mesh_blocker"] {
        let tracer = Tracer::new(&scene(name));
        group.bench_function(name, |bencher| {
            let mut record = |_, crossings: &[Crossing]| {
                black_box(crossings);
            };
            bencher.iter(|| tracer.emit(0, &mut record, &|_| ()));
        });
    }
    group.finish();
}

/// Measures how fast a plane's crossings are added to an accumulator, and how fast the
/// accumulator is transformed to slices.
fn slices(criterion: &mut Criterion) {
    let scene = scene("bench_peer");
    let mut rays = Vec::new();
    let mut record = |_, crossings: &[Crossing]| rays.extend_from_slice(crossings);
    Tracer::new(&scene).emit(0, &mut record, &|_| ());
    let transform = SliceTransform::new(&scene.planes[0].grid);
    let mut sum = transform.accumulator();

    let mut group = criterion.benchmark_group("slices");
    group.sample_size(20);
    group.throughput(Throughput::Elements(rays.len() as u64));
    group.bench_function("deposit", |bencher| {
        bencher.iter(|| {
            for crossing in &rays {
                sum.deposit(&crossing.ray, crossing.weight);
            }
        });
    });
    let grid = &scene.planes[0].grid;
    let cells = grid.azimuths * grid.rho.count() * grid.nu.count();
    group.throughput(Throughput::Elements(cells as u64));
    group.bench_function("transform", |bencher| bencher.iter(|| sum.finish(1.0)));
    group.finish();
}

/// Measures the 4D transform of a recorded light field, on all threads.
fn field(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("field");
    group.sample_size(10);
    for n in [32, 48] {
        let plan = RealFft4::new([n; 4]);
        let mut data = plan.padded(&vec![1.0; n.pow(4)]);
        group.throughput(Throughput::Elements(n.pow(4) as u64));
        group.bench_function(format!("{n}^4"), |bencher| {
            bencher.iter(|| {
                plan.forward(&mut data);
                // Rescales the data, so that many transforms in sequence do not overflow.
                data.iter_mut().for_each(|z| *z /= n.pow(2) as f64);
            });
        });
    }
    group.finish();
}

criterion_group!(stages, emission, photons, slices, field);
criterion_main!(stages);
