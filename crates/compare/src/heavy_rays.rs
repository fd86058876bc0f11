//! Light that a few heavy rays carry.

use etendue_field::Slices;

/// Rays of equal weight in each of some batches whose light would vary as much as it does, where
/// that is so few that one of the batches would hold none; `None` where they are enough.
///
/// Of n equal rays the relative variance is 1/n, and of R batches R e⁻ⁿ are empty. With fewer than
/// ln R the spread of batches is no error of their mean: what carries most of the light may not
/// have come yet.
pub(crate) fn too_few<'a>(batches: impl Iterator<Item = &'a Slices>) -> Option<f64> {
    let light: Vec<f64> = batches.map(Slices::at_zero).collect();
    let count = light.len() as f64;
    let mean = light.iter().sum::<f64>() / count;
    let apart = light.iter().map(|light| (light - mean).powi(2));
    let variance = apart.sum::<f64>() / (count - 1.0);
    let each = mean * mean / variance;
    (each < libm::log(count)).then_some(each)
}
