//! Faults of shading, planted in the prediction or in the photons: a comparison is judged by what it rejects.

use super::bench::{Bench, mean, on_flat, reflectance};
use super::scenes::{alone, changed};
use crate::report::Section;
use etendue_compare::sidak;
use etendue_field::{Crossing, Fresnel, Lobe, Pattern, Slices};
use etendue_scene::Scene;
use etendue_theory::scattering::{Parameter, System};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Share of true sections that may be rejected, over all benches.
const ALPHA: f64 = 0.01;
/// Photons of a bench, unless others are given: those by which the subtlest faults are seen.
const PHOTONS: u64 = 4_000_000;
/// A pixel of an environment of 256 pixels all around, radians.
const PIXEL: f64 = TAU / 256.0;

/// What is wrong.
enum Plant {
    /// The prediction, of a system that was changed.
    System(fn(&mut System)),
    /// The prediction, by a factor.
    Factor(f64),
    /// The photons: those of a scene that was changed, and what is made of their crossings.
    Photons(fn(&mut Scene), fn(&Scene, Crossing) -> Crossing),
}

/// A plane, what is changed in the text of its scene, and the faults held against its photons.
struct Stand {
    scene: &'static str,
    plane: &'static str,
    texts: &'static [[&'static str; 2]],
    faults: Vec<(&'static str, Plant)>,
}

/// The section.
pub(super) fn planted(photons: Option<u64>) -> Section {
    let stands = stands();
    let count = stands.len();
    let level = sidak(ALPHA, count);
    let mut rows = Vec::new();
    let mut passed = true;
    for stand in stands {
        let scene = changed(stand.scene, photons.or(Some(PHOTONS)), stand.texts);
        let bench = Bench::new(alone(scene, stand.plane));
        let sound = bench.p_value(&bench.photons, &bench.sound);
        passed &= sound >= level;
        for (name, plant) in stand.faults {
            let (p, change) = plant.judged(&bench);
            passed &= p < level;
            rows.push(vec![
                name.to_owned(),
                match plant {
                    Plant::Photons(..) => "photons",
                    _ => "prediction",
                }
                .to_owned(),
                stand.scene.to_owned(),
                stand.plane.to_owned(),
                format!("{sound:.5}"),
                format!("{p:.5}"),
                format!("{:.2} %", 100.0 * change),
                match (sound >= level, p < level) {
                    (true, true) => "rejected",
                    (true, false) => "FAIL: accepted",
                    (false, _) => "FAIL: sound rejected",
                }
                .to_owned(),
            ]);
        }
    }
    Section {
        title: "Planted faults of shading".to_owned(),
        text: format!(
            "Each fault alone, in the prediction or in the photons, of a scene with one of its planes, at {:.0e} photons; p sound is of the same plane without a fault. \
             Change: of the spectrum, relative to it. In the row of the lobe around the normal the tiles are met at 5°: at 37° no light of it would be in \
             the window. The sphere in the turned environment has a Phong lobe of exponent 100: of a diffuse one the spectrum would change by 0.3 %, which 4e6 photons do not tell. Required: p < {level:.5}, α = {ALPHA} over {count} planes, for every fault, and p sound not below; p is not below 0.00005.",
            photons.unwrap_or(PHOTONS) as f64
        ),
        header: vec![
            "fault",
            "planted in",
            "scene",
            "plane",
            "p sound",
            "p planted",
            "change",
            "verdict",
        ],
        rows,
        passed,
    }
}

impl Plant {
    /// p, and how far the spectrum is changed.
    fn judged(&self, bench: &Bench) -> (f64, f64) {
        let by_prediction = |said: &Slices| {
            let p = bench.p_value(&bench.photons, said);
            (p, bench.apart(said, &bench.sound))
        };
        match self {
            Self::System(change) => by_prediction(&bench.predicted(change)),
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

fn stands() -> Vec<Stand> {
    let crossings = |crossing| Plant::Photons(|_| (), crossing);
    vec![
        Stand {
            scene: "fresnel_grazing",
            plane: "reflection",
            texts: &[],
            faults: vec![
                (
                    "cosine missing",
                    crossings(|s, c| scaled(c, 1.0 / cosine(s, &c))),
                ),
                ("cosine twice", crossings(|s, c| scaled(c, cosine(s, &c)))),
                (
                    "cosine of the central ray for all",
                    crossings(|s, c| scaled(c, s.planes[0].longitude.cos() / cosine(s, &c))),
                ),
                (
                    "Fresnel factor of s alone",
                    crossings(|s, c| scaled(c, polarised(cosine(s, &c))[0])),
                ),
                (
                    "Fresnel factor of p alone",
                    crossings(|s, c| scaled(c, polarised(cosine(s, &c))[1])),
                ),
                (
                    "index + 2 %",
                    Plant::System(|s| {
                        s.reflectance.brdf.fresnel = Fresnel::Dielectric { index: 1.53 };
                    }),
                ),
            ],
        },
        Stand {
            scene: "textured_glossy",
            plane: "texture",
            texts: &[],
            faults: vec![
                ("exponent + 5 %", Plant::System(|s| lobe(s, 1.05))),
                ("exponent − 5 %", Plant::System(|s| lobe(s, 0.95))),
                (
                    "frequency of the texture + 1 %",
                    Plant::System(|s| texture(s, 1.01)),
                ),
                (
                    "frequency of the texture − 1 %",
                    Plant::System(|s| texture(s, 0.99)),
                ),
                (
                    "albedo forgotten",
                    Plant::System(|s| s.reflectance.brdf.albedo = 1.0),
                ),
            ],
        },
        Stand {
            scene: "textured_glossy",
            plane: "beyond",
            texts: &[],
            faults: vec![(
                "texture multiplied in at this plane",
                Plant::Photons(|s| reflectance(s).texture = None, textured_here),
            )],
        },
        Stand {
            scene: "checkerboard",
            plane: "reflection",
            texts: &[[
                "(0.605186406, 0, -0.796083799)",
                "(0.0871557427, 0, -0.996194698)",
            ]],
            faults: vec![("lobe around the normal", crossings(around_the_normal))],
        },
        Stand {
            scene: "ggx_sphere",
            plane: "reflection",
            texts: &[],
            faults: vec![(
                "α² for α",
                Plant::Photons(
                    |s| {
                        if let Lobe::Ggx { roughness } = &mut reflectance(s).brdf.lobe {
                            *roughness *= *roughness;
                        }
                    },
                    |_, c| c,
                ),
            )],
        },
        Stand {
            scene: "environment",
            plane: "reflection",
            texts: &[],
            // k is 1.25 /m.
            faults: vec![("missing 1/|k|", Plant::Factor(1.25))],
        },
        Stand {
            scene: "environment",
            plane: "reflection",
            texts: &[["Lambertian", "Phong(100)"]],
            faults: vec![
                (
                    "environment turned by 1/256 about Y",
                    Plant::System(|s| turned(s, PIXEL)),
                ),
                ("turned by − 1/256", Plant::System(|s| turned(s, -PIXEL))),
            ],
        },
    ]
}

fn scaled(mut crossing: Crossing, factor: f64) -> Crossing {
    crossing.weight *= factor;
    crossing
}

/// Of the angle at which light comes in.
fn cosine(scene: &Scene, crossing: &Crossing) -> f64 {
    let [_, from] = on_flat(scene, crossing);
    from.z
}

/// Shares of s and p that glass of index 1.5 reflects, over their mean (Fresnel's equations with Snell's law).
fn polarised(cosine: f64) -> [f64; 2] {
    const INDEX: f64 = 1.5;
    let inner = (1.0 - (1.0 - cosine * cosine) / (INDEX * INDEX)).sqrt();
    let s = ((cosine - INDEX * inner) / (cosine + INDEX * inner)).powi(2);
    let p = ((INDEX * cosine - inner) / (INDEX * cosine + inner)).powi(2);
    [s, p].map(|share| 2.0 * share / (s + p))
}

fn lobe(system: &mut System, factor: f64) {
    if let Some(value) = system.value(Parameter::Lobe)
        && let Some(changed) = system.with(Parameter::Lobe, factor * value)
    {
        *system = changed;
    }
}

fn texture(system: &mut System, factor: f64) {
    if let Some(Pattern::Cosine(grating)) = &mut system.reflectance.texture {
        grating.frequency *= factor;
    }
}

fn turned(system: &mut System, angle: f64) {
    if let etendue_field::Light::Environment { environment } = &mut system.light {
        let turn = DQuat::from_axis_angle(environment.frame.y, angle);
        let frame = &mut environment.frame;
        (frame.x, frame.d) = (turn * frame.x, turn * frame.d);
    }
}

/// The texture of `textured_glossy` where the light is, with 1/cos θ₁ for positions along the surface.
fn textured_here(scene: &Scene, crossing: Crossing) -> Crossing {
    const MIRROR: f64 = 0.796_083_799;
    let etendue_scene::Event::Reflects(reflectance) = &scene.patches[0].event else {
        return crossing;
    };
    let ray = crossing.ray;
    let texture = reflectance.texture.as_ref();
    let factor = texture.map_or(1.0, |t| t.value(ray.x / MIRROR, ray.y));
    scaled(crossing, factor)
}

/// What leaves about the mirror direction, turned until that is the normal; solid angles stay, those of (θ, φ) do not.
fn around_the_normal(scene: &Scene, mut crossing: Crossing) -> Crossing {
    let [away, from] = on_flat(scene, &crossing);
    let mirrored = DVec3::new(-from.x, -from.y, from.z);
    let turned = DQuat::from_rotation_arc(mirrored, DVec3::Z) * away;
    let latitude = turned.y.clamp(-1.0, 1.0).asin();
    crossing.weight *= crossing.ray.v.cos() / latitude.cos();
    crossing.ray.u = turned.x.atan2(turned.z) - scene.planes[0].longitude;
    crossing.ray.v = latitude;
    crossing
}
