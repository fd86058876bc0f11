//! Measures a scene by its difference from another scene, whose spectra theory knows.

use crate::reporter::Reporter;
use crate::run::Run;
use crate::workers::Leader;
use etendue_compare::{Class, Prediction};
use etendue_field::{Projection, Slices, VirtualPlane};
use etendue_spectrum::Measurement;
use etendue_store::{Failure, Method};

impl Run {
    /// This run, measured by its difference from `other` ([`Measurement::difference`]). Both scenes
    /// are traced with the same photons.
    ///
    /// The expectation of the measurement is the spectrum of this scene if the predictions of
    /// `other` are right, so it must not be used to judge them.
    ///
    /// # Errors
    /// When the planes or the settings of the two runs differ, or when theory does not apply to a
    /// plane of `other`.
    pub fn against(mut self, other: Self) -> Result<Self, Failure> {
        self.check_twin(&other)?;
        self.method = Method::Difference;
        self.scene.against = Some(Box::new(other.scene));
        Ok(self)
    }

    /// The run of the scene from which the difference is measured.
    pub(crate) fn other(&self) -> Result<Option<Self>, Failure> {
        let other = self.scene.against.as_deref().cloned();
        let run = |scene| Self::of(scene, Method::Photons, Vec::new());
        other.map(run).transpose()
    }

    /// The predictions of the planes, and the measurement to which they belong: what was traced,
    /// or its difference from the other scene, whose predictions are then added. The errors of
    /// these predictions are added to those of this scene.
    ///
    /// # Errors
    /// When another method of measurement replaces theory at a plane, and finds no light.
    pub fn predicted(
        &self,
        traced: Measurement,
        workers: Option<&Leader<'_>>,
        reporter: &dyn Reporter,
    ) -> Result<(Measurement, Vec<Prediction>), Failure> {
        let mut predictions = self.predictions(workers, reporter)?;
        let Some(other) = self.other()? else {
            return Ok((traced, predictions));
        };
        let known = other.predictions(None, reporter)?;
        let expected = known.iter().map(|of| (&of.slices, &of.projection));
        let expected: Vec<(&Slices, &Projection)> = expected.collect();
        for (prediction, known) in predictions.iter_mut().zip(&known) {
            prediction.add_errors_of(known);
            let name = &other.scene.name;
            let step = format!(
                "measured as  the prediction of {name}, plus photons of both scenes in pairs"
            );
            prediction.steps.push(step);
        }
        Ok((traced.difference(&expected), predictions))
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
