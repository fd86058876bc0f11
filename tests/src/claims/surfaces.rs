//! Statements of the paper about surfaces: reciprocity, mirror spheres, curvature, the cosine,
//! lobes, environments.

use super::number::{ClaimNumber, at};
use super::scene::{ClaimRun, SeenScene, number};
use super::{CHANCE, Claim, PULL};
use crate::report::Bound::{Above, AtLeast, AtMost, Below};
use crate::report::Check;
use crate::scenes::tampered;
use etendue_field::{Crossing, PhotonSource, Slices, VirtualPlane};
use etendue_spectrum::bandwidth::Along;
use etendue_trace::Tracer;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) fn claims(run: ClaimRun) -> Vec<Claim> {
    let mut all = vec![reciprocity(run), fresnel(run), mirror_sphere(run)];
    all.extend(curvature(run));
    all.extend([cosine(run), lobe(run)]);
    all.extend(environment(run));
    all
}

/// The field of a surface whose normal is turned from the central ray by `incidence`, in
/// radians.
fn facing(incidence: f64) -> (&'static str, String) {
    let (sine, cosine) = incidence.sin_cos();
    ("surfaces.0.facing", format!("({sine}, 0, {})", -cosine))
}

/// Returns the field of a central ray that arrives at the angle `incidence` and leaves at
/// `outgoing` on the other side of the normal, both in radians.
fn leaves([incidence, outgoing]: [f64; 2]) -> (&'static str, String) {
    let leaves = PI - incidence - outgoing;
    (
        "path.leaves",
        format!("({}, 0, {})", leaves.sin(), leaves.cos()),
    )
}

/// Measures the light that a glossy plane reflects from one angle to another, divided by the
/// irradiance, for two angles in both orders. The returned number is the ratio of the reflectances
/// for the two orders.
fn both_ways(name: &str, run: ClaimRun) -> ClaimNumber {
    let angles = [20.0_f64, 50.0].map(f64::to_radians);
    let [there, back] = [angles, [angles[1], angles[0]]].map(|angles| {
        let seen = run.seen(name, &[facing(angles[0]), leaves(angles)]);
        seen.number(0, Slices::at_zero).per(angles[0].cos())
    });
    there.over(&back)
}

fn reciprocity(run: ClaimRun) -> Claim {
    let ratio = both_ways("reciprocity", run);
    Claim {
        said: "a BRDF of the angle to the mirror direction is not reciprocal (4.1)",
        shown: "BRDF of a Phong lobe from 20° to 50° over the same BRDF from 50° to 20°".to_owned(),
        checks: vec![Check::new("off 1", (ratio.value - 1.0).abs(), Below(0.01)).because(
            "the windows of 0.02 m and 0.02 rad cause an error of second order, and there is noise",
        )],
        numbers: vec![ratio],
        holds: "does not hold: it is reciprocal",
    }
}

fn fresnel(run: ClaimRun) -> Claim {
    let ratio = both_ways("reciprocity_fresnel", run);
    Claim {
        said: "the same, with a factor f(θ_i') (4.3)",
        shown: "the same ratio with the Fresnel factor of glass at the angle of incidence"
            .to_owned(),
        checks: vec![Check::new("ratio", ratio.value, Below(0.8)).because("F(20°)/F(50°) = 0.70")],
        numbers: vec![ratio],
        holds: "holds for such a BRDF",
    }
}

/// Measures a sphere of 0.5 m in a wider beam, seen from three sides.
fn mirror_sphere(run: ClaimRun) -> Claim {
    let found = [0.0, 0.7, 1.4].map(|incidence| {
        let scene = run.scene("mirror_sphere", &[facing(incidence)]);
        let (mut off, mut widest) = (0.0_f64, 0.0_f64);
        let mut look = |_: usize, crossings: &[Crossing]| {
            for crossing in crossings {
                let [normal, leaves] = angles(&scene.planes[0], crossing);
                off = off.max((leaves - 2.0 * normal).abs());
                widest = widest.max(leaves);
            }
        };
        let tracer = Tracer::new(&scene);
        for batch in 0..scene.run.batches {
            tracer.emit(batch, &mut look, &|_| ());
        }
        [off, widest.to_degrees()]
    });
    let [off, widest] = [0, 1].map(|i| found.iter().map(|f| f[i]).fold(0.0, f64::max));
    Claim {
        said: "a mirror sphere maps the full 360° to the 180° of its normals (4.1)",
        shown: format!(
            "photons of a beam leave in directions up to {widest:.2}° from the direction to its \
            source, at twice the angle of the normal; the largest deviation from twice this angle \
            is {off:.0e} rad"
        ),
        numbers: Vec::new(),
        checks: vec![
            Check::new("off twice", off, Below(1e-8))
                .because("rounding is larger at the rim, where the root of 1 − k² r² is small"),
            Check::new("widest", widest, AtLeast(176.0))
                .because("normals reach 88°, because few photons land at the rim"),
        ],
        holds: "holds up to the rim",
    }
}

/// Two angles of a photon that leaves a sphere of 0.5 m, measured from the direction
/// towards the beam's source. The first is the angle to the normal at the point where the photon
/// leaves, and the second is the angle to the direction of the photon.
fn angles(plane: &VirtualPlane, crossing: &Crossing) -> [f64; 2] {
    let ray = crossing.ray;
    let (s, t) = (2.0 * ray.x, 2.0 * ray.y);
    let normal = DVec3::new(s, t, (1.0 - s * s - t * t).max(0.0).sqrt());
    let normal = plane.frame.vector_to_world(normal);
    let ((sin, cos), (up, across)) = ((ray.u + plane.longitude).sin_cos(), ray.v.sin_cos());
    let local = plane.frame.turned_to(normal);
    let leaves = local.vector_to_world(DVec3::new(across * sin, up, across * cos));
    // The arctangent is used because the arccosine is inaccurate near 0 and π.
    [normal, leaves].map(|d| d.x.hypot(d.y).atan2(-d.z))
}

fn curvature(run: ClaimRun) -> [Claim; 2] {
    let curvatures = [-0.5, 0.0, 0.8, 1.6];
    let seen = curvatures.map(|k| run.seen("curvature", &[("surfaces.0.form", form(k))]));
    let each = |of: fn(&Slices) -> f64| seen.each_ref().map(|seen| seen.number(0, of)).to_vec();
    let angular = each(|slices| bandwidth(slices, Along::Nu));
    let spatial = each(|slices| bandwidth(slices, Along::Rho));
    let spread = |of: &[ClaimNumber]| {
        let values = of.iter().map(|n| n.value);
        values.clone().fold(0.0, f64::max) / values.fold(f64::INFINITY, f64::min) - 1.0
    };
    [
        Claim {
            said: "curvature has no effect on the directional bandwidth of the outgoing light field (4.2)",
            shown: format!(
                "95 % bandwidth over ν [/rad] of the light that leaves a glossy surface with k = \
                {curvatures:?} /m"
            ),
            checks: vec![Check::new("spread", spread(&angular), Below(0.03)).because(
                "a window of 0.6 rad cuts the lobe, and off its middle where the surface turns",
            )],
            numbers: angular,
            holds: "holds on the surface, for the light field as a whole",
        },
        Claim {
            said: "curvature has a strong effect on spatial frequencies (4.2)",
            shown: "the same bandwidth over ρ [/m]".to_owned(),
            checks: vec![
                Check::new("spread", spread(&spatial), Above(0.5))
                    .because("a shear by twice k maps ν to ρ"),
            ],
            numbers: spatial,
            holds: "holds",
        },
    ]
}

fn form(k: f64) -> String {
    if k.abs() > 0.0 {
        format!("Sphere({k})")
    } else {
        "Plane".to_owned()
    }
}

pub(super) fn bandwidth(slices: &Slices, along: Along) -> f64 {
    let power = slices.radial_power();
    let found = along.bandwidth(power.view(), &slices.grid);
    found.unwrap_or(f64::NAN)
}

fn cosine(run: ClaimRun) -> Claim {
    let halves = [0.5_f64, 0.25, 0.125];
    let apart = halves.map(|half| {
        let scene = run.scene("cosine", &[("window.u", format!("Hann({half})"))]);
        let whole = SeenScene::of(scene.clone());
        // Replaces the factor cos θ cos φ of a weight by cos θ.
        let without_cosine = |_: usize, mut crossing: Crossing| {
            crossing.weight /= crossing.ray.v.cos();
            Some(crossing)
        };
        let flat = SeenScene {
            measurement: tampered(&scene, without_cosine),
            predictions: whole.predictions.clone(),
        };
        number(&[(&flat, 0), (&whole, 0)], &|slices| {
            slices[0].relative_difference(&slices[1])
        })
    });
    // The two spectra are from the same photons with different weights; no prediction exists for
    // the difference of these spectra.
    let numbers: Vec<ClaimNumber> = apart
        .iter()
        .map(|n| ClaimNumber {
            predicted: n.value,
            ..*n
        })
        .collect();
    let logs = [0, 1, 2].map(|i| [halves[i].ln(), apart[i].value.ln()]);
    let exponent = crate::orders::slope(&logs);
    Claim {
        said: "with the equator in the plane of incidence the cosine depends on θ alone, to first order (5.2)",
        shown: format!(
            "relative difference between the spectra of light times cos θ and light times cos θ \
            cos φ, in windows over φ of {halves:?} rad; it falls with the window to the power \
            {exponent:.2}"
        ),
        checks: vec![
            Check::new("exponent", exponent, AtLeast(1.9)).because("second order in φ"),
            Check::new("the same", exponent, AtMost(2.1)).because("second order in φ"),
        ],
        numbers,
        holds: "holds: the error is of second order in φ",
    }
}

fn lobe(run: ClaimRun) -> Claim {
    let aside = [0.0, 0.1, 0.2];
    let half = 0.1;
    let ratios = aside.map(|aside| {
        let seen = run.seen("lobe", &[leaves([0.6, 0.6 + aside])]);
        let nu = 0.5 / half;
        seen.number(0, |slices| {
            // The spectrum of a Hann window alone falls to half of its peak at the first
            // frequency.
            let [theta, phi] =
                [0, 1].map(|k| (at(slices, k, [0.0, nu]) / slices.at_zero() - 0.5).norm());
            theta / phi
        })
    });
    Claim {
        said: "off the peak a lobe is influenced more by θ than by φ (5.3)",
        shown: format!(
            "change of the reflected light with θ over its change with φ, within ± {half} rad of \
            a direction that is {aside:?} rad off the mirror direction"
        ),
        checks: vec![
            Check::new("at the peak", (ratios[0].value - 1.0).abs(), Below(0.1))
                .because("only the distance to the peak counts"),
            Check::new("off it", ratios[1].value.min(ratios[2].value), AtLeast(4.0))
                .because("one change is of first order and the other of second order"),
        ],
        numbers: ratios.to_vec(),
        holds: "holds",
    }
}

/// Measures a diffuse sphere of curvature k, with a window and frequencies that match the size of
/// the sphere.
fn diffuse(name: &str, k: f64, run: ClaimRun) -> SeenScene {
    let fields = [
        ("surfaces.0.form", form(k)),
        ("surfaces.0.aperture", (0.45 / k).to_string()),
        ("window.x", format!("Hann({})", 0.4 / k)),
        ("frequencies.rho.max", (8.0 * k).to_string()),
    ];
    run.seen(name, &fields)
}

fn environment(run: ClaimRun) -> [Claim; 2] {
    let apart = |name: &str| {
        // With a common seed, the photons on spheres of different sizes would be equal up to scale.
        let next = ClaimRun {
            seed: run.seed.wrapping_add(1),
            ..run
        };
        let [one, other] = [(1.0, run), (3.0, next)].map(|(k, run)| diffuse(name, k, run));
        number(&[(&one, 0), (&other, 0)], &|slices| {
            let [one, other] = [0, 1].map(|i| slices[i].half.mapv(|s| s / slices[i].at_zero()));
            let apart: f64 = (&one - &other).iter().map(|s| s.norm_sqr()).sum();
            let all: f64 = one.iter().map(|s| s.norm_sqr()).sum();
            apart / all
        })
    };
    let [far, near] = ["environment", "near_light"].map(apart);
    [
        Claim {
            said: "for light that varies only in angle, the cosine is a convolution over normals: \
                the spectrum depends on Ωx/k (6.1)",
            shown: "energy of the difference between the spectra of diffuse spheres of k = 1 /m \
                and k = 3 /m at the same Ωx/k, relative to the energy of the former"
                .to_owned(),
            checks: vec![Check::new("apart", far.value / far.error, AtMost(PULL)).because(CHANCE)],
            numbers: vec![far],
            holds: "holds: the spectrum is a function of Ωx/k",
        },
        Claim {
            said: "the same, under a light that varies in space",
            shown: "the same for a square light of 0.5 m, 0.5 m away".to_owned(),
            checks: vec![
                Check::new("apart", near.value, AtLeast(0.002)).because("far beyond noise"),
            ],
            numbers: vec![near],
            holds: "does not hold: the spectrum of such light is not a line",
        },
    ]
}
