//! Curves of kernels that the paper draws: cosines and Fresnel factors, and their transforms.

use crate::failure::Failure;
use crate::figure::recipe::Taken;
use etendue_figures::{Curve, CurveKind, CurvePanel, Curves, Figure, Quantity};
use etendue_theory::shading::{Fresnel, cosine_hat, g_hat, g_hat_3d};
use std::f64::consts::FRAC_PI_2;

/// Points of a curve.
const POINTS: u32 = 400;

/// A function on an interval.
fn curve(kind: CurveKind, name: &str, [from, to]: [f64; 2], f: &dyn Fn(f64) -> f64) -> Curve {
    let point = |i: u32| {
        let x = from + (to - from) * f64::from(i) / f64::from(POINTS);
        [x, f(x), 0.0]
    };
    Curve::new(kind, name, (0..=POINTS).map(point).collect())
}

fn panel(title: &str, x: Quantity, curves: Vec<Curve>) -> CurvePanel {
    CurvePanel {
        title: title.to_owned(),
        x,
        curves,
        is_log: [false; 2],
    }
}

fn values(title: &str, note: &str, panels: Vec<CurvePanel>) -> Curves {
    Curves {
        title: title.to_owned(),
        note: note.to_owned(),
        y: Quantity::new("value", ""),
        panels,
    }
}

/// g(v) and G(u, v), and their transforms (docs/theory.md (6) and (7)).
pub(crate) fn slopes(taken: &Taken<'_>) -> Result<Figure, Failure> {
    let slope = || Quantity::new("*v*", "slope");
    let frequency = || Quantity::new("*Ω*", "cycles/slope");
    let g = |v: f64| libm::pow(1.0 + v * v, -1.5);
    let g_3d = |v: f64| libm::pow(1.0 + v * v, -2.0);
    let (flat, solid) = ("2D: *g*", "3D: *G*, along one axis");
    taken.curves(&values(
        "The cosine over slopes, and its transforms",
        "*g* = (1 + *v*^{2})^{−3/2}, *G* = (1 + *u*^{2} + *v*^{2})^{−2}; transforms 4π|*Ω*| *K*_{1}(2π|*Ω*|) and half π times that.",
        vec![
            panel(
                "in slope",
                slope(),
                vec![
                    curve(CurveKind::Theory, flat, [-3.0, 3.0], &g),
                    curve(CurveKind::Rival, solid, [-3.0, 3.0], &g_3d),
                ],
            ),
            panel(
                "transforms",
                frequency(),
                vec![
                    curve(CurveKind::Theory, flat, [-1.5, 1.5], &g_hat),
                    curve(CurveKind::Rival, solid, [-1.5, 1.5], &|o| g_hat_3d(o, 0.0)),
                ],
            ),
        ],
    ))
}

/// cos₊ and cos₊ times the Fresnel factors of a dielectric and a conductor (Fig. 12).
pub(crate) fn fresnel(taken: &Taken<'_>) -> Result<Figure, Failure> {
    let glass = Fresnel::Dielectric { index: 1.5 };
    // Aluminium at 650 nm, as in the figures of microfacet papers.
    let metal = Fresnel::Conductor {
        index: 1.488,
        extinction: 7.821,
    };
    let angles = || Quantity::new("*θ*", "radians");
    let frequency = || Quantity::new("*Ω*", "cycles/rad");
    let range = [-FRAC_PI_2, FRAC_PI_2];
    let cosine = |theta: f64| libm::cos(theta);
    let both = |of: Fresnel| move |theta: f64| of.reflectance(theta) * libm::cos(theta);
    let pair = |title: &str, value: &dyn Fn(f64) -> f64, transform: &dyn Fn(f64) -> f64| {
        [
            panel(
                &format!("{title}, over angle"),
                angles(),
                vec![curve(CurveKind::Theory, "theory", range, value)],
            ),
            panel(
                &format!("{title}, transform"),
                frequency(),
                vec![curve(CurveKind::Theory, "theory", [-2.0, 2.0], transform)],
            ),
        ]
    };
    let pairs = [
        pair("cos_{+}", &cosine, &cosine_hat),
        pair("× glass", &both(glass), &|o| glass.cosine_hat(o)),
        pair("× aluminium", &both(metal), &|o| metal.cosine_hat(o)),
    ];
    let [functions, transforms]: [Vec<CurvePanel>; 2] =
        [0, 1].map(|i| pairs.iter().map(|pair| pair[i].clone()).collect());
    let panels = [functions, transforms].concat();
    taken.curves(&values(
        "The clamped cosine, alone and with Fresnel factors",
        "Glass: *n* = 1.5. Aluminium: 1.488 + 7.821 i, at 650 nm.",
        panels,
    ))
}
