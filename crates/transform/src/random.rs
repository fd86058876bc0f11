//! Counter-based random numbers: a number depends only on its purpose and index, not on the thread
//! or the order of draws.
//!
//! Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, *Parallel random numbers: as easy as 1, 2, 3*, section 4.3).

/// The purpose of a random number, which separates the streams of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// The random numbers of photon `index`, from emission to its end.
    Photon,
    /// Jitter of blocker `index`.
    Jitter,
    /// Sign flips of round `index`.
    Flip,
    /// Backward ray `index`.
    Backward,
    /// The random numbers of photon `index` if emission is not aimed. Photons of this emission are
    /// a reference for aimed emission.
    Even,
    /// The scrambling of net `index` of photons.
    Net,
    /// The scrambling of a net for emission that is not aimed.
    EvenNet,
    /// The points of set `index`, or the scrambling of the net that set `index` is.
    Points,
    /// The shift of set `index` of points.
    Shift,
    /// The shifts of the lattices of batch `index` of photons.
    Lattice,
    /// The shifts of the lattices of a batch of photons whose emission is not aimed.
    EvenLattice,
    /// The seed of the further light `index`.
    Light,
    /// The random numbers of photon `index`, from which the power of a light is estimated.
    Power,
}

/// Four random words for `block` of item `index` in a stream of `seed`.
#[inline]
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "a 64-bit word is split into two of 32"
)]
pub fn words(seed: u64, stream: Stream, index: u64, block: u32) -> [u32; 4] {
    philox(
        [index as u32, (index >> 32) as u32, block, stream as u32],
        [seed as u32, (seed >> 32) as u32],
    )
}

/// Returns [`words`] of `N` items, each with its own seed, index and block, as a column for each
/// word. The compiler can vectorise the function.
#[inline(always)]
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    reason = "a 64-bit word is split into two of 32"
)]
pub fn columns<const N: usize>(
    seeds: &[u64; N],
    stream: Stream,
    indices: &[u64; N],
    blocks: &[u32; N],
) -> [[u32; N]; 4] {
    let mut columns = [[0; N]; 4];
    for k in 0..N {
        let (index, seed) = (indices[k], seeds[k]);
        let counter = [index as u32, (index >> 32) as u32, blocks[k], stream as u32];
        let [x, y, z, w] = philox(counter, [seed as u32, (seed >> 32) as u32]);
        columns[0][k] = x;
        columns[1][k] = y;
        columns[2][k] = z;
        columns[3][k] = w;
    }
    columns
}

/// Converts a random word to a number in (0, 1). The number is the centre of one of 2³² equal
/// cells.
#[inline]
#[must_use]
pub fn unit(word: u32) -> f64 {
    (f64::from(word) + 0.5) * (1.0 / 4_294_967_296.0)
}

/// Converts a random word to a whole number in 0..`count`; `count` must be above 0.
#[inline]
#[must_use]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number in 0..count"
)]
pub fn index(word: u32, count: usize) -> usize {
    ((unit(word) * count as f64) as usize).min(count - 1)
}

#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    reason = "the two halves of a 64-bit product"
)]
fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let a = u64::from(counter[0]) * 0xD251_1F53;
        let b = u64::from(counter[2]) * 0xCD9E_8D57;
        counter = [
            (b >> 32) as u32 ^ counter[1] ^ key[0],
            b as u32,
            (a >> 32) as u32 ^ counter[3] ^ key[1],
            a as u32,
        ];
        key = [
            key[0].wrapping_add(0x9E37_79B9),
            key[1].wrapping_add(0xBB67_AE85),
        ];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::{Stream, columns, philox, words};

    #[test]
    fn columns_are_words() {
        let seeds = [3, 1 << 40, 7, 8];
        let indices = [0, 5, 1 << 35, u64::MAX];
        let blocks = [0, 1, 2, 9];
        let columns = columns(&seeds, Stream::Backward, &indices, &blocks);
        for k in 0..4 {
            let expected = words(seeds[k], Stream::Backward, indices[k], blocks[k]);
            assert_eq!(columns.map(|column| column[k]), expected);
        }
    }

    /// Known answers of the Random123 distribution, file `kat_vectors`, philox4x32 with 10 rounds.
    #[test]
    fn known_answers() {
        assert_eq!(
            philox([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }
}
