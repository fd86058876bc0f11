//! Faults in the power of a prediction alone, and in its phases alone.

use super::{p_values, shifted, unchanged};
use crate::report::Bound::{AtLeast, Below};
use crate::report::{Check, ReportSection, Row};
use crate::scenes::{fig9b, traced};
use etendue_compare::{TESTS, sidak};
use etendue_field::{Complex, Slices, VirtualPlane};

/// What a fault changes in a prediction.
#[derive(Clone, Copy, PartialEq)]
enum PlantedIn {
    Nothing,
    Power,
    Phase,
}

/// A change of a prediction at a plane.
type SliceFault = fn(&VirtualPlane, Slices) -> Slices;

const FAULTS: [(&str, PlantedIn, SliceFault); 8] = [
    ("none", PlantedIn::Nothing, |_, slices| slices),
    ("amplitudes + 0.5 %", PlantedIn::Power, |_, slices| {
        scaled(slices, |_| 1.005)
    }),
    (
        "amplitudes + 2 % above a quarter of the largest ν",
        PlantedIn::Power,
        |_, slices| {
            let most = slices.grid.nu.max();
            scaled(
                slices,
                |[_, nu]| if nu.abs() > most / 4.0 { 1.02 } else { 1.0 },
            )
        },
    ),
    (
        "amplitudes − 2 % where ρν > 0",
        PlantedIn::Power,
        |_, slices| scaled(slices, |[rho, nu]| if rho * nu > 0.0 { 0.98 } else { 1.0 }),
    ),
    (
        "amplitudes + 0.5 %, and a shift of 1/64 of a bin of 64 along x",
        PlantedIn::Power,
        |plane, slices| {
            let by = plane.window.x.half_width() / 32.0 / 64.0;
            shifted(scaled(slices, |_| 1.005), by)
        },
    ),
    (
        "shift of half a bin of 64 along x",
        PlantedIn::Phase,
        |plane, slices| shifted(slices, plane.window.x.half_width() / 64.0),
    ),
    (
        "wrong sign of the Fourier transform",
        PlantedIn::Phase,
        |_, mut slices| {
            slices.half.mapv_inplace(|s| s.conj());
            slices
        },
    ),
    (
        "phases + 0.1 where ρ > 0",
        PlantedIn::Phase,
        |_, mut slices| {
            for ((_, m, _), value) in slices.half.indexed_iter_mut() {
                if m > 0 {
                    *value *= Complex::cis(0.1);
                }
            }
            slices
        },
    ),
];

/// Multiplies the slices by a factor at each (ρ, ν).
fn scaled(mut slices: Slices, factor: impl Fn([f64; 2]) -> f64) -> Slices {
    let grid = slices.grid;
    for ((_, m, n), value) in slices.half.indexed_iter_mut() {
        *value *= factor([m as f64 * grid.rho.spacing, grid.nu.value(n)]);
    }
    slices
}

/// The section, for the receiver of the main scene.
pub(crate) fn power(photons: u64, seed: u64) -> ReportSection {
    let scene = fig9b(photons, seed);
    let measurement = traced(&scene);
    let is_receiver = |plane: &VirtualPlane| plane.name == "receiver";
    let index = scene.planes.iter().position(is_receiver);
    let index = index.expect("a plane of the main scene");
    let plane = &scene.planes[index];
    let sound = unchanged(&scene, plane).expect("the main scene has a closed form");
    let level = sidak(scene.run.alpha, TESTS * scene.planes.len());
    let rows = FAULTS.map(|(name, change, fault)| {
        let planted = fault(plane, sound.clone());
        let found = p_values(&scene, &measurement, (index, &planted, &[]));
        let [of_slices, of_power] = found.map(|p| p.unwrap_or(f64::NAN));
        let seen = |p| Check::new("rejected", p, Below(level)).because("a fault is planted");
        let unseen = |p| Check::new("accepted", p, AtLeast(level)).because("nothing changes here");
        let checks = match change {
            PlantedIn::Nothing => vec![unseen(of_slices), unseen(of_power)],
            PlantedIn::Power => vec![seen(of_power)],
            PlantedIn::Phase => vec![seen(of_slices), unseen(of_power)],
        };
        let cells = [
            name.to_owned(),
            format!("{of_slices:.5}"),
            format!("{of_power:.5}"),
        ];
        Row::new(cells.to_vec(), checks)
    });
    ReportSection::new(
        format!(
            "Faults in power alone and in phases alone, {:.0e} photons",
            photons as f64
        ),
        format!(
            "Amplitudes or phases of the prediction for {} of the main scene are changed. \
             Required: the power (|F|², averaged over azimuths) is rejected if amplitudes change, \
             and accepted if phases alone change; the slices are rejected if phases change.",
            plane.name
        ),
        "fault | p of slices | p of power | verdict",
        rows.to_vec(),
    )
}
