//! Tests of the covariance of single factors, against finite differences.

use crate::covariance::{cosine, grating, lobe, mask, profile, slope_cosine};
use etendue_field::{
    ConvexPolygon, Disc, Grating, HalfPlane, Hole, Lobe, Mask, Profile, Rectangle, Shape,
};
use std::f64::consts::PI;

/// ∫ f'²/(4π² ∫ f²) on (−half, half), by finite differences.
fn moment(f: impl Fn(f64) -> f64, half: f64) -> f64 {
    let n = 200_000;
    let step = 2.0 * half / f64::from(n);
    let [mut slopes, mut squares] = [0.0; 2];
    for i in 0..n {
        let t = -half + (f64::from(i) + 0.5) * step;
        let slope = (f(t + 0.25 * step) - f(t - 0.25 * step)) / (0.5 * step);
        slopes += slope * slope;
        squares += f(t) * f(t);
    }
    slopes / (4.0 * PI * PI * squares)
}

/// Asserts equality up to the error of the midpoint rule on 2·10⁵ cells, which is below 10⁻⁸ for
/// the tested functions.
fn is(got: f64, expected: f64) {
    assert!((got / expected - 1.0).abs() < 1e-7, "{got} {expected}");
}

#[test]
fn smooth_windows_have_the_moment_of_their_power() {
    let hann = Profile::Hann(0.7);
    is(profile(&hann), moment(|t| hann.value(t), 0.7));
    let gaussian = Profile::Gaussian {
        width: 0.3,
        cut: 1.5,
    };
    is(profile(&gaussian), moment(|t| gaussian.value(t), 1.49));
    // A box has edges, so a Gaussian of the same variance replaces it.
    is(profile(&Profile::Box(0.6)), 1.0 / (8.0 * PI * PI * 0.12));
}

#[test]
fn cosines_have_the_moment_of_their_power() {
    let quarter = 0.5 * PI;
    is(cosine()[2][2], moment(libm::cos, quarter));
    is(cosine()[3][3], moment(|t| libm::cos(t).powi(2), quarter));
    // The moment of G is computed as an integral over rings: ∫ (∂G/∂u)² is half of the integral of
    // the squared radial derivative.
    let ring = |r: f64| (1.0 + r * r).powi(-2);
    let [mut slopes, mut squares] = [0.0; 2];
    for i in 0..400_000 {
        let r = (f64::from(i) + 0.5) * 1e-4;
        let slope = -4.0 * r * (1.0 + r * r).powi(-3);
        slopes += 0.5 * slope * slope * r;
        squares += ring(r).powi(2) * r;
    }
    is(slope_cosine()[2][2], slopes / (4.0 * PI * PI * squares));
    is(slope_cosine()[3][3], slope_cosine()[2][2]);
}

#[test]
fn lobes_have_the_moment_of_their_power() {
    let variance = |c: f64| 1.0 / (8.0 * PI * PI * c);
    // cosⁿ itself has the variance 1/n, to first order in 1/n.
    let phong = lobe(&Lobe::Phong { exponent: 400.0 }, 0.3).unwrap();
    let traced = variance(moment(|t| libm::pow(libm::cos(t), 400.0), 1.0));
    assert!((phong[2][2] / traced - 1.0).abs() < 2.0 / 400.0);
    // Distributions of normals are functions of slopes and are integrated over rings; a normal
    // that is tilted by an angle turns light by twice this angle.
    let of_rings = |f: &dyn Fn(f64) -> f64| {
        let [mut slopes, mut squares] = [0.0; 2];
        let step = 1e-5;
        for i in 0..400_000 {
            let r = (f64::from(i) + 0.5) * step;
            let slope = (f(r + 0.25 * step) - f(r - 0.25 * step)) / (0.5 * step);
            slopes += 0.5 * slope * slope * r;
            squares += f(r).powi(2) * r;
        }
        variance(slopes / (4.0 * PI * PI * squares))
    };
    let a = 0.1;
    let beckmann = lobe(&Lobe::Beckmann { roughness: a }, 0.0).unwrap();
    is(
        beckmann[2][2],
        of_rings(&|r| libm::exp(-r * r / (4.0 * a * a))),
    );
    let ggx = lobe(&Lobe::Ggx { roughness: a }, 0.0).unwrap();
    is(
        ggx[2][2],
        of_rings(&|r| (1.0 + r * r / (4.0 * a * a)).powi(-2)),
    );
    // Perpendicular to the plane of incidence, a tilted normal turns light by a smaller angle.
    let oblique = lobe(&Lobe::Beckmann { roughness: a }, 1.0).unwrap();
    is(oblique[3][3] / oblique[2][2], libm::cos(1.0_f64).powi(2));
    assert!(lobe(&Lobe::Lambertian, 0.0).is_none());
}

#[test]
fn a_grating_has_the_variance_of_its_lines() {
    let lines = Grating {
        axis: 0,
        frequency: 5.0,
        modulation: 0.8,
        phase: 0.3,
    };
    // The grating has lines at 0 and ±5 with powers ¼ and m²/16.
    let side = 0.64 / 16.0;
    is(grating(&lines), 25.0 * 2.0 * side / (0.25 + 2.0 * side));
    let factor = mask(&Mask::Grating(lines)).unwrap();
    is(factor[0][0], grating(&lines));
    assert!(factor[1][1].abs() < f64::MIN_POSITIVE);
}

#[test]
fn a_hole_is_a_gaussian_of_its_covariance() {
    let center = [0.1, -0.05];
    let hole = |shape| mask(&Mask::Aperture(Hole::Shape(shape)));
    let slit = Rectangle {
        center,
        size: [0.4, 0.6],
    };
    let slit = hole(Shape::Rectangle(slit)).unwrap();
    // The variance of a coordinate in a slit of half-width h is h²/3.
    is(slit[0][0], 3.0 / (8.0 * PI * PI * 0.04));
    is(slit[1][1], 3.0 / (8.0 * PI * PI * 0.09));
    // The variance of a coordinate in a disc of radius r is r²/4.
    let round = hole(Shape::Disc(Disc {
        center,
        radius: 0.2,
    }));
    is(round.unwrap()[0][0], 1.0 / (2.0 * PI * PI * 0.04));
    // A square of side √2 s stands on its corner after a turn by 45 degrees. Stretched along one
    // diagonal by 2, it has the variances s²/3 · 4/2 and s²/3 · 1/2 along its diagonals.
    let corners = [[0.4, 0.4], [-0.2, 0.2], [-0.4, -0.4], [0.2, -0.2]];
    let polygon = ConvexPolygon::new(corners.to_vec()).unwrap();
    let rhombus = mask(&Mask::Aperture(Hole::Polygon(polygon))).unwrap();
    let along = |variance: f64| 1.0 / (8.0 * PI * PI * variance);
    let (long, short) = (along(0.32 / 6.0), along(0.08 / 6.0));
    is(rhombus[0][0] + rhombus[0][1], long);
    is(rhombus[0][0] - rhombus[0][1], short);
    is(rhombus[1][0] + rhombus[1][1], long);
    // The central ray meets the screen.
    let beside = Shape::Disc(Disc {
        center: [0.3, 0.0],
        radius: 0.2,
    });
    assert!(hole(beside).is_none());
}

#[test]
fn blockers_are_openings_about_the_central_ray() {
    let wall = |x: f64, y: f64| {
        Shape::Rectangle(Rectangle {
            center: [x, y],
            size: [0.2, 0.4],
        })
    };
    let opaque = |shapes, half_planes| {
        mask(&Mask::Opaque {
            shapes,
            half_planes,
        })
    };
    let of = |half: f64| 3.0 / (8.0 * PI * PI * half * half);
    // The nearest point of the first shape is at 0.4 along x, and the nearest point of the second
    // is at (0.2, 0.3), which is nearer to the central ray.
    let beside = opaque(vec![wall(-0.5, 0.1), wall(0.3, 0.5)], vec![]).unwrap();
    is(beside[0][0], of(0.13_f64.sqrt()));
    is(beside[1][1], of(0.13_f64.sqrt()));
    // A half-plane narrows the opening only along the half-plane's axis.
    let half = HalfPlane {
        axis: 1,
        edge: -0.3,
        above: false,
    };
    let both = opaque(vec![wall(-0.5, 0.1)], vec![half]).unwrap();
    is(both[0][0], of(0.4));
    is(both[1][1], of(0.3));
    let edge = opaque(vec![], vec![half]).unwrap();
    assert!(edge[0][0].abs() < f64::MIN_POSITIVE);
    let disc = Shape::Disc(Disc {
        center: [0.4, 0.3],
        radius: 0.2,
    });
    is(opaque(vec![disc], vec![]).unwrap()[0][0], of(0.3));
    // The first mask blocks the central ray, and the second mask has an edge on the central ray.
    assert!(opaque(vec![wall(0.0, 0.1)], vec![]).is_none());
    assert!(opaque(vec![wall(0.1, 0.0)], vec![]).is_none());
}
