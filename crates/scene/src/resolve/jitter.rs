//! Generates jittered squares.

use etendue_field::Rectangle;
use etendue_transform::random::{self, Stream};

/// Returns squares of side fill · pitch at (i − (n−1)/2) · pitch + U(−jitter/2, jitter/2) · pitch.
pub(super) fn jittered_squares(
    center: [f64; 2],
    count: [u32; 2],
    pitch: f64,
    fill: f64,
    jitter: f64,
    seed: u64,
) -> Vec<Rectangle> {
    let side = fill * pitch;
    let position = |i: u32, n: u32, word: u32| -> f64 {
        let grid = f64::from(i) - 0.5 * (f64::from(n) - 1.0);
        pitch * (grid + jitter * (random::unit(word) - 0.5))
    };
    let mut squares = Vec::with_capacity(count[0] as usize * count[1] as usize);
    for i in 0..count[0] {
        for j in 0..count[1] {
            let index = u64::from(i) * u64::from(count[1]) + u64::from(j);
            let words = random::words(seed, Stream::Jitter, index, 0);
            squares.push(Rectangle {
                center: [
                    center[0] + position(i, count[0], words[0]),
                    center[1] + position(j, count[1], words[1]),
                ],
                size: [side, side],
            });
        }
    }
    squares
}
