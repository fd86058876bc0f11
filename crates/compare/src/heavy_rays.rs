//! Detects whether a few rays of large weight carry most of the light.

use etendue_field::Slices;

/// How many rays of equal weight each batch would need for its light to vary as much as
/// measured. Returns `None` if this number is so large that no batch would be empty.
///
/// With n equal rays, the relative variance is 1/n, and R e⁻ⁿ of R batches are empty. With fewer
/// than ln R rays, the spread of batches does not estimate the error of their mean, because the
/// rays that carry most of the light may still be missing.
pub(crate) fn too_few<'a>(batches: impl Iterator<Item = &'a Slices>) -> Option<f64> {
    let light: Vec<f64> = batches.map(Slices::at_zero).collect();
    let count = light.len() as f64;
    let mean = light.iter().sum::<f64>() / count;
    let apart = light.iter().map(|light| (light - mean).powi(2));
    let variance = apart.sum::<f64>() / (count - 1.0);
    let each = mean * mean / variance;
    (each < libm::log(count)).then_some(each)
}
