//! The bandwidths of lobes and of measured reflections along ν, and changes of bandwidths and slopes.

use etendue_field::Lobe;
use etendue_spectrum::bandwidth::{Along, BANDWIDTH_FRACTION};
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::moments::shear_slope;
use etendue_spectrum::{CrossPower, Measurement, Uncertain};
use etendue_theory::shading::PlanarLobe;

/// The changes of the bandwidths along ρ and ν and of the shear slope of plane `index` from `a` to
/// `b`, whose batches have the same random numbers, with their standard errors. Spectra at different
/// frequencies have none.
///
/// # Errors
/// Returns an error if a measurement has too few batches.
pub fn paired_changes(
    [a, b]: [&Measurement; 2],
    index: usize,
) -> Result<[Option<Uncertain>; 3], TooFewBatches> {
    let grid = &a.planes()[index].grid;
    if b.planes()[index].grid != *grid {
        return Ok([None; 3]);
    }
    let [a, b] = [CrossPower::new(a, index)?, CrossPower::new(b, index)?];
    Ok([
        a.bandwidth_change(&b, Along::Rho),
        a.bandwidth_change(&b, Along::Nu),
        a.change(&b, |power| shear_slope(power, grid)),
    ])
}

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
