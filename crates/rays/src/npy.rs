//! Rays as an array of NumPy: f64 [rays, 8] in C order, the columns x, y, z (m), kx, ky, kz, power and wavelength (m, NaN where it is not known).
//! Read are such files, and those of 7 columns without wavelength; the unit of power is not stated in them.

use crate::cursor::ByteCursor;
use crate::set::{length, unit};
use crate::{Fault, PowerUnit, RaySet, Wavelengths};

/// By how much the length of a direction may differ from 1: f32 that became f64, with room.
const LENGTH_SLACK: f64 = 1e-5;

/// Header of an NPY file, version 1.0, of f64 [rows, columns] in C order; padded to a multiple of 64 bytes.
#[must_use]
pub fn npy_header(rows: u64, columns: usize) -> Vec<u8> {
    let fields =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    let preamble = 10;
    let length = (preamble + fields.len() + 1).next_multiple_of(64) - preamble;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    // The fields are about 80 bytes: the length fits 16 bits.
    header.extend(u16::try_from(length).unwrap_or(u16::MAX).to_le_bytes());
    header.extend(format!("{fields:<width$}\n", width = length - 1).bytes());
    header
}

/// # Errors
/// A ray that [`read`] refuses.
pub(crate) fn write(set: &RaySet) -> Result<Vec<u8>, Fault> {
    let mut bytes = npy_header(set.len() as u64, 8);
    for (ray, ([x, y, z], [kx, ky, kz])) in set.positions.iter().zip(&set.directions).enumerate() {
        let wavelength = set.wavelength(ray).unwrap_or(f64::NAN);
        let row = [*x, *y, *z, *kx, *ky, *kz, set.powers[ray], wavelength];
        check(&row).map_err(|what| Fault::ray(ray, what))?;
        bytes.extend(row.iter().flat_map(|v| v.to_le_bytes()));
    }
    Ok(bytes)
}

/// Why a row is no ray.
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
            "{rays} rays of {} bytes should follow, and {found} bytes do",
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

/// Where numbers begin, and how many rows and columns there are.
fn shape(bytes: &[u8]) -> Result<(usize, usize, usize), Fault> {
    let mut cursor = ByteCursor::new(bytes, 0, true);
    if !cursor
        .take(8, "the signature of NPY")?
        .starts_with(b"\x93NUMPY\x01")
    {
        return Err(Fault::byte(0, "no NPY file of version 1"));
    }
    let length = cursor.take(2, "the length of the header")?;
    let length = usize::from(u16::from_le_bytes([length[0], length[1]]));
    let header = String::from_utf8_lossy(cursor.take(length, "the header")?).replace(' ', "");
    let refused = || {
        let message = "an array of f64 ('<f8') in C order, [rays, 7] or [rays, 8], is expected";
        Fault::byte(10, message)
    };
    let plain = header.contains("'descr':'<f8'") && header.contains("'fortran_order':False");
    let shape = header
        .split_once("'shape':(")
        .and_then(|(_, rest)| rest.split_once(')'))
        .and_then(|(shape, _)| shape.split_once(','))
        .filter(|_| plain)
        .ok_or_else(refused)?;
    match (shape.0.parse(), shape.1.parse()) {
        (Ok(rays), Ok(columns @ (7 | 8))) => Ok((cursor.at(), rays, columns)),
        _ => Err(refused()),
    }
}
