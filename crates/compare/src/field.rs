//! The predicted spectrum of a plane on a 4D grid.

use etendue_spectrum::field::{FieldGroup, FieldSpectrum};
use ndarray::Array2;

/// The predicted spectrum of a windowed light field on a 4D grid. The field is put on the grid in
/// the same way as a measurement.
#[derive(Clone, Debug)]
pub enum PredictedField {
    /// The expectation of the measurement, aliasing included.
    Exact {
        /// The spectrum.
        spectrum: Box<FieldSpectrum>,
        /// The power without aliasing, [|Ωxy|, |Ωuv|]. The power is `None` where the rays of a file
        /// are put on the grid.
        alias_free: Option<Array2<f64>>,
    },
    /// Independent estimates of the expectation. They are computed from rays that are put on the
    /// grid in the same way as photons.
    Sampled(Vec<FieldSpectrum>),
}

impl PredictedField {
    /// The spectrum of another measurement, where no theory applies.
    #[must_use]
    pub fn reference(groups: Vec<FieldGroup>) -> Self {
        let scaled = groups.into_iter().map(|FieldGroup { share, spectrum }| {
            let values = spectrum.values.mapv(|value| value / share);
            FieldSpectrum { values, ..spectrum }
        });
        Self::Sampled(scaled.collect())
    }

    /// The predicted spectra: one for an exact prediction, or one for each group.
    pub(crate) fn spectra(&self) -> &[FieldSpectrum] {
        match self {
            Self::Exact { spectrum, .. } => std::slice::from_ref(spectrum.as_ref()),
            Self::Sampled(spectra) => spectra,
        }
    }
}
