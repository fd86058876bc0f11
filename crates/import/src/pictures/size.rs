//! The size that a picture states.

use etendue_scene::{Fault, PictureSize};

/// Refuses a picture whose stated size is not allowed.
pub(super) fn check_size(
    (width, height): (usize, usize),
    [channels, bytes]: [usize; 2],
    length: usize,
    memory: u64,
) -> Result<(), String> {
    let size = PictureSize {
        pixels: width.checked_mul(height),
        channels,
        bytes,
        packed: None,
    };
    size.check(length, memory).map_err(invalid)
}

/// Describes a fault of a picture.
pub(super) fn invalid(fault: Fault) -> String {
    format!("is not a valid picture: {fault}")
}
