//! The misprints about shading that photons can detect.

use super::arriving::Sphere;
use super::bench::Bench;
use super::scenes::{alone, changed};
use crate::predicted::traced;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use etendue_compare::sidak;
use etendue_field::{Complex, Light, Quantity, Slices};
use etendue_predict::path;
use etendue_scene::Scene;
use std::f64::consts::PI;

/// False rejection rate over all misprints.
const ALPHA: f64 = 0.01;
/// Default number of photons.
const PHOTONS: u64 = 1 << 22;
/// Curvature, per metre, of the sphere in the scene file that has an environment.
pub(super) const K: f64 = 1.25;

struct Misprint {
    place: &'static str,
    printed: &'static str,
    corrected: &'static str,
    said: Slices,
}

/// The section.
pub(super) fn misprints(photons: Option<u64>) -> ReportSection {
    let photons = photons.or(Some(PHOTONS));
    let all = [diffuse(photons), mirror(photons), environment(photons)];
    let count = all.len();
    let level = sidak(ALPHA, count);
    let mut rows = Vec::new();
    let word = |p: f64| if p < level { "rejected" } else { "accepted" }.to_owned();
    for (bench, misprints) in all {
        let corrected = bench.p_value(&bench.photons, &bench.sound);
        for misprint in misprints {
            let printed = bench.p_value(&bench.photons, &misprint.said);
            let checks = vec![
                Check::new("printed", printed, Below(level)).because("it is wrong"),
                Check::p("corrected", Some(corrected), level),
            ];
            let cells = vec![
                misprint.place.to_owned(),
                misprint.printed.to_owned(),
                misprint.corrected.to_owned(),
                bench.scene.name.clone(),
                bench.scene.planes[0].name.clone(),
                format!("{:.1} %", 100.0 * bench.apart(&misprint.said, &bench.sound)),
                format!("{printed:.5}"),
                word(printed),
                format!("{corrected:.5}"),
                word(corrected),
            ];
            rows.push(Row::new(cells, checks));
        }
    }
    ReportSection::new(
        "Errata of shading, with photons",
        format!(
            "This table repeats in 4D, at {:.0e} photons, those misprints of the table in 2D that \
             a spectrum of photons can show. Eq. 6 is tested on a diffuse sphere. The mirror is \
             tested as a BRDF without 1/cos θ: this leaves the light times cos⁺ θ cos² φ, the \
             cosine of the plane-sphere parameterisation. Section 6.1 is tested on the light that \
             arrives at the sphere in the environment, times the cosine and turned about the \
             normals; the corrected formula is evaluated by a midpoint rule over the window. Eqs. \
             15, 17, 20 and 21 concern single steps, and only quadrature in 2D tests them. *Apart* \
             is the difference between the printed and the corrected spectrum, relative to the \
             corrected one. Required: the p-value of the printed formula is below {level:.5}, \
             which is α = {ALPHA} over {count} planes, and the p-value of the corrected formula is \
             not below it.",
            photons.unwrap_or_default() as f64
        ),
        "place | printed | corrected | scene | plane | apart | p printed | printed is | p \
         corrected | corrected is | verdict",
        rows,
    )
}

fn scaled(slices: &Slices, factor: f64) -> Slices {
    let mut slices = slices.clone();
    slices.half *= Complex::from(factor);
    slices
}

fn diffuse(photons: Option<u64>) -> (Bench, Vec<Misprint>) {
    let bench = Bench::new(alone(changed("environment", photons, &[]), "reflection"));
    let said = scaled(&bench.sound, PI);
    let misprint = Misprint {
        place: "Eq. 6",
        printed: "ρ = albedo",
        corrected: "albedo/π",
        said,
    };
    (bench, vec![misprint])
}

fn mirror(photons: Option<u64>) -> (Bench, Vec<Misprint>) {
    let scene = alone(changed("concave_oblique", photons, &[]), "reflection");
    let place = &scene.planes[0];
    let mirror = path(&scene, place).expect("a mirror alone");
    let of = |quantity| {
        let mut seen = mirror.clone();
        seen.plane.quantity = quantity;
        traced(&seen, &place.window, &place.grid).slices
    };
    let said = of(Quantity::DifferentialIrradiance);
    let sound = of(Quantity::Radiance);
    let misprint = Misprint {
        place: "section 4.2, mirror",
        printed: "δ",
        corrected: "δ/cos θ_i'",
        said,
    };
    (Bench::of(scene, sound), vec![misprint])
}

/// The scene with the environment and a single plane, which records the arriving light.
pub(super) fn arriving(photons: Option<u64>) -> Scene {
    let plane = "(name: \"arriving\", at: Before(\"sphere\"), orientation: Mirrored, quantity: DifferentialIrradiance),";
    let edits = [("planes: [", &*format!("planes: [{plane}"))];
    alone(changed("environment", photons, &edits), "arriving")
}

fn environment(photons: Option<u64>) -> (Bench, Vec<Misprint>) {
    let scene = arriving(photons);
    let Light::Environment { environment } = &scene.light else {
        panic!("an environment");
    };
    let sphere = Sphere {
        scene: &scene,
        environment,
        k: K,
    };
    let [sound, unturned] = [-1.0, 1.0].map(|turn| sphere.slices(turn));
    let misprint = |printed, said| Misprint {
        place: "section 6.1",
        printed,
        corrected: "env^(Ωx/k) cos⁺^(Ωx/k + Ωθ)/|k|",
        said,
    };
    let misprints = vec![
        misprint("cos⁺^(Ωx/k − Ωθ)", unturned),
        misprint("no 1/|k|", scaled(&sound, K)),
    ];
    (Bench::of(scene, sound), misprints)
}
