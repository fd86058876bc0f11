//! Tests that each misprint of Durand et al. 2005 disagrees with traced rays, although some
//! misprints cancel each other.

use super::rays::{circle, error_and_order};
use super::trace::{GraphSurface, reflected};
use super::*;
use crate::geometry::{Edition, SpectrumMap};
use etendue_field::Complex;
use std::f64::consts::TAU;

impl Edition {
    /// The step of curvature, into the frames of the local normals. Eq. 11: L(Ωx + k Ωθ,
    /// Ωθ).
    fn curvature(self, k: f64) -> SpectrumMap<2> {
        AffineMap::<2>::curvature(self.sign() * k).spectrum_map()
    }

    /// The step back from the frames of the local normals. It is the inverse of
    /// [`curvature`](Self::curvature), as the text of step 6 says.
    fn back(self, k: f64) -> SpectrumMap<2> {
        AffineMap::<2>::back(self.sign() * k).spectrum_map()
    }
}

const THETA0: f64 = 0.6;
const K: f64 = 0.5;

/// Multiplies the phase by the factor 2π that the printed formulas omit.
fn with_two_pi(mut step: SpectrumMap<2>) -> SpectrumMap<2> {
    step.phase = step.phase.map(|t| TAU * t);
    step
}

/// Builds a mirror reflection with the printed versions of incidence, curvature and outgoing angle.
fn mirror(
    incidence: &SpectrumMap<2>,
    curvature: Edition,
    outgoing: &SpectrumMap<2>,
) -> SpectrumMap<2> {
    incidence
        .then(&curvature.curvature(K))
        .then(&AffineMap::mirror().spectrum_map())
        .then(&curvature.back(K))
        .then(outgoing)
}

/// Builds a mirror reflection with all steps of one edition, for a mirror of the curvature k.
fn reflection(print: Edition, k: f64) -> SpectrumMap<2> {
    print
        .incidence(THETA0)
        .then(&print.curvature(k))
        .then(&AffineMap::mirror().spectrum_map())
        .then(&print.back(k))
        .then(&print.outgoing(-THETA0))
}

/// As [`reflection`], in 4D and for any angle of incidence.
fn reflection_4d(print: Edition, theta0: f64, shape: Matrix<2>) -> SpectrumMap<4> {
    print
        .incidence_4d(theta0)
        .then(&print.curvature_4d(shape, theta0))
        .then(&AffineMap::mirror().spectrum_map())
        .then(&print.back_4d(shape, -theta0))
        .then(&print.outgoing_4d(-theta0))
}

#[test]
fn corrected_is_the_map() {
    let print = Edition::Corrected;
    let map = AffineMap::<2>::mirror_reflection(THETA0, K).spectrum_map();
    assert_eq!(reflection(print, K), map);
    let map = AffineMap::<4>::mirror_reflection(THETA0, SHAPE).spectrum_map();
    let got = reflection_4d(print, THETA0, SHAPE);
    assert!((got.factor - map.factor).abs() < 1e-15); // rounding
    assert!(apart(&got.rays(), &map.rays()) < 1e-15); // rounding
}

#[test]
fn no_misprint_follows_the_rays() {
    use Edition::{Corrected, Equations, Table};
    let incidence = |print: Edition| print.incidence(THETA0);
    let outgoing = |print: Edition| print.outgoing(-THETA0);
    let right = [incidence(Corrected), outgoing(Corrected)];
    let scaled = [with_two_pi(incidence(Table)), with_two_pi(outgoing(Table))];
    let mut phase = [incidence(Corrected), outgoing(Corrected)];
    for step in &mut phase {
        step.phase = step.phase.map(|t| t / TAU);
    }
    let chains = [
        (
            "scale of incidence",
            mirror(&scaled[0], Corrected, &right[1]),
        ),
        (
            "scale of outgoing",
            mirror(&right[0], Corrected, &scaled[1]),
        ),
        ("both", mirror(&scaled[0], Corrected, &scaled[1])),
        ("sign of Eq. 11", mirror(&right[0], Equations, &right[1])),
        (
            "all",
            mirror(&incidence(Equations), Equations, &outgoing(Equations)),
        ),
    ];
    let traced = |z| circle(K, THETA0, z);
    let (error, order) = error_and_order(&mirror(&right[0], Corrected, &right[1]).rays(), traced);
    assert!(error < 0.01 && order > 0.9, "{error:e}, order {order}");
    for (what, chain) in chains {
        let (error, order) = error_and_order(&chain.rays(), traced);
        assert!(
            error > 0.1 && order.abs() < 0.1,
            "{what}: {error:e}, {order}"
        );
    }
    // The two phases of a mirror reflection cancel, but a single wrong phase causes an error that
    // does not decrease with the size of the neighbourhood.
    let alone = mirror(&phase[0], Corrected, &right[1]);
    let (error, order) = error_and_order(&alone.rays(), traced);
    assert!(error > 100.0 && order < -0.9, "phase: {error:e}, {order}");
}

#[test]
fn a_shear_by_the_bilinear_form_alone_does_not_follow_the_rays() {
    for print in [Edition::Equations, Edition::Table] {
        let right = Edition::Corrected;
        let chain = right
            .incidence_4d(THETA0)
            .then(&print.curvature_4d(SHAPE, THETA0))
            .then(&AffineMap::mirror().spectrum_map())
            .then(&print.back_4d(SHAPE, -THETA0))
            .then(&right.outgoing_4d(-THETA0));
        let traced = |z| reflected(GraphSurface::graph(SHAPE), THETA0, z);
        let (error, order) = error_and_order(&chain.rays(), traced);
        assert!(error > 0.05 && order.abs() < 0.1, "{error:e}, {order}");
        assert!(chain.rays().symplectic_defect(1.0) > 0.05);
    }
    let sphere = [[-0.5, 0.0], [0.0, -0.5]];
    let map = reflection_4d(Edition::Table, 0.7, sphere).rays().matrix;
    assert!((map[1][1] / map[3][1] + 1.0).abs() < 1e-15); // the sagittal focus R/2: rounding
}

#[test]
fn planar_mirrors_keep_magnitudes() {
    let before = |[x, t]: [f64; 2]| Complex::new(libm::exp(-x * x - t * t + x * t), x - t);
    for omega in [[0.3, 0.2], [-1.0, 0.4], [0.0, 0.0]] {
        let size = |print: Edition| {
            let mirror = reflection(print, 0.0);
            mirror.spectrum(omega, &before).norm()
        };
        let expected = before([-omega[0], -omega[1]]).norm();
        let cos = libm::cos(THETA0);
        let rounding = 1e-14;
        assert!((size(Edition::Corrected) - expected).abs() < rounding);
        // On a flat mirror, the two wrong arguments of Table 1 cancel, but the factors of Eqs. 9
        // and 10 do not cancel.
        assert!((size(Edition::Table) - expected).abs() < rounding);
        assert!((size(Edition::Equations) - cos * cos * expected).abs() < rounding);
    }
}

#[test]
fn constant_fields_keep_their_value() {
    // A step that has the factor f and replaces Ωx by a Ωx multiplies δ(Ωx) S(Ωθ) by f/|a|.
    let value = |step: SpectrumMap<2>| step.factor / step.matrix[0][0].abs();
    let cos = libm::cos(THETA0);
    let close = |a: f64, b: f64| (a - b).abs() < 1e-15; // rounding
    assert!(close(value(Edition::Corrected.incidence(THETA0)), 1.0));
    assert!(close(value(Edition::Corrected.outgoing(THETA0)), 1.0));
    assert!(close(value(Edition::Equations.incidence(THETA0)), 1.0));
    assert!(close(
        value(Edition::Table.incidence(THETA0)) * cos * cos,
        1.0
    ));
    assert!(close(value(Edition::Table.outgoing(THETA0)), cos * cos));
}
