//! Random BRDFs, and random variation of BRDFs over a surface.

use super::draw::SceneDraw;
use super::light::{axis, modulation};
use super::pictures::texture;
use etendue_scene::{BrdfFile, EventFile, FresnelFile, LobeFile, PatternFile};
use std::io;

/// A random event of the central ray: reflection by a BRDF.
pub(super) fn reflects(draw: &mut SceneDraw) -> io::Result<EventFile> {
    let (mut other, mut blend, mut varied) = (None, None, None);
    if draw.one_in(4) {
        other = Some(Box::new(brdf(draw)));
        blend = Some(pattern(draw)?);
    }
    if draw.one_in(3) {
        varied = Some(pattern(draw)?);
    }
    Ok(EventFile::Reflects {
        brdf: brdf(draw),
        other,
        blend,
        texture: varied,
    })
}

fn brdf(draw: &mut SceneDraw) -> BrdfFile {
    let lobe = match draw.below(4) {
        0 => LobeFile::Lambertian,
        1 => LobeFile::Phong(draw.value([3.0, 500.0], [0.01, 1e4])),
        2 => LobeFile::Beckmann(draw.value([0.05, 0.5], [1e-3, 1.0])),
        _ => LobeFile::Ggx(draw.value([0.05, 0.5], [1e-3, 1.0])),
    };
    let fresnel = match draw.below(6) {
        0 => FresnelFile::Dielectric(draw.value([1.2, 2.0], [0.06, 20.0])),
        1 => FresnelFile::Conductor {
            n: draw.value([0.2, 3.0], [0.06, 20.0]).into(),
            k: draw.value([1.0, 7.0], [1e-3, 20.0]).into(),
        },
        _ => FresnelFile::White,
    };
    let albedo = draw.extreme_or(&[0.0, 1e-6, 0.5], |_| 1.0);
    BrdfFile {
        lobe,
        albedo: albedo.into(),
        fresnel,
        incoming: None,
        outgoing: None,
    }
}

fn pattern(draw: &mut SceneDraw) -> io::Result<PatternFile> {
    Ok(match draw.below(3) {
        0 => PatternFile::Cosine {
            axis: axis(draw),
            frequency: draw.value([0.5, 8.0], [1e-3, 200.0]) / draw.unit,
            modulation: modulation(draw),
            phase: draw.between(-3.0, 3.0),
        },
        1 => PatternFile::Checkerboard(draw.length([0.1, 0.6], [1e-3, 50.0])),
        _ => PatternFile::Picture {
            file: texture(draw)?,
            size: [(); 2].map(|()| draw.length([0.2, 1.5], [1e-3, 50.0])),
        },
    })
}
