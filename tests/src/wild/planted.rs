//! Faults planted in predictions of light that two glossy surfaces reflect.

use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{named, traced};
use etendue_compare::{Prediction, compare};
use etendue_field::{Frame, ProjectionGrid};
use etendue_predict::{Applicability, predict, test_of};
use etendue_scene::Scene;
use etendue_spectrum::Measurement;
use etendue_theory::path::{Interaction, PathSystem};
use etendue_theory::{Model, Observed, RayBudget};
use glam::DQuat;

/// Enough photons to detect the subtlest fault.
const PHOTONS: u64 = 1 << 26;
/// The error of the prediction is a fifth of the photons' noise.
const BUDGET: RayBudget = RayBudget::new(2e7, 1e-3);
/// A fault counts as detected if p is below this value.
const SEEN: f64 = 0.01;
/// The name of the scene.
const SCENE: &str = "two_glossy";
const PLANE: &str = "beyond";

type PlantedFault = (&'static str, fn(&mut PathSystem));

/// The planted faults, each with a description.
const FAULTS: [PlantedFault; 6] = [
    ("square left out", |system| system.masks.clear()),
    ("first lobe 1 % wider", |system| {
        change_lobe(system, 0, 1.01);
    }),
    ("second lobe 1 % wider", |system| {
        // The width of a Phong lobe is proportional to the inverse square root of the lobe's
        // exponent.
        change_lobe(system, 1, 1.01_f64.powi(-2));
    }),
    ("curvature of the first left out", |system| {
        system.surfaces[0].patch.curvature = [0.0; 3];
    }),
    ("second surface tilted by 0.3°", |system| {
        tilt(system, 0.3_f64.to_radians());
    }),
    ("albedo of both 1 % larger", |system| {
        for surface in &mut system.surfaces {
            if let Interaction::Reflects(reflectance) = &mut surface.interaction {
                reflectance.first_mut().albedo *= 1.01;
            }
        }
    }),
];

fn change_lobe(system: &mut PathSystem, surface: usize, factor: f64) {
    if let Interaction::Reflects(reflectance) = &mut system.surfaces[surface].interaction
        && let Some((_, number)) = reflectance.first_mut().lobe.number_mut()
    {
        *number *= factor;
    }
}

fn tilt(system: &mut PathSystem, angle: f64) {
    let frame = &mut system.surfaces[1].patch.frame;
    let turn = DQuat::from_axis_angle(frame.y, angle);
    *frame = Frame {
        x: turn * frame.x,
        d: turn * frame.d,
        ..*frame
    };
}

/// The section.
pub(super) fn planted() -> ReportSection {
    let scene = named(SCENE, Some(PHOTONS), None);
    let number = scene.planes.iter().position(|plane| plane.name == PLANE);
    let scene = scene.seen_at(&[number.unwrap_or_default()]);
    let measured = traced(&scene);
    let theory = Applicability::new(&scene, &scene.planes[0]);
    let Some(view) = theory.theory.path() else {
        unreachable!("{SCENE} has two surfaces that scatter");
    };
    let like = predict(&scene, &scene.planes[0], &theory);
    let p_value = |view: &Observed| p_value(&scene, &measured, view, &like);
    let sound = p_value(view);
    let mut rows = vec![Row::new(
        vec!["none".to_owned(), format!("{sound:.5}")],
        vec![Check::p("p", Some(sound), SEEN)],
    )];
    rows.extend(FAULTS.iter().map(|(name, change)| {
        let mut view = view.clone();
        change(&mut view.system);
        let p = p_value(&view);
        let cells = vec![(*name).to_owned(), format!("{p:.5}")];
        Row::new(
            cells,
            vec![Check::new("p", p, Below(SEEN)).because("the fault is planted")],
        )
    }));
    ReportSection::new(
        "Faults planted behind two glossy surfaces",
        format!(
            "Each fault is planted alone in the prediction of plane `{PLANE}` of `{SCENE}`, which \
             is compared with {PHOTONS} photons. Required: p < {SEEN} for every fault, and p is \
             not below this without a fault. The smallest possible p is 0.00005."
        ),
        "fault | p | verdict",
        rows,
    )
}

/// The p-value for the slices predicted for `view`. All other fields of the prediction are
/// taken from `like`.
fn p_value(scene: &Scene, measured: &Measurement, view: &Observed, like: &Prediction) -> f64 {
    let plane = &scene.planes[0];
    let picture = ProjectionGrid::new(&plane.window, 1);
    let found = view.predict(&[], (&plane.window, &plane.grid, &picture), BUDGET);
    let prediction = Prediction {
        slices: found.slices,
        replicates: found.replicates,
        quadrature_error: found.error,
        first_order: None,
        ..like.clone()
    };
    let compared = compare(measured, 0, &prediction, &test_of(scene));
    compared.map_or(1.0, |found| found.report.p_value.unwrap_or(1.0))
}
