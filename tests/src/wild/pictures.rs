//! Random pictures and meshes, written into the folder of the scene.

use super::draw::SceneDraw;
use exr::prelude::write_rgb_file;
use glam::DVec3;
use std::fmt::Write as _;
use std::fs;
use std::io;

/// Writes a random environment map, and returns the name of its file.
pub(super) fn sky(draw: &mut SceneDraw) -> io::Result<String> {
    let width = 1 << draw.whole(1, 6);
    let peak = if draw.one_in(2) { 1e3 } else { 1.0 };
    picture(draw, [width, (width / 2).max(1)], peak)
}

/// Writes a random picture for a surface, with values from 0 to 1, and returns the name of its
/// file.
pub(super) fn texture(draw: &mut SceneDraw) -> io::Result<String> {
    let size = [(); 2].map(|()| draw.whole(1, 9) as usize);
    picture(draw, size, 1.0)
}

/// Writes a random picture with a dark pixel, and returns the name of its file.
pub(super) fn mask(draw: &mut SceneDraw) -> io::Result<String> {
    let size = [(); 2].map(|()| draw.whole(1, 9) as usize);
    picture(draw, size, 0.0)
}

/// Writes a picture with pixels from 0 to 1, of which one has the given value.
fn picture(draw: &mut SceneDraw, [width, height]: [usize; 2], one: f32) -> io::Result<String> {
    let mut pixels: Vec<f32> = Vec::new();
    for _ in 0..width * height {
        pixels.push(f32::from(u8::try_from(draw.below(256)).unwrap_or(0)) / 255.0);
    }
    let at = draw.below(pixels.len());
    pixels[at] = one;
    let name = next(draw, "exr");
    let path = draw.folder.join(&name);
    write_rgb_file(path, width, height, |x, y| {
        let value = pixels[y * width + x];
        (value, value, value)
    })
    .map_err(io::Error::other)?;
    Ok(name)
}

/// Writes a mesh of a wavy sheet around the origin, perpendicular to `d`, with half-width `half`,
/// and returns the name of its file.
pub(super) fn sheet(draw: &mut SceneDraw, [x, y, n]: [DVec3; 3], half: f64) -> io::Result<String> {
    let cells = draw.whole(1, 8);
    let relief = half * draw.between(0.0, 0.15);
    let (mut text, side) = (String::new(), cells + 1);
    for i in 0..side * side {
        let [s, t] = [i % side, i / side].map(|k| 2.0 * f64::from(k) / f64::from(cells) - 1.0);
        let up = relief * ((2.0 * s).cos() * (1.5 * t).cos() - 1.0);
        let [px, py, pz] = draw.along(half * (s * x + t * y) + up * n);
        let _ = writeln!(text, "v {px:?} {py:?} {pz:?}");
    }
    for i in 0..cells * cells {
        let corner = 1 + i % cells + side * (i / cells);
        let [a, b, c, d] = [corner, corner + 1, corner + side, corner + side + 1];
        let _ = writeln!(text, "f {a} {b} {d}\nf {a} {d} {c}");
    }
    let name = next(draw, "obj");
    fs::write(draw.folder.join(&name), text)?;
    Ok(name)
}

fn next(draw: &mut SceneDraw, extension: &str) -> String {
    draw.inputs += 1;
    format!("input{}.{extension}", draw.inputs)
}
