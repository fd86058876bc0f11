//! Tests of covariance tracing along chains, against quadrature.

use super::apart;
use crate::covariance::{SpectralCovariance, Traced, Untraced, window};
use crate::geometry::tests::covariance::{gaussian_window, power_spectrum};
use crate::geometry::{AffineMap, Edition, Matrix, diagonal, sum};
use crate::path::rays;
use crate::path::{self, Interaction, PathMask, PathSurface, PathSystem};
use crate::plane::Plane;
use crate::testing::{chain_of, mask_at, opaque};
use crate::{Chain, Observed, Operator};
use etendue_field::{
    Brdf, Disc, Frame, Fresnel, Grating, Image, Light, Lobe, Patch, Pattern, Profile, Reflectance,
    Shape, Specular, Window,
};
use std::f64::consts::{PI, TAU};

fn disc(x: f64, radius: f64) -> Shape {
    Shape::Disc(Disc {
        center: [x, 0.0],
        radius,
    })
}

fn lamp() -> Light {
    Light::Area {
        shape: disc(0.0, 0.2),
        radiance: 1.0,
        exponent: 30.0,
    }
}

/// The light in these tests has these variances S along x, y, u and v.
const LAMP: [f64; 4] = [0.01, 0.01, 1.0 / 30.0, 1.0 / 30.0];

/// The standard deviations of the Gaussian window that replaces an opening of the given
/// half-width.
fn open(half: f64) -> [f64; 4] {
    let endless = f64::INFINITY;
    let along = half / 3.0_f64.sqrt();
    [along, along, endless, endless]
}

fn seen() -> Window {
    let gaussian = |width: f64| Profile::Gaussian { width, cut: 9.0 };
    Window {
        x: gaussian(0.5),
        y: gaussian(0.4),
        u: gaussian(0.3),
        v: gaussian(0.2),
    }
}

/// The spectral covariance C of a field with the covariance S, after the window [`seen`].
fn windowed(field: &Matrix<4>) -> Matrix<4> {
    let stds = [0.5, 0.4, 0.3, 0.2].map(|width: f64| width / TAU.sqrt());
    power_spectrum(&gaussian_window(field, stds).unwrap()).unwrap()
}

fn of(traced: &dyn Traced) -> Matrix<4> {
    let light = traced.spectral_covariance().unwrap();
    light.multiplied(&window(&seen())).matrix().unwrap()
}

#[test]
fn between_parallel_planes() {
    let beside = opaque(vec![disc(-0.5, 0.2)]);
    let chain = chain_of(lamp(), [(0.6, Some(beside)), (0.9, None)]);
    let met = AffineMap::<4>::travel(0.6).covariance(&diagonal(LAMP));
    let passed = gaussian_window(&met, open(0.3)).unwrap();
    let expected = windowed(&AffineMap::<4>::travel(0.9).covariance(&passed));
    assert!(apart(&of(&chain), &expected) < 1e-12); // rounding of inverses
    let across = chain_of(lamp(), [(0.6, Some(opaque(vec![disc(0.1, 0.2)])))]);
    assert_eq!(across.spectral_covariance(), Err(Untraced::Blocked));
}

#[test]
fn a_receiver_leaves_the_irradiance_even_over_slopes() {
    let mut chain: Chain = chain_of(lamp(), [(1.2, None)]);
    chain.operators.push(Operator::Diffuse {
        name: "floor".into(),
        albedo: 0.5,
    });
    let met = AffineMap::<4>::travel(1.2).covariance(&diagonal(LAMP));
    let c = chain.spectral_covariance().unwrap().matrix().unwrap();
    assert!((c[0][0] * 8.0 * PI * PI * met[0][0] - 1.0).abs() < 1e-12); // rounding
    assert_eq!([c[2], c[3]], [[0.0; 4]; 2]);
}

/// Builds a surface 1 m from the light. The central ray meets the surface at 0.4 rad, and the
/// surface's principal axes are turned about its normal.
fn patch() -> Patch {
    let leg = Frame::IDENTITY.travelled(1.0);
    let (sin, cos) = libm::sincos(0.4);
    let d = -leg.d * cos + leg.x * sin;
    Patch {
        frame: Frame::new(leg.origin, d, leg.x + leg.y * 0.3).unwrap(),
        curvature: [0.5, 0.3, 0.5],
        aperture: 1e3,
    }
}

/// A plane perpendicular to the mirrored central ray, 0.7 m behind the surface.
fn beyond() -> Plane {
    let leg = Frame::IDENTITY.travelled(1.0);
    let normal = patch().frame.d;
    let mirrored = |v: glam::DVec3| v - 2.0 * v.dot(normal) * normal;
    let frame = Frame::new(leg.origin, mirrored(leg.d), mirrored(leg.x)).unwrap();
    Plane::orthogonal(frame.travelled(0.7))
}

fn masks() -> Vec<PathMask> {
    vec![mask_at(0.4, opaque(vec![disc(-0.5, 0.2)]))]
}

#[test]
fn behind_a_curved_mirror() {
    let mirror = Interaction::Specular(Specular::Mirror);
    let view = Observed {
        system: PathSystem {
            masks: masks(),
            ..PathSystem::new(lamp(), vec![PathSurface::new("mirror", patch(), mirror)])
        },
        plane: beyond(),
    };
    let met = AffineMap::<4>::travel(0.4).covariance(&diagonal(LAMP));
    let passed = gaussian_window(&met, open(0.3)).unwrap();
    let whole = rays::chain(&view, Edition::Corrected).unwrap().map.rays();
    let rest = AffineMap::<4>::travel(-0.4).then(&whole);
    let expected = windowed(&rest.covariance(&passed));
    assert!(apart(&of(&view), &expected) < 1e-12); // rounding of inverses
}

#[test]
fn behind_a_textured_lobe() {
    let lines = Grating {
        axis: 0,
        frequency: 3.0,
        modulation: 0.9,
        phase: 0.0,
    };
    let light = Light::Projector {
        intensity: 1.0,
        image: Image {
            width: [0.15, 0.2],
            grating: None,
        },
    };
    let view = |texture: Option<Pattern>| {
        let reflectance = Reflectance {
            texture,
            ..Brdf::new(Lobe::Phong { exponent: 100.0 }, 1.0, Fresnel::White).into()
        };
        let interaction = Interaction::Reflects(Box::new(reflectance));
        let sphere = PathSurface::new("sphere", patch(), interaction);
        Observed {
            system: PathSystem::new(light.clone(), vec![sphere]),
            plane: beyond(),
        }
    };
    let chain = path::chain(&view(None)).unwrap();
    let light = [0.15, 0.2].map(|width: f64| width * width / TAU);
    let light = diagonal([0.0, 0.0, light[0], light[1]]);
    // The cosine acts as a Gaussian window of variances ½ and ⅜ over the two angles.
    let endless = f64::INFINITY;
    let cosine = [endless, endless, 0.5_f64.sqrt(), 0.375_f64.sqrt()];
    let lit = gaussian_window(&chain.maps[0].covariance(&light), cosine).unwrap();
    let mirrored = AffineMap::<4>::mirror().covariance(&lit);
    let left = sum(&mirrored, &diagonal([0.0, 0.0, 0.01, 0.01]));
    let expected = windowed(&chain.maps[1].covariance(&left));
    let plain = of(&view(None));
    assert!(apart(&plain, &expected) < 1e-10); // rounding; both have the same difference maps
    // The grating adds the variance of its spectral lines along the axis of the patch on which its
    // transmission varies.
    let textured = of(&view(Some(Pattern::Cosine(lines))));
    let mut along = [[0.0; 4]; 4];
    let frame = chain.scatterers[0].frame;
    let axis = [frame.x, frame.y].map(|t| t.dot(patch().frame.x));
    for (i, a) in axis.iter().enumerate() {
        for (j, b) in axis.iter().enumerate() {
            along[i][j] = a * b * 9.0 * 0.81 / 2.81;
        }
    }
    let added = chain.maps[1].spectral_covariance(&along).unwrap();
    assert!(apart(&textured, &sum(&plain, &added)) < 1e-10); // rounding
    let squares = Pattern::Checkerboard { period: 0.1 };
    let untraced = view(Some(squares)).spectral_covariance();
    assert_eq!(untraced, Err(Untraced::Reflectance));
}

#[test]
fn pictures_of_projectors_and_beams() {
    let image = Image {
        width: [0.3, 0.2],
        grating: Some(Grating {
            axis: 1,
            frequency: 4.0,
            modulation: 1.0,
            phase: 0.0,
        }),
    };
    // The spectra of a beam and of a projector are unbounded before a lobe, but not after it.
    let blurred = |c: SpectralCovariance| c.convolved(&diagonal([0.01; 4])).matrix().unwrap();
    let near = |light: Light| blurred(chain_of(light, []).spectral_covariance().unwrap());
    let [a, b] = [0.09 / TAU, 0.04 / TAU];
    let beam = near(Light::Beam {
        irradiance: 1.0,
        image,
    });
    let mut lines = [[0.0; 4]; 4];
    lines[1][1] = 16.0 / 3.0;
    let plain = SpectralCovariance::new([a, b, 0.0, 0.0]);
    assert!(apart(&beam, &blurred(plain.multiplied(&lines))) < 1e-14); // rounding
    let slides = near(Light::Projector {
        intensity: 1.0,
        image,
    });
    let mut lines = [[0.0; 4]; 4];
    lines[3][3] = 16.0 / 3.0;
    let plain = SpectralCovariance::new([0.0, 0.0, a, b]);
    assert!(apart(&slides, &blurred(plain.multiplied(&lines))) < 1e-14); // rounding
}
