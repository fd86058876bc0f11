//! Compares the covariance that is traced along a chain with the covariance of the exact spectrum
//! and with the covariance of the measured spectrum.

use crate::applicability::Applicability;
use crate::theories::Theory;
use etendue_compare::Class;
use etendue_compare::Pair;
use etendue_compare::Prediction;
use etendue_field::{FieldGrid, SliceGrid, VirtualPlane, percent, tidy};
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::field::{FieldCovariance, Moments, PowerMoments};
use etendue_spectrum::moments::second_moment;
use etendue_spectrum::{CrossPower, Measurement};
use etendue_theory::Harmonics;
use etendue_theory::covariance::{SpectralCovariance, Traced, Untraced, power, window};
use etendue_theory::geometry::Matrix;
use ndarray::{Array2, Axis};
use serde::Serialize;

/// The covariance of the power spectrum of a plane, ∫ P Ω Ωᵀ/∫ P over (ρx, ρy, νu, νv), by every
/// available method.
///
/// The unit of an entry is cycles² over the units of its two coordinates. The spectrum of a field
/// with edges has no second moments, so all matrices except `traced` are computed over the same
/// band of frequencies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CovarianceReport {
    /// Name of the plane.
    pub name: String,
    /// Kind of the plane's prediction.
    pub class: Class,
    /// The largest frequency along each axis, cycles per metre and per unit slope.
    pub band: [f64; 4],
    /// The result of covariance tracing, in which the window is the last step. The covariance is
    /// `None` where covariance tracing gives no result or an infinite spectrum.
    pub traced: Option<Matrix<4>>,
    /// The reason why covariance tracing gives no result, in words.
    pub untraced: Option<String>,
    /// The covariance of the traced Gaussian, computed over the band.
    pub traced_in_band: Option<Matrix<4>>,
    /// The covariance of the exact spectrum. It is known only between parallel planes, where theory
    /// gives the spectrum at any four frequencies.
    pub exact: Option<Matrix<4>>,
    /// The covariance measured by the photons, corrected for the bias that noise causes.
    pub measured: Option<Matrix<4>>,
    /// Standard errors of `measured`, by the jackknife over groups of batches.
    pub error: Option<Matrix<4>>,
    /// The growth of each measured variance: its value over the whole band divided by its value
    /// over half of the band.
    pub growth: Option<[f64; 4]>,
    /// The largest difference between `traced_in_band` and `measured`, divided by the geometric
    /// mean of the two variances. The second number is the error of `measured`, divided by the same
    /// mean.
    pub off: Option<[f64; 2]>,
    /// Moments ρρ, ρν and νν of the slice at azimuth 0, where the frequencies along y are zero.
    pub slice: [SliceMoment; 3],
    /// Remarks on the numbers, in words.
    pub remarks: Vec<String>,
}

/// A second moment of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SliceMoment {
    /// By covariance tracing.
    pub traced: Option<f64>,
    /// The moment of the photons, and the moment of the exact prediction.
    #[serde(flatten)]
    pub found: Pair,
}

/// The Gaussian that covariance tracing assigns to a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedPlane {
    /// The covariance C of the power spectrum; `None` where it is infinite.
    pub matrix: Option<Matrix<4>>,
    /// S, the covariance of the Gaussian light field; `None` where it is infinite.
    field: Option<Matrix<4>>,
}

impl TracedPlane {
    /// The covariance that is traced to a plane. The last step is the window.
    ///
    /// # Errors
    /// Returns the reason if covariance tracing gives no result.
    pub fn new(plane: &VirtualPlane, applicability: &Applicability) -> Result<Self, String> {
        let traced: Result<SpectralCovariance, Untraced> = match &applicability.theory {
            Theory::Parallel(chain) => chain.spectral_covariance(),
            Theory::Path(view) => view.spectral_covariance(),
            Theory::None => return Err("there is no chain for this plane".to_owned()),
        };
        let seen = traced.map_err(|reason| reason.to_string())?;
        let seen = seen.multiplied(&window(&plane.window));
        Ok(Self {
            matrix: seen.matrix(),
            field: seen.field(),
        })
    }

    /// The moments of the Gaussian over a band.
    fn in_band(&self, moments: &Moments) -> Option<Matrix<4>> {
        let field = self.field.as_ref()?;
        moments
            .at_frequencies(|omega| power(field, omega))
            .covariance()
    }

    /// The power of the Gaussian at the frequencies of a slice.
    fn on_slice(&self, grid: &SliceGrid) -> Option<Array2<f64>> {
        let field = self.field.as_ref()?;
        let shape = (grid.rho.count(), grid.nu.count());
        Some(Array2::from_shape_fn(shape, |(i, j)| {
            power(field, [grid.rho.value(i), 0.0, grid.nu.value(j), 0.0])
        }))
    }
}

impl CovarianceReport {
    /// The covariances of plane `index` of a measurement, whose light field was also
    /// measured on the grid `grid`.
    ///
    /// # Errors
    /// Returns an error if the measurement has too few batches for standard errors.
    pub fn new(
        (measurement, index): (&Measurement, usize),
        (grid, measured): (&FieldGrid, &FieldCovariance),
        applicability: &Applicability,
        prediction: &Prediction,
    ) -> Result<Self, TooFewBatches> {
        let plane = &measurement.planes()[index];
        let traced = TracedPlane::new(plane, applicability);
        let moments = Moments::new(*grid, &plane.grid);
        let exact = exact(applicability, plane, grid, &moments);
        let estimate = measured.estimate();
        let found = estimate.map(|estimate| estimate.value);
        let traced_in_band = traced
            .as_ref()
            .ok()
            .and_then(|traced| traced.in_band(&moments));
        let growth = measured.growth();
        let mut report = Self {
            name: plane.name.clone(),
            class: prediction.class,
            band: measured.band,
            traced: traced.as_ref().ok().and_then(|traced| traced.matrix),
            untraced: traced.as_ref().err().cloned(),
            traced_in_band,
            exact: exact.and_then(|exact| exact.covariance()),
            measured: found,
            error: estimate.map(|estimate| estimate.error),
            growth,
            off: None,
            slice: slice(measurement, index, prediction, traced.as_ref().ok())?,
            remarks: Vec::new(),
        };
        if let (Some(traced), Some(estimate)) = (traced_in_band, estimate) {
            let value = &estimate.value;
            let by = |of: &dyn Fn(usize, usize) -> f64| largest(value, of);
            let off = by(&|i, j| traced[i][j] - value[i][j]);
            report.off = Some([off, by(&|i, j| estimate.error[i][j])]);
        }
        report.remarks = report.remarks_of();
        Ok(report)
    }

    /// Returns remarks on the limits of the numbers.
    fn remarks_of(&self) -> Vec<String> {
        let mut remarks: Vec<String> = self.untraced.iter().cloned().collect();
        if self.untraced.is_none() && self.traced.is_none() {
            remarks.push(
                "according to covariance tracing, the spectrum is unbounded, as for light from a point; within the band it is a ridge"
                    .to_owned(),
            );
        }
        let share = |axis: usize| Some(self.error?[axis][axis] / self.measured?[axis][axis]);
        let is_grown = |axis: usize, growth: f64| {
            let noise = share(axis).map(|share| NOISE * share * growth.abs());
            noise.is_some_and(|noise| growth - noise > ENDLESS)
        };
        let grown = self.growth.iter().flatten().zip(AXES).enumerate();
        let grown = grown.filter(|(axis, (growth, _))| is_grown(*axis, **growth));
        let grown = grown.map(|(_, found)| found);
        let axes: Vec<String> = grown
            .map(|(growth, axis)| {
                format!("{axis} (times {})", tidy((growth * 100.0).round() / 100.0))
            })
            .collect();
        if !axes.is_empty() {
            remarks.push(format!(
                "the variance along {} grows over the outer half of the band, which contains replicas, tails of edges or other parts of the spectrum. The variance covers only the band",
                axes.join(", ")
            ));
        }
        if let Some([off, error]) = self.off {
            remarks.push(format!(
                "the matrices of covariance tracing and of the photons differ by {} of the variances; the noise is {}",
                percent(off, 1),
                percent(error, 1)
            ));
        }
        remarks
    }
}

/// Growth by more than this number of standard errors is not attributed to noise. Noise alone
/// exceeds this limit once in a thousand cases.
const NOISE: f64 = 3.0;

/// Names of the axes.
pub const AXES: [&str; 4] = ["ρx", "ρy", "νu", "νv"];

/// If a variance over the whole band is larger than the variance over half of the band by more than
/// this factor, the band limits the variance. The variance of a Gaussian grows by 10 % if the band
/// ends at five of its standard deviations, and by 3 % if the band ends at six.
const ENDLESS: f64 = 1.15;

/// Divides each entry by the geometric mean of two variances, which are the variances along the
/// entry's two axes. Returns the largest result.
fn largest(of: &Matrix<4>, entry: &dyn Fn(usize, usize) -> f64) -> f64 {
    let pairs = (0..4).flat_map(|i| (0..4).map(move |j| (i, j)));
    let shares = pairs.map(|(i, j)| entry(i, j).abs() / (of[i][i] * of[j][j]).abs().sqrt());
    shares.fold(0.0, f64::max)
}

/// The covariance of the exact spectrum if theory gives the spectrum at any frequency in
/// closed form.
fn exact(
    applicability: &Applicability,
    plane: &VirtualPlane,
    grid: &FieldGrid,
    moments: &Moments,
) -> Option<PowerMoments> {
    let Theory::Parallel(chain) = &applicability.theory else {
        return None;
    };
    if applicability.dark.is_some() {
        return None;
    }
    let axes = [0, 1, 2, 3];
    let spacing = axes.map(|axis| grid.spacing(axis));
    let half = axes.map(|axis| grid.cells[axis] / 2);
    let harmonics = Harmonics::new(chain, &plane.window, spacing, half)?;
    Some(moments.of(|index| {
        let multiples = axes.map(|axis| grid.harmonic(axis, index[axis]));
        harmonics.at(multiples).norm_sqr()
    }))
}

/// The moments of the slice at azimuth 0.
fn slice(
    measurement: &Measurement,
    index: usize,
    prediction: &Prediction,
    traced: Option<&TracedPlane>,
) -> Result<[SliceMoment; 3], TooFewBatches> {
    let grid = &measurement.planes()[index].grid;
    let measured = CrossPower::of_slice(measurement, index, 0)?;
    let predicted = predicted_slice(prediction);
    let traced = traced.and_then(|traced| traced.on_slice(grid));
    Ok([[2, 0], [1, 1], [0, 2]].map(|powers| {
        let of = |power: &Array2<f64>| second_moment(power.view(), grid, powers);
        let measured = measured.statistic(|power| second_moment(power, grid, powers));
        SliceMoment {
            traced: traced.as_ref().and_then(of),
            found: Pair {
                measured: measured.map(|m| m.value),
                predicted: predicted.as_ref().and_then(of),
                error: measured.map(|m| m.error),
            },
        }
    }))
}

/// |F|² of theory at azimuth 0, [ρ, ν]. The power is computed from pairs of replicates, as
/// a measured power is computed from pairs of batches. Returns `None` where the measurement of
/// another tracer replaces theory.
fn predicted_slice(prediction: &Prediction) -> Option<Array2<f64>> {
    if prediction.class == Class::Reference {
        return None;
    }
    let grid = &prediction.slices.grid;
    if !prediction.replicates.is_empty() {
        let crossed = CrossPower::of_replicates(&prediction.replicates, 0..1);
        return Some(crossed.ok()?.power());
    }
    let power = prediction.slices.half.index_axis(Axis(0), 0);
    Some(grid.unfold_radial(power.mapv(|s| s.norm_sqr()).view()))
}
