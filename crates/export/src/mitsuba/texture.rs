//! Writes parameters that vary over a surface, as pictures over the texture coordinates of the
//! surface. Texture coordinates are (s, t) in metres.

use super::Writer;
use super::picture::{pfm, sampled};
use super::xml::spectrum;
use etendue_field::{Grating, Pattern, Picture};
use std::f64::consts::TAU;

/// Pixels per period of a cosine. The error of linear interpolation is at most (2π/512)²/8 =
/// 2·10⁻⁵ of the cosine's amplitude.
const PERIOD: usize = 512;

/// A number that follows a pattern.
#[derive(Clone, Copy)]
pub(super) struct VariedTexture<'a> {
    /// The pattern, or `None` for a constant, whose value is then the second value of `range`.
    pub(super) pattern: Option<&'a Pattern>,
    /// The values of the number where the pattern is 0 and where it is 1.
    pub(super) range: [f64; 2],
}

impl VariedTexture<'_> {
    fn at(&self, share: f64) -> f64 {
        let [low, high] = self.range;
        low + share * (high - low)
    }

    /// The number multiplied by a factor.
    pub(super) fn times(self, factor: f64) -> Self {
        let range = self.range.map(|value| factor * value);
        Self { range, ..self }
    }
}

impl Writer {
    /// A parameter of a material.
    ///
    /// Checkerboards are also pictures of four pixels, because Mitsuba 3.9.1 swaps the colours of
    /// a checkerboard that is used as a number.
    pub(super) fn varied(&mut self, name: &str, varied: &VariedTexture<'_>) -> String {
        match varied.pattern {
            None => spectrum(name, varied.range[1]),
            Some(Pattern::Checkerboard { period }) => {
                let picture = sampled([2, 2], |column, row| {
                    varied.at(if (column < 1.0) == (row < 1.0) {
                        1.0
                    } else {
                        0.0
                    })
                });
                let to_uv = scaled([1.0 / period; 2], [0.0; 2]);
                self.bitmap(name, picture, "nearest", "repeat", &to_uv)
            }
            Some(Pattern::Cosine(grating)) => self.cosine(name, varied, grating),
            Some(Pattern::Picture(picture)) => {
                let pixels = picture.pixels.values().iter().map(|p| varied.at(*p));
                let pixels = (picture.pixels.width(), pixels.collect());
                let [scale, offset] = placed(picture);
                self.bitmap(name, pixels, "bilinear", "clamp", &scaled(scale, offset))
            }
        }
    }

    fn cosine(&mut self, name: &str, varied: &VariedTexture<'_>, grating: &Grating) -> String {
        let Grating {
            axis,
            frequency,
            modulation,
            phase,
        } = *grating;
        // The picture has two rows, because Mitsuba enlarges pictures of one row.
        let (mut size, mut scale, mut offset) = ([2; 2], [0.0; 2], [0.0; 2]);
        size[axis] = PERIOD;
        scale[axis] = frequency;
        offset[axis] = phase / TAU;
        let picture = sampled(size, |column, row| {
            let turn = [column, row][axis] / PERIOD as f64;
            varied.at(0.5 * (1.0 + modulation * libm::cos(TAU * turn)))
        });
        self.bitmap(name, picture, "bilinear", "repeat", &scaled(scale, offset))
    }

    /// A picture that is 1 in the area of another picture and 0 outside. It has nine
    /// pixels, and only the middle pixel is 1.
    pub(super) fn within(&mut self, name: &str, picture: &Picture) -> String {
        let middle = sampled([3, 3], |column, row| {
            let is_middle = |at: f64| (1.0..2.0).contains(&at);
            if is_middle(column) && is_middle(row) {
                1.0
            } else {
                0.0
            }
        });
        let [scale, offset] = placed(picture);
        let to_uv = scaled(scale.map(|x| x / 3.0), offset.map(|x| (x + 1.0) / 3.0));
        self.bitmap(name, middle, "nearest", "clamp", &to_uv)
    }

    fn bitmap(
        &mut self,
        name: &str,
        (width, values): (usize, Vec<f64>),
        filter: &str,
        wrap: &str,
        to_uv: &str,
    ) -> String {
        let file = self.file(&format!("{name}.pfm"), pfm(width, &values));
        format!(
            "<texture type=\"bitmap\" name=\"{name}\"><string name=\"filename\" value=\"{file}\"/>\
             <boolean name=\"raw\" value=\"true\"/><string name=\"filter_type\" value=\"{filter}\"/>\
             <string name=\"wrap_mode\" value=\"{wrap}\"/>{to_uv}</texture>"
        )
    }
}

/// The map from (s, t) to the coordinates of a picture, as a factor and an offset for each
/// axis. The coordinates of a picture go from (0, 0) at its top left to (1, 1).
fn placed(picture: &Picture) -> [[f64; 2]; 2] {
    let [width, height] = picture.size;
    [[1.0 / width, -1.0 / height], [0.5; 2]]
}

fn scaled([x, y]: [f64; 2], [right, down]: [f64; 2]) -> String {
    format!(
        "<transform name=\"to_uv\"><scale x=\"{x:?}\" y=\"{y:?}\"/><translate x=\"{right:?}\" y=\"{down:?}\"/></transform>"
    )
}
