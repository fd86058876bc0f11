//! The power of a light field in dyadic bands of the window, measured by photons.
//!
//! Along each axis, the window is halved again and again: level s has 2^s intervals. The band (s_x,
//! s_u, s_y, s_v) holds what the means of f over blocks of these levels have, and the means over
//! larger blocks do not have (the nested ANOVA of Owen 1997, *Monte Carlo variance of scrambled net
//! quadrature*). Let E_r be the mean square of the means over the blocks of level r. Then the power
//! W_s of a band is the difference of E along each axis, and E_r = Σ_(s≤r) W_s.

use crate::variance::VarianceError;
use crate::variance::power_estimate::{GroupShares, PowerEstimate};
use crate::variance::sampler::indices;
use etendue_field::{Crossing, PhotonSource, VirtualPlane};
use etendue_spectrum::estimate::TooFewBatches;
use etendue_spectrum::field::FieldOptions;
use rayon::prelude::*;

/// The finest level that is measured along each axis.
pub(crate) const FINEST: usize = 5;

/// Number of intervals of the finest level.
const CELLS: usize = 1 << FINEST;

/// Number of levels along each axis.
const LEVELS: usize = FINEST + 1;

/// The minimum number of groups for a jackknife.
const MIN_GROUPS: usize = 3;

/// All bands up to a level, in row-major order of (x, u, y, v).
pub(crate) fn bands(finest: usize) -> impl Iterator<Item = [usize; 4]> {
    let n = finest + 1;
    (0..n.pow(4)).map(move |i| indices(i, n))
}

/// Measures the power in dyadic bands at a plane with a [Box window](super::box_window), which is
/// plane 0 of `source`. `progress` is called with the number of photons as they are traced.
///
/// # Errors
///
/// Fails if fewer than three batches have photons.
pub fn dyadic_power(
    plane: &VirtualPlane,
    (source, batches): (&dyn PhotonSource, u32),
    progress: &(dyn Fn(u64) + Sync),
) -> Result<PowerEstimate, VarianceError> {
    let batches: Vec<u32> = (0..batches)
        .filter(|batch| source.emitted(*batch) > 0)
        .collect();
    if batches.len() < MIN_GROUPS {
        return Err(VarianceError::TooFewBatches(TooFewBatches {
            have: batches.len(),
            need: MIN_GROUPS,
        }));
    }
    let groups = FieldOptions::default().groups.min(batches.len());
    let members = |group: usize| {
        let members = batches.iter().skip(group).step_by(groups);
        members.copied().collect::<Vec<_>>()
    };
    let each = (0..groups)
        .into_par_iter()
        .map(|group| block_means(plane, source, &members(group), batches.len(), progress));
    let each: Vec<Vec<f64>> = each.collect();
    let share = |group| members(group).len() as f64 / batches.len() as f64;
    let shares = GroupShares::new((0..groups).map(share).collect());
    let mut sum = vec![0.0; each[0].len()];
    for group in &each {
        sum.iter_mut()
            .zip(group)
            .for_each(|(sum, value)| *sum += value);
    }
    let of_group = each.into_par_iter().map(|group| {
        let others: Vec<f64> = sum.iter().zip(&group).map(|(sum, own)| sum - own).collect();
        in_bands(mean_products([group, others]))
    });
    let products: Vec<Vec<f64>> = of_group.collect();
    Ok(estimate(&shares, &products))
}

/// The power in bands from the products of each group with all others.
fn estimate(shares: &GroupShares, products: &[Vec<f64>]) -> PowerEstimate {
    let all: Vec<[usize; 4]> = bands(FINEST).collect();
    let of_band = |band: usize| products.iter().map(|group| group[band]).collect();
    // Band 0 is the square of the mean.
    let of_bands: Vec<Vec<f64>> = (1..all.len()).map(of_band).collect();
    let powers = |of: &dyn Fn(&[f64]) -> f64| {
        let bands = of_bands.iter().map(|products| of(products));
        std::iter::once(0.0).chain(bands).collect::<Vec<f64>>()
    };
    let without = |r| powers(&|products| shares.power_without(products, r));
    PowerEstimate {
        power: powers(&|products| shares.power(products)),
        without_group: (0..products.len()).map(without).collect(),
        is_last: all.iter().map(|band| band.contains(&FINEST)).collect(),
    }
}

/// The means of f over the blocks of the finest level, in row-major order of (x, u, y, v),
/// times the share of these batches in `all` batches.
fn block_means(
    plane: &VirtualPlane,
    source: &dyn PhotonSource,
    batches: &[u32],
    all: usize,
    progress: &(dyn Fn(u64) + Sync),
) -> Vec<f64> {
    let window = &plane.window;
    let half_widths = [window.x, window.u, window.y, window.v].map(|p| p.half_width());
    let volume: f64 = half_widths.iter().map(|h| 2.0 * h / CELLS as f64).product();
    let mut cells = vec![0.0; CELLS.pow(4)];
    for batch in batches {
        let scale = 1.0 / (source.emitted(*batch) as f64 * all as f64 * volume);
        let record = &mut |index: usize, crossings: &[Crossing]| {
            for Crossing { ray, weight } in crossings {
                if index != 0 || !window.contains(ray) {
                    continue;
                }
                let at = [ray.x, ray.u, ray.y, ray.v].into_iter().zip(half_widths);
                let cell = at.fold(0, |cell, (z, h)| {
                    let along = etendue_field::whole(0.5 * (z / h + 1.0) * CELLS as f64);
                    cell * CELLS + along.min(CELLS - 1)
                });
                cells[cell] += scale * weight * plane.factor(ray);
            }
        };
        source.emit(*batch, record, progress);
    }
    cells
}

/// The mean products of the means of two fields over the blocks of each level, (x, u, y, v).
fn mean_products(fields: [Vec<f64>; 2]) -> Vec<f64> {
    let mut products = vec![0.0; LEVELS.pow(4)];
    coarser(fields, [FINEST; 4], 0, &mut products);
    products
}

/// Adds the product of two fields at the levels `at`, and the products at coarser levels along the
/// axes from `first` on.
fn coarser(fields: [Vec<f64>; 2], at: [usize; 4], first: usize, products: &mut [f64]) {
    let index = at.iter().fold(0, |index, level| index * LEVELS + level);
    let [a, b] = &fields;
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    products[index] = sum / a.len() as f64;
    for axis in (first..4).filter(|axis| at[*axis] > 0) {
        // Number of blocks along the axes after this one.
        let inner = 1 << at[axis + 1..].iter().sum::<usize>();
        let halves = |field: &Vec<f64>| {
            let pairs = field.chunks_exact(2 * inner);
            let means = pairs.flat_map(|pair| {
                let (low, high) = pair.split_at(inner);
                low.iter().zip(high).map(|(low, high)| 0.5 * (low + high))
            });
            means.collect::<Vec<f64>>()
        };
        let mut level = at;
        level[axis] -= 1;
        coarser([halves(a), halves(b)], level, axis, products);
    }
}

/// The differences along each axis, which are the values in bands.
fn in_bands(mut values: Vec<f64>) -> Vec<f64> {
    for stride in (0..4).map(|axis| LEVELS.pow(axis)) {
        for i in (0..values.len()).rev() {
            if i / stride % LEVELS > 0 {
                values[i] -= values[i - stride];
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The products at each level are the plain means, and bands add up to them.
    #[test]
    fn products_are_means_over_blocks() {
        let value = |seed: usize, i: usize| ((i * 7919 + seed * 104_729) % 1009) as f64 / 1009.0;
        let field = |seed| {
            (0..CELLS.pow(4))
                .map(|i| value(seed, i))
                .collect::<Vec<f64>>()
        };
        let [a, b] = [field(1), field(2)];
        let products = mean_products([a.clone(), b.clone()]);
        let level = [1, 0, 2, 5];
        let mut blocks = std::collections::BTreeMap::<[usize; 4], [f64; 3]>::new();
        for i in 0..a.len() {
            let at = indices(i, CELLS);
            let block = [0, 1, 2, 3].map(|k| at[k] >> (FINEST - level[k]));
            let sums = blocks.entry(block).or_default();
            [a[i], b[i], 1.0]
                .iter()
                .zip(sums)
                .for_each(|(value, sum)| *sum += value);
        }
        let mean: f64 = blocks.values().map(|[a, b, n]| a * b / (n * n)).sum();
        let mean = mean / blocks.len() as f64;
        let at = |level: [usize; 4]| level.iter().fold(0, |i, l| i * LEVELS + l);
        assert!((products[at(level)] - mean).abs() < 1e-12); // rounding
        let powers = in_bands(products.clone());
        let below = bands(FINEST).filter(|s| s.iter().zip(level).all(|(s, r)| *s <= r));
        let sum: f64 = below.map(|s| powers[at(s)]).sum();
        assert!((sum - products[at(level)]).abs() < 1e-12); // rounding
    }
}
