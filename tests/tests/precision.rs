//! Tests that the transform of reduced precision, which photons of a light with extent use, changes
//! spectra by much less than their noise.

use crate::common::edited;
use crate::scenes::{measured, tampered};
use etendue_field::PhotonSource;
use etendue_spectrum::{Measurement, estimate};
use etendue_trace::Tracer;

const SCENES: [&str; 4] = ["travel", "fig9b", "disc_light", "diffuse"];

const PHOTONS: u64 = 1 << 20;

/// The largest difference between two spectra of one plane, in standard errors.
fn difference(full: &Measurement, reduced: &Measurement, plane: usize) -> f64 {
    let [full, reduced] = [full, reduced].map(|m| estimate::slices(m, plane).expect("batches"));
    let pairs = full.mean.half.iter().zip(&reduced.mean.half);
    let errors = pairs.map(|(a, b)| (a - b).norm());
    let ratios = errors.zip(&full.variance).map(|(e, v)| e / v.sqrt());
    ratios.fold(0.0, f64::max)
}

/// Lights without extent in position or slope, narrow lights, narrow windows, and long runs need full
/// precision.
#[test]
fn quiet_photons_have_full_precision() {
    let precise = |name: &str, edits: &[(&str, &str)], photons: u64| {
        let mut scene = edited(name, edits);
        scene.run.photons = photons;
        Tracer::new(&scene).is_precise()
    };
    assert!(precise("fig4_point", &[], 1 << 22));
    let area = "Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: 1.0)";
    for edit in [
        ("size: (0.2, 0.2)", "size: (0.2, 0.001)"),
        (area, "Beam(center: (0, 0, 0), image: (width: (0.2, 0.2)))"),
        ("u: Hann(0.5)", "u: Hann(0.001)"),
    ] {
        assert!(precise("travel", &[edit], 1 << 22), "{edit:?}");
    }
    assert!(!precise("travel", &[], 1 << 22) && precise("travel", &[], 1 << 30));
}

#[test]
fn reduced_precision_is_hidden_by_noise() {
    for name in SCENES {
        let mut scene = edited(name, &[]);
        scene.run.photons = PHOTONS;
        scene.run.resolution = 1.0;
        let tracer = Tracer::new(&scene);
        assert!(!tracer.is_precise());
        // A source that is not the tracer itself has a transform of full precision.
        let full = tampered(&scene, |_, crossing| Some(crossing));
        let reduced = measured(&scene, &tracer);
        let first = |m: &Measurement| m.at_plane(0).next().map(|batch| batch.slices.clone());
        assert_ne!(first(&full), first(&reduced));
        for (i, plane) in scene.planes.iter().enumerate() {
            let found = difference(&full, &reduced, i);
            // A tenth of the noise adds half a percent to the standard error. Rounding to the
            // nearest whole number, which loses 3e-6 of the sum, gives 0.4 in `travel`.
            assert!(found < 0.1, "{found} standard errors at {}", plane.name);
        }
    }
}
