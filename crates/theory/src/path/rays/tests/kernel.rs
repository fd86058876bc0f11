//! Tests of the sums over rays.

use super::*;
use crate::nets::RayNode;
use crate::path::rays::sums::sums;
use std::f64::consts::TAU;

fn nodes(count: usize) -> Vec<RayNode> {
    let number = |i: usize, k: usize| {
        libm::sin((i * (2 * k + 3)) as f64 * 0.618_033_988_75 + k as f64 * 0.37)
    };
    let node = |i| RayNode {
        z: std::array::from_fn(|k| number(i, k)),
        weight: 1.5 + number(i, 4),
    };
    (0..count).map(node).collect()
}

#[test]
fn plain_summation() {
    // The number of rays is odd and larger than one block, and the number of powers is larger than
    // the number that is computed from one exact power.
    let nodes = nodes(777);
    let axis = |half, spacing| FrequencyAxis { half, spacing };
    let grid = SliceGrid {
        azimuths: 3,
        rho: axis(37, 0.7),
        nu: axis(41, 1.3),
    };
    let fast = sums(&nodes, &grid);
    let total: f64 = nodes.iter().map(|n| n.weight).sum();
    for ((k, m, n), value) in fast.half.indexed_iter() {
        let omega = grid.frequency(k, m as f64 * grid.rho.spacing, grid.nu.value(n));
        let term = |node: &RayNode| {
            let phase: f64 = omega.iter().zip(node.z).map(|(o, z)| o * z).sum();
            Complex::from_polar(node.weight, -TAU * phase)
        };
        let plain: Complex = nodes.iter().map(term).sum();
        // The tolerance is the sum of 32 rounding errors of a factor and the rounding error of
        // phases up to 400.
        assert!((value - plain).norm() < 1e-12 * total, "{k} {m} {n}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let system = mirror(beam([0.1, 0.2]), 0.4, [0.3, 0.0], [-0.5; 3]);
    let plane = after(&system, 0.5);
    let window = window(Profile::Hann(0.2), Profile::Hann(0.2));
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let run = || exact(&system, &plane, &window, &grid(3, [0.2, 0.2]));
        pool.build().unwrap().install(run)
    };
    let one = on(1);
    assert!(one.slices.half.iter().all(|s| s.is_finite()));
    assert_eq!(one, on(2));
}
