//! Statements about locality and discontinuities: narrow windows, a shifted central ray, tails of
//! spectra.

use super::number::{at, line, power};
use super::scene::{ClaimRun, SeenScene, number};
use super::{Claim, decreasing};
use crate::orders::slope;
use crate::report::Bound::{Above, AtMost, Below};
use crate::report::Check;

pub(super) fn claims(run: ClaimRun) -> Vec<Claim> {
    let mut all = vec![tails(run), moved(run), homogeneous(run)];
    all.extend(narrowed(run));
    all
}

/// Measures the exponents of the tails of spectra of shadows. The profiles of these shadows have a
/// discontinuous n-th derivative.
fn tails(run: ClaimRun) -> Claim {
    // The width is 1/√2, because the profile of a unit square along its diagonal is the convolution
    // of two boxes of width 1/√2.
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    let [square, bar] = ["(0.2, 0.2)", "(0.2, 0.002)"];
    // Each case has the size of the light, a plane, the half-width of the window, an azimuth, the
    // width of the boxes whose convolution is the shadow, and the number of frequencies.
    let cases = [
        (square, "After(\"blockers\")", 0.08, 0, 0.1, 4),
        (square, "After(\"blockers\")", 0.08, 1, 0.1 * diagonal, 4),
        (bar, "Before(\"floor\")", 0.25, 1, 0.2 * diagonal, 3),
    ];
    let numbers = cases.map(|(light, place, half, k, width, count)| {
        let rho = format!(
            "(max: {}, spacing: {})",
            f64::from(count) / width,
            0.0625 / width
        );
        // The windows contain the whole shadow. The second square is too small to cast one.
        let seen = [0.1, 1e-6].map(|side| {
            let fields = [
                ("light.size", light.to_owned()),
                ("planes.0.at", place.to_owned()),
                ("window.x", format!("Box({half})")),
                ("frequencies.rho", rho.clone()),
                ("blockers.0.shapes.0.size", format!("({side}, {side})")),
            ];
            run.seen("tails", &fields)
        });
        number(&[(&seen[0], 0), (&seen[1], 0)], &|slices| {
            // Half-way between its zeros, the factor |sin π w Ω| equals one.
            let points: Vec<[f64; 2]> = (0..count)
                .map(|m| {
                    let rho = (f64::from(m) + 0.5) / width;
                    let [with, without] = [0, 1].map(|i| at(&slices[i], k, [rho, 0.0]));
                    [rho.ln(), (without - with).norm().ln()]
                })
                .collect();
            -slope(&points)
        })
    });
    let off = numbers.iter().zip([1.0, 2.0, 3.0]);
    let off = off.map(|(n, e)| (n.value - e).abs()).fold(0.0, f64::max);
    Claim {
        said: "a discontinuity of the n-th derivative has a spectrum that falls off as 1/Ωⁿ⁺¹ (footnote 1)",
        shown: "exponent for the shadow of a square: directly behind the square (n = 0), the same \
            along its diagonal (n = 1), and along the diagonal 1 m behind it in the light of a \
            bar (n = 2)"
            .to_owned(),
        checks: vec![Check::new("off n + 1", off, Below(0.2)).because(
            "the spectrum is noisy at the highest frequency, and exponents are whole numbers",
        )],
        numbers: numbers.to_vec(),
        holds: "holds",
    }
}

/// Half-widths of narrowing windows, metres.
const HALVES: [f64; 4] = [0.8, 0.4, 0.2, 0.1];

/// Measures light behind a grating of 5 /m in narrowing windows.
fn through(modulation: f64, run: ClaimRun) -> [SeenScene; 4] {
    HALVES.map(|half| {
        let fields = [
            ("window.x", format!("Hann({half})")),
            ("blockers.0.modulation", modulation.to_string()),
        ];
        run.seen("narrow_window", &fields)
    })
}

fn narrowed(run: ClaimRun) -> [Claim; 2] {
    let mut valleys = through(1.0, run).map(|seen| {
        seen.number(0, |slices| {
            let around = |middle: f64| power(slices, |rho| (rho - middle).abs() < 0.6);
            around(2.5) / around(5.0)
        })
    });
    let widths = through(0.0, run).map(|seen| {
        seen.number(0, |slices| {
            let along = line(slices, 0);
            let half = along[0].1.norm_sqr() / 2.0;
            let after = along.iter().position(|(_, s)| s.norm_sqr() < half);
            let n = after.unwrap_or(along.len() - 1).max(1);
            let [a, b] = [along[n - 1].1.norm_sqr(), along[n].1.norm_sqr()];
            (n as f64 - 1.0 + (a - half) / (a - b)) * slices.grid.rho.spacing
        })
    });
    valleys.reverse();
    [
        Claim {
            said: "localisation is not possible in space and frequency at once (6)",
            shown: "power of the valley at 2.5 /m over the power of the replica of a grating at 5 \
                /m, in windows of ± 0.1, 0.2, 0.4 and 0.8 m"
                .to_owned(),
            checks: vec![
                decreasing(&valleys[1..]),
                Check::new("± 0.1 m", valleys[0].value, Above(1.0)).because("there is no valley"),
                Check::new("± 0.2 m", valleys[1].value, Above(1.0))
                    .because("there is no valley either"),
                Check::new("± 0.8 m", valleys[3].value, Below(0.01))
                    .because("the replica is resolved"),
            ],
            numbers: valleys.to_vec(),
            holds: "holds: the replica is resolved if the window holds four periods or more",
        },
        Claim {
            said: "low frequencies cannot be measured on small windows (6)",
            shown: "half-width [/m] of the peak at zero, at half of its power, for the light \
                without the grating, in windows of ± 0.8, 0.4, 0.2 and 0.1 m"
                .to_owned(),
            checks: vec![Check::fact(
                "growing",
                widths
                    .windows(2)
                    .all(|pair| pair[1].value > 1.8 * pair[0].value),
                "the width is 1/window, except for the light's own profile",
            )],
            numbers: widths.to_vec(),
            holds: "holds: a frequency below this cannot be distinguished from zero",
        },
    ]
}

/// Measures the fraction of the power between 15 and 25 /m behind an array that extends 2 m to
/// either side of its centre, which is `offset` from the central ray.
fn share(offset: f64, half: f64, run: ClaimRun) -> super::number::ClaimNumber {
    let fields = [
        ("blockers.0.center", format!("({offset}, 0, 1)")),
        ("window.x", format!("Hann({half})")),
    ];
    let seen = run.seen("edge_of_array", &fields);
    seen.number(0, |slices| {
        power(slices, |rho| rho > 15.0) / power(slices, |_| true)
    })
}

fn moved(run: ClaimRun) -> Claim {
    let offsets = [0.0, 1.9, 2.2, 2.6];
    let shares = offsets.map(|offset| share(offset, 0.5, run));
    Claim {
        said: "scenes are not stationary: what blocks the light varies in space (6)",
        shown: format!(
            "share of the power above 15 /m behind an array of 20 /m that ends at ± 2 m, for \
            central rays {offsets:?} m from its middle"
        ),
        checks: vec![
            decreasing(&shares),
            Check::new("beside it", shares[3].value / shares[0].value, Below(0.01))
                .because("the window does not reach the array"),
        ],
        numbers: shares.to_vec(),
        holds: "holds",
    }
}

fn homogeneous(run: ClaimRun) -> Claim {
    let halves = [1.2, 0.6, 0.3];
    let shares = halves.map(|half| share(2.4, half, run));
    Claim {
        said: "smaller neighbourhoods have more homogeneous properties (6)",
        shown: format!("the same, 0.4 m beside the array, in windows of ± {halves:?} m"),
        checks: vec![
            decreasing(&shares),
            Check::new("± 0.3 m", shares[2].value, AtMost(1e-4))
                .because("all light in the window passes beside the array"),
        ],
        numbers: shares.to_vec(),
        holds: "holds: in the narrowest window, all light passes beside the array",
    }
}
