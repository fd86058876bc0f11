//! Tests the tracer: compares it with closed forms, compares plain with aimed emission, and checks
//! its ledger.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_field::{Ledger, PhotonSource};
use etendue_scene::{Emission, Scene, SceneFile, resolve};
use etendue_trace::Tracer;

const FIG9B: &str = include_str!("../../../scenes/fig9b.ron");

fn scene(overrides: &[(&str, &str)]) -> Scene {
    let mut file = SceneFile::parse(FIG9B).unwrap();
    for (path, value) in overrides {
        file = file.with(path, value).unwrap();
    }
    resolve("test", file, ".".as_ref(), u64::MAX).unwrap()
}

/// Computes the mean of weight times window over all emitted photons. Returns this mean and its
/// standard error for each virtual plane, and the ledger of all photons.
fn windowed_integrals(scene: &Scene) -> (Vec<[f64; 2]>, Ledger) {
    let tracer = Tracer::new(scene);
    let mut sums = vec![[0.0; 2]; scene.planes.len()];
    let mut ledger = Ledger::default();
    for batch in 0..scene.run.batches {
        let mut record = |plane: usize, crossings: &[etendue_field::Crossing]| {
            for crossing in crossings {
                let w = crossing.weight * scene.planes[plane].window.value(&crossing.ray);
                sums[plane][0] += w;
                sums[plane][1] += w * w;
            }
        };
        ledger.add(&tracer.emit(batch, &mut record, &|_| ()));
    }
    let n = scene.run.photons as f64;
    let estimate = |[s, s2]: [f64; 2]| {
        let mean = s / n;
        [mean, ((s2 / n - mean * mean) / n).sqrt()]
    };
    (sums.into_iter().map(estimate).collect(), ledger)
}

/// At the light, ∫ L W = L · (∫ over the light of the window in x)² · (∫ of the window in u)²,
/// where L is the radiance and W the window.
#[test]
fn light_has_the_flux_it_should_by_either_emission() {
    let (a, b, half) = (0.5, 0.5, 0.1);
    let across = half + a / std::f64::consts::PI * (std::f64::consts::PI * half / a).sin();
    let exact = (across * b).powi(2);
    for emission in ["Aimed", "Plain"] {
        let scene = scene(&[("run.photons", "1e6"), ("run.emission", emission)]);
        let (integrals, _) = windowed_integrals(&scene);
        let [mean, error] = integrals[0];
        assert!(
            error < 3e-3 * exact,
            "{emission}: {error} does not resolve {exact}"
        );
        // Four standard errors.
        assert!(
            (mean - exact).abs() < 4.0 * error,
            "{emission}: {mean} ± {error}, exact {exact}"
        );
    }
}

#[test]
fn aimed_and_plain_emission_agree_at_every_plane() {
    let estimate = |emission: &str| {
        windowed_integrals(&scene(&[
            ("run.photons", "2e6"),
            ("run.emission", emission),
        ]))
        .0
    };
    for (plane, (aimed, plain)) in estimate("Aimed").iter().zip(estimate("Plain")).enumerate() {
        let z = (aimed[0] - plain[0]) / aimed[1].hypot(plain[1]);
        assert!(aimed[1] < plain[1], "aiming does not pay at plane {plane}");
        // Among the four planes tested, at least one exceeds 3.7 standard errors once in a
        // thousand runs.
        assert!(z.abs() < 3.7, "plane {plane}: {aimed:?} and {plain:?}");
    }
}

#[test]
fn ledger_closes() {
    for emission in ["Aimed", "Plain"] {
        let (_, ledger) = windowed_integrals(&scene(&[
            ("run.photons", "1e6"),
            ("run.emission", emission),
        ]));
        // The rounding error of 10^6 additions in blocks of 4096 is below 1e-13.
        assert!(
            ledger.imbalance().abs() < 1e-12,
            "{emission}: {}",
            ledger.imbalance()
        );
        let parts = [ledger.absorbed, ledger.stopped];
        assert!(
            parts.iter().all(|p| *p > 0.05 * ledger.emitted),
            "{ledger:?}"
        );
    }
}

/// Plain emission of a Lambertian square emits L · area · π.
#[test]
fn plain_flux_is_radiance_times_area_times_pi() {
    let scene = scene(&[
        ("run.photons", "1e5"),
        ("run.emission", "Plain"),
        ("light.radiance", "3"),
    ]);
    assert_eq!(scene.run.emission, Emission::Plain);
    let (_, ledger) = windowed_integrals(&scene);
    let flux = ledger.emitted / scene.run.photons as f64;
    let exact = 3.0 * 0.04 * std::f64::consts::PI;
    assert!(
        (flux / exact - 1.0).abs() < 1e-12,
        "{flux} W, exact {exact} W"
    ); // rounding; all photons have the same flux
}

/// If blockers fill their plane, no light passes. Without blockers, two virtual planes on the two
/// sides of the blockers' plane see the same photons.
#[test]
fn blockers_block() {
    let count = |overrides: &[(&str, &str)]| {
        let scene = scene(overrides);
        let tracer = Tracer::new(&scene);
        let mut crossed = vec![0usize; scene.planes.len()];
        for batch in 0..scene.run.batches {
            tracer.emit(batch, &mut |plane, c| crossed[plane] += c.len(), &|_| ());
        }
        crossed
    };
    let closed = count(&[
        ("run.photons", "2e5"),
        ("blockers.0.fill", "1"),
        ("blockers.0.jitter", "0"),
    ]);
    assert_eq!(closed[0], 200_000);
    assert_eq!(closed[1], 200_000);
    assert!(closed[2..].iter().all(|n| *n == 0), "{closed:?}");
    let open = count(&[("run.photons", "2e5"), ("blockers.0.fill", "1e-9")]);
    assert_eq!(open[1], open[2]);
}
