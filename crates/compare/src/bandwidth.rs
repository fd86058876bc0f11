//! The bandwidths of lobes and of measured reflections along ν.

use etendue_field::Lobe;
use etendue_spectrum::bandwidth::{Along, BANDWIDTH_FRACTION};
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::{CrossPower, Measurement, Uncertain};
use etendue_theory::shading::PlanarLobe;

/// Ω_ρ in cycles per radian: the frequency below which a lobe has [`BANDWIDTH_FRACTION`] of
/// its energy. Returns `None` for a lobe centred on the normal.
#[must_use]
pub fn lobe_cutoff(lobe: Lobe) -> Option<f64> {
    Some(PlanarLobe::of(lobe)?.cutoff(BANDWIDTH_FRACTION))
}

/// The bandwidth along ν that was measured at plane `index`, and the error of this
/// bandwidth. Returns `None` where no light arrived.
///
/// # Errors
/// Returns an error if the measurement has too few batches.
pub fn measured_bandwidth(
    measurement: &Measurement,
    index: usize,
) -> Result<Option<Uncertain>, TooFewBatches> {
    let power = CrossPower::new(measurement, index)?;
    Ok(power.bandwidth(Along::Nu).map(|widest| widest.value))
}
