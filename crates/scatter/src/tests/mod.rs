//! Tests of all models: samples against densities, energy, reciprocity, and planted faults.

mod models;

use crate::{Bsdf, Principled, RoughDielectric, SmoothDielectric, mirror};
use etendue_field::Fresnel;
use glam::DVec3;
use models::{
    MIXTURE, Model, SAMPLES, all, beckmann, conductor, dielectric, ggx, modified_phong, numbers,
    phong, plastic,
};

/// Angles of incidence, up to grazing.
const ANGLES: [f64; 4] = [0.0, 0.6, 1.2, 1.5];

fn at(angle: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(angle);
    DVec3::new(sin * 0.8, sin * 0.6, cos)
}

/// Runs a check for each model at each angle.
fn each(mut check: impl FnMut(&Model, DVec3, String)) {
    for model in all() {
        for angle in ANGLES {
            check(&model, at(angle), format!("{} at {angle}", model.name));
        }
    }
}

#[test]
fn samples_follow_their_density() {
    each(|model, wo, name| {
        let found = model.compare(wo, |wi| model.bsdf.density(wi, wo));
        assert!(found.agrees(), "{name}: {found:?}");
    });
}

#[test]
fn samples_know_their_density() {
    each(|model, wo, name| {
        for bounce in numbers().filter_map(|random| model.bsdf.sample(wo, random)) {
            let density = model.bsdf.density(bounce.wi, wo);
            assert!([None, Some(density)].contains(&bounce.density), "{name}");
            assert!(bounce.weight < model.max_weight, "{name}: {bounce:?}");
        }
    });
}

/// The means of two quantities over samples, each with its standard error. The first
/// quantity is the weight of samples with a density, and the second is all flux that leaves.
fn means(model: &Model, wo: DVec3) -> [[f64; 2]; 2] {
    let mut sums = [[0.0; 2]; 2];
    for bounce in numbers().filter_map(|random| model.bsdf.sample(wo, random)) {
        let squared_index = if bounce.wi.z < 0.0 {
            model.index.powi(2)
        } else {
            1.0
        };
        let weights = [
            bounce.density.map_or(0.0, |_| bounce.weight),
            bounce.weight * squared_index,
        ];
        for (sum, weight) in sums.iter_mut().zip(weights) {
            sum[0] += weight;
            sum[1] += weight * weight;
        }
    }
    let n = f64::from(SAMPLES);
    sums.map(|[sum, squares]| {
        let mean = sum / n;
        [mean, ((squares / n - mean * mean).max(0.0) / n).sqrt()]
    })
}

#[test]
fn white_furnace() {
    each(|model, wo, name| {
        let carried = |wi: DVec3| model.bsdf.value(wi, wo) * wi.z.abs();
        let exact: f64 = model.cells(wo).integrals(carried).iter().sum();
        let [[mean, error], [flux, flux_error]] = means(model, wo);
        // The tolerance is four and a half standard errors, plus the error of the midpoint rule
        // over the cells.
        let bound = 4.5 * error + 2e-3;
        assert!(
            (mean - exact).abs() < bound,
            "{name}: {mean} ± {error}, {exact}"
        );
        let bound = 4.5 * flux_error + 1e-9;
        assert!(flux < model.max_flux + bound, "{name}: {flux} of 1 leaves");
    });
}

/// Tests surfaces that conserve energy, and facets so smooth that shadowing loses little energy.
#[test]
fn nothing_is_lost() {
    for angle in ANGLES {
        let wo = at(angle);
        for is_nonlinear in [false, true] {
            let [_, [flux, error]] = means(&plastic(None, is_nonlinear), wo);
            // The tolerance includes the error of the midpoint rule for the internal reflectance of
            // the coat.
            assert!(
                (flux - 1.0).abs() < 4.5 * error + 1e-5,
                "{angle}: {flux} ± {error}"
            );
        }
        for facets in [beckmann([0.01; 2]), ggx([0.01; 2])] {
            let [_, [flux, error]] = means(&conductor(facets, Fresnel::White), wo);
            // The loss of energy grows with (α tan θ)², which is at most 0.02 here.
            assert!(flux > 0.98 - 4.5 * error, "{facets:?} at {angle}: {flux}");
        }
        let mirrored = mirror(&Fresnel::White, wo);
        assert!((mirrored.weight - 1.0).abs() < 1e-15 && mirrored.density.is_none());
        assert!((mirrored.wi + wo - 2.0 * wo.z * DVec3::Z).length() < 1e-15);
    }
}

#[test]
fn smooth_interfaces_refract_by_snell() {
    for (index, is_thin) in [(1.5, false), (1.0 / 1.5, false), (1.5, true), (0.75, true)] {
        let glass = SmoothDielectric { index, is_thin };
        for wo in ANGLES.map(at) {
            let [near, far] = [1e-9, 1.0 - 1e-9].map(|random| glass.sample(wo, random));
            assert!((near.wi + wo - 2.0 * wo.z * DVec3::Z).length() < 1e-15);
            if far.wi.z > 0.0 {
                // Total reflection.
                assert!(wo.truncate().length() > index, "{glass:?} {wo}");
                continue;
            }
            let behind = if is_thin { 1.0 } else { index };
            // The radiance behind the interface is divided by the squared index; the remaining
            // difference from 1 is rounding error.
            assert!((far.weight * behind * behind - 1.0).abs() < 1e-12);
            assert!((far.wi.truncate() * behind + wo.truncate()).length() < 1e-12);
            assert!(far.density.is_none() && (far.wi.length() - 1.0).abs() < 1e-12);
        }
    }
}

/// Pairs of directions in front of the surface.
fn pairs() -> impl Iterator<Item = [DVec3; 2]> {
    let direction = |[a, b, _]: [f64; 3]| crate::lambertian::sample([a, b]);
    let first = numbers().step_by(200).map(direction);
    first
        .zip(numbers().skip(7).step_by(200).map(direction))
        .map(|(a, b)| [a, b])
}

#[test]
fn light_goes_both_ways() {
    for model in all() {
        for [a, b] in pairs() {
            let [there, back] = [model.bsdf.value(a, b), model.bsdf.value(b, a)];
            // The tolerance covers rounding errors in the exponent of a narrow lobe.
            let close = (there - back).abs() <= 1e-9 * there.abs();
            assert!(close, "{}: {there} and {back}", model.name);
        }
    }
    // Radiance is compared after division by the squared indices.
    for facets in [ggx([0.3, 0.1]), beckmann([0.2, 0.4])] {
        for index in [1.5, 0.8] {
            let front = RoughDielectric { facets, index };
            let back = RoughDielectric {
                facets,
                index: 1.0 / index,
            };
            let turned = |v: DVec3| v.with_z(-v.z);
            for [a, b] in pairs() {
                let there = index * index * front.value(-b, a);
                let back = back.value(turned(a), turned(-b));
                assert!(
                    (there - back).abs() <= 1e-9 * there,
                    "{front:?}: {there} {back}"
                );
            }
        }
    }
}

/// Light passes a transmitting mixture equally in both directions.
#[test]
fn principled_transmits_both_ways() {
    let front = Principled {
        transmission: 0.7,
        metallic: 0.2,
        ..MIXTURE
    };
    let turned = |v: DVec3| v.with_z(-v.z);
    let mut lit = 0;
    for [a, b] in pairs() {
        let there = front.index.powi(2) * front.value(-b, a);
        let back = front.inside().value(turned(a), turned(-b));
        assert!((there - back).abs() <= 1e-9 * there, "{there} {back}");
        lit += u32::from(there > 0.0);
    }
    assert!(lit > 100, "{lit}");
}

/// The comparison of samples with densities detects each of the planted faults.
#[test]
fn planted_faults_are_seen() {
    let wo = at(0.6);
    let seen = |what: &str, model: &Model, fault: &dyn Fn(DVec3) -> f64| {
        let found = model.compare(wo, fault);
        assert!(!found.agrees(), "{what} of {}: {found:?}", model.name);
    };
    let white = |facets| conductor(facets, Fresnel::White);
    let half = |v: DVec3| (wo + v).normalize();
    for (model, other) in [
        (white(beckmann([0.5; 2])), white(beckmann([0.25; 2]))),
        (white(ggx([0.5; 2])), white(ggx([0.25; 2]))),
    ] {
        seen("α halved", &model, &|wi| other.bsdf.density(wi, wo));
        seen("no Jacobian", &model, &|wi| {
            model.bsdf.density(wi, wo) * 4.0 * half(wi).dot(wo)
        });
    }
    let [long, wide] = [[0.3, 0.1], [0.1, 0.3]].map(|alpha| white(ggx(alpha)));
    seen("axes exchanged", &long, &|wi| wide.bsdf.density(wi, wo));
    let model = phong(30.0);
    seen("lobe around the normal", &model, &|wi| {
        model.bsdf.density(wi, DVec3::Z)
    });
    seen("exponent off by 5 %", &model, &|wi| {
        phong(31.5).bsdf.density(wi, wo)
    });
    seen("a cosine too many", &model, &|wi| {
        model.bsdf.density(wi, wo) * wi.z.max(0.0)
    });
    let [model, swapped] = [[0.3, 0.5], [0.5, 0.3]].map(|[a, b]| modified_phong(a, b, 20.0));
    seen("shares exchanged", &model, &|wi| {
        swapped.bsdf.density(wi, wo)
    });
    let glass = dielectric(ggx([0.3; 2]), 1.5);
    seen("no squared index", &glass, &|wi| {
        let by = if wi.z < 0.0 { 2.25 } else { 1.0 };
        glass.bsdf.density(wi, wo) / by
    });
    for model in all() {
        seen("1 % more", &model, &|wi| 1.01 * model.bsdf.density(wi, wo));
    }
}
