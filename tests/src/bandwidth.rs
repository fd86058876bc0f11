//! Generates the page on glossy reflections.

use crate::shading::glossy;
use etendue_figures::Style;
use std::fs;
use std::process::ExitCode;

/// Measures the bandwidths of glossy reflections and prints them. If no number of photons is given,
/// this function also writes results/bandwidth.md, the picture in this page and the numbers that
/// the picture plots.
#[expect(clippy::print_stderr, reason = "the report is the product")]
pub(crate) fn page(photons: Option<u64>) -> ExitCode {
    let (section, curves) = glossy(photons);
    let sections = [section];
    let text = crate::shown(&sections);
    if photons.is_none() {
        let written = etendue_figures::curves(&curves, &Style::default())
            .map_err(|error| error.to_string())
            .and_then(|figure| {
                let page = format!("{HEAD}{text}");
                let files = [
                    ("results/bandwidth.svg", figure.svg),
                    ("results/bandwidth.csv", figure.csv),
                    ("results/bandwidth.md", page),
                ];
                files.into_iter().try_for_each(|(path, text)| {
                    fs::write(path, text).map_err(|error| format!("{path}: {error}"))
                })
            });
        if let Err(message) = written {
            eprintln!("{message}");
            return ExitCode::from(3);
        }
    }
    crate::judged(&sections)
}

const HEAD: &str = "\
# How fast a glossy reflection changes with angle

Written by `cargo run --release -p etendue-validation -- bandwidth`.

Durand et al. 2005, section 6.2, derive from the spectrum how finely a glossy reflection must be \
sampled. They give the bandwidth B, in cycles per unit slope, at a fixed point at distance d \
from the surface, for light from far away (Eq. 20). B' is the bandwidth with an edge at distance \
d' before the surface (Eq. 21):

    corrected   B = Ω_ρ |1 + 2kd/cos θ₁|       B' = Ω_ρ |1 + d (cos θ₀/d' + 2k)/cos θ₁|
    printed     B = Ω_ρ 2kd/cos θ₁             B' = Ω_ρ d (1/d' + 2|k|)/cos θ₁

The printed formulas are an approximation for an eye far away, |2kd/cos θ₁| ≫ 1, and for light \
along the normal, with |k|. They leave out the 1 and a cosine. The distances here are not far. \
At the surface, a flat mirror shows the lobe as wide as it is, so B is Ω_ρ there, not 0. A \
hollow mirror first undoes what travel does, so B has a minimum, and this minimum is not at k = \
0. The photons agree with this. Next to the minimum, the width of the window determines the \
measured bandwidth, not the surface:

![Bandwidth over curvature, angles, distances and the width of the BRDF: photons lie on the \
corrected curves and off the printed curves](bandwidth.svg)

The numbers behind the curves are in [bandwidth.csv](bandwidth.csv). `etendue bandwidth \
SCENE.ron --measure --sweep PATH=A..B:N` sweeps any scene in this way, such as \
[bandwidth](../scenes/bandwidth.ron) and [bandwidth_edge](../scenes/bandwidth_edge.ron).

";
