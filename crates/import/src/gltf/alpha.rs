//! Reads the alpha channel of pictures.

use crate::pictures;
use etendue_field::Raster;
use png::{BitDepth, ColorType, Decoder, Transformations};
use std::io::Cursor;
use std::path::Path;

/// Reads the alpha of each pixel as a number; in pictures without an alpha channel, alpha is 1.
pub(super) fn read(
    extension: &str,
    bytes: &[u8],
    number: impl Fn(f64) -> f64,
) -> Result<Raster, String> {
    let file = Path::new("image").with_extension(extension);
    // The decoder checks the size of the picture before it allocates memory.
    let colours = pictures::decode(&file, bytes)?;
    let (width, height) = (colours.width, colours.height);
    drop(colours);
    let alphas = match extension {
        "png" => alphas(bytes)?,
        _ => None,
    };
    let values = match alphas {
        Some(alphas) => alphas.into_iter().map(number).collect(),
        None => vec![number(1.0); width * height],
    };
    Raster::new(width, height, values).ok_or_else(|| "has no pixels".to_owned())
}

/// Returns the alpha values of a PNG picture whose size was checked, or `None` if the picture has
/// no alpha.
fn alphas(bytes: &[u8]) -> Result<Option<Vec<f64>>, String> {
    let damaged = |error: png::DecodingError| format!("is damaged ({error})");
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let size = reader.output_buffer_size().ok_or("is too large")?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(damaged)?;
    let channels = match frame.color_type {
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgba => 4,
        _ => return Ok(None),
    };
    let alphas = match frame.bit_depth {
        BitDepth::Sixteen => {
            let pixels = buffer.chunks_exact(2 * channels);
            let word = |p: &[u8]| u16::from_be_bytes([p[p.len() - 2], p[p.len() - 1]]);
            pixels.map(|p| f64::from(word(p)) / 65_535.0).collect()
        }
        _ => {
            let pixels = buffer.chunks_exact(channels);
            pixels.map(|p| f64::from(p[channels - 1]) / 255.0).collect()
        }
    };
    Ok(Some(alphas))
}
