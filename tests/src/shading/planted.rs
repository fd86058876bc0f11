//! Faults of shading, planted in the prediction or in the photons, which a comparison must reject.

use super::arriving::Sphere;
use super::bench::{Bench, each_weight, mean, reflectance};
use super::misprints;
use super::scenes::{alone, changed};
use super::tamper::{around_the_normal, cosine, polarised, scaled, textured_here};
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row};
use etendue_compare::sidak;
use etendue_field::{Crossing, Fresnel, Light, Lobe, Pattern, Reflectance, Slices, Term};
use etendue_scene::Scene;
use glam::DQuat;
use std::f64::consts::TAU;

/// False rejection rate over all benches.
const ALPHA: f64 = 0.01;
/// Default number of photons of a bench, enough to detect the subtlest faults.
const PHOTONS: u64 = 1 << 22;
/// The width of a pixel in an environment with 256 pixels per row, radians.
const PIXEL: f64 = TAU / 256.0;

/// A planted fault.
enum Plant {
    /// Changes the prediction, which is computed for a modified reflectance.
    Prediction(fn(&mut Reflectance)),
    /// Multiplies the prediction by a factor.
    Factor(f64),
    /// Changes the photons by modifications of the scene and of the crossings.
    Photons(fn(&mut Scene), fn(&Scene, Crossing) -> Crossing),
}

/// A plane of a scene, the modifications of the scene's text, and the faults that are tested at
/// this plane.
struct Stand {
    scene: &'static str,
    plane: &'static str,
    edits: &'static [(&'static str, &'static str)],
    faults: Vec<(&'static str, Plant)>,
}

/// The section.
pub(super) fn planted(photons: Option<u64>) -> ReportSection {
    let stands = stands();
    // The bench that records arriving light is not in the list and counts as one more bench.
    let count = stands.len() + 1;
    let level = sidak(ALPHA, count);
    let mut rows = Vec::new();
    for stand in stands {
        let scene = changed(stand.scene, photons.or(Some(PHOTONS)), stand.edits);
        let bench = Bench::new(alone(scene, stand.plane));
        let sound = bench.p_value(&bench.photons, &bench.sound);
        for (name, plant) in stand.faults {
            let judged = plant.judged(&bench);
            let place = match plant {
                Plant::Photons(..) => "photons",
                _ => "prediction",
            };
            rows.push(row([name, place], &bench, sound, judged, level));
        }
    }
    let (bench, turned) = turned(photons.or(Some(PHOTONS)));
    let sound = bench.p_value(&bench.photons, &bench.sound);
    for (name, said) in turned {
        let p = bench.p_value(&bench.photons, &said);
        let judged = (p, bench.apart(&said, &bench.sound));
        rows.push(row([name, "prediction"], &bench, sound, judged, level));
    }
    ReportSection::new(
        "Planted faults of shading",
        format!(
            "Each fault is planted alone, in the prediction or in the photons of one plane of a \
             scene, at {:.0e} photons. *p sound* is the p-value of this plane without the fault. \
             *Change* is the change of the spectrum relative to the spectrum. In the row of the \
             lobe around the normal, light meets the tiles at 5°: at 37°, no light of this lobe \
             would be in the window. The environment is turned in the light that arrives at the \
             sphere. The light that the diffuse sphere reflects would change by only 0.3 %, which \
             these photons do not resolve. Required: *p planted* is below {level:.5} for every \
             fault, which is α = {ALPHA} over {count} planes, and *p sound* is not below it. The \
             smallest possible p is 0.00005.",
            photons.unwrap_or(PHOTONS) as f64
        ),
        "fault | planted in | scene | plane | p sound | p planted | change | verdict",
        rows,
    )
}

impl Plant {
    /// The p-value of the comparison with the fault, and the relative change of the
    /// spectrum that the fault causes.
    fn judged(&self, bench: &Bench) -> (f64, f64) {
        let by_prediction = |said: &Slices| {
            let p = bench.p_value(&bench.photons, said);
            (p, bench.apart(said, &bench.sound))
        };
        match self {
            Self::Prediction(change) => by_prediction(&bench.predicted(change)),
            Self::Factor(factor) => {
                let mut said = bench.sound.clone();
                said.half.mapv_inplace(|value| value * factor);
                by_prediction(&said)
            }
            Self::Photons(change, crossing) => {
                let photons = bench.tampered(change, crossing);
                let p = bench.p_value(&photons, &bench.sound);
                (p, bench.apart(&mean(&photons), &mean(&bench.photons)))
            }
        }
    }
}

impl Stand {
    fn new(scene: &'static str, plane: &'static str) -> Self {
        Self {
            scene,
            plane,
            edits: &[],
            faults: Vec::new(),
        }
    }

    fn fault(mut self, name: &'static str, plant: Plant) -> Self {
        self.faults.push((name, plant));
        self
    }

    fn prediction(self, name: &'static str, change: fn(&mut Reflectance)) -> Self {
        self.fault(name, Plant::Prediction(change))
    }

    fn crossings(self, name: &'static str, change: fn(&Scene, Crossing) -> Crossing) -> Self {
        self.fault(name, Plant::Photons(|_| (), change))
    }
}

fn stands() -> Vec<Stand> {
    vec![
        Stand::new("fresnel_grazing", "reflection")
            .crossings("cosine missing", |s, c| scaled(c, 1.0 / cosine(s, &c)))
            .crossings("cosine counted twice", |s, c| scaled(c, cosine(s, &c)))
            .crossings("cosine of the central ray for all rays", |s, c| {
                scaled(c, s.planes[0].longitude.cos() / cosine(s, &c))
            })
            .crossings("Fresnel factor of s-polarised light alone", |s, c| {
                scaled(c, polarised(cosine(s, &c))[0])
            })
            .crossings("Fresnel factor of p-polarised light alone", |s, c| {
                scaled(c, polarised(cosine(s, &c))[1])
            })
            .prediction("index + 2 %", |s| {
                s.first_mut().fresnel = Fresnel::Dielectric { index: 1.53 };
            }),
        Stand::new("textured_glossy", "texture")
            .prediction("exponent + 5 %", |s| lobe(s, 1.05))
            .prediction("exponent − 5 %", |s| lobe(s, 0.95))
            .prediction("frequency of the texture + 1 %", |s| texture(s, 1.01))
            .prediction("frequency of the texture − 1 %", |s| texture(s, 0.99))
            .prediction("albedo forgotten", |s| s.first_mut().albedo = 1.0),
        Stand::new("textured_glossy", "beyond").fault(
            "texture multiplied in at this plane",
            Plant::Photons(|s| reflectance(s).texture = None, textured_here),
        ),
        Stand::new("weighted", "reflection")
            .prediction("weights swapped", swapped)
            .prediction("width of a lobe + 1 %", |s| lobe(s, 1.01_f64.powi(-2)))
            .prediction("width of a lobe − 1 %", |s| lobe(s, 0.99_f64.powi(-2)))
            .prediction("modulation of the weights 1 instead of 0.9", |s| {
                each_weight(s, |grating| grating.modulation = 1.0);
            }),
        Stand::new("sum", "reflection")
            .prediction("a term left out", |s| {
                s.terms.remove(1);
            })
            .prediction("weights swapped", swapped)
            .prediction("h for f", turned_round),
        Stand::new("factor_incoming", "reflection")
            .prediction("h for f", turned_round)
            .prediction("f left out", |s| s.first_mut().incoming = None),
        Stand::new("factor_outgoing", "reflection").prediction("f for h", turned_round),
        Stand {
            edits: &[(
                "(0.605186406, 0, -0.796083799)",
                "(0.0871557427, 0, -0.996194698)",
            )],
            ..Stand::new("checkerboard", "reflection")
                .crossings("lobe around the normal", around_the_normal)
        },
        Stand::new("ggx_sphere", "reflection").fault(
            "α² instead of α",
            Plant::Photons(
                |s| {
                    if let Lobe::Ggx { roughness } = &mut reflectance(s).first_mut().lobe {
                        *roughness *= *roughness;
                    }
                },
                |_, c| c,
            ),
        ),
        // k is 1.25 /m.
        Stand::new("environment", "reflection").fault("missing 1/|k|", Plant::Factor(1.25)),
    ]
}

fn lobe(reflectance: &mut Reflectance, factor: f64) {
    if let Some((_, number)) = reflectance.first_mut().lobe.number_mut() {
        *number *= factor;
    }
}

/// Swaps the factors f and h of each BRDF.
fn turned_round(reflectance: &mut Reflectance) {
    for Term { brdf, .. } in &mut reflectance.terms {
        std::mem::swap(&mut brdf.incoming, &mut brdf.outgoing);
    }
}

/// Swaps the weights of the first two BRDFs.
pub(super) fn swapped(reflectance: &mut Reflectance) {
    if let [one, two, ..] = &mut reflectance.terms[..] {
        std::mem::swap(&mut one.weight, &mut two.weight);
    }
}

fn texture(reflectance: &mut Reflectance, factor: f64) {
    if let Some(Pattern::Cosine(grating)) = &mut reflectance.texture {
        grating.frequency *= factor;
    }
}

/// A bench and two faults. The bench records the environment's light that arrives at the
/// sphere, times the cosine. In both faults, the environment is rotated by a pixel.
fn turned(photons: Option<u64>) -> (Bench, [(&'static str, Slices); 2]) {
    let scene = misprints::arriving(photons);
    let Light::Environment { environment } = &scene.light else {
        panic!("an environment");
    };
    let of = |angle: f64| {
        let mut environment = environment.clone();
        let frame = &mut environment.frame;
        let turn = DQuat::from_axis_angle(frame.y, angle);
        (frame.x, frame.d) = (turn * frame.x, turn * frame.d);
        let sphere = Sphere {
            scene: &scene,
            environment: &environment,
            k: misprints::K,
        };
        sphere.slices(-1.0)
    };
    let sound = of(0.0);
    let turned = [
        ("environment turned by + 1/256", of(PIXEL)),
        ("environment turned by − 1/256", of(-PIXEL)),
    ];
    (Bench::of(scene, sound), turned)
}

/// The table row for a fault, which names where the fault is planted.
fn row(
    [name, place]: [&str; 2],
    bench: &Bench,
    sound: f64,
    (p, change): (f64, f64),
    level: f64,
) -> Row {
    let cells = vec![
        name.to_owned(),
        place.to_owned(),
        bench.scene.name.clone(),
        bench.scene.planes[0].name.clone(),
        format!("{sound:.5}"),
        format!("{p:.5}"),
        format!("{:.2} %", 100.0 * change),
        if p < level { "rejected" } else { "accepted" }.to_owned(),
    ];
    let checks = vec![
        Check::p("sound", Some(sound), level),
        Check::new("planted", p, Below(level)).because("a fault is planted"),
    ];
    Row::new(cells, checks)
}
