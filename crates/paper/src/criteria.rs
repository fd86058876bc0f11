//! Compares the sampling criteria of Durand et al. 2005, section 6.2, with photons. The criteria
//! are evaluated as printed and with corrections.

use crate::quality::Quality;
use crate::rows::letter_panels;
use crate::scene_run::resolved;
use crate::subject::{FigureData, Text};
use etendue_compare::measured_bandwidth;
use etendue_figures::{AxisQuantity, Curve, CurveKind, CurvePanel, Figure};
use etendue_pipeline::measured;
use etendue_predict::{Applicability, criterion};
use etendue_store::Failure;
use etendue_store::Method;
use etendue_theory::shading::Criterion;

/// A field of a scene, and its values.
struct CriterionSweep {
    title: &'static str,
    quantity: AxisQuantity,
    field: &'static str,
    /// The values of the field at both ends of the curves. Measurements with photons are also made
    /// at these values.
    ends: [f64; 2],
    values: &'static [f64],
    /// Converts a value of the field to the quantity on the axis.
    shown: fn(f64) -> f64,
}

/// Number of points of a line.
const POINTS: u32 = 40;

/// Draws curves over curvature and over distance without a blocker, and over curvature behind an
/// edge.
pub(crate) fn criteria(taken: &FigureData<'_>, first: char) -> Result<Figure, Failure> {
    let curvature = |title, values| CriterionSweep {
        title,
        quantity: AxisQuantity::new("*k*", "1/m"),
        field: "surfaces.0.form.Sphere",
        ends: [-1.0, 1.0],
        values,
        shown: |k| k,
    };
    let distance = CriterionSweep {
        title: "Eq. 20 over distance",
        quantity: AxisQuantity::new("*d*", "m"),
        field: "planes.0.at.Distance",
        ends: [1.05, 2.0],
        values: &[1.1, 1.3, 1.6, 1.9],
        shown: |along| along - 1.0,
    };
    let [environment, edge] = [&taken.also[0], &taken.also[1]];
    let values = &[-1.0, -0.7, -0.3, 0.0, 0.4, 0.8];
    let behind = &[-0.7, -0.3, 0.0, 0.4, 0.8];
    let mut panels = [
        panel(
            taken,
            environment,
            &curvature("Eq. 20 over curvature", values),
        )?,
        panel(taken, environment, &distance)?,
        panel(taken, edge, &curvature("Eq. 21, edge at 0.4 m", behind))?,
    ];
    letter_panels(first, &mut panels);
    let words = [
        "Criteria and photons",
        "*B*: the frequency below which 95 % of the power lies, at a fixed point at distance *d*. Corrected: Ω_{ρ} |1 + 2*kd*/cos *θ*_{1}|, and behind an edge at *d'*: \
         Ω_{ρ} |1 + *d* (cos *θ*_{0}/*d'* + 2*k*)/cos *θ*_{1}|. Where the corrected value is smallest, the window determines the measured value.",
    ];
    let y = AxisQuantity::new("*B*", "cycles/slope");
    taken.curves(words, y, panels.to_vec())
}

fn panel(
    taken: &FigureData<'_>,
    text: &Text,
    sweep: &CriterionSweep,
) -> Result<CurvePanel, Failure> {
    let [from, to] = sweep.ends;
    let along = (0..=POINTS).map(|i| from + (to - from) * f64::from(i) / f64::from(POINTS));
    let lines = along.map(|value| {
        let criterion = at(text, sweep, value)?;
        let [corrected, printed] = said(&criterion);
        let x = (sweep.shown)(value);
        Ok([[x, corrected, 0.0], [x, printed, 0.0]])
    });
    let lines: Vec<[[f64; 3]; 2]> = lines.collect::<Result<_, Failure>>()?;
    let points = sweep
        .values
        .iter()
        .map(|value| counted(taken, text, sweep, *value));
    let line = |i: usize| lines.iter().map(|both| both[i]).collect();
    let points = points.collect::<Result<_, _>>()?;
    let curves = vec![
        Curve::new(CurveKind::Rival, "as printed", line(1)),
        Curve::new(CurveKind::Theory, "corrected", line(0)),
        Curve::new(CurveKind::Measured, "photons", points),
    ];
    Ok(CurvePanel::new(sweep.title, sweep.quantity.clone(), curves))
}

/// The bandwidth by the criterion in two versions: corrected, and as printed in the paper.
/// If the scene has an edge, the function returns the bandwidth behind the edge.
fn said(criterion: &Criterion) -> [f64; 2] {
    if criterion.blocker_distance.is_some() {
        [criterion.blocker(), criterion.printed_blocker()]
    } else {
        [criterion.environment(), criterion.printed_environment()]
    }
}

fn at((name, text): &Text, sweep: &CriterionSweep, value: f64) -> Result<Criterion, Failure> {
    let scene = resolved(name, text, &set(sweep, value), |photons| photons)?;
    let plane = &scene.planes[0];
    let found = criterion(&scene, plane, &Applicability::new(&scene, plane));
    found.ok_or_else(|| Failure::cannot_run(format!("{name} has no criterion")))
}

/// A measurement with photons: the value on the axis, the bandwidth and its standard error.
fn counted(
    taken: &FigureData<'_>,
    (name, text): &Text,
    sweep: &CriterionSweep,
    value: f64,
) -> Result<[f64; 3], Failure> {
    let quality: Quality = taken.quality;
    let scene = resolved(name, text, &set(sweep, value), |n| quality.photons(n))?;
    let batches = 0..scene.run.batches;
    let measurement = measured(&scene, Method::Photons, batches, taken.reporter)?;
    let found = measured_bandwidth(&measurement, 0).map_err(Failure::cannot_run)?;
    let dark = || Failure::cannot_run(format!("no light reaches the eye of {name}"));
    let found = found.ok_or_else(dark)?;
    Ok([(sweep.shown)(value), found.value, found.error])
}

fn set(sweep: &CriterionSweep, value: f64) -> [(String, String); 1] {
    [(sweep.field.to_owned(), format!("{value:?}"))]
}
