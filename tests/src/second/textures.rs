//! Patterns, pictures and blends, compared with the second implementation.

use super::check::{SecondCheck, worse};
use super::lobes;
use super::pattern::{Levels, Pattern, Varied};
use super::vector::scale;
use crate::hostile::dice::Dice;
use etendue_field::{self as field, Brdf, Grating, Mixture, Raster, Reflectance};
use std::f64::consts::TAU;
use std::sync::Arc;

const COSINE: &[&str] = &["axes swapped", "phase subtracted"];
const BOARD: &[&str] = &["parity", "a side taken as a period"];
const PICTURE: &[&str] = &[
    "flipped",
    "left and right swapped",
    "axes swapped",
    "nearest pixel instead of interpolation",
    "centres at corners",
];
const BLEND: &[&str] = &[
    "blend order swapped",
    "the nearer for what is between",
    "texture left out",
];

pub(super) fn checks() -> Vec<SecondCheck> {
    let check = |name, faults, tolerance, pattern: fn(&mut Dice) -> Pattern| SecondCheck {
        name,
        rounds: [4000, 1],
        tolerance,
        faults,
        difference: Box::new(move |dice, fault| {
            let pattern = pattern(dice);
            let at = place(dice);
            (fast(&pattern).value(at[0], at[1]) - pattern.value(at, fault)).abs()
        }),
    };
    let angle = (1e-12, "rounding of 2π f t, up to 300");
    let exact = (0.0, "a number of two"); // 0 or 1 on both sides
    let levels = (1e-13, "rounding"); // of interpolated levels up to 1
    vec![
        check("pattern Cosine", COSINE, angle, cosine),
        check("pattern Checkerboard", BOARD, exact, |dice| {
            Pattern::Checkerboard(scale(dice, 0.01, 1.0))
        }),
        check("pattern Picture", PICTURE, levels, picture),
        SecondCheck {
            name: "blend and texture",
            rounds: [4000, 1],
            tolerance: (1e-11, "rounding of patterns"),
            faults: BLEND,
            difference: Box::new(blended),
        },
    ]
}

fn blended(dice: &mut Dice, fault: &str) -> f64 {
    let varied = varied(dice);
    let at = place(dice);
    let mut reflectance = Reflectance::blend(
        varied.brdf.clone(),
        varied.other.clone(),
        fast(&varied.blend),
    );
    reflectance.texture = Some(fast(&varied.texture));
    apart(&reflectance.at(at[0], at[1]), varied.at(at, fault))
}

/// The largest difference between the weights of a BRDF in two sums; if only one sum
/// contains the BRDF, its weight in the other sum counts as zero.
pub(super) fn apart(mixture: &Mixture<'_>, varied: [(f64, &Brdf); 2]) -> f64 {
    let weight = |brdf: &Brdf| {
        let weights = mixture.weighted().filter(|(_, of)| *of == brdf);
        weights.map(|(weight, _)| weight).sum::<f64>()
    };
    let each = varied.map(|(expected, brdf)| (weight(brdf) - expected).abs());
    worse(each[0], each[1])
}

fn place(dice: &mut Dice) -> [f64; 2] {
    [dice.between(-0.7, 0.7), dice.between(-0.7, 0.7)]
}

/// Converts a pattern to the type of the fast implementation.
fn fast(pattern: &Pattern) -> field::Pattern {
    match pattern {
        Pattern::Cosine(grating) => field::Pattern::Cosine(*grating),
        Pattern::Checkerboard(period) => field::Pattern::Checkerboard { period: *period },
        Pattern::Picture(levels, size) => {
            let raster = Raster::new(levels.width, levels.height, levels.values.clone());
            field::Pattern::Picture(field::Picture {
                size: *size,
                pixels: Arc::new(raster.expect("as many levels as pixels")),
            })
        }
    }
}

pub(super) fn grating(dice: &mut Dice) -> Grating {
    Grating {
        axis: dice.below(2),
        frequency: scale(dice, 0.1, 50.0),
        modulation: dice.unit(),
        phase: dice.between(0.0, TAU),
    }
}

fn cosine(dice: &mut Dice) -> Pattern {
    Pattern::Cosine(grating(dice))
}

fn picture(dice: &mut Dice) -> Pattern {
    let [width, height] = [1 + dice.below(6), 1 + dice.below(6)];
    let values = (0..width * height).map(|_| dice.unit()).collect();
    let levels = Levels {
        width,
        height,
        values,
    };
    Pattern::Picture(levels, [scale(dice, 0.3, 2.0), scale(dice, 0.3, 2.0)])
}

fn pattern(dice: &mut Dice) -> Pattern {
    match dice.below(3) {
        0 => cosine(dice),
        1 => Pattern::Checkerboard(scale(dice, 0.01, 1.0)),
        _ => picture(dice),
    }
}

fn brdf(dice: &mut Dice) -> Brdf {
    let (.., lobe) = lobes::LOBES[dice.below(lobes::LOBES.len())];
    let lobe = lobe(dice);
    Brdf::new(lobe, dice.unit(), lobes::fresnel(dice))
}

fn varied(dice: &mut Dice) -> Varied {
    Varied {
        brdf: brdf(dice),
        other: brdf(dice),
        blend: pattern(dice),
        texture: pattern(dice),
    }
}
