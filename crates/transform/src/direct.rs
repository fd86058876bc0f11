//! Plain sums, which are the reference for the slice transform.

use etendue_field::{Complex, Crossing, SliceGrid, Slices, TwoPlane, cis};
use std::f64::consts::TAU;

/// Σ weight · `window`(ray) · e^(−2πi Ω·z) over `crossings`, at the 4D `frequency` Ω = (Ωx,
/// Ωy, Ωu, Ωv).
///
/// The sum is exact apart from rounding errors. If it is divided by the number of emitted photons,
/// it estimates the transform of L W at Ω.
pub fn at<'a>(
    crossings: impl IntoIterator<Item = &'a Crossing>,
    window: impl Fn(&TwoPlane) -> f64,
    frequency: [f64; 4],
) -> Complex {
    let [ox, oy, ou, ov] = frequency;
    crossings
        .into_iter()
        .map(|Crossing { ray, weight }| {
            let cycles = ox * ray.x + oy * ray.y + ou * ray.u + ov * ray.v;
            cis(-TAU * cycles) * (weight * window(ray))
        })
        .sum()
}

/// The same sum at every frequency of `grid`.
pub fn slices(
    crossings: &[Crossing],
    window: impl Fn(&TwoPlane) -> f64,
    grid: &SliceGrid,
) -> Slices {
    let mut slices = Slices::zeros(*grid);
    for ((k, m, n), value) in slices.half.indexed_iter_mut() {
        let rho = grid.rho.value(grid.rho.half + m);
        let frequency = grid.frequency(k, rho, grid.nu.value(n));
        *value = at(crossings, &window, frequency);
    }
    slices
}
