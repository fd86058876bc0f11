//! Comparison of photons with theory at every plane of the scenes for Table 1.

use super::TableRun;
use super::path::{MirrorPath, PathStage};
use super::planar::StageFound;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row, number, plane_cells};
use crate::rows::Line;
use etendue_compare::Verdict;
use etendue_field::{Orientation, Specular};
use etendue_theory::geometry::Media;
use etendue_theory::path::PathSurface;
use etendue_theory::{Model, Observed, Parameter};

/// The section on Table 1 in 4D.
pub(super) fn operators(outcomes: &[&TableRun], planes: usize, level: f64) -> ReportSection {
    let mut rows = Vec::new();
    for outcome in outcomes {
        let planes = 0..outcome.planes.len();
        rows.extend(planes.map(|index| row(outcome, index, level)));
    }
    ReportSection::new(
        format!(
            "Operators in 4D: {} scenes, {} planes",
            outcomes.len(),
            rows.len()
        ),
        format!(
            "Photons are compared with the exact prediction in ray space and with the first-order \
             chain of affine maps. *Error* is the error of the chain, computed from the exact \
             prediction. *Excess* is the disagreement of the chain with the photons beyond noise, \
             and *bound* is the upper 95 % bound of the excess. *Resolvable* is the smallest \
             excess that can be detected above the noise. The columns *2D* repeat the table above \
             for the section in the plane of incidence, for one surface whose principal axes lie \
             in this plane. Required of every plane: light arrives. *p exact* is at least \
             {level:.6}, unless the stated error of the prediction may explain the whole \
             difference; this level is α = 0.01 over all {planes} planes (scenes with the same \
             light are lit by the same photons, so that their p-values are alike, and the level is \
             on the safe side). The bound is at most 1.1 errors or 1 %. *p first order* is below \
             {level:.6} wherever the error is above twice the resolvable excess."
        ),
        "scene | plane | operator | 2D map | 2D order | in window | noise | p exact | error | \
         excess | bound | resolvable | p first order | verdict",
        rows,
    )
}

fn row(outcome: &TableRun, index: usize, level: f64) -> Row {
    let report = &outcome.planes[index].report;
    let view = outcome.system(index);
    let first = report.first_order.as_ref();
    let error = first.map_or(f64::NAN, |f| f.chain.error);
    let resolvable = first.and_then(|f| f.resolvable);
    let p_first = first.and_then(|f| f.p_value);
    let agrees = first.is_some_and(|f| f.verdict == Verdict::Pass);
    let mut checks = vec![
        Check::light(report),
        Check::exact(report, level),
        Check::fact("excess", agrees, "by the rule for first-order chains"),
    ];
    if resolvable.is_some_and(|r| error > 2.0 * r) {
        let p = p_first.unwrap_or(1.0);
        let reason = "the error is twice what noise can hide";
        checks.push(Check::new("told apart", p, Below(level)).because(reason));
    }
    let planar = section(&view).map(|(path, stage)| path.found(stage));
    checks.extend(planar.iter().flat_map(StageFound::checks));
    let (word, line) = operator(&view);
    let mut cells = vec![
        outcome.scene.name.clone(),
        report.name.clone(),
        word.to_owned(),
        planar.map_or("–".to_owned(), |c| format!("{:.0e}", c.map)),
        planar.map_or("–".to_owned(), |c| format!("{:.2}", c.order)),
    ];
    cells.extend(plane_cells(report));
    cells.push(number(p_first));
    Row::new(cells, checks).of(line)
}

/// The name of the last step before a plane, and the row of the paper's Table 1 that
/// describes this step.
fn operator(view: &Observed) -> (&'static str, Option<Line>) {
    let Observed { system, plane } = view;
    let last = system.before_plane().last();
    if plane.is_arriving() {
        return match plane.orientation {
            Orientation::LocalNormals => ("curvature", Some(Line::Curvature)),
            Orientation::Mirrored => ("mirror", Some(Line::Mirror)),
            _ => ("incidence", Some(Line::Incidence)),
        };
    }
    let Some(element) = last else {
        return ("travel", Some(Line::Travel));
    };
    let refracts = matches!(element.event(), Some(Specular::Refraction { .. }));
    match plane.orientation {
        Orientation::LocalNormals if refracts => ("refraction", None),
        Orientation::LocalNormals | Orientation::Mirrored => ("mirror", Some(Line::Mirror)),
        Orientation::Tangent => ("back", Some(Line::Curvature)),
        Orientation::Orthogonal => {
            let far = (plane.frame.origin - element.patch.frame.origin).length();
            match element.event() {
                _ if far > 1e-6 => ("travel", Some(Line::Travel)),
                Some(Specular::ThinLens { .. }) => ("lens", None),
                _ => ("outgoing", Some(Line::Outgoing)),
            }
        }
    }
}

/// The 2D section, in the plane of incidence, of a scene with one surface; a principal
/// axis of this surface must lie in that plane.
fn section(view: &Observed) -> Option<(MirrorPath, PathStage)> {
    let Observed { system, plane } = view;
    let value = |p: Parameter| view.value(p);
    let arriving = plane.is_arriving() || system.visited == 0;
    let before = value(Parameter::Travel(0))?;
    if arriving && plane.orientation == Orientation::Orthogonal {
        let path = MirrorPath {
            travels: [before, 0.0],
            theta0: 0.0,
            k: 0.0,
            media: None,
        };
        return Some((path, PathStage::Travel));
    }
    if arriving != (system.visited == 0) || system.visited > 1 {
        return None;
    }
    let patch = match system.before_plane().first() {
        Some(element) => Some(element.patch),
        None => plane.patch,
    };
    let [k1, k2, _] = patch.map_or([0.0; 3], |patch| patch.curvature);
    // If both principal curvatures are equal, the direction of the principal axes does not
    // matter.
    let across = patch.is_some_and(|p| p.frame.x.y.abs() > 1e-9);
    if across && (k1 - k2).abs() > 1e-12 {
        return None;
    }
    let media = match system.before_plane().first().and_then(PathSurface::event) {
        Some(Specular::ThinLens { .. }) => return None,
        Some(Specular::Refraction { front, back }) => Some(Media {
            before: front,
            after: back,
        }),
        _ => None,
    };
    let theta0 = if arriving {
        plane.longitude
    } else {
        value(Parameter::Incidence(0))?
    };
    let after = value(Parameter::Travel(1)).unwrap_or(0.0);
    let path = MirrorPath {
        travels: [before, after],
        theta0,
        k: k1,
        media,
    };
    let stage = match plane.orientation {
        Orientation::Tangent if arriving => PathStage::Incidence,
        Orientation::LocalNormals if arriving => PathStage::Curvature,
        Orientation::LocalNormals => PathStage::Event,
        Orientation::Mirrored => return None,
        Orientation::Tangent => PathStage::Back,
        Orientation::Orthogonal if after.abs() < 1e-9 => PathStage::Outgoing,
        Orientation::Orthogonal => PathStage::Beyond,
    };
    Some((path, stage))
}
