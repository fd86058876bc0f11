//! Mutations of bytes that ignore the format: flips, cuts, copies and extreme numbers.

use super::dice::Dice;
use std::ops::Range;

/// Integers that are critical as lengths, counts and offsets.
const NUMBERS: [u64; 12] = [
    0,
    1,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x7fff_ffff_ffff_ffff,
    0xffff_ffff_ffff_ffff,
];

/// Numbers that are critical in arithmetic.
const FLOATS: [f64; 8] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -0.0,
    1e308,
    -1e308,
    5e-324,
    -1.0,
];

/// Maximum number of bytes added by one mutation.
const LONGEST: usize = 1 << 16;

/// Applies one to three mutations anywhere in the bytes.
pub(crate) fn mutate(bytes: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..*dice.pick(&[1, 1, 2, 3]) {
        let all = 0..bytes.len();
        once(bytes, all, dice);
    }
}

/// Applies one to three mutations, each of which begins at a byte within `range`.
pub(crate) fn mutate_within(bytes: &mut Vec<u8>, range: &Range<usize>, dice: &mut Dice) {
    for _ in 0..*dice.pick(&[1, 1, 2, 3]) {
        let range = range.start.min(bytes.len())..range.end.min(bytes.len());
        once(bytes, range, dice);
    }
}

fn once(bytes: &mut Vec<u8>, range: Range<usize>, dice: &mut Dice) {
    let at = range.start + dice.below(range.len());
    let left = bytes.len() - at;
    match dice.below(14) {
        0 => bytes.truncate(at),
        1 => {
            let end = at + dice.length(left.max(1)).min(left);
            bytes.drain(at..end);
        }
        2 => {
            let end = at + dice.length(left.max(1)).min(left).min(LONGEST);
            let copy = bytes[at..end].to_vec();
            bytes.splice(at..at, copy);
        }
        3 => {
            let length = dice.length(LONGEST);
            let filler = dice.byte();
            bytes.splice(at..at, std::iter::repeat_n(filler, length));
        }
        4 => {
            let width = *dice.pick(&[1, 2, 4, 8]);
            let mut number = dice.pick(&NUMBERS).to_le_bytes()[..width].to_vec();
            if dice.one_in(3) {
                number.reverse();
            }
            overwrite(bytes, at, &number);
        }
        5 => overwrite(bytes, at, &dice.pick(&FLOATS).to_le_bytes()),
        6 => {
            let byte = dice.byte();
            overwrite(bytes, at, &[byte]);
        }
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << dice.below(8);
            }
        }
    }
}

fn overwrite(bytes: &mut [u8], at: usize, new: &[u8]) {
    for (byte, new) in bytes[at..].iter_mut().zip(new) {
        *byte = *new;
    }
}
