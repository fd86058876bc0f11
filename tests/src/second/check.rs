//! Compares a function with its second implementation, both without a fault and with faults planted
//! in the second implementation.

use super::SEED;
use crate::hostile::dice::Dice;
pub(super) use crate::report::worse;
use crate::report::{
    self,
    Bound::{Above, AtMost, Below},
};

/// A function that returns the largest difference between two implementations in one round of
/// points; the text names a planted fault, if any.
type Difference = dyn Fn(&mut Dice, &str) -> f64;

/// A comparison of two implementations.
pub(super) struct SecondCheck {
    pub(super) name: &'static str,
    /// Number of rounds (random configurations), and number of points in each round.
    pub(super) rounds: [u32; 2],
    /// Maximum permitted difference between the implementations, with the reason for this
    /// maximum.
    pub(super) tolerance: (f64, &'static str),
    /// Faults of the second implementation, each of which must be detected.
    pub(super) faults: &'static [&'static str],
    pub(super) difference: Box<Difference>,
}

/// The largest differences between the implementations, without a fault and with each planted
/// fault.
pub(super) struct Outcome {
    pub(super) difference: f64,
    pub(super) planted: Vec<f64>,
}

impl SecondCheck {
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

    /// Checks that the two implementations agree without a fault, and differ with a fault. The
    /// difference must be finite, so that NaN does not count as a detected fault.
    pub(super) fn required(&self, difference: f64, planted: f64) -> Vec<report::Check> {
        let (most, reason) = self.tolerance;
        vec![
            report::Check::new("agrees", difference, AtMost(most)).because(reason),
            report::Check::new("fault seen", planted, Above(most)).because(reason),
            report::Check::new("a number", planted, Below(f64::INFINITY)).because("no nonsense"),
        ]
    }
}

/// The largest of some differences.
pub(super) fn largest(count: u32, difference: impl FnMut() -> f64) -> f64 {
    std::iter::repeat_with(difference)
        .take(count as usize)
        .fold(0.0, worse)
}

/// A value that is wrong if the named fault is planted, and right otherwise.
pub(super) fn if_planted<T>(fault: &str, name: &str, wrong: T, right: T) -> T {
    if fault == name { wrong } else { right }
}

/// The difference between two numbers, divided by the larger of their magnitudes.
pub(super) fn relative(a: f64, b: f64) -> f64 {
    let larger = worse(a.abs(), b.abs());
    if larger > 0.0 {
        (a - b).abs() / larger
    } else {
        0.0
    }
}
