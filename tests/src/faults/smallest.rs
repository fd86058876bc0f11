//! Finds the smallest faults of the main scene that are still rejected.

use super::{Predict, chained, each_rectangle, moved, scale_travel, unchanged, widened};
use crate::progress::progress;
use crate::report::Bound::Below;
use crate::report::{Check, ReportSection, Row, percent};
use crate::scenes::{fig9b, sampled, tampered, traced};
use etendue_compare::{Residuals, TESTS, sidak};
use etendue_field::{Crossing, VirtualPlane};
use etendue_scene::{Sampling, Scene};
use etendue_spectrum::Measurement;

/// The largest size of a fault that is tried, and the number of times that this size is halved.
const LARGEST: f64 = 0.01;
const HALVES: i32 = 10;

/// A fault of a given size: a changed prediction, or changed photons.
enum SizedFault {
    Predicted(fn(f64) -> Box<Predict>),
    Photons(fn(f64, Crossing) -> Crossing),
}

use SizedFault::{Photons, Predicted};

const FAULTS: [(&str, SizedFault); 7] = [
    (
        "first travel too long",
        Predicted(|size| chained(move |c| scale_travel(c, 0, 1.0 + size))),
    ),
    (
        "second travel too long",
        Predicted(|size| chained(move |c| scale_travel(c, 1, 1.0 + size))),
    ),
    (
        "blockers too wide",
        Predicted(|size| {
            chained(move |c| each_rectangle(c, |r| r.size = r.size.map(|side| side * (1.0 + size))))
        }),
    ),
    (
        "window too wide in x and y",
        Predicted(|size| widened(size, 0.0)),
    ),
    (
        "window too wide in u and v",
        Predicted(|size| widened(0.0, size)),
    ),
    (
        "field moved along x, relative to the half-width",
        Predicted(moved),
    ),
    (
        "flux of photons with x > 0 too large",
        Photons(|size, mut crossing| {
            if crossing.ray.x > 0.0 {
                crossing.weight *= 1.0 + size;
            }
            crossing
        }),
    ),
];

/// Tries each fault with a size of 1 %, and then repeatedly with half the previous size. Returns
/// the section on the smallest rejected size. At this size and at all larger tried sizes, the fault
/// is rejected.
pub(crate) fn smallest(photons: u64, seed: u64) -> ReportSection {
    let kinds = [Sampling::Lattice, Sampling::Net, Sampling::Random];
    let scenes = kinds.map(|kind| sampled(fig9b(photons, seed), kind));
    let sound: Vec<Measurement> = scenes.iter().map(traced).collect();
    let bar = progress((FAULTS.len() * kinds.len()) as u64, "faults");
    let mut rows = Vec::new();
    for (name, fault) in &FAULTS {
        let sizes = scenes.iter().zip(&sound).map(|(scene, sound)| {
            let size = rejected(fault, scene, sound);
            bar.one();
            size
        });
        let sizes: Vec<Option<f64>> = sizes.collect();
        let checks = sizes.iter().map(|size| {
            let size = size.unwrap_or(f64::INFINITY);
            Check::new("size", size, Below(LARGEST)).because("the largest planted size is rejected")
        });
        let shown = sizes.iter().copied().map(percent);
        let cells = std::iter::once((*name).to_owned()).chain(shown).collect();
        rows.push(Row::new(cells, checks.collect()));
    }
    bar.end();
    ReportSection::new(
        format!("The smallest faults at {:.0e} photons", photons as f64),
        format!(
            "Each fault is planted with a size of 1 %, and then {HALVES} times with half of the \
             size before. The table shows the smallest size that is rejected together with all \
             larger sizes, for photons from lattices, from nets and from random numbers. Required: \
             this size is smaller than 1 %."
        ),
        "fault | lattices | nets | random numbers",
        rows,
    )
}

/// The smallest size of a fault that the comparison rejects.
fn rejected(fault: &SizedFault, scene: &Scene, sound: &Measurement) -> Option<f64> {
    let sizes = (0..=HALVES).map(|halves| LARGEST * 0.5_f64.powi(halves));
    sizes
        .take_while(|size| match fault {
            Predicted(predict) => is_rejected(scene, sound, &*predict(*size)),
            Photons(tamper) => {
                let photons = tampered(scene, |_, crossing| Some(tamper(*size, crossing)));
                is_rejected(scene, &photons, &unchanged)
            }
        })
        .last()
}

/// Checks whether photons and prediction disagree at any plane.
fn is_rejected(scene: &Scene, measurement: &Measurement, predict: &Predict) -> bool {
    let level = sidak(scene.run.alpha, TESTS * scene.planes.len());
    let p_value = |(i, plane): (usize, &VirtualPlane)| {
        let prediction = predict(scene, plane)?;
        Residuals::new(measurement, i, &prediction).p_value(scene.run.seed)
    };
    let mut p_values = scene.planes.iter().enumerate().filter_map(p_value);
    p_values.any(|p| p < level)
}
