//! Reads and writes rays as a NumPy array, f64 [rays, 8] in C order. The columns are x, y and z in
//! m, kx, ky, kz, power, and wavelength in m. An unknown wavelength is NaN. The reader also accepts
//! files of 7 columns, without wavelength. The files do not state the unit of power.

use crate::cursor::ByteCursor;
use crate::set::{length, unit};
use crate::{Fault, NpyHeader, PowerUnit, RaySet, Wavelengths};

/// The tolerance for the length of a direction, which should be 1. It covers the rounding errors of
/// f32 numbers that were converted to f64, with a margin.
const LENGTH_SLACK: f64 = 1e-5;

/// # Errors
/// When [`read`] would refuse a ray.
pub(crate) fn write(set: &RaySet) -> Result<Vec<u8>, Fault> {
    let mut bytes = NpyHeader::new("<f8", &[set.len() as u64, 8]).bytes();
    for (ray, ([x, y, z], [kx, ky, kz])) in set.positions.iter().zip(&set.directions).enumerate() {
        let wavelength = set.wavelength(ray).unwrap_or(f64::NAN);
        let row = [*x, *y, *z, *kx, *ky, *kz, set.powers[ray], wavelength];
        check(&row).map_err(|what| Fault::ray(ray, what))?;
        bytes.extend(row.iter().flat_map(|v| v.to_le_bytes()));
    }
    Ok(bytes)
}

/// Checks a row; the error states why the row is not a valid ray.
fn check(row: &[f64; 8]) -> Result<(), String> {
    let [.., kx, ky, kz, power, wavelength] = *row;
    if let Some(value) = row[..7].iter().find(|v| !v.is_finite()) {
        return Err(format!(
            "it has the number {value}; allowed: finite numbers"
        ));
    }
    let size = length([kx, ky, kz]);
    if (size - 1.0).abs() > LENGTH_SLACK {
        return Err(format!(
            "its direction has the length {size}; allowed: unit vectors"
        ));
    }
    if power < 0.0 || wavelength <= 0.0 || wavelength.is_infinite() {
        return Err(format!(
            "power {power}, wavelength {wavelength} m; allowed: power of 0 or more, positive wavelengths or NaN"
        ));
    }
    Ok(())
}

pub(crate) fn read(bytes: &[u8]) -> Result<RaySet, Fault> {
    let (start, rays, columns) = shape(bytes)?;
    let found = bytes.len() - start;
    if rays.checked_mul(8 * columns) != Some(found) {
        let message = format!(
            "{rays} rays of {} bytes should follow, but {found} bytes do",
            8 * columns
        );
        return Err(Fault::byte(start, message));
    }
    let mut cursor = ByteCursor::new(bytes, start, true);
    let mut set = RaySet {
        positions: Vec::with_capacity(rays),
        directions: Vec::with_capacity(rays),
        powers: Vec::with_capacity(rays),
        unit: PowerUnit::Weight,
        wavelengths: Wavelengths::Unknown,
    };
    let mut wavelengths = Vec::with_capacity(rays);
    for ray in 0..rays {
        let mut row = [f64::NAN; 8];
        for value in row.iter_mut().take(columns) {
            *value = cursor.f64("a ray")?;
        }
        let [x, y, z, kx, ky, kz, power, wavelength] = row;
        check(&row).map_err(|what| Fault::ray(ray, what))?;
        set.positions.push([x, y, z]);
        set.directions.push(unit([kx, ky, kz]));
        set.powers.push(power);
        wavelengths.push(wavelength);
    }
    if wavelengths.iter().any(|w| !w.is_nan()) {
        set.wavelengths = Wavelengths::Each(wavelengths);
    }
    Ok(set)
}

/// The offset of the data, and the numbers of rows and columns.
fn shape(bytes: &[u8]) -> Result<(usize, usize, usize), Fault> {
    let refused = || {
        let message = "an NPY file of an array of f64 ('<f8') in C order, [rays, 7] or [rays, 8], is expected";
        Fault::byte(0, message)
    };
    let (header, start) = NpyHeader::read(bytes).ok_or_else(refused)?;
    let is_plain = header.descr == "<f8" && !header.fortran_order;
    let [rays, columns] = header.shape[..] else {
        return Err(refused());
    };
    match (usize::try_from(rays), usize::try_from(columns)) {
        (Ok(rays), Ok(columns @ (7 | 8))) if is_plain => Ok((start, rays, columns)),
        _ => Err(refused()),
    }
}
