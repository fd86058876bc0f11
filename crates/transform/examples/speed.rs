//! Times the slice transform: nanoseconds per ray and azimuth, and milliseconds for the FFTs of a
//! batch.
//!
//! `cargo run --release -p etendue-transform --example speed`

#![allow(clippy::print_stdout, reason = "its purpose")]

use etendue_field::{FrequencyAxis, Profile, SliceGrid, TwoPlane, Window};
use etendue_transform::SliceTransform;
use std::time::Instant;

const RAYS: u32 = 1 << 18;
const AZIMUTHS: usize = 8;

fn main() {
    let rays: Vec<TwoPlane> = (0..RAYS).map(ray).collect();
    println!("window: {:.1} ns a ray", window(&rays));
    for [rho, nu] in [[8, 16], [16, 16], [16, 32], [32, 32], [32, 64]] {
        let (spread, fft) = transform(&rays, [rho, nu]);
        println!("{rho:2} x {nu:2}: {spread:.1} ns a ray and azimuth, {fft:.2} ms a batch");
    }
}

/// Returns low-discrepancy rays in (−1, 1)² × (−1/2, 1/2)²; consecutive rays are far apart.
fn ray(i: u32) -> TwoPlane {
    let at = |step: f64| (f64::from(i) * step).fract() - 0.5;
    TwoPlane {
        x: 2.0 * at(0.856_674_88),
        y: 2.0 * at(0.733_891_86),
        u: at(0.628_706_72),
        v: at(0.538_596_93),
    }
}

/// The shortest of ten times.
fn best(mut seconds: impl FnMut() -> f64) -> f64 {
    (0..10).map(|_| seconds()).fold(f64::INFINITY, f64::min)
}

fn window(rays: &[TwoPlane]) -> f64 {
    let [wide, narrow] = [Profile::Hann(1.0), Profile::Hann(0.5)];
    let window = Window {
        x: wide,
        y: wide,
        u: narrow,
        v: narrow,
    };
    let seconds = best(|| {
        let start = Instant::now();
        let sum: f64 = rays.iter().map(|ray| window.value(ray)).sum();
        std::hint::black_box(sum);
        start.elapsed().as_secs_f64()
    });
    seconds / f64::from(RAYS) * 1e9
}

fn transform(rays: &[TwoPlane], [rho, nu]: [usize; 2]) -> (f64, f64) {
    let axis = |half, spacing| FrequencyAxis { half, spacing };
    let plan = SliceTransform::new(&SliceGrid {
        azimuths: AZIMUTHS,
        rho: axis(rho, 0.5),
        nu: axis(nu, 1.0),
    });
    let mut sum = plan.accumulator();
    let mut fft = f64::INFINITY;
    let spread = best(|| {
        let start = Instant::now();
        for ray in rays {
            sum.deposit(ray, 1.0);
        }
        let spread = start.elapsed().as_secs_f64();
        let start = Instant::now();
        std::hint::black_box(sum.finish(1.0));
        fft = fft.min(start.elapsed().as_secs_f64());
        spread
    });
    let each = f64::from(RAYS) * AZIMUTHS as f64;
    (spread / each * 1e9, fft * 1e3)
}
