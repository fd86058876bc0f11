//! Limits on the size of pictures.

/// Maximum number of values per byte of a file. A JPEG file uses more than half a bit for each
/// block of 64 values, if the picture has visible content.
const MOST_PER_BYTE: usize = 1032;
/// Maximum number of values in a picture, as in the scene crate.
const MAX_NUMBERS: usize = 1 << 27;

/// Refuses a picture that is too large, or larger than a file of `length` bytes can contain.
pub(super) fn check_size(width: usize, height: usize, length: usize) -> Result<(), String> {
    let most = MAX_NUMBERS.min(length.saturating_mul(MOST_PER_BYTE));
    let numbers = width.checked_mul(height).and_then(|n| n.checked_mul(3));
    match numbers {
        Some(1..) if numbers <= Some(most) => Ok(()),
        _ => Err(format!(
            "has {width} × {height} pixels; allowed: as many as {length} bytes can hold, and at most {MAX_NUMBERS} numbers"
        )),
    }
}
