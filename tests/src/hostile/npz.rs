//! Mutated NPZ files: mutations of arrays, of array headers, and of the archive's structure.

use super::bytes;
use super::dice::Dice;
use super::text;
use std::io::{self, Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// Tokens of array headers.
const WORDS: &str = "'>f8' | '<f4' | '<c16' | '<u4' | '|O' | '<U8' | True | False | None | () | \
    (1,) | (18446744073709551615, 2) | (1099511627776,) | 'shape'";

/// The NPZ file after a mutation of one of its arrays or of the archive.
pub(crate) fn mutated(npz: &[u8], dice: &mut Dice) -> io::Result<Vec<u8>> {
    if dice.one_in(4) {
        let mut new = npz.to_vec();
        // The end of a ZIP file holds its directory.
        let directory = npz.len().saturating_sub(1000)..npz.len();
        bytes::mutate_within(&mut new, &directory, dice);
        return Ok(new);
    }
    let mut entries = entries(npz)?;
    let at = dice.below(entries.len());
    match dice.below(10) {
        0 => drop(entries.remove(at)),
        1 => {
            let other = dice.below(entries.len());
            entries[at].1 = entries[other].1.clone();
        }
        2 => entries[at].0 = format!("{}{}", dice.pick(&["", "../", "x"]), entries[at].0),
        3..6 => change_header(&mut entries[at].1, dice),
        6 => bytes::mutate(&mut entries[at].1, dice),
        _ => {
            let data = data(&entries[at].1)..entries[at].1.len();
            bytes::mutate_within(&mut entries[at].1, &data, dice);
        }
    }
    archive(&entries)
}

fn entries(npz: &[u8]) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut archive = ZipArchive::new(Cursor::new(npz))?;
    let count = archive.len();
    let read = |i| -> io::Result<_> {
        let mut entry = archive.by_index(i)?;
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes)?;
        Ok((entry.name().to_owned(), bytes))
    };
    (0..count).map(read).collect()
}

fn archive(entries: &[(String, Vec<u8>)]) -> io::Result<Vec<u8>> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        writer.start_file(name.as_str(), SimpleFileOptions::default())?;
        writer.write_all(bytes)?;
    }
    Ok(writer.finish()?.into_inner())
}

/// The byte offset at which the numbers of an array begin.
fn data(npy: &[u8]) -> usize {
    let length = npy
        .get(8..10)
        .map_or(0, |b| u16::from_le_bytes([b[0], b[1]]));
    (10 + usize::from(length)).min(npy.len())
}

/// Replaces the header of an array; the stated length of the new header may be right or wrong.
fn change_header(npy: &mut Vec<u8>, dice: &mut Dice) {
    let end = data(npy);
    let old = String::from_utf8_lossy(npy.get(10..end).unwrap_or_default()).into_owned();
    let mut new = text::mutated(&old, WORDS, dice);
    if dice.one_in(2) {
        new.resize(old.len(), b' ');
    }
    if let (Ok(length), true) = (u16::try_from(new.len()), npy.len() >= 10) {
        npy[8..10].copy_from_slice(&length.to_le_bytes());
    }
    npy.splice(10.min(end)..end, new);
}
