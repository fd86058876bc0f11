//! Divides the dark pixels of a picture into rectangles.

use etendue_field::{Raster, Rectangle};
use std::collections::BTreeMap;
use std::ops::Range;

/// Pixels with a value below this limit are opaque.
const DARK: f64 = 0.5;

/// Returns rectangles that together cover exactly the dark pixels. They do not overlap. The picture
/// has this centre and this size along X and Y; its first row is at the top.
///
/// Each run of dark pixels in a row is joined with the runs above and below it that have the same
/// ends. This does not find the smallest number of rectangles, but it needs few steps, and shapes
/// with edges along X and Y become few rectangles.
pub(super) fn dark_rectangles(raster: &Raster, center: [f64; 2], size: [f64; 2]) -> Vec<Rectangle> {
    let (width, height) = (raster.width(), raster.height());
    let place = |columns: Range<usize>, rows: Range<usize>| {
        let x = |column: usize| center[0] + size[0] * (column as f64 / width as f64 - 0.5);
        let y = |row: usize| center[1] + size[1] * (0.5 - row as f64 / height as f64);
        let [left, right] = [columns.start, columns.end].map(x);
        let [top, bottom] = [rows.start, rows.end].map(y);
        Rectangle {
            center: [0.5 * (left + right), 0.5 * (bottom + top)],
            size: [right - left, top - bottom],
        }
    };
    let mut rectangles = Vec::new();
    // The runs that reach the current row: their columns, and the row in which they began.
    let mut open: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for (row, values) in raster.values().chunks(width).enumerate() {
        let mut next = BTreeMap::new();
        for run in runs(values) {
            let ends = (run.start, run.end);
            next.insert(ends, open.remove(&ends).unwrap_or(row));
        }
        for ((start, end), first) in std::mem::replace(&mut open, next) {
            rectangles.push(place(start..end, first..row));
        }
    }
    for ((start, end), first) in open {
        rectangles.push(place(start..end, first..height));
    }
    rectangles
}

/// The runs of dark pixels of a row.
fn runs(values: &[f64]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (column, _) in values.iter().enumerate().filter(|(_, v)| **v < DARK) {
        match runs.last_mut() {
            Some(run) if run.end == column => run.end = column + 1,
            _ => runs.push(column..column + 1),
        }
    }
    runs
}
