//! Draws Figs. 3 and 13: coordinates of rays, and the error if one kind of coordinates is treated
//! as another.

use crate::rows::{compared, feet, letter_panels, lettered};
use crate::scene_run::resolved;
use crate::subject::{FigureData, Text};
use etendue_field::percent;
use etendue_figures::{
    AxisQuantity, Curve, CurveKind, CurvePanel, Figure, Plate, PlateRow, stacked,
};
use etendue_predict::{Applicability, Convergence, ConvergenceStep, converge};
use etendue_report::pictures::across;
use etendue_store::Failure;
use ndarray::Array2;

/// Draws Fig. 3: stripes at equal angles, shown over slopes and over angles, at the light and after
/// travel.
pub(crate) fn coordinates(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let names = ["two_plane", "travel", "plane_sphere"];
    let seen = taken.shots[0].each(&names)?;
    let spaces = taken.plate(&Plate {
        title: "Two parameterisations, and the effect of travel",
        note: "Five suns, 0.4 rad apart, behind a grating: the stripes are unequally spaced in slope, *u* = tan *θ*, and equally spaced in angle. Travel shears the stripes along *x*; angles are measured along T, which is opposite to X.",
        heads: lettered(&["slopes", "slopes, after 0.5 m", "angles, there"]),
        rows: compared(&seen, false),
        feet: feet(&seen),
        side: Some(88.0),
        ..Plate::default()
    })?;
    let panels = shrunk(&taken.also[0], &["angles"])?;
    let words = [
        "The error of using *u* in place of *θ*",
        "‖first order − exact‖/‖exact‖ of the spectrum in Fig. 8, for a window *e* times as wide: tan *θ* equals *θ* up to terms of second order.",
    ];
    let error = orders(taken, words, &panels, (2, 'd'))?;
    Ok(stacked(&[spaces, error]))
}

/// Draws Fig. 13: directions by longitude and latitude about three equators.
pub(crate) fn directions(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let [mirror, copper] = [&taken.shots[0], &taken.shots[1]];
    let seen = [
        mirror.each(&["curvature", "outgoing"])?,
        copper.each(&["reflection", "outgoing"])?,
    ]
    .concat();
    let others = seen.iter().map(|seen| {
        let half = seen.found.projection.mean.grid;
        across(&seen.found.measured, [half.half_x, half.half_u])
    });
    let others: Vec<Array2<f64>> = others.collect::<Option<_>>().unwrap_or_default();
    let mut rows = compared(&seen, false);
    rows[0].name = "along";
    let pictures = seen.iter().zip(&others);
    let pictures = pictures.map(|(seen, values)| seen.across(values.view()));
    let across = PlateRow {
        name: "across",
        pictures: pictures.collect(),
        ..rows[0].clone()
    };
    rows.insert(1, across);
    let mut feet = feet(&seen);
    for (lines, seen) in feet.iter_mut().zip(&seen) {
        if let Some(first_order) = &seen.found.report.first_order {
            let share = percent(first_order.chain.error, 1);
            lines.push(format!("flat: off by {share}"));
        }
    }
    let plate = taken.plate(&Plate {
        title: "Directions in 3D, by longitude and latitude",
        note: "Light of a projector on a saddle turned by 45°: a mirror, and rough copper seen 6.9° beside the plane of incidence. *Along*: the first position, and the longitude or first slope; *across*: the second position, and the latitude or second slope.",
        heads: lettered(&[
            "mirror\nnormals",
            "mirror\noutgoing",
            "copper\nnormals",
            "copper\noutgoing",
        ]),
        rows,
        feet,
        side: Some(76.0),
        ..Plate::default()
    })?;
    let panels = shrunk(
        &("twist", etendue_scenes::TABLE1_TWIST),
        &["curvature", "back", "outgoing"],
    )?;
    let words = [
        "The error of a flat (*θ*, *φ*)",
        "‖first order − exact‖/‖exact‖ at the mirror, for neighbourhoods *e* times as wide.",
    ];
    let error = orders(taken, words, &panels, (1, 'e'))?;
    Ok(stacked(&[plate, error]))
}

/// How the first-order errors of some planes of a scene decrease with the size of the
/// neighbourhood.
fn shrunk((name, text): &Text, planes: &[&str]) -> Result<Vec<Convergence>, Failure> {
    let scene = resolved(name, text, &[], |photons| photons)?;
    let wanted = scene
        .planes
        .iter()
        .filter(|plane| planes.contains(&plane.name.as_str()));
    let found =
        wanted.filter_map(|plane| converge(&scene, plane, &Applicability::new(&scene, plane)));
    Ok(found.collect())
}

/// Returns curves of first-order errors, and reference lines for an order of convergence. The
/// letters of the panels begin with `first`.
fn orders(
    taken: &FigureData<'_>,
    words: [&str; 2],
    planes: &[Convergence],
    (order, first): (i32, char),
) -> Result<Figure, Failure> {
    let panel = |plane: &Convergence| {
        let widest = plane.steps[0];
        let line = |step: &ConvergenceStep| {
            let share = step.share / widest.share;
            [step.share, widest.error * share.powi(order), 0.0]
        };
        let measured = |step: &ConvergenceStep| [step.share, step.error, 0.0];
        CurvePanel {
            title: etendue_report::table::spaced(&plane.plane),
            x: AxisQuantity::new("*e*", ""),
            curves: vec![
                Curve::new(
                    CurveKind::Rival,
                    &format!("order {order}"),
                    plane.steps.iter().map(line).collect(),
                ),
                Curve::new(
                    CurveKind::Measured,
                    "against rays through the real geometry",
                    plane.steps.iter().map(measured).collect(),
                ),
            ],
            is_log: [true; 2],
        }
    };
    let mut panels: Vec<CurvePanel> = planes.iter().map(panel).collect();
    letter_panels(first, &mut panels);
    taken.curves(words, AxisQuantity::new("error", ""), panels)
}
