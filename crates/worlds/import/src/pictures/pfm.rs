//! Portable float maps (Debevec 1998): 32-bit numbers, beginning with the lowest row.

use super::size::check_size;
use crate::files::Files;
use etendue_scene::{Channels, Samples};

pub(super) fn read(bytes: &[u8], files: &Files) -> Result<Channels, String> {
    let mut rest = bytes;
    let mut next = || word(&mut rest).ok_or("ends within its header");
    let count = match next()? {
        "PF" => 3,
        "Pf" => 1,
        _ => return Err("does not begin with PF or Pf".to_owned()),
    };
    let mut size = || next()?.parse().map_err(|_| "has no size");
    let (width, height): (usize, usize) = (size()?, size()?);
    let scale: f32 = next()?.parse().map_err(|_| "has no scale")?;
    check_size((width, height), [count, 4], bytes.len(), files)?;
    // A negative scale means that the lowest byte comes first.
    let number = |bytes: &[u8; 4]| {
        let number = match scale < 0.0 {
            true => f32::from_le_bytes(*bytes),
            false => f32::from_be_bytes(*bytes),
        };
        number * scale.abs()
    };
    let row = width * count;
    let numbers = rest.as_chunks().0.get(..row * height);
    let rows = numbers.ok_or("ends before its last pixel")?.chunks(row);
    Ok(Channels {
        width,
        height,
        samples: Samples::Numbers(rows.rev().flatten().map(number).collect()),
        count,
    })
}

/// Takes a word and the character that ends it.
fn word<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let end = rest.iter().position(u8::is_ascii_whitespace)?;
    let (word, after) = rest.split_at(end);
    *rest = &after[1..];
    str::from_utf8(word).ok()
}
