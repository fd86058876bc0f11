//! The BRDFs of the tracers and of theory, compared with the second implementation.

use super::brdf::{self, mirrored};
use super::check::{SecondCheck, if_planted, relative};
use super::pattern::cosine;
use super::textures::grating;
use super::vector::{Vector, aside, direction, scale};
use crate::hostile::dice::Dice;
use etendue_field::{AngleTable, Brdf, Fresnel, Lobe, Mixture, Pattern, Reflectance, Term, Weight};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A BRDF implementation that is under test: a function of the BRDF's description and of two
/// directions, with the normal along Z.
type Fast = fn(&Brdf, Vector, Vector) -> f64;

fn traced(brdf: &Brdf, from: Vector, to: Vector) -> f64 {
    etendue_trace::brdf::value(brdf, from.into(), to.into())
}

fn predicted(brdf: &Brdf, from: Vector, to: Vector) -> f64 {
    etendue_theory::path::scattering::brdf::value(brdf, DVec3::Z, from.into(), to.into())
}

/// An implementation of a sum of BRDFs that is under test.
type FastSum = fn(&Mixture<'_>, Vector, Vector) -> f64;

fn traced_sum(mixture: &Mixture<'_>, from: Vector, to: Vector) -> f64 {
    etendue_trace::brdf::sum(mixture, from.into(), to.into())
}

fn predicted_sum(mixture: &Mixture<'_>, from: Vector, to: Vector) -> f64 {
    etendue_theory::path::scattering::brdf::sum(mixture, DVec3::Z, from.into(), to.into())
}

const SEPARABLE: &[&str] = &[
    "h for f",
    "h left out",
    "angle measured from the surface",
    "interpolated over the cosine",
];
const SUM: &[&str] = &["weights swapped", "a term left out", "phase subtracted"];
const FRESNEL: &[&str] = &["s alone", "p alone", "media swapped", "k left out"];
const PHONG: &[&str] = &["about the half-way vector", "factor (n + 2)/2π"];
const BECKMANN: &[&str] = &[
    "α² is the variance along an axis",
    "masking in one direction only",
    "facet closer to one direction",
];
const GGX: &[&str] = &[
    "Beckmann's masking",
    "masking in one direction only",
    "D to the power 3/2",
];

/// A kind of lobe: the names of its checks for the tracers and for theory, the planted faults, the
/// tolerance with its reason, and a random lobe.
type Row = (
    [&'static str; 2],
    &'static [&'static str],
    (f64, &'static str),
    fn(&mut Dice) -> Lobe,
);

/// All kinds of lobes.
pub(super) const LOBES: [Row; 4] = [
    (
        ["tracers: Fresnel factors", "theory: Fresnel factors"],
        FRESNEL,
        (1e-11, "rounding, more where all is nearly reflected"),
        |_| Lobe::Lambertian,
    ),
    (
        ["tracers: Phong", "theory: Phong"],
        PHONG,
        (1e-11, "rounding of cos α, n = 10⁴ times"),
        |dice| Lobe::Phong {
            exponent: scale(dice, 0.1, 1e4),
        },
    ),
    (
        ["tracers: Beckmann", "theory: Beckmann"],
        BECKMANN,
        (3e-9, "1 − cos² of a facet loses 10⁻¹⁵ of α² = 10⁻⁶"),
        |dice| Lobe::Beckmann {
            roughness: scale(dice, 1e-3, 1.0),
        },
    ),
    (
        ["tracers: GGX", "theory: GGX"],
        GGX,
        (3e-9, "1 − cos² of a facet loses 10⁻¹⁵ of α² = 10⁻⁶"),
        |dice| Lobe::Ggx {
            roughness: scale(dice, 1e-3, 1.0),
        },
    ),
];

pub(super) fn checks() -> Vec<SecondCheck> {
    let of = |i: usize, fast: Fast| {
        LOBES.map(|(names, faults, tolerance, lobe)| SecondCheck {
            name: names[i],
            rounds: [4000, 1],
            tolerance,
            faults,
            difference: Box::new(move |dice, fault| difference(fast, lobe, dice, fault)),
        })
    };
    let more = [
        between_lists("tracers: separable", traced),
        between_lists("theory: separable", predicted),
        of_sum("tracers: sum of BRDFs", traced_sum),
        of_sum("theory: sum of BRDFs", predicted_sum),
    ];
    [of(0, traced), of(1, predicted)]
        .into_iter()
        .flatten()
        .chain(more)
        .collect()
}

fn between_lists(name: &'static str, fast: Fast) -> SecondCheck {
    SecondCheck {
        name,
        rounds: [4000, 1],
        tolerance: (1e-9, "an angle near 0 from its cosine, off by 10⁻⁸ at most"),
        faults: SEPARABLE,
        difference: Box::new(move |dice, fault| separable(fast, dice, fault)),
    }
}

fn of_sum(name: &'static str, fast: FastSum) -> SecondCheck {
    SecondCheck {
        name,
        rounds: [4000, 1],
        tolerance: (1e-10, "rounding of cos α, n = 200 times, and of 2π f t"),
        faults: SUM,
        difference: Box::new(move |dice, fault| summed(fast, dice, fault)),
    }
}

/// The largest relative difference between both implementations of a BRDF with the given
/// kind of lobe.
fn difference(fast: Fast, lobe: fn(&mut Dice) -> Lobe, dice: &mut Dice, fault: &str) -> f64 {
    let brdf = Brdf::new(lobe(dice), dice.unit(), fresnel(dice));
    compared(fast, &brdf, dice, fault)
}

/// The largest relative difference between both implementations of a Phong lobe that is
/// multiplied by tables of factors, one over the incoming angle and one over the outgoing angle.
fn separable(fast: Fast, dice: &mut Dice, fault: &str) -> f64 {
    let exponent = scale(dice, 0.1, 1e3);
    let mut list = || {
        let values: Vec<f64> = (0..2 + dice.below(9)).map(|_| dice.unit()).collect();
        Some(AngleTable {
            values: values.into(),
        })
    };
    let (incoming, outgoing) = (list(), list());
    let brdf = Brdf {
        incoming,
        outgoing,
        ..Brdf::new(Lobe::Phong { exponent }, 1.0, Fresnel::White)
    };
    compared(fast, &brdf, dice, fault)
}

/// The largest relative difference between both implementations of a weighted sum of
/// BRDFs.
fn summed(fast: FastSum, dice: &mut Dice, fault: &str) -> f64 {
    let mut term = |exponent: f64| Term {
        brdf: Brdf::new(Lobe::Phong { exponent }, dice.unit(), fresnel(dice)),
        weight: Weight::Pattern(Pattern::Cosine(grating(dice))),
    };
    let terms = [2.0, 20.0, 200.0].map(&mut term).to_vec();
    let at = [dice.between(-0.7, 0.7), dice.between(-0.7, 0.7)];
    let tilt = dice.between(0.0, 1.2);
    let from = aside(dice, [0.0, 0.0, 1.0], tilt);
    let to = to(dice, Lobe::Phong { exponent: 20.0 }, from);
    let weighted = |i: usize| {
        let Weight::Pattern(Pattern::Cosine(grating)) = &terms[i].weight else {
            return f64::NAN;
        };
        let of = if_planted(fault, "weights swapped", 2 - i, i);
        cosine(grating, at, fault) * brdf::value(&terms[of].brdf, from, to, fault)
    };
    let count = if_planted(fault, "a term left out", 2, 3);
    let expected: f64 = (0..count).map(weighted).sum();
    let reflectance = Reflectance {
        terms: terms.clone(),
        texture: None,
    };
    relative(fast(&reflectance.at(at[0], at[1]), from, to), expected)
}

fn compared(fast: Fast, brdf: &Brdf, dice: &mut Dice, fault: &str) -> f64 {
    let tilt = dice.between(0.0, 1.55);
    let from = aside(dice, [0.0, 0.0, 1.0], tilt);
    let to = to(dice, brdf.lobe, from);
    relative(fast(brdf, from, to), brdf::value(brdf, from, to, fault))
}

pub(super) fn fresnel(dice: &mut Dice) -> Fresnel {
    match dice.below(3) {
        0 => Fresnel::White,
        1 => Fresnel::Dielectric {
            index: scale(dice, 0.05, 20.0),
        },
        _ => Fresnel::Conductor {
            n: scale(dice, 0.05, 20.0),
            k: dice.between(0.0, 20.0),
        },
    }
}

/// A random direction within the lobe, which is occasionally below the surface.
fn to(dice: &mut Dice, lobe: Lobe, from: Vector) -> Vector {
    match lobe {
        Lobe::Lambertian => direction(dice),
        Lobe::Phong { exponent } => {
            let mirror = [-from[0], -from[1], from[2]];
            let by = dice.between(0.0, 4.0) / (exponent + 1.0).sqrt();
            aside(dice, mirror, by.min(PI))
        }
        Lobe::Beckmann { roughness } | Lobe::Ggx { roughness } => {
            let tilt = (roughness * dice.between(0.0, 4.0)).atan();
            let around = dice.between(0.0, TAU);
            let facet = [
                tilt.sin() * around.cos(),
                tilt.sin() * around.sin(),
                tilt.cos(),
            ];
            mirrored(from, facet)
        }
    }
}
