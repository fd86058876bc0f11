//! Tests of optical laws that the maps must obey for all parameters.

use super::*;
use crate::geometry::times;

/// The rounding error of products of a few entries of order one.
const ROUNDING: f64 = 1e-14;

#[test]
fn travels_add_up() {
    let both = AffineMap::<4>::travel(0.7).then(&AffineMap::travel(1.9));
    assert!(apart(&both, &AffineMap::travel(2.6)) < ROUNDING);
    assert!(apart(&both, &AffineMap::travel(2.5)) > 0.09); // the test can fail
}

#[test]
fn inverses() {
    let shears = AffineMap::<2>::curvature(0.6).then(&AffineMap::<2>::back(0.6));
    assert!(apart(&shears, &AffineMap::identity()) < ROUNDING);
    let shears = AffineMap::<4>::curvature(SHAPE, 0.7).then(&AffineMap::<4>::back(SHAPE, -0.7));
    assert!(apart(&shears, &AffineMap::identity()) < ROUNDING);
    let twice = AffineMap::<4>::mirror().then(&AffineMap::mirror());
    assert!(apart(&twice, &AffineMap::identity()) < ROUNDING);
    let off = AffineMap::<4>::outgoing(-0.4)
        .then(&AffineMap::rotation(0.3))
        .then(&AffineMap::travel(2.0));
    let back = off.then(&off.inverse().unwrap());
    assert!(apart(&back, &AffineMap::identity()) < ROUNDING);
    assert!(
        AffineMap::<2>::linear([[1.0, 2.0], [2.0, 4.0]])
            .inverse()
            .is_none()
    );
}

#[test]
fn composition_is_one_map_after_the_other() {
    let (first, second) = (
        AffineMap::<4>::incidence(0.5),
        AffineMap::<4>::curvature(SHAPE, 0.5),
    );
    let ray = [0.3, -0.2, 0.1, 0.4];
    let one = first.then(&second).apply(ray);
    let other = second.apply(first.apply(ray));
    let wrong = first.apply(second.apply(ray));
    let difference = |a: [f64; 4], b: [f64; 4]| (0..4).map(|i| (a[i] - b[i]).abs()).sum::<f64>();
    assert!(difference(one, other) < ROUNDING);
    assert!(difference(one, wrong) > 0.1); // the order matters
    let omega = [1.0, -2.0, 0.5, 3.0];
    // The spectrum map returns the frequency before the map.
    let [there, back] = [first, first.inverse().unwrap()].map(|map| map.spectrum_map().matrix);
    assert!(difference(times(&back, &times(&there, &omega)), omega) < ROUNDING);
}

#[test]
fn thin_lens_between_travels() {
    let (a, b, f) = (1.3, 0.8, 0.6);
    let system = AffineMap::<2>::travel(a)
        .then(&AffineMap::thin_lens(f))
        .then(&AffineMap::travel(b));
    let abcd = [[1.0 - b / f, a + b - a * b / f], [-1.0 / f, 1.0 - a / f]];
    assert!(apart(&system, &AffineMap::linear(abcd)) < ROUNDING);
    // If 1/a + 1/b = 1/f, there is an image. Positions in the image do not depend on directions;
    // they are magnified by b/a and inverted.
    let b = 1.0 / (1.0 / f - 1.0 / a);
    let image = AffineMap::<4>::travel(a)
        .then(&AffineMap::thin_lens(f))
        .then(&AffineMap::travel(b));
    let [x, y, ..] = image.apply([0.1, -0.2, 0.5, 0.7]);
    assert!((x + 0.1 * b / a).abs() < ROUNDING && (y - 0.2 * b / a).abs() < ROUNDING);
}

#[test]
fn closed_form_of_a_mirror() {
    let (theta0, k) = (0.7_f64, -0.4);
    let c0 = libm::cos(theta0);
    let expected = AffineMap::<2>::linear([[-1.0, 0.0], [-2.0 * k / c0, -1.0]]); // docs/theory.md (26)
    let mirror = AffineMap::<2>::mirror_reflection(theta0, k);
    assert!(apart(&mirror, &expected) < ROUNDING);
    assert!((mirror.focus().unwrap() + c0 / (2.0 * k)).abs() < ROUNDING);
    assert!(
        AffineMap::<2>::mirror_reflection(theta0, 0.0)
            .focus()
            .is_none()
    );
    let [[m11, m12], [_, m22]] = SHAPE;
    let expected = AffineMap::<4>::linear([
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [-2.0 * m11 / c0, 2.0 * m12, -1.0, 0.0],
        [-2.0 * m12, 2.0 * c0 * m22, 0.0, 1.0],
    ]);
    assert!(apart(&AffineMap::<4>::mirror_reflection(theta0, SHAPE), &expected) < ROUNDING);
}

#[test]
fn lensmaker() {
    let (r1, r2, thickness, n) = (0.5, 0.8, 0.02, GLASS.after);
    let lens = |thickness| {
        // The second surface of a biconvex lens is concave as seen from inside.
        AffineMap::<2>::refracting_surface(0.0, 1.0 / r1, &GLASS)
            .unwrap()
            .then(&AffineMap::travel(thickness))
            .then(&AffineMap::<2>::refracting_surface(0.0, -1.0 / r2, &OUT_OF_GLASS).unwrap())
    };
    let power = (n - 1.0) * (1.0 / r1 + 1.0 / r2);
    assert!(apart(&lens(0.0), &AffineMap::thin_lens(1.0 / power)) < ROUNDING);
    // This is Eq. 6.2 of Hecht, Optics, with a negative second radius.
    let thick = power - (n - 1.0).powi(2) * thickness / (n * r1 * r2);
    assert!((lens(thickness).matrix[1][0] + thick).abs() < ROUNDING);
    assert!((power - thick).abs() > 0.005); // the test detects the thickness
}

#[test]
fn total_reflection_has_no_refracted_ray() {
    assert!(AffineMap::<4>::refracting_surface(0.72, SHAPE, &OUT_OF_GLASS).is_some());
    assert!(AffineMap::<4>::refracting_surface(0.74, SHAPE, &OUT_OF_GLASS).is_none()); // asin(1/1.5) = 0.7297
    assert!(AffineMap::<2>::refraction(f64::NAN, &OUT_OF_GLASS).is_none());
}

#[test]
fn specular_steps_keep_etendue() {
    let mirror = AffineMap::<4>::mirror_reflection(0.7, SHAPE);
    let surface = AffineMap::<4>::refracting_surface(0.7, SHAPE, &GLASS).unwrap();
    let same = AffineMap::<4>::refracting_surface(
        0.7,
        SHAPE,
        &Media {
            before: 1.5,
            after: 1.5,
        },
    )
    .unwrap();
    let path = AffineMap::travel(2.0)
        .then(&mirror)
        .then(&AffineMap::rotation(0.4))
        .then(&AffineMap::travel(0.5))
        .then(&AffineMap::thin_lens(0.3));
    for kept in [mirror, same, path] {
        assert!(kept.symplectic_defect(1.0) < ROUNDING);
        assert!((kept.det() - 1.0).abs() < ROUNDING);
    }
    // An interface between equal media has no effect, curved or not.
    assert!(apart(&same, &AffineMap::identity()) < ROUNDING);
    let ratio = GLASS.index_ratio();
    assert!(path.then(&surface).symplectic_defect(ratio) < ROUNDING);
    assert!((surface.det() - ratio * ratio).abs() < ROUNDING);
    assert!(surface.symplectic_defect(1.0) > 0.3); // 1 − 1/1.5
    let flat = AffineMap::<2>::refracting_surface(0.7, 0.4, &GLASS).unwrap();
    assert!(flat.symplectic_defect(ratio) < ROUNDING);
    assert!((flat.det() - ratio).abs() < ROUNDING);
    // An oblique surface is not perpendicular to the light, so the map onto the surface has a
    // symplectic defect. The map of a curved surface has a defect too if its shear by M lacks the
    // cosine, because then it is not a physical map.
    assert!(AffineMap::<4>::incidence(0.7).symplectic_defect(1.0) > 0.3);
    let nan = AffineMap::<2>::travel(f64::NAN);
    assert!(nan.symplectic_defect(1.0).is_nan());
}

/// The map from the frame (X, Y, D) to (−X, Y, −D), for light that returns along its path.
fn turn_round() -> AffineMap<4> {
    AffineMap::<4>::linear([
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, -1.0],
    ])
}

#[test]
fn paths_are_reversible() {
    let (distance, theta0, theta1) = (1.3, 0.7, -0.4);
    let theta2 = GLASS.refracted(theta1).unwrap();
    let there = AffineMap::<4>::mirror_reflection(theta0, SHAPE)
        .then(&AffineMap::travel(distance))
        .then(&AffineMap::<4>::refracting_surface(theta1, SHAPE, &GLASS).unwrap())
        .then(&AffineMap::thin_lens(0.7));
    let [[m11, m12], [m21, m22]] = SHAPE;
    // Seen from the other side, a concave surface is convex, T is reversed, and B is not reversed.
    let behind = [[-m11, m12], [m21, -m22]];
    let back = |behind| {
        AffineMap::<4>::thin_lens(0.7)
            .then(&AffineMap::<4>::refracting_surface(theta2, behind, &OUT_OF_GLASS).unwrap())
            .then(&AffineMap::travel(distance))
            .then(&AffineMap::<4>::mirror_reflection(-theta0, SHAPE))
    };
    let home = |back: AffineMap<4>| there.then(&turn_round()).then(&back).then(&turn_round());
    assert!(apart(&home(back(behind)), &AffineMap::identity()) < ROUNDING);
    assert!(apart(&home(back(SHAPE)), &AffineMap::identity()) > 0.1); // the test can fail
}

#[test]
fn sections_are_the_plane_of_incidence() {
    let k = SHAPE[0][0];
    let mirror = AffineMap::<4>::mirror_reflection(0.7, SHAPE).matrix;
    let flat = AffineMap::<2>::mirror_reflection(0.7, k).matrix;
    let surface = AffineMap::<4>::refracting_surface(0.7, SHAPE, &GLASS)
        .unwrap()
        .matrix;
    let line = AffineMap::<2>::refracting_surface(0.7, k, &GLASS)
        .unwrap()
        .matrix;
    for n in 0..4 {
        let (i, j) = (n / 2, n % 2);
        assert!((mirror[2 * i][2 * j] - flat[i][j]).abs() < ROUNDING);
        assert!((surface[2 * i][2 * j] - line[i][j]).abs() < ROUNDING);
    }
}

#[test]
fn turning_the_axes_turns_what_happens() {
    // Lenses and travel are rotationally symmetric.
    let turn = AffineMap::<4>::rotation(0.4);
    for step in [AffineMap::travel(1.2), AffineMap::thin_lens(0.6)] {
        assert!(apart(&turn.then(&step), &step.then(&turn)) < ROUNDING);
    }
    let full = (0..10).fold(AffineMap::identity(), |all, _| {
        all.then(&AffineMap::<4>::rotation(std::f64::consts::TAU / 10.0))
    });
    assert!(apart(&full, &AffineMap::identity()) < ROUNDING);
    // A point on the new first axis has a zero second coordinate.
    let (sin, cos) = libm::sincos(0.4_f64);
    let [x, y, ..] = turn.apply([cos, sin, 0.0, 0.0]);
    assert!((x - 1.0).abs() < ROUNDING && y.abs() < ROUNDING);
    // At normal incidence on a mirror, the orientation of the axes does not matter if the shape
    // operator turns with them.
    let [[a, b], [_, d]] = SHAPE;
    let turned = [
        [
            cos * cos * a - 2.0 * cos * sin * b + sin * sin * d,
            cos * sin * a + (cos * cos - sin * sin) * b - cos * sin * d,
        ],
        [
            cos * sin * a + (cos * cos - sin * sin) * b - cos * sin * d,
            sin * sin * a + 2.0 * cos * sin * b + cos * cos * d,
        ],
    ];
    // T is −X before the mirror and X after it, so the axes of the surface turn in the opposite
    // sense.
    let one = turn.then(&AffineMap::<4>::mirror_reflection(0.0, turned));
    let other = AffineMap::<4>::mirror_reflection(0.0, SHAPE).then(&AffineMap::rotation(-0.4));
    assert!(apart(&one, &other) < ROUNDING);
}
