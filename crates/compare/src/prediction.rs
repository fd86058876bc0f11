//! Everything that a measurement of a plane is compared with.

use crate::class::Class;
use crate::first_order::FirstOrder;
use etendue_field::{Projection, Slices};
use etendue_spectrum::Measurement;
use etendue_spectrum::estimate::{self, TooFewBatches};

/// Everything that a measurement of a plane is compared with.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The kind of prediction.
    pub class: Class,
    /// The steps that produce the spectrum, with one line for each step.
    pub steps: Vec<String>,
    /// The slices of the windowed spectrum.
    pub slices: Slices,
    /// The estimated ‖error‖/‖slices‖: the standard error where theory has replicates, otherwise
    /// the quadrature error. The error is `None` for a closed form and for a reference.
    pub quadrature_error: Option<f64>,
    /// The relative error ‖error‖/‖slices‖ due to smooth meshes. Theory replaces smooth meshes by
    /// osculating patches, and the two tracers of a reference deflect rays at them differently. The
    /// error is `None` without a smooth mesh.
    pub mesh_error: Option<f64>,
    /// The quadrature error of lights without replicates, relative to the slices of all lights, if
    /// other lights have replicates.
    pub rule_error: Option<f64>,
    /// The first-order chain. Where a first-order chain exists, `slices` and all other fields
    /// belong to the exact ray-space prediction.
    pub first_order: Option<FirstOrder>,
    /// Independent replicates, which are batches of a reference or randomised rules of theory;
    /// `slices` is their mean. The list is empty where the slices have no statistical error. With n
    /// replicates, a p-value is at least 2¹⁻ⁿ, so at least 16 replicates should be used.
    pub replicates: Vec<Slices>,
    /// ∫ L W without occluders; zero for a reference. The slices of theory are compared with this
    /// value to decide whether they are dark.
    pub unblocked: f64,
    /// The windowed light field in (x, u).
    pub projection: Projection,
    /// For each parameter of the chain: name, value and derivative of the slices.
    pub parameters: Vec<PredictedParameter>,
    /// The shortest and the longest distance, in metres, from the plane back to the occluders of
    /// its light. The value is `None` if there are no occluders, or if light is reflected between
    /// the occluders and the plane.
    pub depth: Option<[f64; 2]>,
    /// The cuts, in cycles per metre, for a plane where light leaves a diffuse surface. Energy
    /// above a cut counts as high-frequency.
    pub cuts: Vec<f64>,
}

/// A parameter of the chain and how the slices depend on it.
#[derive(Clone, Debug)]
pub struct PredictedParameter {
    /// Name, such as "travel light to blockers".
    pub name: String,
    /// Unit of the value; empty for a pure number.
    pub unit: String,
    /// Value in the scene.
    pub value: f64,
    /// ∂ slices / ∂ parameter.
    pub derivative: Slices,
}

impl Prediction {
    /// Checks whether the slices have a statistical error, which their replicates show.
    pub(crate) fn is_statistical(&self) -> bool {
        !self.replicates.is_empty()
    }

    /// ‖error‖/‖slices‖ for the errors that replicates do not show.
    pub(crate) fn systematic_error(&self) -> Option<f64> {
        let quadrature = self.quadrature_error.filter(|_| !self.is_statistical());
        both(both(quadrature, self.rule_error), self.mesh_error)
    }

    /// ‖error‖/‖slices‖ as estimated from the replicates of theory. This error does not
    /// shrink with more photons.
    pub(crate) fn statistical_error(&self) -> Option<f64> {
        self.quadrature_error.filter(|_| self.is_statistical())
    }

    /// The combined ‖error‖/‖slices‖ of all kinds of error.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        both(
            both(self.quadrature_error, self.rule_error),
            self.mesh_error,
        )
    }

    /// Adds the errors of `known` to this prediction, which is then tested against the slices of
    /// `known` plus a measured difference.
    pub fn add_errors_of(&mut self, known: &Self) {
        let size = known.slices.norm() / self.slices.norm().max(f64::MIN_POSITIVE);
        let error = known.error().map(|error| error * size);
        let [own, others] = [&self.replicates, &known.replicates].map(Vec::len);
        if others > 0 {
            let count = if own > 0 { own.min(others) } else { others };
            let replicate = |i: usize| {
                let mut of = self.replicates.get(i).unwrap_or(&self.slices).clone();
                of.half += &(&known.slices.half - &known.replicates[i].half);
                of
            };
            self.replicates = (0..count).map(replicate).collect();
        }
        self.quadrature_error = both(self.quadrature_error, error);
    }

    /// A plane of a measurement in the form of a prediction. Another, independent
    /// measurement is compared with it.
    ///
    /// # Errors
    /// Returns an error if the measurement has too few batches.
    pub fn measured(measurement: &Measurement, plane: usize) -> Result<Self, TooFewBatches> {
        let batches = measurement.at_plane(plane);
        Ok(Self {
            class: Class::Reference,
            steps: Vec::new(),
            slices: estimate::slices(measurement, plane)?.mean,
            quadrature_error: None,
            mesh_error: None,
            rule_error: None,
            first_order: None,
            replicates: batches.map(|batch| batch.slices.clone()).collect(),
            unblocked: 0.0,
            projection: estimate::projection(measurement, plane)?.mean,
            parameters: Vec::new(),
            depth: None,
            cuts: Vec::new(),
        })
    }
}

/// The root of the sum of squares of two errors.
fn both(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(libm::hypot(a, b)),
        (a, b) => a.or(b),
    }
}
