//! Computes bandwidths of measured and predicted light. One bandwidth covers all power; the other
//! covers the light after its mean is subtracted.

use crate::prediction::Prediction;
use crate::report::{Azimuths, Bandwidth, DirectedPair};
use crate::residuals::of_transform;
use etendue_field::Slices;
use etendue_spectrum::bandwidth::{Along, Widest, widest};
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::{CrossPower, Measurement, Uncertain, WindowedMean};
use ndarray::Array3;

/// The bandwidths of a measured power and of a prediction, each in the azimuth where it is
/// largest. `replicates` is the power of a prediction that has replicates.
pub(crate) fn bandwidth(
    measured: &CrossPower<'_>,
    replicates: Option<&CrossPower<'_>>,
    predicted: &Slices,
) -> Bandwidth {
    let power = slices_power(predicted);
    let moved = &power + &of_transform(&power);
    let along = |of: Along| {
        let widest = |power: &Array3<f64>| Some(widest(power.view(), &predicted.grid, of)?.value);
        let change = widest(&moved).zip(widest(&power));
        let transform_error = change.map_or(0.0, |(moved, still)| (moved - still).abs());
        let measured = measured.bandwidth(of);
        let predicted = match replicates {
            Some(power) => power.bandwidth(of),
            None => exact(predicted, of),
        };
        let noise = predicted.map_or(0.0, |p| p.value.error);
        let noise = libm::hypot(noise, transform_error);
        DirectedPair {
            measured: measured.map(|m| m.value.value),
            predicted: predicted.map(|p| p.value.value),
            error: measured.map(|m| libm::hypot(m.value.error, noise)),
            azimuth: Azimuths {
                measured: measured.map(|m| m.azimuth),
                predicted: predicted.map(|p| p.azimuth),
            },
        }
    };
    Bandwidth {
        rho: along(Along::Rho),
        nu: along(Along::Nu),
    }
}

/// Subtracts the mean from the light at plane `index` and from its prediction, and returns the
/// bandwidths of both.
///
/// # Errors
/// Returns an error if the measurement has too few batches.
pub(crate) fn variation(
    measurement: &Measurement,
    index: usize,
    prediction: &Prediction,
    predicted: &Slices,
) -> Result<Bandwidth, TooFewBatches> {
    let plane = &measurement.planes()[index];
    let azimuths = 0..plane.grid.azimuths;
    let mean = WindowedMean::new(&plane.window, &plane.grid);
    let batches = measurement.at_plane(index).map(|batch| &batch.slices);
    let batches = mean.removed_from_all(batches);
    let measured = CrossPower::of_replicates(&batches, azimuths.clone())?;
    let replicates = mean.removed_from_all(prediction.replicates.iter());
    let replicates = match replicates.is_empty() {
        true => None,
        false => Some(CrossPower::of_replicates(&replicates, azimuths)?),
    };
    let predicted = mean.removed_from(predicted);
    Ok(bandwidth(&measured, replicates.as_ref(), &predicted))
}

/// The bandwidth of slices without a statistical error.
fn exact(slices: &Slices, of: Along) -> Option<Widest<Uncertain>> {
    let power = slices_power(slices);
    let exact = widest(power.view(), &slices.grid, of)?;
    Some(Widest {
        azimuth: exact.azimuth,
        value: Uncertain {
            value: exact.value,
            error: 0.0,
        },
    })
}

fn slices_power(slices: &Slices) -> Array3<f64> {
    slices.half.mapv(|s| s.norm_sqr())
}
