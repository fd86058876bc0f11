//! Radiance pictures (Ward, Real pixels, Graphics Gems II, 1991): red, green and blue with a shared
//! exponent.

use super::size::check_size;
use crate::files::Files;
use etendue_scene::{Channels, Samples};

/// Maximum number of header lines.
const MOST_LINES: usize = 1000;

pub(super) fn read(bytes: &[u8], files: &Files) -> Result<Channels, String> {
    let mut rest = bytes;
    if !line(&mut rest).is_some_and(|first| first.starts_with(b"#?")) {
        return Err("does not begin with the characters `#?`".to_owned());
    }
    for _ in 0..MOST_LINES {
        match line(&mut rest) {
            Some(b"") => break,
            Some(text) if text.starts_with(b"FORMAT=") && text != b"FORMAT=32-bit_rle_rgbe" => {
                return Err("is not in format 32-bit_rle_rgbe".to_owned());
            }
            Some(_) => {}
            None => return Err("ends within its header".to_owned()),
        }
    }
    let (width, height) = line(&mut rest)
        .and_then(size)
        .ok_or("has no size in the form -Y height +X width")?;
    check_size((width, height), [3, 4], bytes.len(), files)?;
    let mut numbers = Vec::new();
    for _ in 0..height {
        for [r, g, b, e] in row(&mut rest, width).ok_or("ends before its last pixel")? {
            // These products are exact.
            let unit = libm::ldexpf(1.0, i32::from(e) - 136);
            let scale = if e == 0 { 0.0 } else { unit };
            numbers.extend([r, g, b].map(|v| f32::from(v) * scale));
        }
    }
    Ok(Channels {
        width,
        height,
        samples: Samples::Numbers(numbers),
        count: 3,
    })
}

fn line<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let end = rest.iter().position(|b| *b == b'\n')?;
    let (line, after) = rest.split_at(end);
    *rest = &after[1..];
    Some(line.trim_ascii_end())
}

fn size(line: &[u8]) -> Option<(usize, usize)> {
    let words: Vec<&str> = str::from_utf8(line).ok()?.split_whitespace().collect();
    let ["-Y", height, "+X", width] = words[..] else {
        return None;
    };
    Some((width.parse().ok()?, height.parse().ok()?))
}

/// Reads the pixels of a row, run-length encoded by channel or uncompressed.
fn row(rest: &mut &[u8], width: usize) -> Option<Vec<[u8; 4]>> {
    let in_runs = rest.len() >= 4
        && rest[..2] == [2, 2]
        && (8..0x8000).contains(&width)
        && usize::from(rest[2]) * 256 + usize::from(rest[3]) == width;
    if !in_runs {
        let (row, after) = rest.split_at_checked(width.checked_mul(4)?)?;
        *rest = after;
        return Some(
            row.chunks_exact(4)
                .map(|p| [p[0], p[1], p[2], p[3]])
                .collect(),
        );
    }
    *rest = &rest[4..];
    let mut pixels = vec![[0; 4]; width];
    for channel in 0..4 {
        let mut at = 0;
        while at < width {
            let (count, after) = rest.split_first()?;
            let is_run = *count > 128;
            let length = usize::from(if is_run { *count - 128 } else { *count });
            let (data, after) = after.split_at_checked(if is_run { 1 } else { length })?;
            let target = pixels.get_mut(at..at + length).filter(|t| !t.is_empty())?;
            for (i, pixel) in target.iter_mut().enumerate() {
                pixel[channel] = data[if is_run { 0 } else { i }];
            }
            *rest = after;
            at += length;
        }
    }
    Some(pixels)
}
