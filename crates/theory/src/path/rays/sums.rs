//! The sum Σ w e^(−2πi Ω·z) over rays, at all frequencies of a grid of slices.
//!
//! On the slice of one azimuth a ray is a point (a, b), and its exponential at (m Δρ, n Δν) is the
//! product of a factor for ρ and a factor for ν. The sum over rays is a matrix product of the real
//! and imaginary parts of the factors. One matrix product gives the sums both for + ν and for − ν.

use crate::nets::RayNode;
use etendue_field::{Complex, SliceGrid, Slices, cis};
use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Number of rays that are summed by one matrix product.
const BLOCK: usize = 256;
/// Maximum number of partial sums over rays; partial sums are computed in parallel and added in
/// order.
const PARTS: usize = 16;
/// From one exact power of a phase factor, this number of powers is computed by repeated
/// multiplication. The number is limited because each multiplication adds a rounding error.
const POWERS: usize = 32;
/// Number of powers of e^(i angle) that are computed in parallel. The power n + `LANES` is the
/// power n multiplied by e^(i `LANES` angle).
const LANES: usize = 8;

/// The sums at all frequencies of all slices. The sums are bitwise identical on any number
/// of threads, and their rounding error is below 10⁻¹² of Σ |w|.
pub(super) fn sums(nodes: &[RayNode], grid: &SliceGrid) -> Slices {
    let part = nodes.len().div_ceil(PARTS).max(BLOCK);
    let parts: Vec<_> = nodes.chunks(part).collect();
    let tasks = grid.azimuths * parts.len();
    let products: Vec<Array2<f64>> = (0..tasks)
        .into_par_iter()
        .map(|i| product(parts[i % parts.len()], grid, i / parts.len()))
        .collect();
    let mut slices = Slices::zeros(*grid);
    for (i, product) in products.iter().enumerate() {
        let mut slice = slices.half.index_axis_mut(Axis(0), i / parts.len());
        let zero = grid.nu.half;
        for m in 0..=grid.rho.half {
            for n in 0..=zero {
                let [rr, ri] = [product[[2 * m, 2 * n]], product[[2 * m, 2 * n + 1]]];
                let [ir, ii] = [product[[2 * m + 1, 2 * n]], product[[2 * m + 1, 2 * n + 1]]];
                slice[[m, zero + n]] += Complex::new(rr - ii, ri + ir);
                if n > 0 {
                    slice[[m, zero - n]] += Complex::new(rr + ii, ir - ri);
                }
            }
        }
    }
    slices
}

/// Returns sums over rays of the products of the factors for ρ and ν. Entry [2m + i, 2n + j] is for
/// part i of the factor for ρ and part j of the factor for ν. Part 0 is the real part, and part 1
/// is the imaginary part.
fn product(nodes: &[RayNode], grid: &SliceGrid, azimuth: usize) -> Array2<f64> {
    let (sin, cos) = libm::sincos(grid.azimuth(azimuth));
    let [along_rho, along_nu] = [grid.rho.half, grid.nu.half].map(|half| 2 * (half + 1));
    let mut sum = Array2::zeros((along_rho, along_nu));
    let mut rho = Array2::zeros((BLOCK, along_rho));
    let mut nu = Array2::zeros((BLOCK, along_nu));
    for block in nodes.chunks(BLOCK) {
        for (i, node) in block.iter().enumerate() {
            let [x, y, u, v] = node.z;
            let position = -TAU * grid.rho.spacing * (x * cos + y * sin);
            let slope = -TAU * grid.nu.spacing * (u * cos + v * sin);
            powers(position, node.weight, rho.row_mut(i).into_slice());
            powers(slope, 1.0, nu.row_mut(i).into_slice());
        }
        let (rho, _) = rho.view().split_at(Axis(0), block.len());
        let (nu, _) = nu.view().split_at(Axis(0), block.len());
        general_mat_mul(1.0, &rho.t(), &nu, 1.0, &mut sum);
    }
    sum
}

/// Returns scale · e^(i n angle) for n = 0, 1, …, with real and imaginary parts alternating.
fn powers(angle: f64, scale: f64, row: Option<&mut [f64]>) {
    let step = cis(angle);
    let squared = step * step;
    let stride = squared * squared * squared * squared;
    let parts = row.into_iter().flat_map(|row| row.chunks_mut(2 * POWERS));
    for (part, to) in parts.enumerate() {
        // The powers in different lanes do not depend on each other, so the compiler can vectorise
        // the loop.
        let mut lanes = [cis(angle * (part * POWERS) as f64) * scale; LANES];
        for i in 1..LANES {
            lanes[i] = lanes[i - 1] * step;
        }
        for eight in to.chunks_mut(2 * LANES) {
            for (pair, lane) in eight.chunks_exact_mut(2).zip(&mut lanes) {
                pair[0] = lane.re;
                pair[1] = lane.im;
                *lane *= stride;
            }
        }
    }
}
