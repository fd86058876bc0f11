//! The prediction of a fit: the slices of a scene as a function of its free fields.

use crate::fit::data::FitPlane;
use etendue_compare::{Class, NormalEquations, Prediction, Residuals};
use etendue_field::{Complex, SliceGrid, Slices};
use etendue_predict::{Applicability, predict};
use etendue_scene::Scene;
use etendue_store::Failure;
use ndarray::{Array2, Array3, Axis};
use rayon::prelude::*;
use std::ops::Range;

/// A scene whose fields are free, and the planes that its predictions are compared with.
pub struct FitModel<'a> {
    /// The scene in which the free fields have the given values.
    pub scene_at: &'a (dyn Fn(&[f64]) -> Result<Scene, Failure> + Sync),
    /// Names of the free fields.
    pub fields: &'a [String],
    /// The measured planes.
    pub planes: &'a [FitPlane],
}

impl std::fmt::Debug for FitModel<'_> {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { fields, planes, .. } = self;
        let model = &mut to.debug_struct("FitModel");
        model
            .field("fields", fields)
            .field("planes", planes)
            .finish_non_exhaustive()
    }
}

/// The predictions at a point, with the derivative of each plane's slices by each field.
pub(super) struct Linearised {
    pub(super) predictions: Vec<Prediction>,
    /// For each plane, an array for each field.
    pub(super) derivatives: Vec<Vec<Array3<Complex>>>,
}

/// The first step of a finite difference, as a share of the value; or the step itself where the
/// value is 0.
const FIRST_STEP: f64 = 0.01;
/// The smallest step of a finite difference, as a share of the value. Where rays sample a
/// prediction, smaller steps would compare single rays.
const MIN_STEP: f64 = 1e-5;
/// The step of a finite difference, in errors of a field whose noise is independent at all
/// frequencies. The error of the derivative is then small where the fit is linear.
const STEP_ERRORS: f64 = 3.0;

/// The largest number of groups of batches: the Fisher information takes a time that is cubic in their number.
const MAX_GROUPS: usize = 1024;

/// The size of a field for steps and ranges.
pub(crate) fn size(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value.abs() }
}

/// The steps of finite differences before the noise of the fields is known.
pub(super) fn first_steps(values: &[f64]) -> Vec<f64> {
    values.iter().map(|of| FIRST_STEP * size(*of)).collect()
}

/// The steps of finite differences after a linearisation with this information.
pub(super) fn steps(values: &[f64], information: &Array2<f64>) -> Vec<f64> {
    let each = values.iter().zip(information.diag());
    each.map(|(value, information)| {
        let size = size(*value);
        (STEP_ERRORS / information.sqrt()).clamp(MIN_STEP * size, FIRST_STEP * size)
    })
    .collect()
}

/// The frequencies of a grid up to a share of the largest.
fn coarse(mut grid: SliceGrid, share: f64) -> SliceGrid {
    for axis in [&mut grid.rho, &mut grid.nu] {
        let half = etendue_field::whole((share * axis.half as f64).ceil());
        axis.half = half.clamp(axis.half.min(1), axis.half);
    }
    grid
}

/// The part of an array [azimuth, ρ ≥ 0, ν] on a coarse grid.
fn cropped<T: Clone>(all: &Array3<T>, grid: &SliceGrid) -> Array3<T> {
    let first = all.dim().2 / 2 - grid.nu.half;
    let rho = all.slice_axis(Axis(1), (..=grid.rho.half).into());
    let nu = (first..first + grid.nu.count()).into();
    rho.slice_axis(Axis(2), nu).to_owned()
}

impl FitModel<'_> {
    /// The prediction of each measured plane, at frequencies up to a share of the largest.
    pub(super) fn predict(&self, values: &[f64], share: f64) -> Result<Vec<Prediction>, Failure> {
        let scene = (self.scene_at)(values)?;
        let each = self.planes.iter().map(|data| {
            let mut plane = scene.planes[data.index].clone();
            if plane.grid != data.plane.grid || plane.window != data.plane.window {
                return Err(Failure::bad_input(format!(
                    "the window or the frequencies of plane {} depend on {}: they are a choice of the measurement, so they cannot be fitted",
                    plane.name,
                    self.fields.join(", ")
                )));
            }
            let theory = Applicability::new(&scene, &plane);
            if theory.class() == Class::Reference {
                return Err(Failure::bad_input(format!(
                    "plane {} has no theory: {}; name other planes with --plane",
                    plane.name,
                    theory.reasons.join("; ")
                )));
            }
            plane.grid = coarse(data.plane.grid, share);
            Ok(predict(&scene, &plane, &theory))
        });
        each.collect()
    }

    /// The central differences of predictions at a point, with the given steps. At the end
    /// of the range of a field, the difference is one-sided.
    pub(super) fn linearised(
        &self,
        values: &[f64],
        predictions: Vec<Prediction>,
        steps: &[f64],
        share: f64,
    ) -> Result<Linearised, Failure> {
        let moved = |i: usize, by: f64| {
            let mut moved = values.to_vec();
            moved[i] += by;
            self.predict(&moved, share)
        };
        let all: Vec<_> = (0..2 * values.len())
            .into_par_iter()
            .map(|k| moved(k / 2, if k % 2 == 0 { 1.0 } else { -1.0 } * steps[k / 2]))
            .collect();
        let mut all = all.into_iter();
        let mut derivatives = vec![Vec::new(); self.planes.len()];
        for step in steps {
            let [ahead, behind] = [all.next(), all.next()].map(|one| one.expect("two points"));
            let sides = usize::from(ahead.is_ok()) + usize::from(behind.is_ok());
            let here = || predictions.clone();
            let (ahead, behind) = match (ahead, behind) {
                (Err(failure), Err(_)) => return Err(failure),
                (ahead, behind) => (
                    ahead.unwrap_or_else(|_| here()),
                    behind.unwrap_or_else(|_| here()),
                ),
            };
            let scale = Complex::from(1.0 / (sides as f64 * step));
            for (plane, (a, b)) in derivatives.iter_mut().zip(ahead.iter().zip(&behind)) {
                plane.push((&a.slices.half - &b.slices.half) * scale);
            }
        }
        Ok(Linearised {
            predictions,
            derivatives,
        })
    }

    /// Σ |S − F|²/σ² over the independent frequencies of all planes, up to a share of the largest.
    pub(super) fn chi2(&self, predictions: &[Prediction]) -> f64 {
        let pairs = self.planes.iter().zip(predictions);
        let of_plane = |(data, prediction): (&FitPlane, &Prediction)| {
            let grid = &prediction.slices.grid;
            let apart = cropped(&data.mean, grid) - &prediction.slices.half;
            let variance = cropped(&data.variance, grid);
            let cells = apart.indexed_iter().zip(&variance);
            let terms = cells
                .filter(|(((_, m, n), _), v)| grid.is_independent(*m, *n) && **v > 0.0)
                .map(|((_, apart), v)| apart.norm_sqr() / v);
            terms.sum::<f64>()
        };
        pairs.map(of_plane).sum()
    }

    /// The normal equations of the mean residual, with one row of scores.
    pub(super) fn equations(&self, at: &Linearised) -> NormalEquations {
        let each = self.planes.iter().zip(&at.predictions).zip(&at.derivatives);
        let each = each.map(|((data, prediction), derivatives)| {
            let grid = prediction.slices.grid;
            let apart = cropped(&data.mean, &grid) - &prediction.slices.half;
            let residuals = Residuals::of(grid, vec![apart]);
            NormalEquations::new(&residuals, &cropped(&data.variance, &grid), derivatives)
        });
        summed(each)
    }

    /// The residuals of all batches at each plane, in as many groups at all planes.
    pub(super) fn residuals(&self, at: &Linearised) -> Vec<Residuals> {
        let each = self.planes.iter().zip(&at.predictions);
        let each = each.map(|(data, prediction)| {
            let batches: Vec<&Slices> = data.batches.iter().collect();
            Residuals::between_samples(&batches, &prediction.slices, &prediction.replicates)
        });
        let each: Vec<Residuals> = each.collect();
        let groups = each.iter().map(Residuals::count).min().unwrap_or(0);
        let groups = groups.min(MAX_GROUPS);
        each.into_iter().map(|of| of.grouped(groups)).collect()
    }

    /// The normal equations of some planes, with a row of scores for each residual.
    pub(super) fn each(
        &self,
        at: &Linearised,
        residuals: &[Residuals],
        planes: Range<usize>,
    ) -> NormalEquations {
        summed(planes.map(|i| {
            NormalEquations::new(&residuals[i], &self.planes[i].variance, &at.derivatives[i])
        }))
    }
}

/// The equations of several planes.
fn summed(each: impl Iterator<Item = NormalEquations>) -> NormalEquations {
    each.reduce(|a, b| a.plus(&b)).expect("a plane")
}

/// The information matrix divided by the roots of its diagonal, so that the diagonal is 1.
pub(super) fn scaled(information: &Array2<f64>) -> Array2<f64> {
    let roots = information.diag().mapv(f64::sqrt);
    information / &roots / &roots.insert_axis(Axis(1))
}
