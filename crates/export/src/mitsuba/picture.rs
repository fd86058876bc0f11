//! Writes pictures as PFM files (Debevec 1998), with one 32-bit number per pixel. Mitsuba keeps the
//! same precision.

/// Encodes a picture. `values` begins with the top row, and the file begins with the lowest row.
pub(super) fn pfm(width: usize, values: &[f64]) -> Vec<u8> {
    let rows = values.len() / width;
    let mut bytes = format!("Pf\n{width} {rows}\n-1.0\n").into_bytes();
    for row in values.chunks_exact(width).rev() {
        for value in row {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "the file holds 32-bit numbers"
            )]
            bytes.extend((*value as f32).to_le_bytes());
        }
    }
    bytes
}

/// A picture whose pixels are values of a function at their centres. The arguments of the
/// function are distances from the left and from the top, in pixels.
pub(super) fn sampled(
    [width, height]: [usize; 2],
    value: impl Fn(f64, f64) -> f64,
) -> (usize, Vec<f64>) {
    let pixels = (0..width * height).map(|i| {
        let (column, row) = (i % width, i / width);
        value(column as f64 + 0.5, row as f64 + 0.5)
    });
    (width, pixels.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_row_comes_first() {
        let (width, values) = sampled([2, 3], |column, row| column + 10.0 * row);
        assert_eq!(values, [5.5, 6.5, 15.5, 16.5, 25.5, 26.5]);
        let bytes = pfm(width, &values);
        let numbers = bytes.strip_prefix(b"Pf\n2 3\n-1.0\n").unwrap();
        let first = f32::from_le_bytes(numbers[..4].try_into().unwrap());
        assert!((first - 25.5).abs() < 1e-9 && numbers.len() == 24); // exactly this number
    }
}
