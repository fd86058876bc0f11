//! Draws Table 1: for each operator, the light before the operator and the light after it.

use crate::rows::{fields, measured};
use crate::subject::FigureData;
use etendue_figures::{Figure, Plate, stacked};
use etendue_report::pictures::Seen;
use etendue_store::Failure;

/// An operator of Table 1. The first text is the name of the operator, a line break and the formula
/// of the operator. The other texts are the scene, the plane before the operator and the plane
/// after the operator.
type Step = (&'static str, [[&'static str; 2]; 2]);

/// Largest width of a picture, so that both parts fit a page.
const SIDE: f64 = 58.0;

/// The two parts of the paper's table.
const PARTS: [(&str, [Step; 5]); 2] = [
    (
        "Operators: maps and masks, then local shading",
        [
            (
                "travel\n*ℓ̂*(Ω_{x}, Ω_{u} + *d*Ω_{x})",
                [["travel", "near"], ["travel", "middle"]],
            ),
            (
                "visibility\n*ℓ̂* ⊗ *V̂*",
                [["fig1", "before_blockers"], ["fig1", "after_blockers"]],
            ),
            (
                "light incidence\n*ℓ̂*(−Ω_{x}/*c*, Ω_{θ})/*c*",
                [["incidence", "arrival"], ["incidence", "incidence"]],
            ),
            (
                "outgoing angle\n*c* *ℓ̂*(*c*Ω_{x}, Ω_{θ})",
                [["incidence", "reflection"], ["incidence", "outgoing"]],
            ),
            (
                "curvature\n*ℓ̂*(Ω_{x} − *k*Ω_{θ}, Ω_{θ})",
                [["fig10", "1_incidence"], ["fig10", "2_curvature"]],
            ),
        ],
    ),
    (
        "",
        [
            (
                "cosine\n*ℓ̂* ⊗ ĉos_{+}",
                [["fig10", "2_curvature"], ["fig10", "3_cosine"]],
            ),
            (
                "BRDF\n*dÊ* *ρ̂*",
                [["fig10", "4_mirror"], ["fig10", "5_reflection"]],
            ),
            (
                "texture\n*T̂* ⊗ *ℓ̂*",
                [["glossy", "reflection"], ["textured_glossy", "texture"]],
            ),
            (
                "separable BRDF\n(*dÊ* ⊗ *f̂*(−Ω_{θ})) *ρ̂*",
                [
                    ["fresnel_grazing", "cosine"],
                    ["fresnel_grazing", "reflection"],
                ],
            ),
            (
                "varying BRDF\n*dÊ* ⊗_{x} *ρ̂*",
                [["tiles", "mirrored"], ["tiles", "reflection"]],
            ),
        ],
    ),
];

const NOTE: &str = "Measured. Formulas are corrected, without phases; *c* = cos *θ*.";

/// Draws light fields and spectra before and after each operator.
pub(crate) fn operators(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let parts = PARTS.iter().enumerate().map(|(i, (title, steps))| {
        let sides = [0, 1].map(|side| {
            let seen = steps.iter().map(|(_, planes)| {
                let [scene, plane] = planes[side];
                let shot = taken.shots.iter().find(|shot| shot.scene.name == scene);
                let missing = || Failure::cannot_run(format!("no scene {scene}"));
                shot.ok_or_else(missing)?.at(plane)
            });
            seen.collect::<Result<Vec<Seen<'_>>, Failure>>()
        });
        let [before, after] = sides;
        let (before, after) = (before?, after?);
        taken.plate(&Plate {
            title,
            note: if i == 0 { NOTE } else { "" },
            heads: steps.iter().map(|(name, _)| (*name).to_owned()).collect(),
            rows: vec![
                fields("before", &before, false),
                fields("after", &after, false),
                measured("before", &before, false),
                measured("after", &after, false),
            ],
            side: Some(SIDE),
            ..Plate::default()
        })
    });
    Ok(stacked(&parts.collect::<Result<Vec<Figure>, _>>()?))
}
