//! Encodes heat maps as embedded PNGs with one pixel per cell.

use crate::color::{Rgb, Shading};
use crate::figure::Error;
use crate::grey::level;
use crate::raster::encoded;
use base64::Engine;
use ndarray::ArrayView2;

/// The data URI of a picture of `values` [x, y], with x to the right and y upwards. Returns
/// `None` if there are no cells.
pub(crate) fn heat_map(
    values: ArrayView2<'_, f64>,
    shading: &Shading,
) -> Result<Option<String>, Error> {
    let (columns, rows) = values.dim();
    picture(columns, rows, |i, j| {
        shading.color(values[[i, rows - 1 - j]])
    })
}

/// The data URI of a vertical strip of all colors, with the lowest values at the bottom.
pub(crate) fn color_strip(shading: &Shading) -> Result<Option<String>, Error> {
    const LEVELS: usize = 256;
    picture(1, LEVELS, |_, j| {
        let t = 1.0 - (j as f64 + 0.5) / LEVELS as f64;
        shading.colors.at(t)
    })
}

/// The data URI of a picture of `columns` × `rows` pixels, whose colors are a function of
/// (column, row). Row 0 is at the top.
fn picture(
    columns: usize,
    rows: usize,
    color: impl Fn(usize, usize) -> Rgb,
) -> Result<Option<String>, Error> {
    let (Ok(width), Ok(height)) = (u32::try_from(columns), u32::try_from(rows)) else {
        return Err(Error::Size(u32::MAX, u32::MAX));
    };
    if width == 0 || height == 0 {
        return Ok(None);
    }
    let mut pixels = Vec::with_capacity(3 * columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            pixels.extend(color(column, row));
        }
    }
    let bytes = encoded([width, height], png::ColorType::Rgb, None, &pixels)?;
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    Ok(Some(format!("data:image/png;base64,{text}")))
}

/// A photograph as a grey PNG. The values of `radiance` are given in rows from the top, and
/// are converted by the transfer curve of sRGB (IEC 61966-2-1). The brightest hundredth of the
/// pixels is drawn white.
///
/// # Errors
/// If there are no pixels, if there are more pixels than a PNG can hold, or if the number of values
/// differs from the number of pixels.
pub fn photograph([width, height]: [usize; 2], radiance: &[f64]) -> Result<Vec<u8>, Error> {
    let (Ok(w), Ok(h)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(Error::Size(u32::MAX, u32::MAX));
    };
    let mut sorted: Vec<f64> = radiance.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let white = sorted
        .get(sorted.len() - sorted.len().div_ceil(100))
        .copied();
    let white = white.filter(|white| *white > 0.0).unwrap_or(1.0);
    let grey: Vec<u8> = radiance.iter().map(|x| level(x / white)).collect();
    Ok(encoded([w, h], png::ColorType::Grayscale, None, &grey)?)
}
