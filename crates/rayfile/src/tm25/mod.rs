//! IES TM-25-13, the ray file format of the Illuminating Engineering Society. TM-25-20 files, which
//! state the version 2020, are read with the same layout.
//!
//! The reader follows IES TM-25-13, "Ray File Format for the Description of the Emission Property of Light
//! Sources", section 4.7, and files of LED makers and of LightTools. All numbers are little-endian; the numbers of
//! rays are f32. Units: mm, nm, W, lm. Text is UTF-32.
//!
//! If a file is read and written again, its bytes do not change, except for bytes after the end of
//! a text and for invalid characters. Each of these changes causes a note.
//!
//! Three deviations are accepted with a note. The total flux in the header may differ from the sum
//! over the rays (LightTools writes 1). Directions may have a length other than 1 (in the
//! [`RaySet`] they have length 1). Fields that affect no ray may have values out of range.

mod header;
mod text;

pub use header::{Flags, SpectrumType, Tm25Header};

use crate::cursor::ByteCursor;
use crate::set::{length, unit};
use crate::{Fault, PowerUnit, RaySet, Wavelengths};

/// A file with its numbers unchanged.
#[derive(Clone, Debug, PartialEq)]
pub struct Tm25File {
    header: Tm25Header,
    /// The rays in sequence, each with the numbers listed in the header.
    numbers: Vec<f32>,
    notes: Vec<String>,
}

/// If the length of a direction differs from 1 by at most this number, there is no note. The number
/// is ten rounding errors of f32.
const LENGTH_SLACK: f64 = 1e-6;
/// If the relative difference between the flux of the header and the sum over rays is at most this
/// number, there is no note. The number allows for rounding to f32 and to four printed digits.
const FLUX_SLACK: f64 = 1e-3;

impl Tm25File {
    /// Reads a file.
    ///
    /// # Errors
    /// The first violation of the format, including bytes after the last ray.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut notes = Vec::new();
        let (header, rays, start) = Tm25Header::read(bytes, &mut notes)?;
        let columns = header.columns();
        let found = bytes.len() - start;
        let needed = usize::try_from(rays)
            .ok()
            .and_then(|rays| rays.checked_mul(4 * columns));
        if needed != Some(found) {
            let message = format!(
                "{rays} rays of {} bytes should follow, but {found} bytes do",
                4 * columns
            );
            return Err(Fault::byte(start, message));
        }
        let mut cursor = ByteCursor::new(bytes, start, true);
        let mut numbers = Vec::with_capacity(found / 4);
        while cursor.left() > 0 {
            numbers.push(cursor.f32("a ray")?);
        }
        let mut file = Self {
            header,
            numbers,
            notes,
        };
        file.check()?;
        Ok(file)
    }

    /// A file with the given rays, each with as many numbers as [`Tm25Header::columns`] counts.
    ///
    /// # Errors
    /// When the header or the rays are invalid.
    pub fn new(header: Tm25Header, numbers: Vec<f32>) -> Result<Self, Fault> {
        header.check()?;
        if !numbers.len().is_multiple_of(header.columns()) {
            let message = format!(
                "the number of values is {}, which is not a multiple of the {} values of a ray",
                numbers.len(),
                header.columns()
            );
            return Err(Fault::file(message));
        }
        let mut file = Self {
            header,
            numbers,
            notes: Vec::new(),
        };
        file.check()?;
        Ok(file)
    }

    /// The header, which applies to all rays.
    #[must_use]
    pub fn header(&self) -> &Tm25Header {
        &self.header
    }

    /// Returns notes on anything unusual, in the order of the file.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The number of rays.
    #[must_use]
    pub fn len(&self) -> usize {
        self.numbers.len() / self.header.columns()
    }

    /// Checks whether the file has no rays.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The numbers of each ray.
    fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.numbers.chunks_exact(self.header.columns())
    }

    /// The bytes of the file.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        let mut bytes = self.header.bytes(self.len() as u64);
        bytes.reserve(4 * self.numbers.len());
        bytes.extend(self.numbers.iter().flat_map(|v| v.to_le_bytes()));
        bytes
    }

    /// The rays of the file, in metres. Power is in W if rays state radiant flux, and
    /// otherwise in lm. A wavelength of 0 is unknown.
    #[must_use]
    pub fn rays(&self) -> RaySet {
        let flags = self.header.flags;
        let vector = |row: &[f32], at: usize| [0, 1, 2].map(|i| f64::from(row[at + i]));
        let wavelengths = match self.header.spectrum_type {
            _ if flags.wavelength => {
                let known = |nm: f32| {
                    if nm > 0.0 {
                        f64::from(nm) / 1e9
                    } else {
                        f64::NAN
                    }
                };
                let each = |row: &[f32]| known(row[6 + usize::from(flags.radiant_flux)]);
                Wavelengths::Each(self.rows().map(each).collect())
            }
            SpectrumType::OneWavelength => {
                Wavelengths::One(f64::from(self.header.wavelength_nm) / 1e9)
            }
            SpectrumType::OneSpectrum => Wavelengths::Spectrum(self.spectrum()),
            _ => Wavelengths::Unknown,
        };
        RaySet {
            positions: self
                .rows()
                .map(|row| vector(row, 0).map(|c| c / 1000.0))
                .collect(),
            directions: self.rows().map(|row| unit(vector(row, 3))).collect(),
            powers: self
                .rows()
                .map(|row| f64::from(row[flags.power_column()]))
                .collect(),
            unit: if flags.radiant_flux {
                PowerUnit::Watt
            } else {
                PowerUnit::Lumen
            },
            wavelengths,
        }
    }

    /// The radiant flux of 1 lm, in W, if the header states both fluxes.
    #[must_use]
    pub fn watts_per_lumen(&self) -> Option<f64> {
        let Tm25Header {
            luminous_flux,
            radiant_flux,
            ..
        } = self.header;
        let stated = luminous_flux > 0.0 && radiant_flux > 0.0;
        stated.then(|| f64::from(radiant_flux) / f64::from(luminous_flux))
    }

    /// The first spectral table, in metres.
    fn spectrum(&self) -> Vec<[f64; 2]> {
        let table = self.header.spectra.first().into_iter().flatten();
        let row =
            |[wavelength, weight]: &[f32; 2]| [f64::from(*wavelength) / 1e9, f64::from(*weight)];
        table.map(row).collect()
    }

    /// Refuses invalid rays, and adds notes on unusual values; each note covers all rays together.
    fn check(&mut self) -> Result<(), Fault> {
        let flags = self.header.flags;
        let spectrum = flags.spectrum_column();
        let mut lengths = 0;
        let mut sum = 0.0;
        for (index, row) in self.rows().enumerate() {
            let refused = |what: String| Err(Fault::ray(index, what));
            if let Some(at) = row.iter().position(|v| !v.is_finite()) {
                let (name, value) = (self.header.column_name(at), row[at]);
                return refused(format!("{name} is {value}; allowed: finite numbers"));
            }
            let size = length([3, 4, 5].map(|i| f64::from(row[i])));
            if size < 1e-3 {
                return refused(format!(
                    "its direction has the length {size}; allowed: unit vectors"
                ));
            }
            lengths += usize::from((size - 1.0).abs() > LENGTH_SLACK);
            for at in flags.not_negative() {
                if row[at] < 0.0 {
                    let (name, value) = (self.header.column_name(at), row[at]);
                    return refused(format!("{name} is {value}; allowed: 0 or more"));
                }
            }
            if let Some(found) = spectrum.map(|at| f64::from(row[at])) {
                let most = self.header.spectra.len();
                if found.fract() != 0.0 || found < 1.0 || found > most as f64 {
                    return refused(format!(
                        "its spectrum has number {found}; allowed: 1 to {most}"
                    ));
                }
            }
            sum += f64::from(row[flags.power_column()]);
        }
        if lengths > 0 {
            self.notes.push(format!(
                "{lengths} directions are not unit vectors; they are treated as unit vectors"
            ));
        }
        self.note_flux(sum);
        Ok(())
    }

    fn note_flux(&mut self, sum: f64) {
        let flags = self.header.flags;
        let (stated, unit) = if flags.radiant_flux {
            (self.header.radiant_flux, "W")
        } else {
            (self.header.luminous_flux, "lm")
        };
        let stated = f64::from(stated);
        if !stated.is_nan() && (stated - sum).abs() > FLUX_SLACK * sum.abs() {
            self.notes.push(format!(
                "the header states {stated} {unit}, but the rays have {sum} {unit}; the power of the rays is used"
            ));
        }
    }
}
