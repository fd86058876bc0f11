//! The style of figures, read from a file.

use etendue_figures::Style;
use etendue_scene::{limits, read_file};
use etendue_store::Failure;
use std::path::Path;

/// Reads a style.
pub(crate) fn read(path: &Path) -> Result<Style, Failure> {
    let fault =
        |why: &dyn std::fmt::Display| Failure::bad_input(format!("{}: {why}", path.display()));
    let bytes =
        read_file(path, limits::FILE_BYTES).map_err(|e| fault(&format!("cannot be read: {e}")))?;
    let style: Style = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_bytes(&bytes)
        .map_err(|e| fault(&format!("{e}; an example of a style is {EXAMPLE}")))?;
    for (name, value, [least, most]) in [
        ("width", style.width, Style::WIDTHS),
        ("height", style.height, Style::HEIGHTS),
    ] {
        if !(least..=most).contains(&value) {
            return Err(fault(&format!(
                "{name}: {value} is not allowed; allowed: {least} to {most} inches"
            )));
        }
    }
    if let Some(floor) = style
        .floor
        .filter(|floor| !(LOWEST..=HIGHEST).contains(floor))
    {
        return Err(fault(&format!(
            "floor: {floor} is not allowed; allowed: {LOWEST} to {HIGHEST} dB"
        )));
    }
    Ok(style)
}

/// A style with every field.
const EXAMPLE: &str = "(titles: false, scene: false, verdicts: false, width: 3.33, height: 4.5, floor: -40, palette: Viridis)";

/// Bounds, in dB, of the lowest level in the colors of spectra. For any number of photons, noise is
/// above the lower bound. At the upper bound, the peak of a spectrum is still visible.
const LOWEST: f64 = -200.0;
const HIGHEST: f64 = -1.0;
