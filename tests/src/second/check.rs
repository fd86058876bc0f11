//! A function held against its second implementation, as it is and with faults planted in the
//! second.

use super::SEED;
use crate::hostile::dice::Dice;
pub(super) use crate::report::worse;
use crate::report::{
    self,
    Bound::{Above, AtMost, Below},
};

/// The largest difference of a round, with a fault planted in the second implementation or, where
/// none is named, without.
type Difference = dyn Fn(&mut Dice, &str) -> f64;

/// What is held against what.
pub(super) struct SecondCheck {
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

    /// The two agree, and do not with a fault: then they differ by a number, so that no fault
    /// passes for seen because it is nonsense.
    pub(super) fn required(&self, difference: f64, planted: f64) -> Vec<report::Check> {
        let (most, reason) = self.tolerance;
        vec![
            report::Check::new("agrees", difference, AtMost(most), reason),
            report::Check::new("fault seen", planted, Above(most), reason),
            report::Check::new("a number", planted, Below(f64::INFINITY), "no nonsense"),
        ]
    }
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
