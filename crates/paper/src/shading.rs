//! Draws Figs. 14 and 15: diffuse shading under an environment, and the bandwidth of glossy
//! reflections.

use crate::criteria::criteria;
use crate::rows::{Seen, compared, feet, lettered};
use crate::subject::FigureData;
use etendue_field::{
    Complex, EnvironmentMap, Light, Profile, Slices, SphericalGaussian, cis, modulus,
};
use etendue_figures::{AxisQuantity, Curve, CurveKind, CurvePanel, Curves, Figure, Plate, stacked};
use etendue_store::Failure;
use etendue_theory::shading::environment::{Glow, irradiance};
use std::f64::consts::TAU;

/// Draws Fig. 14: a diffuse sphere in an environment.
pub(crate) fn environment(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let names = ["environment", "curvature", "cosine", "reflection"];
    let seen = names.map(|name| Seen::at(&taken.shots[0], name));
    let seen: Vec<Seen<'_>> = seen.into_iter().collect::<Result<_, _>>()?;
    let steps = taken.plate(&Plate {
        title: "Diffuse shading under an environment map",
        note: "Light that varies over angle alone has its spectrum along *ν*; curvature shears the spectrum onto *ρ* = *kν*, the cosine blurs it along *ν*, and the light that leaves \
               a diffuse surface has its spectrum on the line *ν* = 0.",
        heads: lettered(&names),
        rows: compared(&seen, false),
        feet: feet(&seen),
        bars: None,
        side: None,
    })?;
    Ok(stacked(&[steps, product(taken, &seen[3])?]))
}

/// Returns the spectrum at ν = 0, and the product of the spectrum of the environment and the
/// spectrum of the cosine.
fn product(taken: &FigureData<'_>, shaded: &Seen<'_>) -> Result<Figure, Failure> {
    let scene = &taken.shots[0].scene;
    let k = scene
        .patches
        .first()
        .map_or(1.0, |object| object.patch.curvature[0]);
    let glows = glows(&scene.light);
    let sky = |nu: f64| glows.iter().map(|glow| glow.spectrum(nu)).sum::<Complex>();
    let rho = shaded.plane.grid.rho.values();
    let over = |spectrum: &dyn Fn(f64) -> Complex| {
        let values = windowed(spectrum, &shaded.plane.window.x, &rho);
        let peak = values[rho.len() / 2];
        let both = rho.iter().zip(values);
        both.map(|(rho, value)| [*rho, value / peak, 0.0]).collect()
    };
    let panel = CurvePanel {
        title: "(e) leaving the sphere".to_owned(),
        x: AxisQuantity::new("*ρ*", "cycles/m"),
        curves: vec![
            Curve::new(
                CurveKind::Rival,
                "environment alone",
                over(&|rho| sky(rho / k)),
            ),
            Curve::new(
                CurveKind::Theory,
                "environment × cosine",
                over(&|rho| irradiance(k, rho, &sky)),
            ),
            Curve::new(
                CurveKind::Measured,
                "photons",
                at_zero_nu(&shaded.found.measured),
            ),
        ],
        is_log: [false; 2],
    };
    taken.curves(&Curves {
        title: "The product".to_owned(),
        note: "|*S*_{0}| at *ν* = 0, the line of the light that leaves. Lines: the product in 2D, seen through the same window, with and without the spectrum of the cosine."
            .to_owned(),
        y: AxisQuantity::new("relative to 0", ""),
        panels: vec![panel],
    })
}

/// Returns the lobes of an environment over longitude, integrated over latitude.
fn glows(light: &Light) -> Vec<Glow> {
    let Light::Environment { environment } = light else {
        return Vec::new();
    };
    let EnvironmentMap::Lobes(lobes) = &environment.map else {
        return Vec::new();
    };
    let glow = |lobe: &SphericalGaussian| Glow {
        amplitude: lobe.radiance * lobe.width,
        mean: libm::atan2(lobe.from.x, lobe.from.z.abs()),
        deviation: lobe.width,
    };
    lobes.iter().map(glow).collect()
}

/// Returns |spectrum ⊗ Ŵ| at some frequencies. The spectrum is transformed to positions, multiplied
/// by the window and transformed back.
fn windowed(spectrum: &dyn Fn(f64) -> Complex, window: &Profile, rho: &[f64]) -> Vec<f64> {
    const STEPS: i32 = 400;
    // The range extends to four times the last frequency, because lobes of a tenth of a radian
    // have no power beyond this range.
    let last = 4.0 * rho.last().copied().unwrap_or(1.0);
    let along = |half: f64| (-STEPS..=STEPS).map(move |i| half * f64::from(i) / f64::from(STEPS));
    let values: Vec<(f64, Complex)> = along(last).map(|q| (q, spectrum(q))).collect();
    let wave = |z: f64| cis(TAU * z);
    let field = |s: f64| {
        let terms = values.iter().map(|(q, value)| value * wave(q * s));
        terms.sum::<Complex>() * window.value(s)
    };
    let field: Vec<(f64, Complex)> = along(window.half_width()).map(|s| (s, field(s))).collect();
    let at = |rho: &f64| {
        let terms = field.iter().map(|(s, value)| value * wave(-rho * s));
        modulus(terms.sum::<Complex>())
    };
    rho.iter().map(at).collect()
}

/// Returns |S| at azimuth 0 and ν = 0 as a function of ρ, divided by its value at ρ = 0.
fn at_zero_nu(slices: &Slices) -> Vec<[f64; 3]> {
    let full = slices.full();
    let (grid, peak) = (&slices.grid, slices.at_zero());
    let rho = grid.rho.values();
    let points = rho.iter().enumerate();
    points
        .map(|(i, rho)| [*rho, modulus(full[[0, i, grid.nu.half]]) / peak, 0.0])
        .collect()
}

/// Draws Fig. 15: the steps of section 6.2, and the criteria of this section compared with photons.
pub(crate) fn adaptive(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let seen: Vec<Seen<'_>> = Seen::all(&taken.shots[0]).collect();
    let heads = [
        "incidence",
        "curvature",
        "mirror",
        "lobe",
        "back",
        "outgoing",
        "eye",
    ];
    let steps = taken.plate(&Plate {
        title: "Bandwidth of a glossy reflection, step by step",
        note: "A beam (distant light with content at all angular frequencies) on a glossy sphere. The lobe limits the spectrum, which is a line; curvature shears this line twice, and travel shears it once more.",
        heads: lettered(&heads),
        rows: compared(&seen, false),
        feet: feet(&seen),
        bars: None,
        side: Some(54.0),
    })?;
    Ok(stacked(&[steps, criteria(taken, 'h')?]))
}
