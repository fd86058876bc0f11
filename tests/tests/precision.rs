//! Tests that the transform of reduced precision, which photons of a light with extent use, changes
//! spectra by much less than their noise.

use crate::common::measured;
use etendue_field::{Crossing, Ledger, PhotonSource};
use etendue_scene::{SceneFile, resolve};
use etendue_spectrum::{Measurement, estimate};
use etendue_trace::Tracer;

const SCENES: [&str; 4] = [
    include_str!("../../scenes/travel.ron"),
    include_str!("../../scenes/fig9b.ron"),
    include_str!("../../scenes/disc_light.ron"),
    include_str!("../../scenes/diffuse.ron"),
];

const PHOTONS: u64 = 1 << 20;

/// The photons of a tracer, with a transform of full precision.
struct Precise<'a>(&'a Tracer);

impl PhotonSource for Precise<'_> {
    fn emitted(&self, batch: u32) -> u64 {
        self.0.emitted(batch)
    }

    fn emit(
        &self,
        batch: u32,
        record: &mut dyn FnMut(usize, &[Crossing]),
        progress: &dyn Fn(u64),
    ) -> Ledger {
        self.0.emit(batch, record, progress)
    }
}

/// Returns the largest difference between two spectra of one plane, in standard errors.
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
    let precise = |text: &str, photons: u64| {
        let mut file = SceneFile::parse(text).expect("a scene file");
        file.run.photons = photons;
        let scene = resolve("test", file, "../scenes".as_ref(), u64::MAX).expect("a sound scene");
        Tracer::new(&scene).is_precise()
    };
    let point = include_str!("../../scenes/fig4_point.ron");
    let travel = SCENES[0];
    let narrow = travel.replace("size: (0.2, 0.2)", "size: (0.2, 0.001)");
    assert_ne!(narrow, travel);
    assert!(precise(point, 1 << 22) && precise(&narrow, 1 << 22));
    let area = "Rectangle(center: (0, 0, 0), size: (0.2, 0.2), radiance: 1.0)";
    let beam = travel.replace(area, "Beam(center: (0, 0, 0), image: (width: (0.2, 0.2)))");
    let thin = travel.replace("u: Hann(0.5)", "u: Hann(0.001)");
    assert!(beam != travel && thin != travel);
    assert!(precise(&beam, 1 << 22) && precise(&thin, 1 << 22));
    assert!(!precise(travel, 1 << 22) && precise(travel, 1 << 30));
}

#[test]
fn reduced_precision_is_hidden_by_noise() {
    for text in SCENES {
        let mut file = SceneFile::parse(text).expect("a scene file");
        file.run.photons = PHOTONS;
        file.run.resolution = 1.0;
        let scene = resolve("test", file, "../scenes".as_ref(), u64::MAX).expect("a sound scene");
        let tracer = Tracer::new(&scene);
        assert!(!tracer.is_precise());
        let full = measured(&scene, &Precise(&tracer));
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
