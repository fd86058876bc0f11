//! The scene as a file for `etendue run`.

use crate::parts::{SLAT, count, grid, place, seed};
use crate::plane::PathPlace;
use crate::rays::{APERTURE, AZIMUTHS};
use crate::setup::{SettingKey, Setup};
use etendue_field::FrequencyAxis;
use std::fmt::Write;

/// Photons of a run that takes a few seconds.
const PHOTONS: u64 = 4_194_304;

/// The scene file.
#[must_use]
pub fn scene(setup: &Setup) -> String {
    let get = |key| setup.get(key);
    let (x, distance, end) = (
        get(SettingKey::Position),
        get(SettingKey::Distance),
        get(SettingKey::Travel),
    );
    let grid = grid(setup);
    let axis = |axis: &FrequencyAxis| format!("(max: {}, spacing: {})", axis.max(), axis.spacing);
    let planes: Vec<String> = PathPlace::all(setup)
        .into_iter()
        .map(|p| plane(p, setup))
        .collect();
    format!(
        "// Set up in the explorer, explorer.html#{fragment}
(
    light: Rectangle(center: ({x}, 0, 0), size: ({side}, {side}), radiance: 1),
{blockers}    surfaces: [
        {receiver},
    ],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: [\"receiver\"]),
    planes: [
{planes}
    ],
    window: (x: Hann({window_x}), u: Hann({window_u})),
    frequencies: (azimuths: {AZIMUTHS}, rho: {rho}, nu: {nu}),
    run: (photons: {PHOTONS}, seed: 1, batches: 64),
)
",
        fragment = setup.fragment(),
        side = get(SettingKey::Width),
        blockers = blockers(setup, distance),
        receiver = receiver(setup, x, end),
        planes = planes.join("\n"),
        window_x = get(SettingKey::WindowX),
        window_u = get(SettingKey::WindowU),
        rho = axis(&grid.rho),
        nu = axis(&grid.nu),
    )
}

fn blockers(setup: &Setup, distance: f64) -> String {
    let [pitch, fill, jitter] =
        [SettingKey::Pitch, SettingKey::Fill, SettingKey::Jitter].map(|key| setup.get(key));
    let count = count(setup);
    if fill <= 0.0 {
        return String::new();
    }
    let head = format!("name: \"blockers\", center: (0, 0, {distance})");
    if setup.is(SettingKey::Squares) {
        let seed = seed(setup);
        return format!(
            "    blockers: [
        JitteredSquares({head}, count: ({count}, {count}), pitch: {pitch}, fill: {fill}, \
             jitter: {jitter}, seed: {seed}),
    ],
"
        );
    }
    let mut text = format!("    blockers: [\n        Shapes({head}, shapes: [\n");
    for i in 0..count {
        let (at, side) = (place(i, count) * pitch, fill * pitch);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "            Rectangle(center: ({at}, 0), size: ({side}, {SLAT})),"
        );
    }
    text + "        ]),\n    ],\n"
}

fn receiver(setup: &Setup, x: f64, end: f64) -> String {
    let albedo = setup.get(SettingKey::Albedo);
    if !setup.is(SettingKey::Glossy) {
        return format!(
            "Rectangle(name: \"receiver\", center: ({x}, 0, {end}), size: (6, 6), albedo: {albedo})"
        );
    }
    let [curvature, exponent] =
        [SettingKey::Curvature, SettingKey::Exponent].map(|key| setup.get(key));
    let form = if curvature.abs() > 0.0 {
        format!("Sphere({curvature})")
    } else {
        "Plane".to_owned()
    };
    format!(
        "Smooth(name: \"receiver\", center: ({x}, 0, {end}), facing: (0, 0, -1), form: {form}, \
         aperture: {APERTURE},
            event: Reflects(brdf: (lobe: Phong({exponent}), albedo: {albedo})))"
    )
}

/// Writes a plane of the scene file. If the setup has no blockers, the planes around the place of
/// the blockers keep their distance from the light.
fn plane(plane: PathPlace, setup: &Setup) -> String {
    let distance = setup.get(SettingKey::Distance);
    let are_there = setup.get(SettingKey::Fill) > 0.0;
    let before_receiver = "at: Before(\"receiver\")";
    let place = match plane {
        PathPlace::Light => "at: Emission".to_owned(),
        PathPlace::Travelled if are_there => "at: Before(\"blockers\")".to_owned(),
        PathPlace::Blocked if are_there => "at: After(\"blockers\")".to_owned(),
        PathPlace::Travelled | PathPlace::Blocked => format!("at: Distance({distance})"),
        PathPlace::Arrived => before_receiver.to_owned(),
        PathPlace::Irradiance => format!("{before_receiver}, quantity: DifferentialIrradiance"),
        PathPlace::Curved => format!("{before_receiver}, orientation: LocalNormals"),
        PathPlace::Blurred => "at: After(\"receiver\"), orientation: LocalNormals".to_owned(),
        PathPlace::Diffuse | PathPlace::Glossy => "at: After(\"receiver\")".to_owned(),
    };
    format!("        (name: \"{}\", {place}),", plane.name())
}
