//! Random blockers, perpendicular to the first leg of the path.

use super::draw::SceneDraw;
use super::light::{axis, modulation};
use super::pictures::{mask, sheet};
use etendue_scene::{
    AxisName, BlockersFile, HalfName, HoleFile, LightFile, MeshSource, SceneFile, ShapeFile,
    resolve,
};
use glam::DVec3;
use std::io;
use std::path::Path;

/// The smallest size permitted in a scene file, metres.
const LEAST: f64 = 1e-9;
/// Maximum number of products of shapes. Up to this number, a prediction takes an acceptable time.
const MOST: f64 = 3e4;
/// The prediction for one disc costs as much as the prediction for this number of rectangles.
const STRIPS: f64 = 64.0;
/// The largest number of rectangles in a random picture of 9 × 9 pixels.
const PIXELS: f64 = 41.0;

/// Number of kinds of layers, some of which are the same.
const KINDS: usize = 16;
/// The seed of added layers is the seed of the search with these bits flipped.
const OWN: u64 = 0x6c61_7965_7273;

/// A feature of scenes that a search selects.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub(super) enum SoughtFeature {
    Bars,
    Picture,
    Aperture,
    /// Further lights. They are drawn only if they are selected.
    Lights,
    /// Colours instead of numbers. They are drawn only if they are selected.
    Colors,
}

impl SoughtFeature {
    pub(super) fn is_of(self, blockers: &BlockersFile) -> bool {
        match self {
            Self::Bars => matches!(blockers, BlockersFile::Bars { .. }),
            Self::Picture => matches!(blockers, BlockersFile::Picture { .. }),
            Self::Aperture => matches!(blockers, BlockersFile::Aperture { .. }),
            Self::Lights | Self::Colors => false,
        }
    }
}

/// Draws up to three layers before the first surface. The distance of this surface from the light
/// is given.
pub(super) fn blockers(
    draw: &mut SceneDraw,
    light: &LightFile,
    first: f64,
) -> io::Result<Vec<BlockersFile>> {
    let count = *draw.pick(&[0, 1, 1, 1, 2, 2, 3]);
    let mut layers = Vec::new();
    let mut products = match light {
        LightFile::Disc { .. } => STRIPS,
        _ => 1.0,
    };
    for i in 0..count {
        let share = (0.15 + 0.7 * (i as f64 + draw.between(0.0, 0.9)) / count as f64).min(0.95);
        let share = draw.extreme_or(&[1e-4, 0.9999, share], |_| share);
        // No two layers may lie in the same plane.
        let share = share * (1.0 + 1e-4 * i as f64 - 2e-4);
        let layer = layer(draw, None, format!("mask {i}"), share * first)?;
        products *= terms(&layer);
        if products < MOST {
            layers.push(layer);
        }
    }
    Ok(layers)
}

/// Adds a layer with the selected feature to the scene with this index for this seed, unless there
/// is such a layer.
pub(super) fn add_layer(
    file: &mut SceneFile,
    feature: SoughtFeature,
    of: (u64, u64),
    folder: &Path,
) -> io::Result<()> {
    let kind = match feature {
        SoughtFeature::Bars => 11,
        SoughtFeature::Picture => 12,
        SoughtFeature::Aperture => 13,
        SoughtFeature::Lights | SoughtFeature::Colors => return Ok(()),
    };
    if file.blockers.iter().any(|layer| feature.is_of(layer)) {
        return Ok(());
    }
    let Ok(scene) = resolve("wild", file.clone(), folder, u64::MAX) else {
        return Ok(());
    };
    let mut draw = SceneDraw::apart(OWN, of, folder);
    let distance = scene.path.first_hit() * draw.between(0.1, 0.9);
    let layer = layer(&mut draw, Some(kind), "added".into(), distance)?;
    let products: f64 = file.blockers.iter().chain([&layer]).map(terms).product();
    if products >= MOST {
        file.blockers.clear();
    }
    file.blockers.push(layer);
    if resolve("wild", file.clone(), folder, u64::MAX).is_err() {
        file.blockers.pop();
    }
    Ok(())
}

fn terms(layer: &BlockersFile) -> f64 {
    match layer {
        BlockersFile::JitteredSquares { count, .. } => count.map(f64::from).iter().product(),
        BlockersFile::Bars { count, .. } => f64::from(*count),
        BlockersFile::Picture { .. } => PIXELS,
        BlockersFile::Shapes { shapes, .. } => {
            let strips = |s: &ShapeFile| match s {
                ShapeFile::Disc { .. } => STRIPS,
                _ => 1.0,
            };
            shapes.iter().map(strips).sum()
        }
        BlockersFile::Aperture {
            hole: HoleFile::Disc { .. },
            ..
        } => STRIPS,
        BlockersFile::Aperture { .. } => 1.0,
        BlockersFile::Grating { .. } => 3.0,
        BlockersFile::Mesh { .. } => 1.0,
    }
}

/// Draws a layer. The kind is one of [`KINDS`] numbers; if none is given, it is drawn too.
fn layer(
    draw: &mut SceneDraw,
    kind: Option<usize>,
    name: String,
    distance: f64,
) -> io::Result<BlockersFile> {
    let aside = if draw.one_in(3) {
        [(); 2].map(|()| draw.unit * draw.between(-0.2, 0.2))
    } else {
        [0.0; 2]
    };
    let center = draw.place(DVec3::new(aside[0], aside[1], distance));
    Ok(match kind.unwrap_or_else(|| draw.below(KINDS)) {
        0..=2 => squares(draw, name, center),
        3 | 4 => BlockersFile::Shapes {
            name,
            center,
            shapes: board(draw),
        },
        5..=7 => BlockersFile::Shapes {
            name,
            center,
            shapes: half_planes(draw),
        },
        8..=10 => BlockersFile::Grating {
            name,
            center,
            axis: axis(draw),
            frequency: draw.value([1.0, 8.0], [1e-3, 500.0]) / draw.unit,
            modulation: modulation(draw),
            phase: draw.between(-3.0, 3.0),
        },
        11 => BlockersFile::Bars {
            name,
            center,
            axis: axis(draw),
            count: draw.whole(1, 9),
            pitch: draw.length([0.05, 0.4], [1e-5, 50.0]),
            fill: draw.value([0.2, 0.8], [1e-3, 1.0]),
        },
        12 => BlockersFile::Picture {
            name,
            center,
            file: mask(draw)?,
            size: [(); 2].map(|()| draw.length([0.2, 1.0], [1e-4, 50.0])),
        },
        13 | 14 => BlockersFile::Aperture {
            name,
            center,
            hole: hole(draw),
        },
        _ => mesh(draw, name, center, distance)?,
    })
}

fn squares(draw: &mut SceneDraw, name: String, center: [f64; 3]) -> BlockersFile {
    let extremes = [(1.0, 0.0), (1e-3, 0.999), (0.999, 0.001)];
    let (fill, jitter) = draw.extreme_or(&extremes, |draw| {
        let fill = draw.between(0.2, 0.8);
        (fill, draw.between(0.0, 1.0 - fill))
    });
    BlockersFile::JitteredSquares {
        name,
        center,
        count: [(); 2].map(|()| draw.whole(1, 9)),
        pitch: draw.length([0.05, 0.4], [1e-5, 50.0]),
        fill,
        jitter,
        seed: u64::from(draw.whole(0, 9)),
    }
}

/// Draws shapes, at most one in each cell of a square grid.
fn board(draw: &mut SceneDraw) -> Vec<ShapeFile> {
    let pitch = draw.length([0.1, 0.5], [1e-4, 20.0]);
    let count = 1 + draw.below(5);
    let shape = |draw: &mut SceneDraw, i: usize| {
        let [column, row] = [i % 3, i / 3].map(|k| (k as f64 - 0.5) * pitch);
        let center = [column, row];
        let size = [(); 2].map(|()| (pitch * draw.value([0.2, 0.95], [1e-6, 1.0])).max(LEAST));
        if draw.one_in(3) {
            let radius = 0.5 * size[0];
            ShapeFile::Disc { center, radius }
        } else {
            ShapeFile::Rectangle { center, size }
        }
    };
    (0..count).map(|i| shape(draw, i)).collect()
}

/// Draws the hole of an aperture. A polygon has its corners on an ellipse around the central ray or
/// beside it.
fn hole(draw: &mut SceneDraw) -> HoleFile {
    let center = [(); 2].map(|()| draw.unit * draw.between(-0.1, 0.1));
    let size = [(); 2].map(|()| draw.length([0.1, 0.6], [1e-4, 20.0]));
    match draw.below(4) {
        0 => HoleFile::Disc {
            center,
            radius: 0.5 * size[0],
        },
        1 => HoleFile::Rectangle { center, size },
        _ => {
            let count = draw.whole(3, 12);
            let corner = |i: u32| {
                // Corners keep apart, so no three of them lie on a line up to rounding.
                let part = f64::from(i) + draw.between(0.0, 0.7);
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * part / f64::from(count));
                [
                    center[0] + 0.5 * size[0] * cos,
                    center[1] + 0.5 * size[1] * sin,
                ]
            };
            let corners = (0..count).map(corner).collect();
            HoleFile::Polygon { corners }
        }
    }
}

/// Draws one half-plane, or two half-planes with a slit between them, which is occasionally very
/// narrow or closed.
fn half_planes(draw: &mut SceneDraw) -> Vec<ShapeFile> {
    let axis: AxisName = axis(draw);
    let edge = draw.unit * draw.between(-0.15, 0.15);
    let half = |edge: f64, opaque: HalfName| ShapeFile::HalfPlane { axis, edge, opaque };
    if draw.one_in(2) {
        let opaque = *draw.pick(&[HalfName::Above, HalfName::Below]);
        return vec![half(edge, opaque)];
    }
    let gap = if draw.is_extreme() && draw.one_in(2) {
        0.0
    } else {
        draw.length([0.02, 0.3], [1e-7, 1.0])
    };
    vec![
        half(edge, HalfName::Below),
        half(edge + gap, HalfName::Above),
    ]
}

/// The largest curvature permitted in a scene file, per metre.
const CURVATURE: f64 = 1e6;

/// Draws a mesh that touches neither the light nor the objects behind it.
fn mesh(
    draw: &mut SceneDraw,
    name: String,
    center: [f64; 3],
    distance: f64,
) -> io::Result<BlockersFile> {
    let size = (0.1 * draw.unit).min(0.1 * distance) * draw.between(0.3, 1.0);
    let mesh = match draw.below(3) {
        0 => MeshSource::Star {
            radius: size,
            relief: draw.between(0.0, 0.5),
            lobes: draw.whole(0, 3),
            rings: draw.whole(6, 30),
        },
        1 => MeshSource::Paraboloid {
            curvatures: [(); 2]
                .map(|()| (draw.between(-0.5, 0.5) / size).clamp(-CURVATURE, CURVATURE)),
            half: size,
            cells: draw.whole(1, 20),
        },
        _ => MeshSource::File(sheet(draw, [DVec3::X, DVec3::Y, DVec3::NEG_Z], size)?),
    };
    Ok(BlockersFile::Mesh {
        name,
        center,
        mesh,
        scale: 1.0,
    })
}
