//! Sweeps over every length and angle in the sampling criteria of section 6.2, and compares the
//! criteria with photons.

use super::glossy_bench::{ACROSS, BASE, BOX, GlossyBench, Lit, LobeOwner, WIDEST};
use crate::report::Bound::{Above, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::traced;
use etendue_compare::measured_bandwidth;
use etendue_figures::{AxisQuantity, Curve, CurveKind, CurvePanel, Curves};
use etendue_predict::{Applicability, exact_bandwidth};
use std::f64::consts::SQRT_2;

/// Default number of photons per point.
const PHOTONS: u64 = 1_000_000;
/// Maximum difference between the measured and the exact bandwidth, in standard errors.
const MOST: f64 = 3.3;
/// Permitted relative error of a criterion.
const ERROR: f64 = 0.05;
/// A sweep: its name, the swept quantity, and the bench for each value of this quantity.
struct GlossySweep {
    name: &'static str,
    quantity: AxisQuantity,
    bench: fn(f64) -> GlossyBench,
    values: &'static [f64],
}

/// Symbols and units of swept quantities.
const CURVATURE: [&str; 2] = ["*k*", "1/m"];
const VIEW: [&str; 2] = ["*θ*_{0} = −*θ*_{1}", "degrees"];
const ASIDE: [&str; 2] = ["*θ*_{0} + *θ*_{1}", "degrees"];
const DISTANCE: [&str; 2] = ["*d*", "m"];
const WIDTH: [&str; 2] = ["1/√*n*", "radians"];
const BLOCKER: [&str; 2] = ["*d*'", "m"];
const ROUGHNESS: [&str; 2] = ["*α*", ""];

fn sweeps() -> Vec<GlossySweep> {
    let sweep = |name, [symbol, unit]: [&str; 2], values, bench| GlossySweep {
        name,
        quantity: AxisQuantity::new(symbol, unit),
        bench,
        values,
    };
    let curvatures = &[-1.75, -1.4, -1.1, -0.88, -0.65, -0.35, 0.0, 0.5, 1.0];
    let lights = &[0.3, 0.45, 0.8, 1.6];
    vec![
        sweep("curvature", CURVATURE, curvatures, |k| BASE.curved(k)),
        sweep("view angle", VIEW, &[0.0, 20.0, 40.0, 60.0], |angle| {
            BASE.seen_at(angle)
        }),
        sweep(
            "beside the mirror direction",
            ASIDE,
            &[-6.0, -3.0, 3.0, 6.0],
            |angle| {
                let aside = angle.to_radians();
                let bench = BASE.with(LobeOwner::Phong(400.0));
                GlossyBench { aside, ..bench }
            },
        ),
        sweep("distance", DISTANCE, &[0.1, 0.25, 0.8, 1.5], |distance| {
            GlossyBench { distance, ..BASE }
        }),
        sweep("BRDF width", WIDTH, &[0.01, 0.03, 0.05, 0.1], |width| {
            BASE.with(LobeOwner::Phong(width.powi(-2)))
        }),
        sweep("light at d'", BLOCKER, lights, |distance| {
            BASE.lit(Lit::Point(distance))
        }),
        sweep("light at d', concave", BLOCKER, lights, |distance| {
            BASE.lit(Lit::Point(distance)).curved(-0.5)
        }),
        sweep(
            "curvature, light at 0.6 m",
            CURVATURE,
            &[-1.2, -0.6, 0.0, 0.6],
            |k| BASE.lit(Lit::Point(0.6)).curved(k),
        ),
        sweep(
            "view angle, light at 0.6 m",
            VIEW,
            &[0.0, 25.0, 45.0],
            |angle| BASE.lit(Lit::Point(0.6)).seen_at(angle),
        ),
        sweep("slit at d'", BLOCKER, &[0.4, 0.8], |distance| {
            let lobe = LobeOwner::Phong(400.0);
            BASE.lit(Lit::Slit(distance)).with(lobe)
        }),
        sweep("Beckmann", ROUGHNESS, &[0.03], |alpha| {
            BASE.with(LobeOwner::Beckmann(alpha))
        }),
        sweep("GGX", ROUGHNESS, &[0.03], |alpha| {
            BASE.with(LobeOwner::Ggx(alpha))
        }),
    ]
}

/// The section on the sweeps and the picture that plots them.
///
/// # Panics
/// Panics if a scene cannot be measured.
pub(crate) fn glossy(photons: Option<u64>) -> (ReportSection, Curves) {
    let photons = photons.unwrap_or(PHOTONS);
    let mut rows = Vec::new();
    let mut panels = Vec::new();
    let (mut worst, mut farthest) = (0.0_f64, 0.0_f64);
    let (mut count, mut told) = (0_i32, 0_i32);
    for sweep in sweeps() {
        let mut points = Vec::new();
        for &value in sweep.values {
            let bench = (sweep.bench)(value);
            let c = bench.criterion();
            let (windows, floor) = bench.windows(&c);
            count += 1;
            // Each point of a sweep has its own seed, so that the points are independent.
            let scene = bench.scene(&windows, photons, count.unsigned_abs().into());
            let plane = &scene.planes[0];
            let theory = Applicability::new(&scene, plane);
            let exact = exact_bandwidth(&scene, plane, &theory).expect("light comes");
            let measurement = traced(&scene);
            let found = measured_bandwidth(&measurement, 0).expect("enough batches");
            let found = found.expect("light comes");
            let off = (found.value - exact) / found.error;
            let [said, printed] = bench.says(&c);
            let noise = MOST * found.error;
            let [ours, theirs] = [said, printed].map(|b| range(b, floor));
            let holds =
                |[low, high]: [f64; 2], x: f64, slack: f64| low - slack < x && x < high + slack;
            // Whether no measurement with this noise can be compatible with both ranges.
            let apart = ours[1] + 2.0 * noise < theirs[0] || theirs[1] + 2.0 * noise < ours[0];
            let rejected = !holds(theirs, found.value, noise);
            told += i32::from(rejected);
            let within = |id, x: f64, slack: f64| {
                let bounds = [Above(ours[0] - slack), Below(ours[1] + slack)];
                bounds.map(|bound| {
                    Check::new(id, x, bound).because("within the error of the criterion")
                })
            };
            let mut checks = vec![Check::new("noise", off.abs(), Below(MOST)).because("errors")];
            checks.extend(within("exact one", exact, 0.0));
            checks.extend(within("measured one", found.value, noise));
            checks.extend(apart.then(|| {
                Check::fact(
                    "rejected",
                    rejected,
                    "the printed criterion \
                differs by more than the errors",
                )
            }));
            worst = worst.max(off.abs());
            if floor <= 0.0 {
                farthest = farthest.max((exact / said - 1.0).abs());
            }
            points.push([value, found.value, found.error]);
            let three = |x: f64| format!("{x:.3}");
            let cells = vec![
                sweep.name.to_owned(),
                value.to_string(),
                three(said),
                three(printed),
                three(exact),
                format!("{:.3} ± {:.3}", found.value, found.error),
                format!("{off:+.1} σ"),
                if floor > 0.0 {
                    "window".to_owned()
                } else {
                    format!("{:+.1} %", 100.0 * (exact / said - 1.0))
                },
                format!("{:+.0} %", 100.0 * (printed / found.value - 1.0)),
                format!("{:.2} to {:.2}", ours[0], ours[1]),
                if rejected { "rejected" } else { "" }.to_owned(),
            ];
            rows.push(Row::new(cells, checks));
        }
        if sweep.values.len() > 2 {
            panels.push(panel(&sweep, points));
        }
    }
    // The probability of the deviation is two-sided, for normally distributed errors.
    let one = libm::erfc(worst / SQRT_2);
    let all = 1.0 - (1.0 - one).powi(count);
    let section = ReportSection::new(
        "Sampling criteria against photons (section 6.2)",
        format!(
            "For each of {count} points, {photons} photons are traced, with the seeds 1 to \
             {count}. The bandwidth in slope is measured at a fixed point of a plane across the \
             ray to the eye: it is the frequency, in cycles per unit slope, below which 95 % of \
             the energy lies. A sphere with a glossy BRDF is lit by a beam (an environment with \
             content at all frequencies, Eq. 20), or by a point or through a slit at d' (Eq. 21; \
             an edge by itself has all frequencies). Unless a row states other values, k = 0.5/m, \
             θ₀ = −θ₁ = 0.5, d = 0.5 m, and Phong n = 2500; n = 400 beside the mirror direction \
             and behind the slit. *Said* is the corrected criterion, Ω_ρ |1 + 2kd/cos θ₁| or Ω_ρ \
             |1 + d (cos θ₀/d' + 2k)/cos θ₁|, where Ω_ρ is the 95 % cutoff of the lobe. *Exact* is \
             a quadrature through the real geometry, by the same estimator with the same windows. \
             *Measured* comes from the photons, with its jackknife error over 64 batches. The \
             bounds were fixed before the run. Required: the measured bandwidth is within {MOST} \
             errors of the exact one (the largest deviation of {count} is {worst:.2} errors; the \
             largest is this or more by chance with p = {all:.2}, Šidák). The exact bandwidth is \
             within the error of the corrected criterion, and the measured bandwidth is within \
             this error and {MOST} errors of its own. The printed criterion is rejected by the \
             same measure wherever it differs from the corrected one by more than these errors. It \
             is rejected at {told} of {count} points. The corrected criterion is off by {:.1} % at \
             most where the window holds the lobe. Its error is taken as {:.0} %, for four \
             reasons. It is of first order in the neighbourhood, which the lobe extends to ±0.05 \
             and more in angle, and which extends to ±{ACROSS} m in x. A sum over frequencies \
             reaches half a step, 0.6 %, beyond the last. The slit has a thirtieth of the lobe's \
             variance. The beam is wide, but a Gaussian. Where a concave mirror undoes travel, for \
             example, the lobe is seen wider in slope than the window may be (±{WIDEST}). There \
             the window widens the spectrum, and the measured bandwidth may be greater by up to \
             the window's own bandwidth of {:.2}, added in squares. These rows say `window`.",
            100.0 * farthest,
            100.0 * ERROR,
            BOX / WIDEST,
        ),
        "sweep | value | said | printed | exact | measured | measured − exact | exact/said | \
         printed/measured | said, with its error | printed is | verdict",
        rows,
    );
    let picture = Curves {
        title: "How fast a glossy reflection changes with angle".to_owned(),
        note: format!("Durand et al. 2005, section 6.2; {photons} photons for each point"),
        y: AxisQuantity::new("*B*", "cycles/slope"),
        panels,
    };
    (section, picture)
}

/// The range of measured bandwidths that agree with the `bandwidth` of a criterion; the
/// window may widen the spectrum by at most `floor`.
fn range(bandwidth: f64, floor: f64) -> [f64; 2] {
    let error = ERROR * bandwidth;
    [bandwidth - error, bandwidth.hypot(floor) + error]
}

/// The measured points, and the curves that the criteria predict.
fn panel(sweep: &GlossySweep, points: Vec<[f64; 3]>) -> CurvePanel {
    const COUNT: u32 = 80;
    // Four digits are sufficient for the points of a curve.
    let digits = |x: f64| (x * 1e4).round() / 1e4;
    let first = points.first().map_or(0.0, |p| p[0]);
    let last = points.last().map_or(1.0, |p| p[0]);
    let says: Vec<[f64; 3]> = (0..=COUNT)
        .map(|i| {
            let x = first + f64::from(i) / f64::from(COUNT) * (last - first);
            let bench = (sweep.bench)(x);
            let [said, printed] = bench.says(&bench.criterion());
            [x, said, printed].map(digits)
        })
        .collect();
    let line = |kind, name: &str, i: usize| Curve {
        kind,
        name: name.to_owned(),
        points: says.iter().map(|p| [p[0], p[i], 0.0]).collect(),
    };
    CurvePanel {
        title: sweep.name.to_owned(),
        x: sweep.quantity.clone(),
        is_log: [false; 2],
        curves: vec![
            line(CurveKind::Rival, "as printed", 2),
            line(CurveKind::Theory, "corrected", 1),
            Curve {
                kind: CurveKind::Measured,
                name: "measured with photons".to_owned(),
                points,
            },
        ],
    }
}
