//! Packs unit vectors into two numbers and a sign, as MCPL does.

/// The tolerance for |d|² of a direction, which should be 1. The reference implementation of MCPL
/// uses the same tolerance when it writes files.
const SLACK: f64 = 1e-5;

/// Refuses a vector that is not of unit length.
pub(super) fn check(d: [f64; 3]) -> Result<(), String> {
    let squared: f64 = d.iter().map(|c| c * c).sum();
    if (squared - 1.0).abs() <= SLACK {
        Ok(())
    } else {
        let [x, y, z] = d;
        Err(format!(
            "direction ({x}, {y}, {z}); allowed: unit vectors, |d|² within {SLACK} of 1"
        ))
    }
}

/// Packs a unit vector as in version 3, by adaptive projection (Kittelmann et al. 2017, section
/// 3.2). The component with the largest modulus is omitted, except for its sign. If the omitted
/// component is x or y, 1/z takes its place. The modulus of 1/z is larger than 1, which shows which
/// component was omitted.
pub(super) fn pack(d: [f64; 3]) -> ([f64; 2], bool) {
    let [x, y, z] = d;
    if z.abs() >= x.abs().max(y.abs()) {
        ([x, y], z.is_sign_negative())
    } else if x.abs() >= y.abs() {
        ([inverse(z), y], x.is_sign_negative())
    } else {
        ([x, inverse(z)], y.is_sign_negative())
    }
}

/// Returns 1/z, and +∞ for both 0 and −0.
fn inverse(z: f64) -> f64 {
    if z == 0.0 { f64::INFINITY } else { 1.0 / z }
}

/// The vector that [`pack`] encoded as two numbers and a sign.
pub(super) fn unpack([a, b]: [f64; 2], negative: bool) -> Result<[f64; 3], String> {
    let signed = |v: f64| if negative { -v } else { v };
    // Computes the omitted component, which is the largest component of a valid unit vector.
    let missing = |c: f64, d: f64| {
        let squared = 1.0 - (c * c + d * d);
        if squared >= -SLACK {
            Ok(signed(squared.max(0.0).sqrt()))
        } else {
            Err(format!("packed direction {a}, {b} is not a unit vector"))
        }
    };
    match [a.abs() > 1.0, b.abs() > 1.0] {
        // NaN also leads to this branch, because comparisons with NaN are false; `missing` then
        // refuses NaN.
        [false, false] => Ok([a, b, missing(a, b)?]),
        [true, false] => Ok([missing(b, 1.0 / a)?, b, 1.0 / a]),
        [false, true] => Ok([a, missing(a, 1.0 / b)?, 1.0 / b]),
        [true, true] => missing(a, b).map(|_| [0.0; 3]),
    }
}

/// Unpacks a direction of version 2. The direction is stored as a point of an octahedron,
/// |x| + |y| + |z| = 1. The lower half of the octahedron is folded out, which gives a square.
/// `flat` means that z is 0.
pub(super) fn unpack_octahedral([a, b]: [f64; 2], flat: bool) -> Result<[f64; 3], String> {
    // The numbers are coordinates in a square. Rounding to f32 may move a point outside the
    // square by up to 1e-6.
    if !(a.abs() <= 1.0 + 1e-6 && b.abs() <= 1.0 + 1e-6) {
        return Err(format!(
            "packed direction {a}, {b}; allowed: −1 to 1 for both"
        ));
    }
    let sign = |v: f64| if v >= 0.0 { 1.0 } else { -1.0 };
    let z = 1.0 - a.abs() - b.abs();
    let point = if z < 0.0 {
        [(1.0 - b.abs()) * sign(a), (1.0 - a.abs()) * sign(b), z]
    } else {
        [a, b, z]
    };
    let [x, y, z] = crate::set::unit(point);
    Ok([x, y, if flat { 0.0 } else { z }])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_pack_and_unpack() {
        let steps = -7..=7;
        for x in steps.clone() {
            for y in steps.clone() {
                for z in steps.clone() {
                    if [x, y, z] == [0; 3] {
                        continue;
                    }
                    let d = crate::set::unit([x, y, z].map(f64::from));
                    let (packed, negative) = pack(d);
                    let again = unpack(packed, negative).unwrap();
                    for (a, b) in again.iter().zip(d) {
                        // The limit covers two rounding errors of numbers up to 1. The square root,
                        // whose argument is at least 1/3, multiplies these errors by at most two.
                        assert!((a - b).abs() < 1e-15, "{d:?} {again:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_no_vector_packs_to_is_refused() {
        for packed in [
            [f64::NAN, 0.0],
            [0.0, f64::NAN],
            [f64::INFINITY, 2.0],
            [0.9, 0.9],
            [f64::INFINITY, f64::NAN],
        ] {
            assert!(unpack(packed, false).is_err(), "{packed:?}");
        }
        assert!(unpack_octahedral([f64::NAN, 0.0], false).is_err());
        assert!(unpack_octahedral([1.1, 0.0], false).is_err());
    }
}
