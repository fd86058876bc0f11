//! The size that a picture states.

use crate::files::Files;
use etendue_scene::{Fault, PictureSize};

/// Refuses a picture whose stated size is not allowed.
pub(super) fn check_size(
    (width, height): (usize, usize),
    [channels, bytes]: [usize; 2],
    length: usize,
    files: &Files,
) -> Result<(), String> {
    let size = PictureSize {
        pixels: width.checked_mul(height),
        channels,
        bytes,
        packed: None,
    };
    let checked = size.check(length, files.left());
    checked.map_err(|fault| invalid(fault, files))
}

/// Describes a fault of a picture.
pub(super) fn invalid(fault: Fault, files: &Files) -> String {
    if fault.memory {
        files.fall_short();
    }
    format!("is not a valid picture: {fault}")
}
