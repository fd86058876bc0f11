//! Measures a scene by its difference from another scene, whose spectra theory knows.

use crate::measure::measured_by;
use crate::method::pair;
use crate::reporter::Reporter;
use crate::run::Run;
use etendue_compare::{Class, Prediction};
use etendue_field::{Projection, Slices, VirtualPlane};
use etendue_spectrum::Measurement;
use etendue_store::{Failure, Method};

impl Run {
    /// The measurement and the predictions of this run, whose method is the difference from `other`
    /// ([`Measurement::difference_from`]). Both scenes are traced with the same photons.
    ///
    /// The expectation of the measurement is the spectrum of this scene if the predictions of
    /// `other` are right, so it must not be used to judge them. Errors of these predictions are
    /// added to the errors of the predictions of this scene.
    ///
    /// # Errors
    /// When the planes or the settings of the two runs differ, or when theory does not apply to a
    /// plane of `other`.
    pub fn measured_against(
        &mut self,
        other: &Self,
        reporter: &dyn Reporter,
    ) -> Result<(Measurement, Vec<Prediction>), Failure> {
        self.check_twin(other)?;
        self.method = Method::Difference;
        let known = other.predictions(None, reporter)?;
        let [of_other, own] = pair([&other.scene, &self.scene]).map(|source| {
            let all = 0..self.scene.run.batches;
            measured_by(&*source, &self.scene, all, reporter)
        });
        let expected = known.iter().map(|of| (&of.slices, &of.projection));
        let expected: Vec<(&Slices, &Projection)> = expected.collect();
        let measurement = own.difference_from(&of_other, &expected);
        let mut predictions = self.predictions(None, reporter)?;
        for (prediction, known) in predictions.iter_mut().zip(&known) {
            prediction.add_errors_of(known);
            let name = &other.scene.name;
            let step = format!(
                "measured as  the prediction of {name}, plus photons of both scenes in pairs"
            );
            prediction.steps.push(step);
        }
        Ok((measurement, predictions))
    }

    /// Fails if another run cannot be subtracted from this one.
    fn check_twin(&self, other: &Self) -> Result<(), Failure> {
        let [own, others] = [&self.scene, &other.scene];
        let fault = |what: String| Err(Failure::bad_input(format!("{}: {what}", others.name)));
        let names = |planes: &[VirtualPlane]| -> Vec<String> {
            planes.iter().map(|plane| plane.name.clone()).collect()
        };
        let [planes, wanted] = [others, own].map(|scene| names(&scene.planes).join(", "));
        if planes != wanted {
            return fault(format!("its planes are {planes}; must be {wanted}"));
        }
        for ((a, b), theory) in others.planes.iter().zip(&own.planes).zip(&other.theories) {
            if (a.window, a.grid, a.orientation, a.quantity)
                != (b.window, b.grid, b.orientation, b.quantity)
            {
                return fault(format!(
                    "plane {} has another window, frequencies, orientation or quantity than in {}",
                    a.name, own.name
                ));
            }
            if theory.class() == Class::Reference {
                return fault(format!(
                    "no theory applies to plane {}; allowed: a scene whose planes all have a theory",
                    a.name
                ));
            }
        }
        if others.run != own.run {
            return fault(format!("its field run differs from that of {}", own.name));
        }
        Ok(())
    }
}
