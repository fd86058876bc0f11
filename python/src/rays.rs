//! The estimator for a user's rays.

use crate::arrays::Arrays;
use crate::live::Live;
use crate::outcome::{self, cells};
use etendue_compare::noise_dof;
use etendue_field::{Complex, Crossing, Ledger, PhotonSource, TwoPlane, VirtualPlane};
use etendue_spectrum::bandwidth::Along;
use etendue_spectrum::moments::shear_slope;
use etendue_spectrum::{
    CrossPower, Measurement, PartialBatch, RadialPower, Uncertain, estimate, measure_watched,
};
use etendue_store::Failure;
use ndarray::{Array1, Array4};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Number of rays summed at a time.
const BLOCK: usize = 4096;

/// A user's rays, in batches.
pub(crate) struct Rays(Vec<Vec<Crossing>>);

impl Rays {
    /// Creates rays from columns x, y, u, v and weight. Weights are multiplied by the number of
    /// batches, and by the number of rays of their batch, so that the mean over batches is the sum
    /// over all rays.
    pub(crate) fn new(
        columns: &[PyReadonlyArray1<'_, f64>; 5],
        batch: &PyReadonlyArray1<'_, u32>,
        batches: u32,
    ) -> PyResult<Self> {
        let fault = |what: String| Err(PyValueError::new_err(what));
        let [x, y, u, v, weight] = columns.each_ref().map(|column| column.as_array());
        let batch = batch.as_array();
        let rays = x.len();
        if [y.len(), u.len(), v.len(), weight.len(), batch.len()] != [rays; 5] {
            return fault("x, y, u, v, weight and batch must have the same length".to_owned());
        }
        let mut all =
            vec![Vec::with_capacity(rays / (batches.max(1) as usize) + 1); batches as usize];
        for i in 0..rays {
            let ray = TwoPlane {
                x: x[i],
                y: y[i],
                u: u[i],
                v: v[i],
            };
            let numbers = [ray.x, ray.y, ray.u, ray.v, weight[i]];
            if numbers.iter().any(|number| !number.is_finite()) {
                return fault(format!("ray {i} is {numbers:?}; allowed: finite numbers"));
            }
            let Some(own) = all.get_mut(batch[i] as usize) else {
                return fault(format!(
                    "batch[{i}] is {}; allowed: 0 to {}",
                    batch[i],
                    batches - 1
                ));
            };
            let weight = weight[i] * f64::from(batches);
            own.push(Crossing { ray, weight });
        }
        if let Some(empty) = all.iter().position(Vec::is_empty) {
            return fault(format!(
                "batch {empty} of {batches} has no ray; allowed: at least one ray per batch"
            ));
        }
        for own in &mut all {
            let count = own.len() as f64;
            own.iter_mut().for_each(|ray| ray.weight *= count);
        }
        Ok(Self(all))
    }

    fn measured(&self, plane: &VirtualPlane, live: &Live) -> Measurement {
        let batches = (0..self.0.len()).filter_map(|i| u32::try_from(i).ok());
        let mut batches = batches.map(PartialBatch::new);
        let all = self.0.iter().map(|batch| batch.len() as u64).sum();
        let watch = live.trace(all, "rays");
        measure_watched(self, std::slice::from_ref(plane), &mut batches, &watch).0
    }

    /// The sum of each batch times the number of batches, [batch, azimuth, ρ ≥ 0, ν].
    pub(crate) fn sums(&self, plane: &VirtualPlane, live: &Live) -> Array4<Complex> {
        let measured = self.measured(plane, live);
        let [azimuths, rho, nu] = plane.grid.half_shape();
        let mut sums = Array4::zeros((self.0.len(), azimuths, rho, nu));
        for (mut sum, batch) in sums.outer_iter_mut().zip(measured.at_plane(0)) {
            sum.assign(&batch.slices.half);
        }
        sums
    }
}

impl PhotonSource for Rays {
    fn emitted(&self, batch: u32) -> u64 {
        self.0[batch as usize].len() as u64
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        for block in self.0[batch as usize].chunks(BLOCK) {
            record(0, block);
            progress(block.len() as u64);
        }
        Ledger::default()
    }
}

/// The spectrum of rays.
pub(crate) struct Spectrum {
    slices: estimate::SliceEstimate,
    radial: RadialPower,
    projection: estimate::ProjectionEstimate,
    in_window: u64,
    /// Effective number of independent real numbers in the noise of the slices.
    noise_dof: Option<f64>,
    batches: usize,
    measurement: Measurement,
    /// The slope and the bandwidths, with their names.
    numbers: [(&'static str, Option<Uncertain>); 5],
}

/// Returns the spectrum of rays, with errors from the spread between batches.
pub(crate) fn spectrum(
    rays: &Rays,
    plane: &VirtualPlane,
    live: &Live,
) -> Result<Spectrum, Failure> {
    let measured = rays.measured(plane, live);
    let few = |error: estimate::TooFewBatches| Failure::bad_input(error);
    let power = CrossPower::new(&measured, 0).map_err(few)?;
    let grid = &plane.grid;
    let varying = measured.without_mean(0);
    let varying = CrossPower::of_replicates(&varying, 0..grid.azimuths).map_err(few)?;
    let along_rho = |power: &CrossPower<'_>| power.bandwidth(Along::Rho).map(|b| b.value);
    let along_nu = |power: &CrossPower<'_>| power.bandwidth(Along::Nu).map(|b| b.value);
    Ok(Spectrum {
        slices: estimate::slices(&measured, 0).map_err(few)?,
        radial: power.radial(),
        projection: estimate::projection(&measured, 0).map_err(few)?,
        in_window: measured.tally(0).inside,
        noise_dof: if rays.0.len() < 3 {
            None
        } else {
            noise_dof(&measured, 0).map_err(few)?
        },
        batches: rays.0.len(),
        measurement: measured.clone(),
        numbers: [
            ("slope", power.statistic(|p| shear_slope(p, grid))),
            ("bandwidth_rho", along_rho(&power)),
            ("bandwidth_nu", along_nu(&power)),
            ("variation_rho", along_rho(&varying)),
            ("variation_nu", along_nu(&varying)),
        ],
    })
}

impl Spectrum {
    pub(crate) fn arrays(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let grid = self.slices.mean.grid;
        let azimuth = (0..grid.azimuths).map(|k| grid.azimuth(k)).collect();
        let [x, u] = cells(&self.projection.mean.grid);
        let sigma = self.slices.variance.mapv(f64::sqrt);
        let all = Arrays::new(py)
            .add::<f64, _>("azimuth", azimuth)?
            .add("rho", Array1::from(grid.rho.values()))?
            .add("nu", Array1::from(grid.nu.values()))?
            .add("slices", self.slices.mean.full())?
            .add("slices_sigma", grid.unfold_even(sigma.view()))?
            .add("power", self.radial.power)?
            .add("power_sigma", self.radial.sigma)?
            .add("shot_noise", self.radial.shot_noise)?
            .add("x", x)?
            .add("u", u)?
            .add("light_field", self.projection.mean.values)?
            .add("light_field_sigma", self.projection.standard_error)?
            .finish();
        all.set_item("in_window", self.in_window)?;
        all.set_item("noise_dof", self.noise_dof)?;
        all.set_item("batches", self.batches)?;
        all.set_item("measurement", outcome::Measurement(self.measurement))?;
        for (name, number) in self.numbers {
            all.set_item(name, number.map(|n| (n.value, n.error)))?;
        }
        Ok(all)
    }
}
