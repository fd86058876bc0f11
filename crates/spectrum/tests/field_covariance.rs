//! Tests the covariance of spectra, measured on Gaussian light fields whose covariance is known.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use crate::common::{Random, grid, plane};
use etendue_field::{Crossing, Ledger, PhotonSource, Profile, TwoPlane, VirtualPlane, Window};
use etendue_spectrum::field::{
    FieldMeasurement, FieldOptions, FieldSpectrum, Moments, measure_field,
};
use std::f64::consts::{PI, TAU};

/// A window with a Gaussian profile of variance w²/2π along each axis.
fn window() -> Window {
    let gaussian = |width: f64, cut: f64| Profile::Gaussian { width, cut };
    Window {
        x: gaussian(0.5, 0.8),
        y: gaussian(0.4, 0.7),
        u: gaussian(0.3, 0.5),
        v: gaussian(0.3, 0.5),
    }
}

fn at() -> VirtualPlane {
    let window = window();
    plane("at", window, grid(&window, 1, [7, 7], 1.0))
}

/// The distance that the light has travelled, in metres.
const TRAVEL: f64 = 0.8;
/// Variances of x, y, u and v at the light.
const LIGHT: [f64; 4] = [0.02, 0.03, 0.03, 0.02];

/// A source of photons sampled from a Gaussian light field after travel.
struct Gaussian {
    seed: u64,
    each: u64,
}

impl PhotonSource for Gaussian {
    fn emitted(&self, _: u32) -> u64 {
        self.each
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        _: &dyn Fn(u64),
    ) -> Ledger {
        let mut random = Random(self.seed.wrapping_mul(1_000_003) + u64::from(batch) * 7919);
        let plane = at();
        for _ in 0..self.each {
            let mut pair = || {
                let (r, turn) = (random.unit(), TAU * random.unit());
                let r = (-2.0 * libm::log(1.0 - r)).sqrt();
                [r * libm::cos(turn), r * libm::sin(turn)]
            };
            let ([x, y], [u, v]) = (pair(), pair());
            let [x, y, u, v] = [x, y, u, v]
                .iter()
                .zip(LIGHT)
                .map(|(n, s): (&f64, f64)| n * s.sqrt())
                .collect::<Vec<_>>()
                .try_into()
                .unwrap();
            let ray = TwoPlane {
                x: x + TRAVEL * u,
                y: y + TRAVEL * v,
                u,
                v,
            };
            // Photons are sampled from radiance over (x, y, u, v), so the factor from flux to
            // radiance is divided out.
            let weight = 1.0 / plane.factor(&ray);
            record(0, &[Crossing { ray, weight }]);
        }
        Ledger::default()
    }
}

/// Three entries of 1/8π² S⁻¹ for the windowed field over (x, u) or (y, v): position and
/// position, position and slope, slope and slope.
fn expected(axis: usize) -> [f64; 3] {
    let window = window();
    let width = |profile: Profile| match profile {
        Profile::Gaussian { width, .. } => width,
        _ => unreachable!("the window is of Gaussians"),
    };
    let [x, u] = [[window.x, window.u], [window.y, window.v]][axis].map(width);
    let [sx, su] = [LIGHT[axis], LIGHT[axis + 2]];
    // The windowed field is exp(−½ ((x − d u)²/sx + u²/su) − π x²/wx² − π u²/wu²).
    [
        1.0 / sx + TAU / (x * x),
        -TRAVEL / sx,
        TRAVEL * TRAVEL / sx + 1.0 / su + TAU / (u * u),
    ]
    .map(|inverse| inverse / (8.0 * PI * PI))
}

fn measured(seed: u64, each: u64) -> FieldMeasurement {
    let options = FieldOptions {
        covariance: true,
        ..FieldOptions::default()
    };
    let source = Gaussian { seed, each };
    measure_field(&source, 0, &at(), 0..16, &options, &|_| ()).unwrap()
}

/// The known covariance: the entries ρx², ρx νu and νu², and the corresponding entries
/// along y. All other entries of the covariance are zero.
fn known() -> [[f64; 4]; 4] {
    let mut matrix = [[0.0; 4]; 4];
    for axis in 0..2 {
        let [position, both, slope] = expected(axis);
        matrix[axis][axis] = position;
        matrix[axis][axis + 2] = both;
        matrix[axis + 2][axis] = both;
        matrix[axis + 2][axis + 2] = slope;
    }
    matrix
}

#[test]
fn photons_have_the_covariance_of_their_field() {
    let field = measured(3, 20_000);
    let found = field.covariance.unwrap().estimate().unwrap();
    let (mut most, mut signal) = (0.0_f64, f64::INFINITY);
    for (i, row) in known().iter().enumerate() {
        for (j, expected) in row.iter().enumerate() {
            let off = (found.value[i][j] - expected) / found.error[i][j];
            most = most.max(off.abs());
        }
        signal = signal.min(row[i] / found.error[i][i]);
    }
    // Each entry's difference from the known value, divided by its error from 16 groups, follows
    // Student's t with 15 degrees of freedom. The largest of ten such differences exceeds 4.1
    // once in a hundred times.
    assert!(most < 4.1, "{most}");
    // Each of three faults would cause differences far above the errors: a shear of the wrong sign,
    // A in place of A⁻ᵀ, or a factor of 2.
    assert!(signal > 20.0, "{signal}");
    let wrong = (found.value[0][2] + expected(0)[1]) / found.error[0][2];
    assert!(wrong.abs() > 20.0, "{wrong}");
}

/// If a group has only 20 photons, the noise power exceeds the moments, but does not bias the
/// estimates.
#[test]
fn few_photons_have_no_bias() {
    let (mut all, mut naive) = (Vec::new(), Vec::new());
    for seed in 0..32 {
        let field = measured(100 + seed, 20);
        let moments = field.covariance.as_ref().unwrap().moments;
        all.push([
            moments.power,
            moments.second[0][0],
            moments.second[2][2],
            moments.second[0][2],
        ]);
        let plain = with_noise(&field.spectrum);
        naive.push([
            plain.power,
            plain.second[0][0],
            plain.second[2][2],
            plain.second[0][2],
        ]);
    }
    let exact = exact_moments();
    let exact = [
        exact.power,
        exact.second[0][0],
        exact.second[2][2],
        exact.second[0][2],
    ];
    let mean = |runs: &[[f64; 4]], k: usize| {
        let n = runs.len() as f64;
        let mean = runs.iter().map(|run| run[k]).sum::<f64>() / n;
        let squares = runs.iter().map(|run| (run[k] - mean).powi(2)).sum::<f64>();
        (mean, (squares / (n * (n - 1.0))).sqrt())
    };
    for (k, exact) in exact.into_iter().enumerate() {
        let (value, error) = mean(&all, k);
        // At least one of four entries exceeds this tolerance by chance once in a thousand times.
        assert!(
            (value - exact).abs() < 3.7 * error,
            "{k}: {value} {error} {exact}"
        );
        if k < 3 {
            let (value, error) = mean(&naive, k);
            // If noise is not removed, the difference exceeds the error by far.
            assert!(value - exact > 20.0 * error, "{k}: {value} {error} {exact}");
        }
    }
}

/// The moments of |ℓ̂|² over the same band, including noise.
fn with_noise(spectrum: &FieldSpectrum) -> etendue_spectrum::field::PowerMoments {
    let moments = Moments::new(spectrum.grid, &at().grid);
    moments.of(|index| spectrum.values[index].norm_sqr())
}

/// The moments of the spectrum of the windowed field, exp(−2π² Ωᵀ S Ω) times its integral.
fn exact_moments() -> etendue_spectrum::field::PowerMoments {
    let grid = FieldOptions {
        covariance: true,
        ..FieldOptions::default()
    }
    .grid(&at());
    let section = |axis: usize| {
        let [a, b, c] = expected(axis).map(|entry| 8.0 * PI * PI * entry);
        let determinant = a * c - b * b;
        let [sx, su] = [LIGHT[axis], LIGHT[axis + 2]];
        // The integral of the windowed Gaussian, divided by the integral of the density from
        // which the photons are sampled.
        let integral = 1.0 / (determinant * sx * su).sqrt();
        (
            [c / determinant, -b / determinant, a / determinant],
            integral,
        )
    };
    let sections = [section(0), section(1)];
    Moments::new(grid, &at().grid).at_frequencies(|omega| {
        let of = |axis: usize| {
            let ([xx, xu, uu], integral) = sections[axis];
            let [r, n] = [omega[axis], omega[axis + 2]];
            integral * libm::exp(-2.0 * PI * PI * (xx * r * r + 2.0 * xu * r * n + uu * n * n))
        };
        (of(0) * of(1)).powi(2)
    })
}

/// The band contains the entire spectrum, so sums over the band's frequencies equal the
/// integrals.
#[test]
fn moments_of_a_gaussian_are_its_covariance() {
    let found = exact_moments().covariance().unwrap();
    for (i, row) in known().iter().enumerate() {
        for (j, expected) in row.iter().enumerate() {
            let scale = (known()[i][i] * known()[j][j]).sqrt();
            let off = (found[i][j] - expected).abs() / scale;
            // The tolerance is the part of the spectrum beyond seven half-cycles of the narrowest
            // axis.
            assert!(off < 2e-3, "{i} {j} {off}");
        }
    }
}
