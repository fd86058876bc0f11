//! Transforms in pbrt's notation. The transforms of a file are applied to coordinates in reverse
//! order, beginning with the last transform.

use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

/// Maximum relative deviation of axes from orthogonal axes of equal length. Transforms are products
/// of rounded numbers, so they deviate slightly.
const ALIKE: f64 = 1e-3;

/// A rotation by degrees about an axis of any length.
pub(super) fn rotation([angle, x, y, z]: [f64; 4]) -> Result<DAffine3, String> {
    let axis = DVec3::new(x, y, z).try_normalize();
    let axis = axis.ok_or("the axis has length 0")?;
    Ok(crate::range::rotation(axis, angle.to_radians()))
}

/// The map to camera coordinates with Z forward, Y up and X to the right, which are
/// left-handed like all coordinates of pbrt.
pub(super) fn look_at(numbers: [f64; 9]) -> Result<DAffine3, String> {
    let [eye, at, up] = [0, 3, 6].map(|i| DVec3::from_slice(&numbers[i..]));
    let along = (at - eye).try_normalize().ok_or("no viewing direction")?;
    let right = up.normalize_or_zero().cross(along).try_normalize();
    let right = right.ok_or("up is parallel to the viewing direction")?;
    let linear = DMat3::from_cols(right, along.cross(right), along);
    Ok(DAffine3::from_mat3_translation(linear, eye).inverse())
}

/// The map of a matrix that is given by 16 numbers, column by column.
pub(super) fn matrix(numbers: &[f64; 16]) -> Result<DAffine3, String> {
    let matrix = DMat4::from_cols_array(numbers);
    if matrix.row(3) != DVec4::W {
        return Err("the numbers 4, 8, 12 and 16 of the matrix are not 0 0 0 1".to_owned());
    }
    Ok(DAffine3::from_mat4(matrix))
}

/// A map without its scale, and the scale, or `None` if the map shears or scales axes
/// unequally.
pub(super) fn without_scale(map: DAffine3) -> Option<(DAffine3, f64)> {
    let scale = libm::cbrt(map.matrix3.determinant().abs());
    let linear = map.matrix3 * (1.0 / scale);
    let gram = linear.transpose() * linear;
    let is_rigid = scale.is_finite() && gram.abs_diff_eq(DMat3::IDENTITY, ALIKE);
    let rigid = DAffine3::from_mat3_translation(linear, map.translation);
    (is_rigid && rigid.is_finite()).then_some((rigid, scale))
}
