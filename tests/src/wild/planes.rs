//! Random planes, windows and frequencies.

use super::draw::SceneDraw;
use etendue_field::{Orientation, Profile, Quantity};
use etendue_scene::{
    AxisFile, CentralRay, FrequenciesFile, Place, PlaneFile, SceneFile, SurfaceFile, WindowFile,
};

/// Draws one to three planes at points of the path.
pub(super) fn planes(draw: &mut SceneDraw, file: &SceneFile, path: &CentralRay) -> Vec<PlaneFile> {
    let mut planes = Vec::new();
    for i in 0..*draw.pick(&[1, 1, 2, 2, 3]) {
        let (at, orientation) = place(draw, file, path);
        let (window, frequencies) = if draw.one_in(3) {
            let window = window(draw);
            let frequencies = frequencies(draw, &window);
            (Some(window), Some(frequencies))
        } else {
            (None, None)
        };
        planes.push(PlaneFile {
            name: format!("p{i}"),
            at,
            quantity: *draw.pick(&[
                Quantity::Radiance,
                Quantity::Radiance,
                Quantity::DifferentialIrradiance,
            ]),
            orientation,
            window,
            frequencies,
        });
    }
    planes
}

fn place(draw: &mut SceneDraw, file: &SceneFile, path: &CentralRay) -> (Place, Orientation) {
    let across = Orientation::Orthogonal;
    let visit = draw.below(file.path.visits.len());
    let name = file.path.visits[visit].clone();
    match draw.below(10) {
        0 if draw.one_in(2) => (Place::Emission, across),
        0 | 1 if !file.blockers.is_empty() => {
            let at = draw.below(file.blockers.len());
            let mask = file.blockers[at].name().to_owned();
            let place = [Place::Before(mask.clone()), Place::After(mask)];
            (place[draw.below(2)].clone(), across)
        }
        0..=4 => {
            let leg = draw.below(path.legs.len());
            let leg = &path.legs[leg];
            let reach = leg.length.min(2.0 * draw.unit);
            let share = draw.extreme_or(&[1e-4, 0.9999], |draw| draw.between(0.05, 0.95));
            (Place::Distance(leg.start + share * reach), across)
        }
        5 | 6 => {
            let orientation = orientation(draw, file, &name, true);
            (Place::Before(name), orientation)
        }
        _ => {
            let orientation = orientation(draw, file, &name, false);
            (Place::After(name), orientation)
        }
    }
}

fn orientation(draw: &mut SceneDraw, file: &SceneFile, name: &str, before: bool) -> Orientation {
    let surface = file.surfaces.iter().find(|s| s.name() == name);
    let on_mesh = matches!(surface, Some(SurfaceFile::Mesh { .. }));
    match draw.below(6) {
        0 => Orientation::Tangent,
        1 if !on_mesh => Orientation::LocalNormals,
        2 if !on_mesh && before => Orientation::Mirrored,
        _ => Orientation::Orthogonal,
    }
}

pub(super) fn window(draw: &mut SceneDraw) -> WindowFile {
    let x = draw.length([0.1, 0.5], [1e-4, 20.0]);
    let u = draw.value([0.08, 0.45], [1e-4, 4.0]);
    let ratio = |draw: &mut SceneDraw| draw.value([0.5, 2.0], [1e-2, 1e2]);
    let y = draw.one_in(4).then(|| x * ratio(draw));
    let v = draw.one_in(4).then(|| u * ratio(draw));
    WindowFile {
        x: profile(draw, x),
        y: y.map(|half| profile(draw, half)),
        u: profile(draw, u),
        v: v.map(|half| profile(draw, half)),
    }
}

fn profile(draw: &mut SceneDraw, half: f64) -> Profile {
    match draw.below(5) {
        0 => Profile::Box(half),
        1 => Profile::Gaussian {
            width: half / draw.value([0.7, 3.0], [0.01, 9.9]),
            cut: half,
        },
        _ => Profile::Hann(half),
    }
}

pub(super) fn frequencies(draw: &mut SceneDraw, window: &WindowFile) -> FrequenciesFile {
    let widest = |a: Profile, b: Option<Profile>| {
        let b = b.map_or(0.0, |b| b.half_width());
        a.half_width().max(b)
    };
    let halves = [widest(window.x, window.y), widest(window.u, window.v)];
    let [rho, nu] = halves.map(|half| {
        let natural = 0.5 / half;
        let steps = f64::from(draw.extreme_or(&[1, 40], |draw| draw.whole(2, 9)));
        let spacing = draw.one_in(5).then(|| natural * draw.between(0.3, 1.0));
        AxisFile {
            max: steps * natural,
            spacing,
        }
    });
    FrequenciesFile {
        azimuths: draw.extreme_or(&[1, 16], |draw| draw.whole(1, 5)),
        rho,
        nu,
    }
}
