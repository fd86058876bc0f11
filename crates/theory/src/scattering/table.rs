//! A light field at the nodes of a rule, and what is summed over them.

use super::field::Field;
use super::incoming::Rule as LightRule;
use super::rule::Rule;
use crate::geometry::Matrix;
use crate::rays::Plane;
use etendue_field::{Complex, SliceGrid, Slices, TwoPlane, Window};
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The windowed light field at the nodes of a rule, times their volume.
pub(super) struct Table {
    coordinates: [Vec<f64>; 4],
    /// [(x, y), (u, v)].
    values: Array2<f64>,
}

impl Table {
    pub(super) fn new<F: Field>(field: &F, plane: &Plane, window: &Window, rule: Rule) -> Self {
        let profiles = [window.x, window.y, window.u, window.v];
        let coordinates: [Vec<f64>; 4] = std::array::from_fn(|axis| {
            let (n, half) = (rule.plane[axis], profiles[axis].half_width());
            (0..n)
                .map(|i| half * ((2.0 * i as f64 + 1.0) / n as f64 - 1.0))
                .collect()
        });
        let volume: f64 = (0..4)
            .map(|axis| 2.0 * profiles[axis].half_width() / rule.plane[axis] as f64)
            .product();
        let light = LightRule::new(rule.light, &field.system().light);
        let [xs, ys, us, vs] = &coordinates;
        let rows: Vec<Vec<f64>> = (0..xs.len() * ys.len())
            .into_par_iter()
            .map(|row| {
                let (x, y) = (xs[row / ys.len()], ys[row % ys.len()]);
                // On the surface itself one place is seen in all directions.
                let one_place = plane.orientation.is_local();
                let mut shared = None;
                let mut values = Vec::with_capacity(us.len() * vs.len());
                for &u in us {
                    for &v in vs {
                        let z = [x, y, u, v];
                        let weight = window.value(&TwoPlane { x, y, u, v });
                        let Some(leaving) = field.leaving(z).filter(|_| weight > 0.0) else {
                            values.push(0.0);
                            continue;
                        };
                        let shines = match shared.take() {
                            Some(shines) => shines,
                            None => field.shines(&leaving, &light),
                        };
                        let radiance = field.radiance(&leaving, &shines);
                        if one_place {
                            shared = Some(shines);
                        }
                        values.push(volume * weight * plane.factor(z) * radiance);
                    }
                }
                values
            })
            .collect();
        let values = Array2::from_shape_fn((rows.len(), us.len() * vs.len()), |(i, j)| rows[i][j]);
        Self {
            coordinates,
            values,
        }
    }

    pub(super) fn slices(&self, grid: &SliceGrid) -> Slices {
        let mut slices = Slices::zeros(*grid);
        let [xs, ys, us, vs] = &self.coordinates;
        let each: Vec<Array2<Complex>> = (0..grid.azimuths)
            .into_par_iter()
            .map(|k| {
                let (sin, cos) = grid.azimuth(k).sin_cos();
                // Along one azimuth a place is one number, and so are slopes.
                let waves = |a: &[f64], b: &[f64], frequencies: &[f64]| {
                    let places: Vec<f64> = a
                        .iter()
                        .flat_map(|p| b.iter().map(move |q| p * cos + q * sin))
                        .collect();
                    let phase = |i: usize, j: usize| -TAU * frequencies[i] * places[j];
                    let shape = (frequencies.len(), places.len());
                    [
                        Array2::from_shape_fn(shape, |(i, j)| phase(i, j).cos()),
                        Array2::from_shape_fn(shape, |(i, j)| phase(i, j).sin()),
                    ]
                };
                let rho: Vec<f64> = (0..=grid.rho.half)
                    .map(|m| m as f64 * grid.rho.spacing)
                    .collect();
                let [re, im] = waves(xs, ys, &rho).map(|wave| wave.dot(&self.values));
                let [cos, sin] = waves(us, vs, &grid.nu.values());
                let real = re.dot(&cos.t()) - im.dot(&sin.t());
                let imaginary = re.dot(&sin.t()) + im.dot(&cos.t());
                Array2::from_shape_fn(real.dim(), |at| Complex::new(real[at], imaginary[at]))
            })
            .collect();
        for (mut slice, values) in slices.half.axis_iter_mut(Axis(0)).zip(each) {
            slice.assign(&values);
        }
        slices
    }

    /// Each value with its coordinates.
    fn nodes(&self) -> impl Iterator<Item = ([f64; 4], f64)> + '_ {
        let [xs, ys, us, vs] = &self.coordinates;
        self.values.indexed_iter().map(move |((i, j), value)| {
            let z = [
                xs[i / ys.len()],
                ys[i % ys.len()],
                us[j / vs.len()],
                vs[j % vs.len()],
            ];
            (z, *value)
        })
    }

    /// Sums over y and v, [x, u].
    pub(super) fn projected(&self) -> Array2<f64> {
        let [xs, ys, us, vs] = &self.coordinates;
        let mut sums = Array2::zeros((xs.len(), us.len()));
        for ((i, j), value) in self.values.indexed_iter() {
            sums[[i / ys.len(), j / vs.len()]] += value;
        }
        sums
    }

    pub(super) fn covariance(&self) -> Option<Matrix<4>> {
        let total = self.values.sum();
        if total <= 0.0 {
            return None;
        }
        let mut mean = [0.0; 4];
        for (z, value) in self.nodes() {
            for (mean, z) in mean.iter_mut().zip(z) {
                *mean += value / total * z;
            }
        }
        let mut moments = [[0.0; 4]; 4];
        for (z, value) in self.nodes() {
            for i in 0..4 {
                for j in 0..4 {
                    moments[i][j] += value / total * (z[i] - mean[i]) * (z[j] - mean[j]);
                }
            }
        }
        Some(moments)
    }
}
