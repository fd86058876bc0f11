//! Searches a change with which a prediction that failed would agree with the measurement.

use crate::residuals::Residuals;
use etendue_field::{Complex, Slices, brief};
use etendue_spectrum::Measurement;
use ndarray::{Array3, Axis, Zip};

/// A change of the coordinates of a light field: its words, the place on a circle of 2K azimuths
/// πk/K from which the slice at azimuth k comes, and whether ν is reversed. Slices at φ + π are the
/// complex conjugates of slices at φ, because a light field is real.
type ConventionChange = (&'static str, fn(usize, usize) -> usize, bool);

const UNCHANGED: ConventionChange = ("", |k, _| k, false);

/// Conventions that theories mistake. A Fourier transform whose exponent has the opposite sign
/// reverses all coordinates.
const CHANGES: [ConventionChange; 6] = [
    ("reversed in x, y, u and v", |k, n| k + n, false),
    ("reversed in u and v", |k, _| k, true),
    ("reversed in x and y", |k, n| k + n, true),
    ("reversed in y and v", |k, n| 2 * n - k, false),
    ("reversed in x and u", |k, n| n - k, false),
    // To azimuth 90° − φ. If 90° is not an azimuth, the change is another one, which agrees with
    // nothing.
    (
        "exchanged, x with y and u with v",
        |k, n| n / 2 + 2 * n - k,
        false,
    ),
];

/// The number of standard errors by which a factor is different from 1.
const DIFFERENT: f64 = 4.0;
/// The smallest p-value that a change is named with. A factor near 1 that explains a part of another
/// mistake has a smaller one.
const NAMED: f64 = 0.05;

/// States with which change a prediction would agree with the measurement of plane `index`, if
/// there is one: a factor, or coordinates that are reversed or exchanged, or both. `variance` is
/// the variance of the mean residual.
pub(crate) fn hint(
    (measurement, index): (&Measurement, usize),
    measured: &Slices,
    predicted: &Slices,
    replicates: &[Slices],
    variance: &Array3<f64>,
    seed: u64,
) -> Option<String> {
    let fit = |change| {
        let changed = changed(predicted, change);
        (change, Fit::new(&changed.half, &measured.half, variance))
    };
    let closest = CHANGES
        .map(fit)
        .into_iter()
        .min_by(|(_, a), (_, b)| a.left.total_cmp(&b.left));
    [Some(fit(UNCHANGED)), closest]
        .into_iter()
        .flatten()
        .find_map(|(change, Fit { factor, error, .. })| {
            let scaled = |slices: &Slices| {
                let mut slices = changed(slices, change);
                slices.half.mapv_inplace(|value| value * factor);
                slices
            };
            let replicates: Vec<Slices> = replicates.iter().map(scaled).collect();
            let residuals = Residuals::between(measurement, index, &scaled(predicted), &replicates);
            let p_value = residuals.p_value(seed)?;
            let differs = (factor - 1.0).abs() > DIFFERENT * error;
            let times = differs.then(|| format!("multiplied by {}", four_digits(factor)));
            let reversed = Some(change.0.to_owned()).filter(|words| !words.is_empty());
            let words: Vec<String> = times.into_iter().chain(reversed).collect();
            (p_value >= NAMED && !words.is_empty()).then(|| {
                format!(
                    "the prediction would agree, p = {p_value:.3}, if it were {}",
                    words.join(" and ")
                )
            })
        })
}

/// The real factor with which a prediction is closest to a measurement in units of its noise.
struct Fit {
    factor: f64,
    error: f64,
    /// The squared distance that is left.
    left: f64,
}

impl Fit {
    fn new(
        predicted: &Array3<Complex>,
        measured: &Array3<Complex>,
        variance: &Array3<f64>,
    ) -> Self {
        let [mut cross, mut own, mut all] = [0.0; 3];
        Zip::from(predicted)
            .and(measured)
            .and(variance)
            .for_each(|f, m, v| {
                if *v > 0.0 {
                    cross += (f.conj() * m).re / v;
                    own += f.norm_sqr() / v;
                    all += m.norm_sqr() / v;
                }
            });
        Self {
            factor: cross / own,
            error: (0.5 / own).sqrt(),
            left: all - cross * cross / own,
        }
    }
}

fn four_digits(x: f64) -> String {
    let unit = libm::pow(10.0, libm::log10(x.abs()).floor() - 3.0);
    brief((x / unit).round() * unit)
}

fn changed(slices: &Slices, (_, azimuth, reverses_nu): ConventionChange) -> Slices {
    let mut changed = Slices::zeros(slices.grid);
    let azimuths = slices.grid.azimuths;
    for (k, mut half) in changed.half.outer_iter_mut().enumerate() {
        let from = azimuth(k, azimuths) % (2 * azimuths);
        let mut own = slices.half.index_axis(Axis(0), from % azimuths);
        if reverses_nu {
            own.invert_axis(Axis(1));
        }
        half.assign(&own);
        if from >= azimuths {
            half.mapv_inplace(|value| value.conj());
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;
    use etendue_field::{FrequencyAxis, SliceGrid};

    /// Slices of rays at the given coordinates.
    fn slices(rays: &[[f64; 4]]) -> Slices {
        let axis = FrequencyAxis {
            half: 3,
            spacing: 1.0,
        };
        let grid = SliceGrid {
            azimuths: 4,
            rho: axis,
            nu: axis,
        };
        let mut slices = Slices::zeros(grid);
        for ((k, m, n), value) in slices.half.indexed_iter_mut() {
            let omega = grid.frequency(k, grid.rho.value(m + 3), grid.nu.value(n));
            for ray in rays {
                let phase: f64 = omega.iter().zip(ray).map(|(a, b)| a * b).sum();
                *value += Complex::from_polar(1.0, -std::f64::consts::TAU * phase);
            }
        }
        slices
    }

    #[test]
    fn changes_of_slices_are_changes_of_rays() {
        let rays = [[0.1, -0.23, 0.31, 0.17], [-0.05, 0.4, 0.02, -0.33]];
        let signs = [
            [-1.0; 4],
            [1.0, 1.0, -1.0, -1.0],
            [-1.0, -1.0, 1.0, 1.0],
            [1.0, -1.0, 1.0, -1.0],
            [-1.0, 1.0, -1.0, 1.0],
        ];
        let signed = signs.map(|signs| rays.map(|ray| std::array::from_fn(|i| signs[i] * ray[i])));
        let exchanged = rays.map(|[x, y, u, v]| [y, x, v, u]);
        for (change, rays_of) in CHANGES
            .into_iter()
            .zip(signed.into_iter().chain([exchanged]))
        {
            let apart = &changed(&slices(&rays), change).half - &slices(&rays_of).half;
            // The tolerance is the rounding of phases.
            assert!(
                apart.iter().all(|value| value.norm() < 1e-12),
                "{}",
                change.0
            );
        }
    }
}
