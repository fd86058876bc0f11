//! Draws Figs. 14 and 15: diffuse shading under an environment, and the bandwidth of glossy
//! reflections.

use crate::criteria::criteria;
use crate::product::{Explanation, ShadedCylinder};
use crate::rows::{compared, feet, letter_panels, lettered};
use crate::subject::FigureData;
use etendue_figures::{AxisQuantity, Curve, CurveKind, CurvePanel, Figure, Plate, stacked};
use etendue_report::pictures::Seen;
use etendue_store::Failure;

/// Draws Fig. 14: a diffuse sphere in an environment.
pub(crate) fn environment(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let names = ["environment", "curvature", "cosine", "reflection"];
    let seen = taken.shots[0].each(&names)?;
    let steps = taken.plate(&Plate {
        title: "Diffuse shading under an environment map",
        note: "Light that varies over angle alone has its spectrum along *ν*; curvature shears the spectrum onto *ρ* = *kν*, the cosine blurs it along *ν*, and the light that leaves \
               a diffuse surface has its spectrum on the line *ν* = 0.",
        heads: lettered(&names),
        rows: compared(&seen, false),
        feet: feet(&seen),
        ..Plate::default()
    })?;
    Ok(stacked(&[steps, product(taken)?]))
}

/// Draws the spectrum of the light that leaves a cylinder, the product of the spectra of
/// environment and cosine, and three explanations that photons reject.
fn product(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let cylinder = ShadedCylinder::new(taken, &taken.also[0])?;
    let found = cylinder.measured();
    let explanations = cylinder.explanations()?;
    let rho = cylinder.frequencies();
    let line = |kind, of: &Explanation, part: usize| {
        let points = rho.iter().zip(&of.relative);
        let points = points.map(|(rho, f)| [*rho, [f.re, f.im][part], 0.0]);
        let digits = if of.chi2_per_dof < 100.0 { 2 } else { 0 };
        let chi2 = format!("{:.digits$}", of.chi2_per_dof);
        let name = format!("{}: *χ*²/dof {chi2}, *p* {:.5}", of.name, of.p_value);
        Curve::new(kind, &name, points.collect())
    };
    let [right, rejected @ ..] = &explanations;
    let panels = rejected.iter().zip([0, 0, 1]).map(|(rejected, part)| {
        let points = rho.iter().zip(&found);
        let points = points.map(|(rho, (s, errors))| [*rho, [s.re, s.im][part], errors[part]]);
        let title = format!("{}, {}", ["Re", "Im"][part], rejected.name);
        let curves = vec![
            line(CurveKind::Rival, rejected, part),
            line(CurveKind::Theory, right, part),
            Curve::new(CurveKind::Measured, "photons", points.collect()),
        ];
        CurvePanel::new(&title, AxisQuantity::new("*ρ*", "cycles/m"), curves)
    });
    let mut panels: Vec<CurvePanel> = panels.collect();
    letter_panels('e', &mut panels);
    let words = [
        "The product",
        "*S*(*ρ*)/*S*(0) at *ν* = 0 of the light that leaves a diffuse cylinder under two lobes of light, over arc length. \
         *p*: probability of a difference at least as large as that of the photons, if the line is true.",
    ];
    taken.curves(words, AxisQuantity::new("*S*/*S*(0)", ""), panels)
}

/// Draws Fig. 15: the steps of section 6.2, and the criteria of this section compared with photons.
pub(crate) fn adaptive(taken: &FigureData<'_>) -> Result<Figure, Failure> {
    let seen: Vec<Seen<'_>> = taken.shots[0].all().collect();
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
        side: Some(54.0),
        ..Plate::default()
    })?;
    Ok(stacked(&[steps, criteria(taken, 'h')?]))
}
