//! Computations for several photons at once, in loops that the compiler can vectorise.

use etendue_field::{ConvexPolygon, Shape};

/// An array whose element at each index is the value that `f` returns for the index.
/// `std::array::from_fn` would call its function separately for each index.
#[inline(always)]
pub(crate) fn lanes<T: Copy + Default, const N: usize>(f: impl Fn(usize) -> T) -> [T; N] {
    let mut all = [T::default(); N];
    for (i, value) in all.iter_mut().enumerate() {
        *value = f(i);
    }
    all
}

/// Checks which points lie in a shape. The kind of shape is fixed inside each loop.
#[inline(always)]
pub(crate) fn inside<const N: usize>(shape: &Shape, [x, y]: [&[f64; N]; 2]) -> [bool; N] {
    match shape {
        Shape::Rectangle(rectangle) => lanes(|i| rectangle.contains(x[i], y[i])),
        Shape::Disc(disc) => lanes(|i| disc.contains(x[i], y[i])),
    }
}

/// Checks which points lie in a polygon.
#[inline(always)]
pub(crate) fn inside_polygon<const N: usize>(
    polygon: &ConvexPolygon,
    [x, y]: [&[f64; N]; 2],
) -> [bool; N] {
    lanes(|i| polygon.contains(x[i], y[i]))
}
