//! Collects the results of a scene that has been measured and predicted.

use crate::inquiry::inquire;
use crate::measure::MeasuredScene;
use crate::reporter::{Reporter, Work};
use crate::summary::Summary;
use crate::{enough_photons, field};
use etendue_compare::{PlaneComparison, TESTS, Test, compare};
use etendue_predict::test_each;
use etendue_store::{Failure, Results};
use rayon::prelude::*;

/// The results of a scene: the comparison of each plane, and the verdict.
#[derive(Debug)]
pub struct Judged {
    /// The comparison of each plane, in the order of the scene.
    pub planes: Vec<PlaneComparison>,
    /// The verdict, with the numbers from which it follows.
    pub summary: Summary,
}

impl Judged {
    /// Compares all planes, and investigates the planes that fail. If light fields are saved to a
    /// result folder, these light fields are also compared.
    pub fn of(
        case: &MeasuredScene,
        fields: Option<&mut Results>,
        reporter: &dyn Reporter,
    ) -> Result<Self, Failure> {
        let _stage = reporter.begin(Work::Stage("comparing"));
        let tests = if fields.is_some() {
            field::TESTS
        } else {
            TESTS
        };
        let mut planes = judged(case, &test_each(&case.scene, tests))?;
        if let Some(results) = fields {
            field::compare(Some(results), case, &mut planes, reporter)?;
        }
        let inquiries = inquire(case, &planes, reporter)?;
        let summary = Summary::new(case, &planes, inquiries);
        Ok(Self { planes, summary })
    }
}

/// The comparison of each plane, with its verdict.
pub fn judged(case: &MeasuredScene, test: &Test) -> Result<Vec<PlaneComparison>, Failure> {
    let compared = |(i, prediction)| {
        compare(&case.measurement, i, prediction, test).map_err(Failure::cannot_run)
    };
    let each = case.predictions.par_iter().enumerate();
    let mut planes = each.map(compared).collect::<Result<Vec<_>, _>>()?;
    enough_photons::leave_open(case, &mut planes)?;
    enough_photons::leave_hidden_lights_open(case, &mut planes)?;
    enough_photons::name_other_method(case, &mut planes);
    Ok(planes)
}
