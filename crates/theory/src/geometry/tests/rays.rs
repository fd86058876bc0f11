//! Tests of the maps against traced rays: the error is of first or second order in the size of the
//! neighbourhood.

use super::slopes::{to_angles, to_slopes};
use super::trace::{GraphSurface, LightAxes, reflected, refracted};
use super::*;

/// Half the size of the largest tested neighbourhood.
const SIZE: f64 = 1e-3;

/// The largest error of a map, divided by e, for rays in a neighbourhood of size e. Also
/// returns the power of e with which the error falls.
pub(super) fn error_and_order<const N: usize>(
    map: &AffineMap<N>,
    traced: impl Fn([f64; N]) -> [f64; N],
) -> (f64, f64) {
    let error = |e: f64| {
        let errors = bundle(40, e).flat_map(|z| {
            let (got, expected) = (map.apply(z), traced(z));
            (0..N).map(move |i| (got[i] - expected[i]).abs() / e)
        });
        errors.fold(0.0, f64::max)
    };
    let (wide, narrow) = (error(2.0 * SIZE), error(SIZE));
    (narrow, libm::log2(wide / narrow))
}

/// Tolerance of a measured order of convergence; the next term of the error is smaller by a factor
/// e and changes the order by about e.
const ORDER: f64 = 0.02;

fn assert_order<const N: usize>(
    map: &AffineMap<N>,
    traced: impl Fn([f64; N]) -> [f64; N],
    expected: f64,
) {
    let (error, order) = error_and_order(map, traced);
    assert!((order - expected).abs() < ORDER, "{error:e}, order {order}");
    assert!(error < 20.0 * SIZE.powf(expected), "{error:e}");
}

/// Traces a ray that meets a circle in the plane of incidence.
pub(super) fn circle(k: f64, theta0: f64, [x, u]: [f64; 2]) -> [f64; 2] {
    let [x, _, u, _] = reflected(GraphSurface::sphere(k), theta0, [x, 0.0, u, 0.0]);
    [x, u]
}

#[test]
fn circle_mirror() {
    for k in [0.5, -0.5] {
        for (theta0, order) in [(0.6, 1.0), (-1.1, 1.0), (0.0, 2.0)] {
            let map = AffineMap::<2>::mirror_reflection(theta0, k);
            assert_order(&map, |z| circle(k, theta0, z), order);
        }
    }
}

#[test]
fn mirrors_in_space() {
    for (theta0, order) in [(0.7, 1.0), (-0.4, 1.0), (0.0, 2.0)] {
        for k in [0.5, -0.5] {
            let map = AffineMap::<4>::mirror_reflection(theta0, [[k, 0.0], [0.0, k]]);
            assert_order(
                &map,
                |z| reflected(GraphSurface::sphere(k), theta0, z),
                order,
            );
        }
        let map = AffineMap::<4>::mirror_reflection(theta0, SHAPE);
        assert_order(
            &map,
            |z| reflected(GraphSurface::graph(SHAPE), theta0, z),
            order,
        );
    }
}

#[test]
fn refraction_in_space() {
    for media in [GLASS, OUT_OF_GLASS] {
        for (theta0, order) in [(0.6, 1.0), (-0.4, 1.0), (0.0, 2.0)] {
            for k in [0.5, -0.5] {
                let map = AffineMap::<4>::refracting_surface(theta0, [[k, 0.0], [0.0, k]], &media);
                let sphere = |z| refracted(GraphSurface::sphere(k), theta0, &media, z);
                assert_order(&map.unwrap(), sphere, order);
            }
            let map = AffineMap::<4>::refracting_surface(theta0, SHAPE, &media);
            let graph = |z| refracted(GraphSurface::graph(SHAPE), theta0, &media, z);
            assert_order(&map.unwrap(), graph, order);
        }
    }
}

#[test]
fn other_rules_of_refraction_do_not_converge() {
    let theta0 = 0.6;
    let theta2 = GLASS.refracted(theta0).unwrap();
    let traced = |z| refracted(GraphSurface::graph(SHAPE), theta0, &GLASS, z);
    let in_plane = AffineMap::<2>::refraction(theta0, &GLASS).unwrap();
    let across = AffineMap::<2>::refraction(0.0, &GLASS).unwrap();
    let off = AffineMap::<4>::incidence(theta2).inverse().unwrap();
    // Four mistakes are tested: latitudes are refracted by the rule for longitudes, latitudes are
    // not refracted, the way back uses the cosine of the incident side, or all cosines are omitted.
    let wrong = [
        (AffineMap::<2>::linear(in_plane.matrix), theta0, theta2),
        (AffineMap::identity(), theta0, theta2),
        (across, theta0, theta0),
        (across, 0.0, 0.0),
    ];
    let chain = |latitude: &AffineMap<2>, before, after| {
        AffineMap::<4>::incidence(theta0)
            .then(&AffineMap::<4>::curvature(SHAPE, before))
            .then(&AffineMap::sections(&in_plane, latitude))
            .then(&AffineMap::<4>::back(SHAPE, after))
            .then(&off)
    };
    assert_order(&chain(&across, theta0, theta2), traced, 1.0);
    for (latitude, before, after) in wrong {
        let (error, order) = error_and_order(&chain(&latitude, before, after), traced);
        assert!(error > 0.02 && order.abs() < 0.1, "{error:e}, {order}");
    }
}

#[test]
fn foci_of_a_hollow_sphere() {
    let (radius, theta0) = (2.0, 0.7_f64);
    // The traced rays are near the central ray and parallel to it. The error of the central
    // difference is of order e².
    let e = 1e-4;
    let crossing = |axis: usize| {
        let ends = [-e, e].map(|offset| {
            let mut z = [0.0; 4];
            z[axis] = offset;
            reflected(GraphSurface::sphere(-1.0 / radius), theta0, z)
        });
        let [low, high] = ends;
        -(high[axis] - low[axis]) / (high[axis + 2] - low[axis + 2])
    };
    let map = AffineMap::<4>::mirror_reflection(theta0, [[-0.5, 0.0], [0.0, -0.5]]).matrix;
    let expected = [
        0.5 * radius * libm::cos(theta0),
        0.5 * radius / libm::cos(theta0),
    ]; // Coddington
    for (axis, expected) in expected.into_iter().enumerate() {
        let traced = crossing(axis);
        // The error is e² = 1e-8, times a curvature of order one.
        assert!((traced - expected).abs() < 1e-7, "{traced}");
        let got = -map[axis][axis] / map[axis + 2][axis];
        assert!((got - expected).abs() < 1e-14, "{got}"); // rounding
    }
    // If the cosine were omitted in the sagittal plane, the second focal distance would be R/2 =
    // 1.
    assert!((expected[1] - 1.307_459).abs() < 1e-6); // the number in print has six digits
}

#[test]
fn axes_turned_about_the_light() {
    let axes = LightAxes::coming(0.6);
    let map = AffineMap::<4>::rotation(0.8);
    for z in bundle::<4>(20, 1.0) {
        let (got, expected) = (map.apply(z), axes.turned(0.8).coordinates(axes.ray(z)));
        let off = (0..4).map(|i| (got[i] - expected[i]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-14); // rounding: exact for all slopes
    }
}

#[test]
fn axes_turned_about_a_normal() {
    // The map rotates (θ, φ) like a vector in the plane, which is correct only near the normal.
    let axes = LightAxes::leaving(0.0);
    let turned = |z| to_angles(axes.turned(0.8).coordinates(axes.ray(to_slopes(z))));
    assert_order(&AffineMap::<4>::rotation(0.8), turned, 2.0);
    let [_, _, theta, phi] = turned([0.0, 0.0, 0.7, 0.0]);
    let [_, _, x, y] = AffineMap::<4>::rotation(0.8).apply([0.0, 0.0, 0.7, 0.0]);
    assert!((theta - x).hypot(phi - y) > 0.03);
}
