//! Draws Table 1: for each operator, the light before the operator and the light after it.

use crate::rows::{DECIBEL, Seen, row};
use crate::subject::FigureData;
use etendue_figures::{Figure, Picture, Plate, PlateRow, Scale, stacked};
use etendue_report::pictures::{light_field_quantity, spectrum_quantity};
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
                Seen::at(shot.ok_or_else(missing)?, plane)
            });
            seen.collect::<Result<Vec<Seen<'_>>, Failure>>()
        });
        let [before, after] = sides;
        let (before, after) = (before?, after?);
        taken.plate(&Plate {
            title,
            note: if i == 0 { NOTE } else { "" },
            heads: steps.iter().map(|(name, _)| (*name).to_owned()).collect(),
            rows: rows(&before, &after),
            feet: Vec::new(),
            bars: None,
            side: Some(SIDE),
        })
    });
    Ok(stacked(&parts.collect::<Result<Vec<Figure>, _>>()?))
}

fn rows<'a>(before: &[Seen<'a>], after: &[Seen<'a>]) -> Vec<PlateRow<'a>> {
    let light = |seen: &[Seen<'a>]| seen.iter().map(Seen::light_field).collect();
    let power = |seen: &[Seen<'a>]| -> Vec<Picture<'a>> {
        let pictures = seen
            .iter()
            .map(|seen| seen.spectrum(seen.found.radial.power.view()));
        pictures.collect()
    };
    let (fields, spectra) = (light_field_quantity, spectrum_quantity);
    vec![
        row("before", fields(), Scale::Linear, false, light(before)),
        row("after", fields(), Scale::Linear, false, light(after)),
        row("before", spectra(), DECIBEL, false, power(before)),
        row("after", spectra(), DECIBEL, false, power(after)),
    ]
}
