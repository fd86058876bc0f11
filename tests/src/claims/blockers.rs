//! Statements about blockers: finite arrays, replicas, jitter, averages, combinations, soft shadows.

use super::number::{ClaimNumber, at, line, power};
use super::scene::{ClaimRun, number};
use super::{CHANCE, Claim, PULL, decreasing};
use crate::orders::slope;
use crate::report::Bound::{AtLeast, AtMost, Below};
use crate::report::Check;
use crate::shading::strips::{Strips, coefficients, in_common, strips};
use etendue_field::{Complex, Slices};
use std::f64::consts::PI;

pub(super) fn claims(run: ClaimRun) -> Vec<Claim> {
    vec![
        finite(run),
        replicas(run),
        jitter(run),
        average(run),
        before_average(run),
        combined(run),
        soft_shadows(run),
    ]
}

/// The fields of an array of squares.
fn array(count: u32, pitch: f64) -> [(&'static str, String); 2] {
    [
        ("blockers.0.count", format!("({count}, {count})")),
        ("blockers.0.pitch", pitch.to_string()),
    ]
}

fn finite(run: ClaimRun) -> Claim {
    let pitch = 0.2;
    let counts = [4, 8, 16];
    let widths = counts.map(|count| {
        let count = format!("({count}, 60)");
        let seen = run.seen("finite_array", &[("blockers.0.count", count)]);
        seen.number(0, |slices| {
            let replica = |rho: f64| (rho - 5.0).abs() < 2.5;
            let along = line(slices, 0).into_iter();
            let inside = along.filter(|(rho, _)| replica(*rho));
            let highest = inside.map(|(_, s)| s.norm_sqr()).fold(0.0, f64::max);
            power(slices, replica) * slices.grid.rho.spacing / highest
        })
    });
    let of_comb = |i: usize| widths[i].value * f64::from(counts[i]) * pitch;
    Claim {
        said: "a finite number of blockers blurs the comb of their spectrum (3.4)",
        shown: format!(
            "equivalent width [1/m] of the replica at 5 /m, behind {counts:?} columns of squares \
            that are 0.2 m apart"
        ),
        numbers: widths.to_vec(),
        checks: vec![
            decreasing(&widths),
            Check::new("4 columns: width × N p", of_comb(0), AtLeast(0.95))
                .because("∫|D_N|²/N² = 1/(N p), tilted by the transform of the squares"),
            Check::new("the same", of_comb(0), AtMost(1.1))
                .because("the window of 6 m widens the replica"),
        ],
        holds: "holds: with N columns of pitch p, the width is 1/(N p), unless the window is \
            narrower than the array",
    }
}

fn replicas(run: ClaimRun) -> Claim {
    let pitches = [0.4, 0.2, 0.1];
    let places = [(0.4, 20), (0.2, 40), (0.1, 80)].map(|(pitch, count)| {
        let seen = run.seen("replicas", &array(count, pitch));
        // The number is the pitch times the frequency of the spectral peak. The peak is located at
        // the vertex of a parabola through the highest values.
        seen.number(0, |slices| {
            let along = line(slices, 0);
            let step = slices.grid.rho.spacing;
            let around = |rho: f64| (rho * pitch - 1.0).abs() < 0.3;
            let inside = (0..along.len()).filter(|m| around(along[*m].0));
            let size = |m: usize| along[m].1.norm_sqr();
            let top = inside.fold(0, |top, m| {
                if size(m) > size(top) || top == 0 {
                    m
                } else {
                    top
                }
            });
            let [a, b, c] = [size(top - 1), size(top), size(top + 1)];
            (along[top].0 + 0.5 * step * (a - c) / (a - 2.0 * b + c)) * pitch
        })
    });
    let off = places.iter().map(|p| (p.value - 1.0).abs());
    Claim {
        said: "replicas are farther away for a smaller pattern (3.4)",
        shown: format!(
            "frequency of the first replica times the pitch, for squares {pitches:?} m apart"
        ),
        numbers: places.to_vec(),
        checks: vec![
            Check::new("off 1", off.fold(0.0, f64::max), Below(2e-3))
                .because("the window's spectrum has a slope over the replica"),
        ],
        holds: "holds: the first replica is at 1/pitch",
    }
}

fn jitter(run: ClaimRun) -> Claim {
    let share = |[jitter, seed]: [f64; 2]| {
        let fields = [
            ("blockers.0.jitter", jitter.to_string()),
            ("blockers.0.seed", seed.to_string()),
        ];
        run.seen("jitter", &fields).number(0, |slices| {
            let band = |rho: f64| (7.5..17.5).contains(&rho);
            let off = |rho: f64| (rho / 5.0 - (rho / 5.0).round()).abs();
            power(slices, |rho| band(rho) && off(rho) < 0.14) / power(slices, band)
        })
    };
    let shares = [[0.0, 1.0], [0.3, 1.0], [0.3, 2.0], [0.3, 3.0]].map(share);
    let most = shares[1..].iter().map(|s| s.value).fold(0.0, f64::max);
    Claim {
        said: "jittered blockers give a smoother spectrum (3.4)",
        shown: "share of the power from 7.5 to 17.5 /m that is within 0.7 /m of the replicas at \
            10 and 15 /m: first without jitter, then for three arrays with a jitter of 0.3 \
            pitches"
            .to_owned(),
        checks: vec![
            Check::new("jitter 0", shares[0].value, AtLeast(0.95))
                .because("a comb has no power between its lines"),
            Check::new("jitter 0.3", most, AtMost(0.8))
                .because("between the lines the power is N (1 − sinc²(jΩ))"),
        ],
        numbers: shares.to_vec(),
        holds: "holds",
    }
}

/// Pitches of arrays of squares with fill one half, and the number of squares along each axis. At
/// these pitches the light's image covers an odd number of half periods, and ripples are largest.
const PITCHES: [(f64, u32); 3] = [(0.2, 14), (0.2 / 3.0, 38), (0.04, 62)];

fn ripples(name: &str, run: ClaimRun) -> [ClaimNumber; 3] {
    let average =
        "Grating(name: \"blockers\", center: (0, 0, 1), axis: X, frequency: 1, modulation: 0)";
    let average = run.seen(name, &[("blockers.0", average.to_owned())]);
    PITCHES.map(|(pitch, count)| {
        let squares = run.seen(name, &array(count, pitch));
        number(&[(&squares, 0), (&average, 0)], &|slices| {
            let pairs = slices[0].half.iter().zip(&slices[1].half);
            let apart: f64 = pairs.map(|(a, b)| (a - b).norm_sqr()).sum();
            let all: f64 = slices[1].half.iter().map(|s| s.norm_sqr()).sum();
            apart / all
        })
    })
}

fn exponent(numbers: &[ClaimNumber; 3]) -> f64 {
    let pairs = PITCHES.iter().zip(numbers);
    let logs: Vec<[f64; 2]> = pairs
        .map(|((pitch, _), n)| [pitch.ln(), n.value.ln()])
        .collect();
    slope(&logs)
}

fn average(run: ClaimRun) -> Claim {
    let numbers = ripples("average", run);
    let exponent = exponent(&numbers);
    Claim {
        said: "small occluders act as their average on soft shadows (3.4)",
        shown: format!(
            "energy of a difference: the light that leaves a diffuse floor behind squares 0.2, \
            0.067 and 0.04 m apart minus the light behind their average, relative to the latter; \
            it falls with the pitch to the power {exponent:.2}"
        ),
        numbers: numbers.to_vec(),
        checks: vec![
            Check::new("exponent", exponent, AtLeast(1.7))
                .because("the amplitude falls with the pitch, so the power falls with exponent 2"),
            Check::new("the same", exponent, AtMost(2.6))
                .because("the exponent is 2, but windows hold few periods"),
        ],
        holds: "holds: the difference in amplitude is of first order in the pitch",
    }
}

fn before_average(run: ClaimRun) -> Claim {
    let numbers = ripples("average_arriving", run);
    Claim {
        said: "the same, for the light that arrives at the floor",
        shown: "the same before the floor: replicas move to angular frequencies and do not vanish"
            .to_owned(),
        numbers: numbers.to_vec(),
        checks: vec![
            Check::new(
                "smallest",
                numbers
                    .iter()
                    .map(|n| n.value)
                    .fold(f64::INFINITY, f64::min),
                AtLeast(0.1),
            )
            .because("only the first replicas, at 1/pitch in ρ, are left"),
        ],
        holds: "does not hold before diffuse reflection: the integration over angle causes the \
            average",
    }
}

/// The strips of one mask of a pair, centred on the central ray, in metres.
fn centred(pair: u32, offset: f64) -> Strips {
    let mut open = strips(pair, offset);
    open.iter_mut().flatten().for_each(|edge| *edge -= 0.5);
    open
}

/// The complement of the open strips, as opaque rectangles from −1 m to 1 m.
fn opaque(open: &Strips) -> String {
    let mut edges = vec![-1.0];
    edges.extend(open.iter().flatten());
    edges.push(1.0);
    let each = edges.chunks(2).map(|e| {
        let (center, size) = (0.5 * (e[0] + e[1]), e[1] - e[0]);
        format!("Rectangle(center: ({center}, 0), size: ({size}, 8)),")
    });
    format!("[{}]", each.collect::<String>())
}

/// Two maximum frequencies, per metre. Up to the first frequency, bounds are compared with spectra.
/// Up to the second frequency, the sum in a bound is computed.
const HELD: usize = 12;
const SUMMED: usize = 40;

/// The 90 % bandwidth of |S(ρ, 0)| behind both masks, the 90 % bandwidth of the bound
/// Σ|V̂(m)||S₁(ρ − m, 0)|, and the largest ratio of the spectrum to the bound. S₁ is the spectrum
/// behind one mask alone.
fn bounded(slices: &[Slices], other: &[Complex]) -> [f64; 3] {
    let [one, both] = [0, 1].map(|i| line(&slices[i], 0));
    let size = |n: usize| one.get(n).map_or(0.0, |(_, s)| s.norm());
    let bound = |n: usize| -> f64 {
        let terms = other.iter().enumerate();
        terms
            .map(|(i, v)| v.norm() * size((n + SUMMED).abs_diff(i)))
            .sum()
    };
    let bound: Vec<f64> = (0..=HELD).map(bound).collect();
    let real: Vec<f64> = both[..=HELD].iter().map(|(_, s)| s.norm()).collect();
    let bandwidth = |sizes: &[f64]| {
        let energy = |n: usize| sizes[n] * sizes[n] * if n == 0 { 1.0 } else { 2.0 };
        let total: f64 = (0..=HELD).map(energy).sum();
        let mut inside = 0.0;
        for n in 0..=HELD {
            let next = inside + energy(n);
            if next >= 0.9 * total {
                return n as f64 + (0.9 * total - inside) / energy(n);
            }
            inside = next;
        }
        HELD as f64
    };
    let ratio = real.iter().zip(&bound).map(|(r, b)| r / b);
    [
        bandwidth(&real),
        bandwidth(&bound),
        ratio.fold(0.0, f64::max),
    ]
}

fn combined(run: ClaimRun) -> Claim {
    let (mut excess, mut ratios, mut under) = (Vec::new(), Vec::new(), 0);
    for pair in [0, 1, 2, 4, 5, 6, 7, 8] {
        let (first, second) = (centred(pair, 0.137), centred(pair, 0.414));
        let both = in_common(&first, &second);
        if both.is_empty() {
            continue;
        }
        let [one, two] = [&first, &both]
            .map(|open| run.seen("combined", &[("blockers.0.shapes", opaque(open))]));
        let other = coefficients(&second, SUMMED);
        let pair = [(&one, 0), (&two, 0)];
        let over = number(&pair, &|slices| {
            let [real, bound, _] = bounded(slices, &other);
            bound / real
        });
        under += usize::from(over.value < 1.0);
        excess.push(over);
        ratios.push(number(&pair, &|slices| bounded(slices, &other)[2]));
    }
    let ratio = ratios.iter().map(|r| r.value).fold(0.0, f64::max);
    Claim {
        said: "without phase, bandwidths of combined blockers are over-estimated and never \
            under-estimated (3.4)",
        shown: format!(
            "90 % bandwidth of the bound |Ŝ₁| ⊗ |V̂₂| over the 90 % bandwidth of Ŝ₁₂, for {} \
            pairs of three random slits in one plane, with measured Ŝ; the largest ratio of |Ŝ₁₂| \
            to the bound is {ratio:.3}",
            excess.len()
        ),
        checks: vec![
            Check::none("pairs under-estimated", under),
            Check::new("largest ratio", ratio, AtMost(1.0))
                .because("the magnitude of a sum is at most the sum of magnitudes"),
        ],
        numbers: excess,
        holds: "holds for all pairs",
    }
}

fn soft_shadows(run: ClaimRun) -> Claim {
    let (light, frequency) = (0.2, 6.0);
    let mut off = 0.0_f64;
    let numbers = [0.2, 0.5, 1.0, 2.0].map(|after| {
        let floor = 1.0 + after;
        // The frequency of the grating's image on the floor.
        let rho = frequency / floor;
        let seen = |phase: f64| {
            let fields = [
                ("blockers.0.phase", phase.to_string()),
                ("surfaces.0.center", format!("(0, 0, {floor})")),
                (
                    "frequencies.rho",
                    format!("(max: {rho}, spacing: {})", rho / 5.0),
                ),
            ];
            run.seen("soft_shadow", &fields)
        };
        let [plus, minus] = [0.0, PI].map(seen);
        // The two gratings are shifted against each other by half a period. The shadow is the light
        // behind the first grating minus the light behind the second grating. The light without a
        // shadow is the sum of both.
        let contrast = number(&[(&plus, 0), (&minus, 0)], &|slices| {
            let [a, b] = [0, 1].map(|i| at(&slices[i], 0, [rho, 0.0]));
            let all = slices[0].at_zero() + slices[1].at_zero();
            2.0 * (a - b).re / all
        });
        let blur = PI * light * frequency * after / floor;
        off = off.max((contrast.value - blur.sin() / blur).abs() / contrast.error);
        contrast
    });
    Claim {
        said: "soft shadows are a convolution of light and blockers over space, and they are \
            softer farther behind the blockers (6.1)",
        shown: "contrast of the shadow of a grating (6 /m, 1 m from the light) on floors 0.2, \
            0.5, 1, 2 m behind it; a convolution with a box of width w d₂/D gives sinc(w f d₂/D)"
            .to_owned(),
        numbers: numbers.to_vec(),
        checks: vec![
            decreasing(&numbers),
            Check::new("off the convolution, in errors", off, AtMost(PULL)).because(CHANCE),
        ],
        holds: "holds for a diffuse light and planar blockers parallel to the floor",
    }
}
