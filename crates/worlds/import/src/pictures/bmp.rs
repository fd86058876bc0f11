//! BMP pictures.

use super::size::check_size;
use crate::files::Files;
use etendue_scene::{Channels, Samples};
use zune_bmp::BmpDecoder;
use zune_core::bytestream::ZCursor;
use zune_core::options::DecoderOptions;

/// Reads a picture. Transparency is ignored, because programs that write BMP files rarely set the
/// transparency of pixels.
pub(super) fn read(bytes: &[u8], files: &Files) -> Result<Channels, String> {
    let damaged = |error: zune_bmp::BmpDecoderErrors| format!("is damaged ({error:?})");
    let mut decoder = BmpDecoder::new_with_options(ZCursor::new(bytes), DecoderOptions::default());
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().ok_or("has no size")?;
    let space = decoder.colorspace().ok_or("has no colours")?;
    let each = space.num_components();
    // The colours are copied without their transparency.
    check_size((width, height), [each, 2], bytes.len(), files)?;
    let levels = decoder.decode().map_err(damaged)?;
    if levels.len() != each * width * height || !matches!(each, 1 | 3 | 4) {
        return Err("does not have the number of pixels that its header states".to_owned());
    }
    let count = if each == 1 { 1 } else { 3 };
    let colors = levels.chunks_exact(each).flat_map(|pixel| &pixel[..count]);
    Ok(Channels {
        width,
        height,
        samples: Samples::Bytes(colors.copied().collect()),
        count,
    })
}
