//! Patterns, pictures and sums of BRDFs computed from their definitions (docs of
//! `etendue_field::Pattern`, docs/scenes.md).

use super::check::if_planted;
use etendue_field::{Brdf, Grating};
use std::f64::consts::TAU;

/// The levels of a picture, row by row from the top, each row from the left.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<f64>,
}

/// A pattern on a surface, as the second implementation represents it.
#[derive(Clone, Debug)]
pub(super) enum Pattern {
    Cosine(Grating),
    Checkerboard(f64),
    /// A picture: the levels of its pixels, and its width and height in metres.
    Picture(Levels, [f64; 2]),
}

impl Pattern {
    /// The value of the pattern at a point, given by its coordinates along the axes of
    /// the surface.
    pub(super) fn value(&self, at: [f64; 2], fault: &str) -> f64 {
        let [s, t] = match fault {
            "axes swapped" => [at[1], at[0]],
            "sign of t" => [at[0], -at[1]],
            _ => at,
        };
        match self {
            Self::Cosine(grating) => cosine(grating, [s, t], fault),
            Self::Checkerboard(period) => checkerboard(*period, [s, t], fault),
            Self::Picture(levels, size) => levels.picture(*size, [s, t], fault),
        }
    }
}

/// The value ½ (1 + m cos(2π f t + p)) of a grating.
pub(super) fn cosine(grating: &Grating, at: [f64; 2], fault: &str) -> f64 {
    let angle = TAU * grating.frequency * at[grating.axis];
    let angle = if_planted(
        fault,
        "phase subtracted",
        angle - grating.phase,
        angle + grating.phase,
    );
    0.5 + 0.5 * grating.modulation * angle.cos()
}

/// A checkerboard. Squares of half a period are counted along both axes from the vertex,
/// and the value is 1 where the sum of the counts is even.
fn checkerboard(period: f64, at: [f64; 2], fault: &str) -> f64 {
    let side = if_planted(fault, "a side taken as a period", period, period / 2.0);
    let odd = |t: f64| (t / side).floor().rem_euclid(2.0) > 0.5;
    let is_even = odd(at[0]) == odd(at[1]);
    let is_one = if_planted(fault, "parity", !is_even, is_even);
    if is_one { 1.0 } else { 0.0 }
}

impl Levels {
    pub(super) fn level(&self, column: usize, row: usize) -> f64 {
        self.values[row * self.width + column]
    }

    /// The value of a picture that is centred at the vertex, with its top towards Y. The
    /// picture is bilinear between pixel centres, constant beyond the outermost centres, and 0
    /// beyond its edge.
    fn picture(&self, [width, height]: [f64; 2], [s, t]: [f64; 2], fault: &str) -> f64 {
        if s.abs() > width / 2.0 || t.abs() > height / 2.0 {
            return 0.0;
        }
        let left = if_planted(
            fault,
            "left and right swapped",
            width / 2.0 - s,
            width / 2.0 + s,
        );
        let top = if_planted(fault, "flipped", height / 2.0 + t, height / 2.0 - t);
        let off = if_planted(fault, "centres at corners", 0.0, 0.5);
        let centres = |count: usize, side: f64| -> Vec<f64> {
            let pitch = side / count as f64;
            (0..count).map(|i| (i as f64 + off) * pitch).collect()
        };
        let (i, across) = between(&centres(self.width, width), left, fault);
        let (j, down) = between(&centres(self.height, height), top, fault);
        let next = [(i + 1).min(self.width - 1), (j + 1).min(self.height - 1)];
        let row = |j: usize| (1.0 - across) * self.level(i, j) + across * self.level(next[0], j);
        (1.0 - down) * row(j) + down * row(next[1])
    }
}

/// The index of the last pixel centre before a position, and the position between this
/// centre and the next as a fraction. Positions beyond the outermost pixel centres are clamped to
/// these centres.
fn between(centres: &[f64], at: f64, fault: &str) -> (usize, f64) {
    let last = centres.len() - 1;
    if at <= centres[0] {
        return (0, 0.0);
    }
    if at >= centres[last] {
        return (last, 0.0);
    }
    let before = (0..last).rev().find(|i| centres[*i] <= at).unwrap_or(0);
    let share = (at - centres[before]) / (centres[before + 1] - centres[before]);
    let nearest = "nearest pixel instead of interpolation";
    (before, if_planted(fault, nearest, share.round(), share))
}

/// Two BRDFs whose weighted sum is the BRDF at each point of a surface.
#[derive(Clone, Debug)]
pub(super) struct Varied {
    pub(super) brdf: Brdf,
    pub(super) other: Brdf,
    pub(super) blend: Pattern,
    pub(super) texture: Pattern,
}

impl Varied {
    /// Two BRDFs with their weights at a point. The weight of `brdf` is the value of the
    /// blend, and the weight of `other` is one minus this value. The value of the texture
    /// multiplies the weights of both BRDFs.
    pub(super) fn at(&self, at: [f64; 2], fault: &str) -> [(f64, &Brdf); 2] {
        let share = self.blend.value(at, fault);
        let share = match fault {
            "blend order swapped" => 1.0 - share,
            "the nearer for what is between" => share.round(),
            _ => share,
        };
        let texture = if_planted(
            fault,
            "texture left out",
            1.0,
            self.texture.value(at, fault),
        );
        [
            (texture * share, &self.brdf),
            (texture * (1.0 - share), &self.other),
        ]
    }
}
