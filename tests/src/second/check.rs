//! A function held against its second implementation, as it is and with faults planted in the
//! second.

use super::SEED;
use crate::hostile::dice::Dice;

/// The largest difference of a round, with a fault planted in the second implementation or, where
/// none is named, without.
type Difference = dyn Fn(&mut Dice, &str) -> f64;

/// What is held against what.
pub(super) struct Check {
    pub(super) name: &'static str,
    /// Times that random numbers are thrown, and points for each.
    pub(super) rounds: [u32; 2],
    /// The largest difference that may be, and why it may.
    pub(super) tolerance: (f64, &'static str),
    /// Each changes the second implementation, which must then be seen to differ.
    pub(super) faults: &'static [&'static str],
    pub(super) difference: Box<Difference>,
}

/// What came of it: differences without a fault and with each.
pub(super) struct Outcome {
    pub(super) difference: f64,
    pub(super) planted: Vec<f64>,
}

impl Check {
    pub(super) fn run(&self) -> Outcome {
        let largest = |fault: &str| {
            let rounds = 0..u64::from(self.rounds[0]);
            let each = rounds.map(|i| (self.difference)(&mut Dice::new(SEED, i), fault));
            each.fold(0.0, worse)
        };
        Outcome {
            difference: largest(""),
            planted: self.faults.iter().map(|fault| largest(fault)).collect(),
        }
    }

    pub(super) fn points(&self) -> u32 {
        self.rounds[0] * self.rounds[1]
    }

    /// Whether the two agree.
    pub(super) fn holds(&self, outcome: &Outcome) -> bool {
        outcome.difference <= self.tolerance.0
    }

    /// Whether a difference with a fault is one that the check reports: a number, so that no fault
    /// passes for seen because it is nonsense.
    pub(super) fn sees(&self, planted: f64) -> bool {
        planted.is_finite() && planted > self.tolerance.0
    }
}

/// The larger difference; what is not a number is as far off as can be.
pub(super) fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// How far two numbers are apart, as a share of the larger.
pub(super) fn relative(a: f64, b: f64) -> f64 {
    let larger = worse(a.abs(), b.abs());
    if larger > 0.0 {
        (a - b).abs() / larger
    } else {
        0.0
    }
}
