//! Faults of the affine maps to and from a scattering surface, judged by the rule for first-order
//! chains.

use super::scenes::{alone, changed};
use crate::predicted;
use crate::report::{Check, ReportSection, Row, word};
use crate::scenes::traced;
use etendue_compare::Verdict;
use etendue_predict::{Applicability, path, predict};
use etendue_theory::geometry::AffineMap;
use etendue_theory::path::{PathChain, ScatteringSurface, chain, defect};

/// Default number of photons.
const PHOTONS: u64 = 1 << 22;
const SCENE: &str = "textured_glossy";

type Change = fn(&mut PathChain);

fn faults() -> Vec<(&'static str, Change)> {
    vec![
        ("none", |_| ()),
        ("onto: curvature left out", |c| {
            let back = AffineMap::<4>::back(surface(c).curvature, surface(c).incidence);
            c.maps[0] = c.maps[0].then(&back);
        }),
        ("onto: 1/cos θ₀ beside x left out", |c| {
            let cos = surface(c).incidence.cos();
            row(&mut c.maps[0], 0, cos);
        }),
        ("onto: 1/cos θ₀ beside x counted twice", |c| {
            let cos = surface(c).incidence.cos();
            row(&mut c.maps[0], 0, 1.0 / cos);
        }),
        ("off: curvature left out", |c| {
            c.maps[1] = forth(c).then(&c.maps[1]);
        }),
        ("off: wrong sign of curvature", |c| {
            c.maps[1] = forth(c).then(&forth(c)).then(&c.maps[1]);
        }),
        ("off: cos θ₁ beside x left out", |c| {
            let cos = surface(c).outgoing[0].cos();
            row(&mut c.maps[1], 0, 1.0 / cos);
        }),
        ("off: wrong sign of y", |c| row(&mut c.maps[1], 1, -1.0)),
    ]
}

fn surface(chain: &PathChain) -> &ScatteringSurface {
    &chain.scatterers[0]
}

/// The map into local normals, for light that leaves the surface.
fn forth(chain: &PathChain) -> AffineMap<4> {
    AffineMap::<4>::curvature(surface(chain).curvature, surface(chain).outgoing[0])
}

fn row(map: &mut AffineMap<4>, row: usize, by: f64) {
    map.matrix[row] = map.matrix[row].map(|x| by * x);
    map.offset[row] *= by;
}

/// The section.
pub(super) fn chains(photons: Option<u64>) -> ReportSection {
    let photons = photons.unwrap_or(PHOTONS);
    let mut rows = Vec::new();
    for plane in ["texture", "outgoing"] {
        let scene = alone(changed(SCENE, Some(photons), &[]), plane);
        let measurement = traced(&scene);
        let place = &scene.planes[0];
        let sound = predict(&scene, place, &Applicability::new(&scene, place));
        let view = path(&scene, place).expect("a plane behind a BRDF");
        for (name, fault) in faults() {
            // At a plane on the surface, the maps after the surface have no effect.
            if plane == "texture" && name.starts_with("off") {
                continue;
            }
            let mut tampered = chain(&view).expect("a central ray");
            fault(&mut tampered);
            let [_, said] = predicted::scattered(&view, place, &tampered);
            let defect = defect(&view, &tampered).expect("a central ray");
            let of = (&scene, &measurement, 0);
            let report = predicted::judged_chain(of, &sound, said, defect);
            let check = match name {
                "none" => {
                    let accepted = report.verdict == Verdict::Pass;
                    Check::fact("accepted", accepted, "nothing is wrong")
                }
                _ => {
                    let rejected = report.verdict == Verdict::Fail;
                    Check::fact("rejected", rejected, "a fault is planted")
                }
            };
            let cells = vec![
                SCENE.to_owned(),
                plane.to_owned(),
                name.to_owned(),
                percent(report.excess),
                percent(report.excess_bound),
                percent(Some(report.chain.error)),
                format!("{:.1e}", report.chain.defect),
                word(report.verdict).to_owned(),
            ];
            rows.push(Row::new(cells, vec![check]));
        }
    }
    ReportSection::new(
        "Faults planted in the first-order chain of shading",
        format!(
            "The affine maps onto the glossy sphere and off it are each changed alone, at {:.0e} \
             photons. The chain is judged as in a run: it is rejected when a part of its error \
             above 10⁻⁵ remains as the neighbourhood of the central ray shrinks. *Excess* is the \
             disagreement with the photons beyond noise, and *bound* is the upper 95 % bound of \
             the excess. Required: the chain is rejected with every fault, and accepted without a \
             fault.",
            photons as f64
        ),
        "scene | plane | fault | excess | bound | error of the sound chain | error that remains | \
         verdict",
        rows,
    )
}

fn percent(x: Option<f64>) -> String {
    x.map_or("–".to_owned(), |x| format!("{:.2} %", 100.0 * x))
}
