//! Tests of predicted spectra against closed forms and Gauss rules.

use super::*;
use crate::Parameter;
use crate::obstacle::{Obstacle, ObstacleForm};
use crate::quadrature::gauss_legendre;
use crate::testing::{
    chain_of, disc, half_plane, lambertian, mask_at, opaque, rectangles, spot, square,
};
use etendue_field::{ConvexPolygon, Grating, Hole, Mask, Shape};
use std::f64::consts::{PI, TAU};

/// Relative error allowed for a midpoint rule: ten times the error at which refinement stops.
const GOOD: f64 = 1e-6;
/// Relative error allowed for nets of two million rays.
const OF_NETS: f64 = 1.5e-3;

/// Slices whose values are computed by a function of the frequency.
fn slices_of(grid: &SliceGrid, value: impl Fn([f64; 4]) -> Complex) -> Slices {
    let mut slices = Slices::zeros(*grid);
    for ((k, m, n), to) in slices.half.indexed_iter_mut() {
        *to = value(grid.frequency(k, m as f64 * grid.rho.spacing, grid.nu.value(n)));
    }
    slices
}

/// The spectrum at distance d of a projector's field, computed by a Gauss rule over
/// slopes. On x = d u, y = d v the field is the image times √(1 + u² + v²), because off-axis
/// positions are farther from the projector (docs/theory.md, section 2). If `exact` is false, the
/// factor √(1 + u² + v²) is omitted.
fn at_distance(d: f64, width: f64, window: &Window, grid: &SliceGrid, exact: bool) -> Slices {
    let most = (window.x.half_width() / d).min(window.u.half_width());
    // A Gauss rule with 70 nodes is accurate for integrands with up to 22 cycles.
    let nodes: Vec<_> = gauss_legendre(100)
        .into_iter()
        .map(|(t, weight)| {
            let u = most * t;
            let seen = window.x.value(d * u) * window.u.value(u);
            (
                u,
                weight * most * seen * libm::exp(-PI * (u / width).powi(2)),
            )
        })
        .collect();
    let root = |u: f64, v: f64| {
        if exact {
            (1.0 + u * u + v * v).sqrt()
        } else {
            1.0
        }
    };
    slices_of(grid, |[ox, oy, ou, ov]| {
        let pairs = nodes.iter().flat_map(|a| nodes.iter().map(move |b| (a, b)));
        pairs
            .map(|((u, p), (v, q))| {
                let phase = (ox * d + ou) * u + (oy * d + ov) * v;
                Complex::from_polar(p * q * root(*u, *v), -TAU * phase)
            })
            .sum()
    })
}

#[test]
fn projector_over_a_distance() {
    let d = 1.5;
    let gaussian = |width, cut| Profile::Gaussian { width, cut };
    let windows = [
        window(Profile::Hann(0.3), Profile::Hann(0.25)),
        window(gaussian(0.2, 0.45), gaussian(0.2, 0.4)),
    ];
    for window in windows {
        let system = PathSystem::new(projector([0.3, 0.3]), vec![]);
        let grid = grid(3, [0.3, 0.25]);
        let got = exact(&system, &after(&system, d), &window, &grid);
        let expected = at_distance(d, 0.3, &window, &grid, true);
        let off = got.slices.relative_difference(&expected);
        assert!(off < GOOD && got.error.unwrap() < GOOD, "{off:e}");
        // A prediction without the factor √(1 + u² + v²) fails this test.
        let without = at_distance(d, 0.3, &window, &grid, false);
        let told = got.slices.relative_difference(&without);
        assert!(told > 10.0 * GOOD, "{told}");
    }
}

#[test]
fn beam_over_a_distance() {
    // A beam does not change with distance, and its spectrum is constant in Ωu and Ωv.
    let (width, cut) = (0.2, 0.7);
    let system = PathSystem::new(beam([width, 0.3]), vec![]);
    let window = window(Profile::Gaussian { width: 0.4, cut }, Profile::Hann(0.1));
    let grid = grid(4, [0.3, 0.1]);
    let got = exact(&system, &after(&system, 2.0), &window, &grid);
    let narrowed = |w: f64| 1.0 / (1.0 / (w * w) + 1.0 / 0.16_f64).sqrt();
    let [a, b] = [width, 0.3].map(narrowed);
    let expected = slices_of(&grid, |[x, y, ..]| {
        Complex::from(a * b * libm::exp(-PI * (a * a * x * x + b * b * y * y)))
    });
    // The window is cut at 0.7, where the product of window and image is exp(−π (0.49/0.16 +
    // 0.49/0.09)) of its peak.
    let off = got.slices.relative_difference(&expected);
    assert!(off < 1e-9, "{off:e}");
}

#[test]
fn area_lights_agree_with_polygons() {
    let steps = || {
        let grating = Grating {
            axis: 0,
            frequency: 3.0,
            modulation: 0.8,
            phase: 0.4,
        };
        vec![(0.6, Some(Mask::Grating(grating))), (0.9, None)]
    };
    let window = window(Profile::Hann(0.3), Profile::Hann(0.3));
    let grid = grid(2, [0.3, 0.3]);
    let lights = [
        lambertian(square([0.02, 0.0], 0.2)),
        spot(disc([0.0, 0.03], 0.1), 0.0),
        spot(disc([0.0, 0.03], 0.1), 20.0),
    ];
    for light in lights {
        let expected = crate::slices(&chain_of(light.clone(), steps()), &window, &grid);
        let mut system = PathSystem::new(light, vec![]);
        let Some(Mask::Grating(grating)) = steps()[0].1 else {
            unreachable!()
        };
        system.masks = vec![mask_at(0.6, Mask::Grating(grating))];
        let got = exact(&system, &after(&system, 1.5), &window, &grid);
        let off = got.slices.relative_difference(&expected);
        let said = got.error.unwrap();
        assert!(off < OF_NETS && off < 2.0 * said, "{off:e}, said {said:e}");
        // A prediction for a grating that is one centimetre farther from the light differs
        // detectably.
        system.masks = vec![mask_at(0.61, Mask::Grating(grating))];
        let moved = exact(&system, &after(&system, 1.5), &window, &grid);
        let told = moved.slices.relative_difference(&expected);
        assert!(told > 3.0 * said, "{told}");
    }
}

/// Tests the errors of the shadows of a rectangle and of a disc. Edges of shadows reduce the
/// advantage of nets over random points.
#[test]
fn shadows_are_as_good_as_stated() {
    let square_light = Shape::Rectangle(square([0.0, 0.05], 0.2));
    let masks = [
        rectangles(&[square([0.05, 0.0], 0.1)]),
        opaque(vec![disc([0.05, 0.0], 0.06)]),
    ];
    for mask in masks {
        for light in [Light::Point { intensity: 2.0 }, spot(square_light, 0.0)] {
            let (off, said) = shadow(light, mask.clone());
            assert!(off < OF_NETS && off < 2.0 * said, "{off:e}, said {said:e}");
        }
    }
}

/// The error of a mask's shadow relative to its closed form, and its estimated error.
fn shadow(light: Light, mask: Mask) -> (f64, f64) {
    let window = window(Profile::Hann(0.3), Profile::Hann(0.3));
    let grid = grid(2, [0.3, 0.3]);
    let steps = [(0.6, Some(mask.clone())), (0.9, None)];
    let expected = crate::slices(&chain_of(light.clone(), steps), &window, &grid);
    let mut system = PathSystem::new(light, vec![]);
    system.masks = vec![mask_at(0.6, mask)];
    let got = exact(&system, &after(&system, 1.5), &window, &grid);
    (
        got.slices.relative_difference(&expected),
        got.error.unwrap(),
    )
}

/// Derivatives with respect to masks agree with those of closed forms.
#[test]
fn derivatives_of_masks_are_those_of_closed_forms() {
    for mask in [
        rectangles(&[square([0.05, 0.0], 0.1)]),
        opaque(vec![disc([0.05, 0.0], 0.06)]),
        half_plane(1, 0.12, true),
        crate::testing::grating(0, 3.0, 0.4),
        rectangular_hole(),
    ] {
        let known = by_closed_form(&mask);
        assert!(!known.is_empty());
        for (name, known) in known {
            let off = by_rays(&behind(&mask), &[&name]).relative_difference(&known);
            assert!(off < OF_DERIVATIVES, "{mask:?}, {name}: {off}");
        }
    }
}

/// Few rays meet the edge of a small disc. Noise would make a derivative too long, so that a change of
/// the parameter is measured too small.
#[test]
fn noise_does_not_lengthen_derivatives() {
    let (mut shares, mut noises) = (Vec::new(), Vec::new());
    for i in -4..=4 {
        let mask = opaque(vec![disc([0.02 * f64::from(i), 0.01], 0.014)]);
        let system = behind(&mask);
        let view = view(&system, &after(&system, 1.5));
        let parameters = view.parameters();
        let found = derivatives(&view, &parameters, RayBudget::new(1e4, 1e-3));
        let names = parameters.iter().map(|parameter| view.name(*parameter));
        let found: Vec<(String, Slices)> = names.zip(found).collect();
        for (name, known) in by_closed_form(&mask) {
            let (_, own) = found.iter().find(|(own, _)| *own == name).unwrap();
            // Most of the derivative may be noise; then there is none.
            if own.is_dark() {
                continue;
            }
            let along = |of: &Slices| -> f64 {
                let cells = of.half.iter().zip(&own.half);
                cells.map(|(a, b)| a.re * b.re + a.im * b.im).sum()
            };
            shares.push(along(&known) / along(own));
            noises.push(own.relative_difference(&known));
        }
    }
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    assert!(shares.len() > 10 && mean(&noises) > 0.4, "{noises:?}");
    // A change of a parameter is measured as this share of itself. Without the factor of
    // `NetMean::without_noise`, the mean is 0.75.
    let error_of_mean = 0.03; // the shares spread by 0.13
    assert!(
        (mean(&shares) - 1.0).abs() < 3.0 * error_of_mean,
        "{shares:?}"
    );
}

/// An obstacle across the central ray's leg is a mask. Of the sizes and the positions that a mask
/// has, an obstacle has the same derivatives.
#[test]
fn obstacles_move_as_masks_do() {
    let frame = Frame {
        origin: DVec3::new(0.05, 0.0, 0.6),
        ..Frame::IDENTITY
    };
    let corner = |x: f64, y: f64| frame.origin + 0.05 * DVec3::new(x, y, 0.0);
    let [a, b] = [corner(-1.0, -1.0), corner(1.0, 1.0)];
    let triangles = [1.0, -1.0].map(|side| [a, b, corner(-side, side)]);
    let card = ObstacleForm::Rectangle {
        frame,
        size: [0.1; 2],
    };
    let round = ObstacleForm::Patch(Patch {
        frame,
        curvature: [0.0; 3],
        aperture: 0.06,
    });
    let square = rectangles(&[square([0.05, 0.0], 0.1)]);
    for (form, mask, count) in [
        (card, &square, 4),
        (ObstacleForm::mesh(triangles.to_vec()), &square, 2),
        (round, &opaque(vec![disc([0.05, 0.0], 0.06)]), 3),
    ] {
        let mut system = PathSystem::new(light_above(), vec![]);
        system.obstacles.push(Obstacle {
            name: "b".into(),
            form: form.clone(),
            until: None,
        });
        let mut found = 0;
        for (name, known) in by_closed_form(mask) {
            let name = name.replace("radius", "aperture");
            if name.contains("side") && count == 2 {
                continue;
            }
            found += 1;
            let off = by_rays(&system, &[&name]).relative_difference(&known);
            assert!(off < OF_DERIVATIVES, "{form:?}, {name}: {off}");
        }
        assert_eq!(found, count);
    }
}

/// Two corners of a polygon that move together move an edge of a rectangular hole. The side of the
/// hole grows by as much, and its centre moves by half of it.
#[test]
fn corners_move_as_the_edge_between_them() {
    let [x, y] = [0, 1].map(|axis| HOLE.extent(axis));
    let mut corners = vec![[x[0], y[0]], [x[0], y[1]], [x[1], y[1]], [x[1], y[0]]];
    let mut known = by_closed_form(&rectangular_hole()).into_iter();
    let mut of = |part: &str| known.find(|(name, _)| name.starts_with(part)).unwrap().1;
    let mut edge = of("side x");
    edge.half += &(of("position x").half * Complex::from(0.5));
    // Names follow the scene's order of corners, clockwise or not.
    for names in [[3, 4], [1, 2]] {
        let polygon = ConvexPolygon::new(corners.clone()).unwrap();
        let mask = Mask::Aperture(Hole::Polygon(polygon));
        let names = names.map(|number| format!("x of corner {number} of b"));
        let off = by_rays(&behind(&mask), &[&names[0], &names[1]]).relative_difference(&edge);
        assert!(off < OF_DERIVATIVES, "{names:?}: {off}");
        corners.reverse();
    }
}

/// Nets add nodes until derivatives have a relative error of 0.1; steps add less.
const OF_DERIVATIVES: f64 = 0.15;

const HOLE: Rectangle = Rectangle {
    center: [0.05, 0.0],
    size: [0.2; 2],
};

fn rectangular_hole() -> Mask {
    Mask::Aperture(Hole::Shape(Shape::Rectangle(HOLE)))
}

fn light_above() -> Light {
    spot(Shape::Rectangle(square([0.0, 0.05], 0.2)), 0.0)
}

fn by_closed_form(mask: &Mask) -> Vec<(String, Slices)> {
    let steps = [(0.6, Some(mask.clone())), (0.9, None)];
    let chain = chain_of(light_above(), steps);
    let mut parameters = chain.parameters();
    parameters.retain(|parameter| parameter.mask().is_some());
    let names = parameters.iter().map(|parameter| chain.name(*parameter));
    names
        .zip(derivatives(&chain, &parameters, BUDGET))
        .collect()
}

fn behind(mask: &Mask) -> PathSystem {
    let mut system = PathSystem::new(light_above(), vec![]);
    system.masks = vec![mask_at(0.6, mask.clone())];
    system
}

/// The sum of the derivatives with respect to some parameters of a path.
fn by_rays(system: &PathSystem, names: &[&str]) -> Slices {
    let view = view(system, &after(system, 1.5));
    let mut parameters = view.parameters();
    parameters.retain(|parameter| names.contains(&view.name(*parameter).as_str()));
    let each = derivatives(&view, &parameters, BUDGET).into_iter();
    each.reduce(|sum, one| Slices {
        half: sum.half + &one.half,
        ..sum
    })
    .unwrap()
}

fn derivatives(model: &impl Model, parameters: &[Parameter], budget: RayBudget) -> Vec<Slices> {
    let window = window(Profile::Hann(0.3), Profile::Hann(0.3));
    let grid = grid(2, [0.3, 0.3]);
    let over = (&window, &grid, &ProjectionGrid::new(&window, 32));
    model.predict(parameters, over, budget).derivatives
}

#[test]
fn plane_mirror_is_a_travel() {
    let window = window(Profile::Hann(0.3), Profile::Hann(0.25));
    let grid = grid(4, [0.3, 0.25]);
    let light = Light::Projector {
        intensity: 1.0,
        image: Image {
            width: [0.3, 0.2],
            grating: Some(Grating {
                axis: 0,
                frequency: 4.0,
                modulation: 1.0,
                phase: 0.7,
            }),
        },
    };
    let folded = mirror(
        light.clone(),
        std::f64::consts::FRAC_PI_4,
        [0.0, 0.0],
        [0.0; 3],
    );
    let straight = PathSystem::new(light, vec![]);
    let got = exact(&folded, &after(&folded, 0.5), &window, &grid);
    // The mirror reverses the x axis of the frame (x' = −x, y' = y), so azimuths φ become π − φ
    // and (ρ, ν) become (−ρ, −ν).
    let expected = exact(&straight, &after(&straight, 1.5), &window, &grid);
    let full = expected.slices.full();
    let mut turned = Slices::zeros(grid);
    let [last_rho, last_nu] = [grid.rho.count() - 1, grid.nu.count() - 1];
    for ((k, m, n), to) in turned.half.indexed_iter_mut() {
        let i = grid.rho.half + m;
        *to = if k == 0 {
            full[[0, last_rho - i, last_nu - n]]
        } else {
            full[[grid.azimuths - k, i, n]]
        };
    }
    let off = got.slices.relative_difference(&turned);
    assert!(off < 1e-9, "{off:e}"); // the same lattice of rays, but reversed
    assert!(got.slices.relative_difference(&expected.slices) > 0.01);
}

#[test]
fn lens_images_a_slide() {
    // The slide is a Lambertian light of 1 cm² with a grating directly on it. The slide is at a =
    // 0.5 m from a lens of focal length f = 0.3 m, so its image is at b = 0.75 m.
    let (a, f) = (0.5, 0.3);
    let b = 1.0 / (1.0 / f - 1.0 / a);
    let patch = placed(&Frame::IDENTITY, a, 0.0, [0.0; 2], [0.0; 3]);
    let lens = Specular::ThinLens { focal_length: f };
    let mut system = PathSystem::new(
        lambertian(square([0.0; 2], 0.02)),
        vec![element("lens", patch, lens)],
    );
    system.masks = vec![mask_at(1e-6, crate::testing::grating(0, 200.0, 0.0))];
    let window = window(Profile::Hann(0.02), Profile::Hann(0.05));
    let rho = 200.0 * a / b;
    let axis = |spacing| FrequencyAxis { half: 1, spacing };
    let grid = SliceGrid {
        azimuths: 1,
        rho: axis(rho),
        nu: axis(1.0),
    };
    let contrast = |distance: f64| {
        let slices = exact(&system, &after(&system, distance), &window, &grid).slices;
        slices.half[[0, 1, 1]].norm() / slices.at_zero()
    };
    let sharp = contrast(b);
    // The contrast of a sharp image of the grating is m/2 = 0.45; in a window of a few periods the
    // contrast is lower by at most a few per cent.
    assert!((sharp - 0.45).abs() < 0.02, "{sharp}");
    // At a plane 5 cm out of focus, slopes of ± 0.05 blur the image by ± 2.5 mm, a third of the
    // image's period of 7.5 mm.
    assert!(contrast(b + 0.05) < 0.9 * sharp);
}
