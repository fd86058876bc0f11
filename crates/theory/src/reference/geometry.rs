//! Checks of mirrors, Gaussian fields along a path, and the kernel from slopes to angles.

use super::*;
use crate::geometry::tests::covariance::{gaussian_lobe, gaussian_window, power_spectrum};
use crate::geometry::tests::plane_sphere_kernel::plane_sphere_kernel;
use crate::geometry::{AffineMap, Matrix};
use std::f64::consts::PI;

#[test]
fn caustic_of_a_hollow_mirror() {
    let block = block("caustic");
    let p = |name: &str| number(&block["params"][name]);
    let (a, s) = (p("A"), p("S"));
    let beam = |[x, t]: [f64; 2]| {
        let exponent = (a * x).powi(2) + (s * t).powi(2);
        Complex::from(a * s * libm::exp(-PI * exponent))
    };
    let map = |sample: &Value| AffineMap::<2>::caustic(p("th0"), p("k"), number(&sample["d"]));
    let all = samples(&block["samples"]).iter();
    let pairs = all.clone().map(|sample| {
        let got = map(sample).spectrum(frequency(sample), &beam);
        (got, complex(sample))
    });
    assert_close("caustic", deviation(16, pairs));
    let focus = AffineMap::<2>::mirror_reflection(p("th0"), p("k"))
        .focus()
        .unwrap();
    let expected = number(&block["focal_distance"]);
    assert_close("focus", deviation(1, [(focus.into(), expected.into())]));
    // The test detects the sign error of the curvature in Eq. 11.
    let wrong = all.map(|sample| {
        let map = AffineMap::<2>::caustic(p("th0"), -p("k"), number(&sample["d"]));
        (map.spectrum(frequency(sample), &beam), complex(sample))
    });
    assert!(deviation(16, wrong) > 0.1);
}

#[test]
fn kernel_from_slopes_to_angles() {
    let block = block("tp_to_ps_kernel");
    let pairs = samples(&block["samples"]).iter().map(|sample| {
        let got = plane_sphere_kernel(number(&sample["ov"]), number(&sample["oth"]));
        (got.into(), number(&sample["value"]).into())
    });
    assert_close("kernel", deviation(8, pairs));
}

fn matrix<const N: usize>(value: &Value) -> Matrix<N> {
    let rows = samples(value);
    assert!(rows.len() == N && rows.iter().all(|row| samples(row).len() == N));
    std::array::from_fn(|i| std::array::from_fn(|j| number(&rows[i][j])))
}

/// The operation that a row of a chain represents.
enum BlockStep<const N: usize> {
    Map(AffineMap<N>),
    Window([f64; N]),
    Lobe(f64),
}

/// Follows a chain row by row and compares all its values: matrices, covariances, determinants,
/// spectral covariances.
fn assert_chain<const N: usize>(block: &Value, steps: &[BlockStep<N>]) {
    let rows = samples(&block["rows"]);
    assert_eq!(rows.len(), steps.len() + 1);
    let entries = |got: Matrix<N>, expected: &Value| -> Vec<(Complex, Complex)> {
        let expected = matrix::<N>(expected);
        let pairs = got
            .into_iter()
            .flatten()
            .zip(expected.into_iter().flatten());
        pairs.map(|(a, b)| (a.into(), b.into())).collect()
    };
    let mut field = matrix::<N>(&rows[0]["Sigma"]);
    let [mut matrices, mut fields, mut volumes, mut powers] = [const { Vec::new() }; 4];
    for (step, row) in steps.iter().zip(&rows[1..]) {
        let before = power_spectrum(&field);
        field = match step {
            BlockStep::Map(map) => {
                matrices.extend(entries(map.matrix, &row["matrix"]));
                map.covariance(&field)
            }
            BlockStep::Window(std) => gaussian_window(&field, *std).unwrap(),
            BlockStep::Lobe(std) => gaussian_lobe(&field, *std),
        };
        fields.extend(entries(field, &row["Sigma"]));
        let volume = AffineMap::linear(field).det();
        volumes.push((volume.into(), number(&row["det"]).into()));
        let expected = &row["power_spectrum_covariance"];
        if !expected.is_null() {
            powers.extend(entries(power_spectrum(&field).unwrap(), expected));
            if let BlockStep::Map(map) = step {
                let moved = map.spectral_covariance(&before.unwrap()).unwrap();
                powers.extend(entries(moved, expected));
            }
        }
    }
    assert_close("matrices", deviation(N * N * 7, matrices));
    assert_close("covariances", deviation(N * N * 8, fields));
    // The limit is the rounding error of terms a hundred times larger.
    let off = deviation(8, volumes);
    assert!(off < 1e-12, "determinants: {off:e}");
    if N == 2 {
        assert_close("spectral covariances", deviation(2 * N * N * 7, powers));
    }
}

#[test]
fn covariance_along_a_path_in_2d() {
    let block = block("covariance_2d");
    let p = |name: &str| number(&block["params"][name]);
    let [wx, wv] = [0, 1].map(|i| number(&block["params"]["win"][i]));
    let steps = [
        BlockStep::Map(AffineMap::travel(p("d1"))),
        BlockStep::Window([wx, wv]),
        BlockStep::Map(AffineMap::<2>::incidence(p("th0"))),
        BlockStep::Map(AffineMap::<2>::curvature(p("k"))),
        BlockStep::Map(AffineMap::mirror()),
        BlockStep::Lobe(p("lobe")),
        BlockStep::Map(AffineMap::<2>::back(p("k"))),
        BlockStep::Map(AffineMap::<2>::outgoing(p("th1"))),
        BlockStep::Map(AffineMap::travel(p("d2"))),
    ];
    assert_chain(&block, &steps);
}

#[test]
fn covariance_along_a_path_in_4d() {
    let block = block("covariance_4d");
    let p = |name: &str| number(&block["params"][name]);
    let shape = matrix::<2>(&block["params"]["M"]);
    let theta0 = p("th0");
    let steps = [
        BlockStep::Map(AffineMap::travel(p("d1"))),
        BlockStep::Map(AffineMap::<4>::incidence(theta0)),
        BlockStep::Map(AffineMap::<4>::curvature(shape, theta0)),
        BlockStep::Map(AffineMap::mirror()),
        BlockStep::Lobe(p("lobe")),
        BlockStep::Map(AffineMap::<4>::back(shape, -theta0)),
        BlockStep::Map(AffineMap::<4>::outgoing(-theta0)),
        BlockStep::Map(AffineMap::travel(p("d2"))),
    ];
    assert_chain(&block, &steps);
}
