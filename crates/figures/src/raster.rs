//! The raster of a whole figure as a PNG file.

use etendue_field::whole;

/// An opaque or transparent raster, rows of red, green, blue and opacity from the top, as a PNG that
/// states its resolution in pixels per inch.
pub(crate) fn raster(
    [width, height]: [u32; 2],
    per_inch: f64,
    pixels: &[u8],
) -> Result<Vec<u8>, png::EncodingError> {
    const METRES: f64 = 0.0254;
    let per_metre = u32::try_from(whole(per_inch / METRES)).unwrap_or(u32::MAX);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
