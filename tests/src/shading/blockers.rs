//! Tests statements of the paper about blockers in 2D: replicas, combinations, wedges, averages and
//! soft shadows.

use super::primal::{about, between, integral, transform, wave};
use super::strips::{coefficients, in_common, strips};
use super::words::Statement;
use crate::orders::slope;
use etendue_field::Complex;
use std::f64::consts::{PI, TAU};

/// Half-width of a light, distance from the light to the blockers, and distance from the blockers
/// to the receiver, in metres.
const LIGHT: f64 = 0.2;
const BEFORE: f64 = 1.0;
const AFTER: f64 = 0.5;
/// Maximum frequency in sums of pattern coefficients.
const SUMMED: usize = 48;

pub(super) fn statements() -> Vec<Statement> {
    let mut all = vec![replicas()];
    all.extend(combined());
    all.extend(wedge());
    all.extend(average());
    all.extend(soft_shadow());
    all
}

/// Locates the off-centre peaks in the spectrum of windowed light behind strips.
fn replicas() -> Statement {
    let mut worst = 0.0_f64;
    for pitch in [0.2, 0.1, 0.05] {
        // Returns the light that arrives at the position x, weighted by a Gaussian window of
        // width 0.3 over slopes.
        let seen = |x: f64| {
            let [low, high] =
                [x - LIGHT, x + LIGHT].map(|edge: f64| (edge / BEFORE).clamp(-0.5, 0.5));
            integral(between([low, high], 30), |v| {
                (-PI * (v / 0.3).powi(2)).exp()
            })
        };
        let open: Vec<(f64, f64)> = (-40..40)
            .flat_map(|n| {
                let low = f64::from(n) * pitch;
                between([low, low + 0.5 * pitch], 12)
            })
            .filter(|(x, _)| x.abs() < 1.0)
            .map(|(x, w)| (x, w * seen(x) * (-PI * (x / 0.5).powi(2)).exp()))
            .collect();
        let power = |omega: f64| {
            let sum: Complex = open.iter().map(|(x, w)| wave(omega * x) * *w).sum();
            sum.norm_sqr()
        };
        let (mut low, mut high) = (0.7 / pitch, 1.3 / pitch);
        while high - low > 1e-9 / pitch {
            let third = (high - low) / 3.0;
            if power(low + third) < power(high - third) {
                low += third;
            } else {
                high -= third;
            }
        }
        worst = worst.max((0.5 * (low + high) * pitch - 1.0).abs());
    }
    Statement {
        said: "replicas sit at the blockers' frequency f (3.4)",
        measured: "largest deviation of a peak from 1/pitch, relative to 1/pitch, in the spectrum \
            of a light behind strips 0.2, 0.1, 0.05 m apart"
            .to_owned(),
        number: worst,
        expected: [0.0, 1e-3],
        holds: "holds: for smaller patterns, replicas are farther away",
    }
}

/// The 90 % bandwidth of Fourier coefficients c_n: the smallest |n| below which 90 % of
/// their energy lies.
fn bandwidth(coefficients: &[Complex]) -> usize {
    let middle = coefficients.len() / 2;
    let energy =
        |n: usize| coefficients[middle + n].norm_sqr() + coefficients[middle - n].norm_sqr();
    let total: f64 = (0..=middle).map(energy).sum();
    let mut sum = 0.0;
    (0..=middle)
        .find(|n| {
            sum += energy(*n);
            sum >= 0.9 * total
        })
        .unwrap_or(middle)
}

/// Compares, for pairs of patterns in one plane, the spectrum of their product with its estimate
/// from magnitudes alone.
fn combined() -> Vec<Statement> {
    let (mut largest, mut under, mut over) = (0.0_f64, 0, 0);
    let pairs: u32 = 200;
    for pair in 0..pairs {
        let (a, b) = (strips(pair, 0.137), strips(pair, 0.414));
        let both = in_common(&a, &b);
        if both.is_empty() {
            continue;
        }
        let [first, second, true_one] = [&a, &b, &both].map(|open| coefficients(open, SUMMED));
        let bound: Vec<Complex> = (0..first.len())
            .map(|n| {
                let terms = (0..first.len()).filter_map(|m| {
                    let other = (n + first.len() / 2).checked_sub(m)?;
                    Some(first[m].norm() * second.get(other)?.norm())
                });
                Complex::from(terms.sum::<f64>())
            })
            .collect();
        // For |n| up to half of the computed range, the convolution sum omits only terms with
        // small, distant coefficients.
        for n in 32..=64 {
            largest = largest.max(true_one[n].norm() / bound[n].norm());
        }
        let [said, real] = [&bound, &true_one].map(|c| bandwidth(c));
        under += i32::from(said < real);
        over += i32::from(said > real);
    }
    vec![
        Statement {
            said: "combined blockers can be over-estimated, but not under-estimated (3.4)",
            measured: format!(
                "largest ratio |V̂₁₂|/(|V̂₁| ⊗ |V̂₂|) for {pairs} pairs of random strips, |n| ≤ \
                16"
            ),
            number: largest,
            expected: [0.2, 1.0],
            holds: "holds at every frequency, because magnitudes without phase are a bound",
        },
        Statement {
            said: "the same, for two complementary half-planes in one plane",
            measured: "largest ratio of the true |V̂₁₂| to the bound without phase".to_owned(),
            number: complementary(),
            expected: [0.0, 1e-12],
            holds: "the bound can be far too large: these half-planes let nothing pass",
        },
        Statement {
            said: "the same, for a bandwidth that holds a share of the energy",
            measured: format!(
                "share of the pairs whose 90 % bandwidth is under-estimated by magnitudes ({over} \
                are over-estimated)"
            ),
            number: f64::from(under) / f64::from(pairs),
            expected: [0.0, 0.0],
            holds: "holds for all pairs, although the order of magnitudes does not fix the order \
                of such bandwidths",
        },
    ]
}

fn complementary() -> f64 {
    let [a, b] = [[0.0, 0.5], [0.5, 1.0]].map(|half| coefficients(&vec![half], SUMMED));
    let middle = a.len() / 2;
    // The product is Σ c_m d_(n−m), and the size is the sum of the magnitudes of the same terms.
    // The product and the size both include the tail of terms in 1/m², which are negative in the
    // product for n = 0.
    let product: Complex = (0..a.len()).map(|m| a[m] * b[2 * middle - m]).sum();
    let size: f64 = (0..a.len())
        .map(|m| a[m].norm() * b[2 * middle - m].norm())
        .sum();
    // For odd |m| above 48, the terms of the product for n = 0 are −1/(πm)².
    let tail: f64 = (24..2_000_000)
        .map(|j| 2.0 / (PI * (2.0 * f64::from(j) + 1.0)).powi(2))
        .sum();
    let rest = 1.0 / (2.0 * PI * PI * 2_000_000.0);
    (product.re - tail - rest).abs() / (size + tail)
}

/// Tests two cosine gratings at depths 0 and 1 m.
fn wedge() -> Vec<Statement> {
    let frequency = 2.0;
    let content = |modulation: f64| {
        let grating = |y: f64| 1.0 - 0.5 * modulation * (1.0 - (TAU * frequency * y).cos());
        let at = |omega: [f64; 2]| -> f64 {
            let sum: Complex = about(0.0, 4.0, 160)
                .map(|(x, w)| {
                    let slopes = about(0.0, 4.0, 160);
                    let bell = |t: f64| (-PI * t * t / 4.0).exp();
                    let inner = transform(slopes, omega[1], |v| bell(v) * grating(x + v));
                    inner * wave(omega[0] * x) * (w * bell(x) * grating(x))
                })
                .sum();
            sum.norm()
        };
        at([0.0, frequency]) / at([0.0, 0.0])
    };
    let logs = [0.2_f64, 0.1, 0.05].map(|m| [m.ln(), content(m).ln()]);
    vec![
        Statement {
            said: "the spectrum of non-planar blockers stays in a wedge of angular frequencies \
                (3.2)",
            measured: "content at (0, f), outside the wedge, relative to the content at zero, for \
                two full cosine gratings 1 m apart"
                .to_owned(),
            number: content(1.0),
            expected: [0.249, 0.251],
            holds: "does not hold where rays meet two blockers",
        },
        Statement {
            said: "the same, for faint blockers",
            measured: "exponent with which this content falls with the modulation".to_owned(),
            number: slope(&logs),
            expected: [1.9, 2.2],
            holds: "holds to first order in the blocked light",
        },
    ]
}

/// E(x) = ∫ cos θ dθ, in closed form, over the directions in which the light is visible
/// through strips.
fn irradiance(x: f64, pitch: f64, phase: f64) -> f64 {
    let distance = BEFORE + AFTER;
    let sine = |u: f64| (u - x) / (u - x).hypot(distance);
    // The line from x to the point u of the light crosses the strips' plane at y = x + (u − x)
    // d₂/D.
    let onto = |y: f64| x + (y - x) * distance / AFTER;
    let ends = [-LIGHT, LIGHT].map(|u| x + (u - x) * AFTER / distance);
    let mut n = (ends[0] / pitch - phase).floor() - 1.0;
    let mut sum = 0.0;
    while (n + phase) * pitch < ends[1] {
        let low = onto((n + phase) * pitch).max(-LIGHT);
        let high = onto((n + phase + 0.5) * pitch).min(LIGHT);
        if high > low {
            sum += sine(high) - sine(low);
        }
        n += 1.0;
    }
    sum
}

fn average() -> Vec<Statement> {
    let distance = BEFORE + AFTER;
    let free = |x: f64| {
        let sine = |u: f64| (u - x) / (u - x).hypot(distance);
        sine(LIGHT) - sine(-LIGHT)
    };
    // At these pitches of the strips, the light's image covers an odd number of half periods, and
    // the first harmonic is largest.
    let image = 2.0 * LIGHT * AFTER / distance;
    let pitches = [4.5, 9.5, 18.5, 36.5].map(|count| image / count);
    let ripple = |pitch: f64| {
        let period = pitch * distance / BEFORE;
        (0..64)
            .map(|i| {
                let x = period * f64::from(i) / 64.0;
                (irradiance(x, pitch, 0.25) - 0.5 * free(x)).abs()
            })
            .fold(0.0, f64::max)
            / (0.5 * free(0.0))
    };
    let logs = pitches.map(|pitch| [pitch.ln(), ripple(pitch).ln()]);
    // Returns the spectrum at one frequency of the light in a Gaussian window.
    let at = |pitch: Option<f64>| -> Complex {
        transform(about(0.0, 1.4, 6000), 0.7, |x| {
            let e = pitch.map_or(0.5 * free(x), |pitch| irradiance(x, pitch, 0.25));
            e * (-PI * (x / 0.4).powi(2)).exp()
        })
    };
    let mean = at(None);
    let spectrum = [0.3, 0.15].map(|pitch| (at(Some(pitch)) - mean).norm() / mean.norm());
    vec![
        Statement {
            said: "small blockers act as their average (3.4)",
            measured: format!(
                "exponent with which the ripple of the irradiance under strips falls with their \
                pitch, from {:.4} to {:.4} m",
                pitches[0], pitches[3]
            ),
            number: slope(&logs),
            expected: [0.9, 1.1],
            holds: "holds to first order in the pitch",
        },
        Statement {
            said: "the same, for the spectrum at one frequency",
            measured: format!(
                "exponent from the pitch 0.3 to 0.15 m, where the differences are {:.1e} and \
                {:.1e}",
                spectrum[0], spectrum[1]
            ),
            number: (spectrum[0] / spectrum[1]).log2(),
            // The spectrum falls with the pitch like the tail of a Gaussian at f d₁/D − 0.7, in a
            // window of 0.4 m. For the two pitches, this difference is 1.5 and 3.7 cycles per
            // metre.
            expected: [4.0, 100.0],
            holds: "holds, and the ripple falls faster than any power: only the tails of replicas \
                arrive",
        },
    ]
}

/// Compares the integral ∫ light(u) B(y(u)) du with the convolution of a scaled light and the
/// blockers.
fn soft_shadow() -> Vec<Statement> {
    let distance = BEFORE + AFTER;
    let mask = |y: f64| 0.5 + 0.5 * (TAU * 6.0 * y).cos() * (-y * y).exp();
    let points: Vec<f64> = (0..40).map(|i| 0.05 * f64::from(i) - 1.0).collect();
    let shadow = |x: f64, lit: &dyn Fn(f64, f64) -> f64| {
        integral(between([-LIGHT, LIGHT], 60), |u| {
            let v = (u - x) / distance;
            lit(u, v) * mask(x + AFTER * v)
        })
    };
    // Returns the convolution of the blockers with the light's image at x d₁/D. The image is a box
    // that is scaled by d₂/D.
    let convolved = |x: f64| {
        let size = AFTER / distance;
        let at = x * BEFORE / distance;
        integral(between([-LIGHT * size, LIGHT * size], 60), |y| mask(at + y)) / size
    };
    let off = |lit: &dyn Fn(f64, f64) -> f64| {
        let each = points.iter();
        let pairs: Vec<[f64; 2]> = each
            .map(|x| [shadow(*x, lit), convolved(*x) * lit(0.0, -x / distance)])
            .collect();
        let error: f64 = pairs.iter().map(|[a, b]| (a - b).powi(2)).sum();
        (error / pairs.iter().map(|[a, _]| a * a).sum::<f64>()).sqrt()
    };
    let g = |v: f64| (1.0 + v * v).powf(-1.5);
    vec![
        Statement {
            said: "soft shadows are a primal convolution in a special case (6.1)",
            measured: "difference between light ⊗ mask and the integral, over a uniform light, of \
                what a planar mask lets pass, without g"
                .to_owned(),
            number: off(&|_, _| 1.0),
            expected: [0.0, 1e-12],
            holds: "holds for a uniform diffuse light parallel to mask and receiver",
        },
        Statement {
            said: "the same, with the cosine factor g of the receiver",
            measured: "the same, with the convolution multiplied by g towards the light's centre"
                .to_owned(),
            number: off(&|_, v| g(v)),
            expected: [1e-4, 0.1],
            holds: "does not hold exactly: g varies over the light",
        },
        Statement {
            said: "the same, with a light that is not diffuse",
            measured: "the same, for a lobe 1 + 3v".to_owned(),
            number: off(&|_, v| 1.0 + 3.0 * v),
            expected: [1e-4, 10.0],
            holds: "does not hold: the spectrum of such light is not a line",
        },
    ]
}
