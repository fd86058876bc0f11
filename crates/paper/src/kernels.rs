//! Curves of kernels in the paper: cosines and Fresnel factors, and their transforms.

use crate::energy::energy_below;
use crate::rows::letter_panels;
use crate::subject::FigureData;
use etendue_field::Fresnel;
use etendue_figures::{
    Axis, AxisQuantity, Curve, CurveKind, CurvePanel, Figure, Picture, Plate, PlateRow, Scale,
    stacked,
};
use etendue_store::Failure;
use etendue_theory::shading::{
    cosine_hat, fresnel_cosine_hat, fresnel_reflectance, g_hat, g_hat_3d,
};
use etendue_transform::gauss_legendre;
use ndarray::Array2;
use std::f64::consts::FRAC_PI_2;

/// Number of points of a curve.
const POINTS: u32 = 400;
/// Number of cells of a picture along each axis.
const CELLS: usize = 121;

/// The curve of a function on an interval.
fn curve(kind: CurveKind, name: &str, [from, to]: [f64; 2], f: &dyn Fn(f64) -> f64) -> Curve {
    let point = |i: u32| {
        let x = from + (to - from) * f64::from(i) / f64::from(POINTS);
        [x, f(x), 0.0]
    };
    Curve::new(kind, name, (0..=POINTS).map(point).collect())
}

/// Draws g(v) and G(u, v), and their transforms (docs/theory.md (6) and (7)).
pub(crate) fn slopes(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let slope = || AxisQuantity::new("*v*", "slope");
    let frequency = || AxisQuantity::new("*Ω*", "cycles/slope");
    let g = |v: f64| libm::pow(1.0 + v * v, -1.5);
    let g_3d = |v: f64| libm::pow(1.0 + v * v, -2.0);
    let (flat, solid) = ("2D: *g*", "3D: *G*, along one axis");
    let words = [
        "The cosine over slopes, and its transforms",
        "*g* = (1 + *v*^{2})^{−3/2}, *G* = (1 + *u*^{2} + *v*^{2})^{−2}; the transform of *g* is 4π|*Ω*| *K*_{1}(2π|*Ω*|), and the transform of *G* is π/2 times as large.",
    ];
    let panels = vec![
        CurvePanel::new(
            "(a) in slope",
            slope(),
            vec![
                curve(CurveKind::Theory, flat, [-3.0, 3.0], &g),
                curve(CurveKind::Rival, solid, [-3.0, 3.0], &g_3d),
            ],
        ),
        CurvePanel::new(
            "(b) transforms",
            frequency(),
            vec![
                curve(CurveKind::Theory, flat, [-1.5, 1.5], &g_hat),
                curve(CurveKind::Rival, solid, [-1.5, 1.5], &|o| g_hat_3d(o, 0.0)),
            ],
        ),
    ];
    let curves = taken.curves(words, AxisQuantity::new("value", ""), panels)?;
    Ok(stacked(&[curves, solid_slopes(taken)?]))
}

/// Draws G(u, v) over both slopes, and its transform over both frequencies (Fig. 5c).
fn solid_slopes(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let at = |i: usize, end: f64| end * (2.0 * i as f64 / (CELLS - 1) as f64 - 1.0);
    let map = |end: f64, f: &dyn Fn(f64, f64) -> f64| {
        Array2::from_shape_fn((CELLS, CELLS), |(i, j)| f(at(i, end), at(j, end)))
    };
    let [slopes, frequencies] = [3.0, 1.5];
    let value = map(slopes, &|u, v| libm::pow(1.0 + u * u + v * v, -2.0));
    let transform = map(frequencies, &g_hat_3d);
    let axes = |names: [&str; 2], unit: &str, end: f64| {
        names.map(|name| Axis::edges(name, unit, [-end, end]))
    };
    let in_slope = axes(["*u*", "*v*"], "slope", slopes);
    let in_frequency = axes(["*Ω*_{u}", "*Ω*_{v}"], "cycles/slope", frequencies);
    let pictures = vec![
        Picture::new(in_slope, value.view()),
        Picture::new(in_frequency, transform.view()),
    ];
    let quantity = AxisQuantity::new("value", "");
    taken.plate(&Plate {
        title: "In 3D",
        heads: vec![
            "(c) *G*(*u*, *v*)".to_owned(),
            "(d) its transform".to_owned(),
        ],
        rows: vec![PlateRow::new(
            "theory",
            quantity,
            Scale::Linear,
            false,
            pictures,
        )],
        ..Plate::default()
    })
}

/// The shares of energy in the table of Fig. 12.
const SHARES: [f64; 3] = [0.8, 0.95, 0.99];
/// The largest frequency of the search, cycles per radian.
const MAX_FREQUENCY: f64 = 6.0;

/// The cosine, or the cosine times a Fresnel factor.
struct KernelFactor {
    name: &'static str,
    fresnel: Option<Fresnel>,
}

impl KernelFactor {
    fn value(&self, theta: f64) -> f64 {
        let factor = self.fresnel.map_or(1.0, |f| fresnel_reflectance(f, theta));
        factor * libm::cos(theta)
    }

    fn transform(&self, omega: f64) -> f64 {
        self.fresnel
            .map_or_else(|| cosine_hat(omega), |f| fresnel_cosine_hat(f, omega))
    }

    /// The frequencies, in cycles per radian, below which the factor has [`SHARES`] of its
    /// energy.
    fn energy_below(&self) -> [Option<f64>; 3] {
        let nodes = gauss_legendre(200).into_iter();
        let squares = nodes.map(|(t, w)| w * self.value(FRAC_PI_2 * t).powi(2));
        let energy = FRAC_PI_2 * squares.sum::<f64>();
        energy_below(|omega| self.transform(omega), energy, SHARES, MAX_FREQUENCY)
    }
}

/// Draws cos₊, and cos₊ times the Fresnel factors of two dielectrics and a conductor (Fig. 12).
/// Also states the frequencies below which [`SHARES`] of the energy of each curve lie; in the
/// table, their rows have the panel `energy`, the share as x and the frequency Ω as the value.
pub(crate) fn fresnel(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let material = |name, fresnel| KernelFactor { name, fresnel };
    let dielectric = |index| Some(Fresnel::Dielectric { index });
    // Aluminium at 650 nm, as in the figures of microfacet papers.
    let metal = Fresnel::Conductor { n: 1.488, k: 7.821 };
    let materials = [
        material("cos_{+}", None),
        material("× glass", dielectric(1.5)),
        material("× diamond", dielectric(2.417)),
        material("× aluminium", Some(metal)),
    ];
    let angles = || AxisQuantity::new("*θ*", "radians");
    let frequency = || AxisQuantity::new("*Ω*", "cycles/rad");
    let range = [-FRAC_PI_2, FRAC_PI_2];
    let kinds = [
        CurveKind::Theory,
        CurveKind::Rival,
        CurveKind::OtherTheory,
        CurveKind::ThirdTheory,
    ];
    let panel = |title: &str, x, range, value: &dyn Fn(&KernelFactor, f64) -> f64| {
        let curves = materials.iter().zip(kinds).map(|(of, kind)| {
            let mut drawn = curve(kind, of.name, range, &|at| value(of, at));
            let largest = drawn.points.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
            drawn
                .points
                .iter_mut()
                .for_each(|point| point[1] /= largest);
            drawn
        });
        CurvePanel::new(title, x, curves.collect())
    };
    let mut panels = vec![
        panel("over angle", angles(), range, &|of, at| of.value(at)),
        panel("transform", frequency(), [-2.0, 2.0], &|of, at| {
            of.transform(at)
        }),
    ];
    let shares = materials.each_ref().map(|of| {
        let below = of.energy_below();
        below.map(|frequency| frequency.map_or("–".to_owned(), |f| format!("{f:.3}")))
    });
    let told = materials.iter().zip(&shares);
    let told = told.map(|(of, below)| format!("{} {}", of.name, below.join(", ")));
    let note = format!(
        "Glass: *n* = 1.5. Diamond: 2.417. Aluminium: 1.488 + 7.821 i, at 650 nm. Frequencies below which 80, 95 and 99 % of the energy lie (cycles/rad): {}.",
        told.collect::<Vec<_>>().join("; ")
    );
    letter_panels('a', &mut panels);
    let words = ["The clamped cosine, alone and with Fresnel factors", &note];
    let mut figure = taken.curves(words, AxisQuantity::new("relative to its peak", ""), panels)?;
    for (of, below) in materials.iter().zip(&shares) {
        let name = of.name.replace(['_', '{', '}'], "");
        for (share, frequency) in SHARES.iter().zip(below) {
            let row = format!("energy,share below Ω [cycles/rad],{name},{share},{frequency},0.0\n");
            figure.csv.push_str(&row);
        }
    }
    Ok(figure)
}
