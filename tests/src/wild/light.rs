//! Random lights.

use super::draw::SceneDraw;
use super::pictures::sky;
use etendue_scene::{
    AxisName, BulbFile, EnvironmentFile, GratingFile, ImageFile, LightFile, SphericalGaussianFile,
};
use glam::DVec3;
use std::io;

/// A light at the origin of the scene's frame.
pub(super) fn light(draw: &mut SceneDraw) -> io::Result<LightFile> {
    let center = draw.place(DVec3::ZERO);
    let strength = draw.extreme_or(&[1e-9, 1e-3, 1e3, 1e9], |_| 1.0);
    let sides = |draw: &mut SceneDraw| [(); 2].map(|()| draw.length([0.03, 0.5], [1e-6, 100.0]));
    Ok(match draw.below(14) {
        0..=3 => LightFile::Rectangle {
            center,
            size: sides(draw),
            radiance: strength.into(),
        },
        4 | 5 => LightFile::Disc {
            center,
            radius: 0.5 * sides(draw)[0],
            radiance: strength.into(),
        },
        6 | 7 => {
            let size = sides(draw)[0];
            LightFile::Spot {
                center,
                bulb: if draw.one_in(2) {
                    BulbFile::Square(size)
                } else {
                    BulbFile::Disc(0.5 * size)
                },
                radiance: strength.into(),
                exponent: draw.value([1.0, 40.0], [0.01, 1e4]),
            }
        }
        8 => LightFile::Point {
            center,
            intensity: strength.into(),
        },
        9 => LightFile::Projector {
            center,
            intensity: strength.into(),
            image: image(draw, 1.0),
        },
        10 => {
            let unit = draw.unit;
            LightFile::Beam {
                center,
                irradiance: strength.into(),
                image: image(draw, unit),
            }
        }
        _ => environment(draw, center)?,
    })
}

fn image(draw: &mut SceneDraw, unit: f64) -> ImageFile {
    let width = [(); 2].map(|()| unit * draw.value([0.05, 0.5], [1e-3, 20.0]));
    let grating = draw.one_in(3).then(|| GratingFile {
        axis: axis(draw),
        frequency: draw.value([1.0, 15.0], [1e-3, 300.0]) / unit,
        modulation: modulation(draw),
        phase: draw.between(-3.0, 3.0),
    });
    ImageFile { width, grating }
}

/// A random axis, X or Y.
pub(super) fn axis(draw: &mut SceneDraw) -> AxisName {
    *draw.pick(&[AxisName::X, AxisName::Y])
}

/// A random modulation between 0 and 1.
pub(super) fn modulation(draw: &mut SceneDraw) -> f64 {
    draw.extreme_or(&[0.0, 1.0], |draw| draw.between(0.3, 1.0))
}

fn environment(draw: &mut SceneDraw, center: [f64; 3]) -> io::Result<LightFile> {
    let plain = draw.one_in(2);
    let [up, front] = if plain {
        [DVec3::Y, DVec3::Z].map(|v| v.to_array())
    } else {
        [(); 2].map(|()| draw.direction().to_array())
    };
    let map = if draw.one_in(3) {
        EnvironmentFile::File(sky(draw)?)
    } else {
        let count = 1 + draw.below(3);
        // If the environment has axes, lobes are given in these axes, otherwise in world axes.
        EnvironmentFile::Lobes((0..count).map(|_| lobe(draw, plain)).collect())
    };
    Ok(LightFile::Environment {
        center,
        up,
        front,
        scale: 1.0,
        map,
    })
}

fn lobe(draw: &mut SceneDraw, plain: bool) -> SphericalGaussianFile {
    let width = draw.value([0.05, 0.6], [1e-3, 100.0]);
    // If the direction of a lobe is random, the lobe must be wide, because a narrow lobe may send
    // no light forward.
    let (from, width) = if plain {
        let [x, y] = [(); 2].map(|()| draw.between(-0.7, 0.7));
        (draw.along(DVec3::new(x, y, -1.0)), width)
    } else {
        (draw.direction().to_array(), width.max(0.3))
    };
    SphericalGaussianFile {
        from,
        width,
        radiance: draw.value([0.3, 3.0], [1e-6, 1e6]).into(),
    }
}
