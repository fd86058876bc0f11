//! Reads and writes the header (section 4.7 of the standard), in the order of the file.

use super::text;
use crate::Fault;
use crate::cursor::ByteCursor;

/// The way in which the spectral information of rays is stored (section 4.7.1.9).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpectrumType {
    /// 0: there is no spectral information.
    None,
    /// 1: all rays have the wavelength of the header.
    OneWavelength,
    /// 2: each ray has a wavelength.
    WavelengthPerRay,
    /// 3: all rays have the spectrum of the first table.
    OneSpectrum,
    /// 4: each ray refers to a table.
    SpectrumPerRay,
}

/// The numbers that rays have in addition to position and direction (section 4.7.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags {
    /// Radiant flux, W.
    pub radiant_flux: bool,
    /// Wavelength, nm.
    pub wavelength: bool,
    /// Luminous flux, lm; the tristimulus value Y.
    pub luminous_flux: bool,
    /// Stokes parameters S1, S2, S3, divided by S0, and the X axis of their frame.
    pub stokes: bool,
    /// Tristimulus values X and Z.
    pub tristimulus: bool,
    /// The number of a spectral table, from 1.
    pub spectrum: bool,
}

impl Flags {
    /// The names of the columns of rays, in order.
    fn names(self) -> Vec<&'static str> {
        let groups: [(bool, &[&str]); 7] = [
            (true, &["x", "y", "z", "kx", "ky", "kz"]),
            (self.radiant_flux, &["radiant flux"]),
            (self.wavelength, &["wavelength"]),
            (self.luminous_flux, &["luminous flux"]),
            (
                self.stokes,
                &["S1", "S2", "S3", "axis x", "axis y", "axis z"],
            ),
            (self.tristimulus, &["tristimulus X", "tristimulus Z"]),
            (self.spectrum, &["spectrum"]),
        ];
        let present = groups.into_iter().filter(|(there, _)| *there);
        present.flat_map(|(_, names)| names).copied().collect()
    }

    /// The column of a ray's power: radiant flux, or luminous flux if there is no radiant
    /// flux.
    pub(super) fn power_column(self) -> usize {
        6 + usize::from(!self.radiant_flux && self.wavelength)
    }

    /// The columns that cannot hold negative numbers.
    pub(super) fn not_negative(self) -> impl Iterator<Item = usize> {
        let numbers = [self.radiant_flux, self.wavelength, self.luminous_flux];
        6..6 + numbers.map(usize::from).iter().sum::<usize>()
    }

    pub(super) fn spectrum_column(self) -> Option<usize> {
        self.names().iter().position(|name| *name == "spectrum")
    }
}

/// The content of a file before its rays, except for their number.
#[derive(Clone, Debug, PartialEq)]
pub struct Tm25Header {
    /// Version, 2013 or 2020.
    pub version: i32,
    /// 0: simulated, 1: measured.
    pub creation_method: i32,
    /// Total luminous flux, in lm; NaN if it is not stated.
    pub luminous_flux: f32,
    /// Total radiant flux, in W; NaN if it is not stated.
    pub radiant_flux: f32,
    /// Date and time, in the notation of ISO 8601, in 28 bytes that end with zeros; all bytes are
    /// zero if the file states no date.
    pub date: [u8; 28],
    /// The place where rays begin, by the codes 0 (unknown) to 7 of section 4.7.1.8.
    pub start_position: i32,
    /// The way in which the spectral information is stored.
    pub spectrum_type: SpectrumType,
    /// The wavelength of all rays, nm, for [`SpectrumType::OneWavelength`].
    pub wavelength_nm: f32,
    /// The shortest and the longest wavelength, nm.
    pub range_nm: [f32; 2],
    /// Bytes reserved for later versions of the standard.
    pub reserved: [u8; 168],
    /// The numbers that rays have.
    pub flags: Flags,
    /// Texts, in the order of [`Tm25Header::TEXTS`].
    pub texts: [String; 9],
    /// Spectral tables: wavelength in nm, and weight.
    pub spectra: Vec<Vec<[f32; 2]>>,
    /// Names of columns that the standard does not define.
    pub extra_columns: Vec<String>,
    /// Additional text.
    pub additional_text: String,
    /// The number of characters available for [`Tm25Header::additional_text`], a multiple of 8.
    pub text_room: usize,
}

impl Default for Tm25Header {
    /// The header of simulated rays with a radiant flux and no further information.
    fn default() -> Self {
        Self {
            version: 2013,
            creation_method: 0,
            luminous_flux: f32::NAN,
            radiant_flux: f32::NAN,
            date: [0; 28],
            start_position: 0,
            spectrum_type: SpectrumType::None,
            wavelength_nm: f32::NAN,
            range_nm: [f32::NAN; 2],
            reserved: [0; 168],
            flags: Flags {
                radiant_flux: true,
                ..Flags::default()
            },
            texts: Default::default(),
            spectra: Vec::new(),
            extra_columns: Vec::new(),
            additional_text: String::new(),
            text_room: 0,
        }
    }
}

/// Number of characters of a text of section 4.7.3.
const TEXT: usize = 1000;
/// The largest number of spectra in a file. The number is limited because an empty spectrum takes
/// more bytes in memory than in the file.
const MOST_SPECTRA: u32 = 65_536;
/// Number of characters of a column name (section 4.7.5).
const NAME: usize = 128;

impl Tm25Header {
    /// The subject of each text of section 4.7.3 of the standard.
    pub const TEXTS: [&str; 9] = [
        "light source",
        "manufacturer",
        "creator of the model",
        "creator of the file",
        "equipment",
        "camera",
        "operation of the light source",
        "additional information",
        "reference of the data",
    ];

    /// The number of columns of a ray.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.flags.names().len() + self.extra_columns.len()
    }

    /// The name of a column of rays.
    pub(super) fn column_name(&self, at: usize) -> String {
        let names = self.flags.names();
        let extra = at.checked_sub(names.len());
        let extra = extra.and_then(|at| self.extra_columns.get(at)).cloned();
        names
            .get(at)
            .map(|n| (*n).to_owned())
            .or(extra)
            .unwrap_or_default()
    }

    /// The header, the number of rays, and the offset of the first ray.
    pub(super) fn read(bytes: &[u8], notes: &mut Vec<String>) -> Result<(Self, u64, usize), Fault> {
        let cursor = &mut ByteCursor::new(bytes, 0, true);
        let mut header = Self::default();
        let (rays, spectra, extra, text_bytes) = header.read_description(cursor, notes)?;
        header.read_flags(cursor)?;
        for (place, what) in header.texts.iter_mut().zip(Self::TEXTS) {
            *place = text::read(cursor, TEXT, what, notes)?;
        }
        header.read_spectra(cursor, spectra, notes)?;
        for _ in 0..extra {
            let name = text::read(cursor, NAME, "the name of a column", notes)?;
            header.extra_columns.push(name);
        }
        header.text_room = text_bytes / 4;
        header.additional_text = text::read(cursor, header.text_room, "additional text", notes)?;
        header.check()?;
        Ok((header, rays, cursor.at()))
    }

    /// Reads 4.7.1. Returns the numbers of rays, spectra, additional columns and bytes of
    /// additional text.
    fn read_description(
        &mut self,
        cursor: &mut ByteCursor<'_>,
        notes: &mut Vec<String>,
    ) -> Result<(u64, u32, u32, usize), Fault> {
        if cursor.take(4, "the signature of TM-25")? != b"TM25" {
            return Err(Fault::byte(0, "it does not begin with TM25"));
        }
        self.version = cursor.i32("the version")?;
        if ![2013, 2020].contains(&self.version) {
            let version = self.version;
            return Err(Fault::byte(
                4,
                format!("version {version}; allowed: 2013, 2020"),
            ));
        }
        self.creation_method = cursor.i32("the method of creation")?;
        self.luminous_flux = cursor.f32("the luminous flux")?;
        self.radiant_flux = cursor.f32("the radiant flux")?;
        let rays = cursor.u64("the number of rays")?;
        self.date.copy_from_slice(cursor.take(28, "the date")?);
        self.start_position = cursor.i32("the start of rays")?;
        self.spectrum_type = match cursor.i32("the type of spectra")? {
            0 => SpectrumType::None,
            1 => SpectrumType::OneWavelength,
            2 => SpectrumType::WavelengthPerRay,
            3 => SpectrumType::OneSpectrum,
            4 => SpectrumType::SpectrumPerRay,
            other => {
                let message = format!("the type of spectra is {other}; allowed: 0 to 4");
                return Err(Fault::byte(60, message));
            }
        };
        self.wavelength_nm = cursor.f32("the wavelength")?;
        self.range_nm = [
            cursor.f32("the shortest wavelength")?,
            cursor.f32("the longest wavelength")?,
        ];
        let spectra = cursor.u32("the number of spectra")?;
        let extra = cursor.u32("the number of additional columns")?;
        let at = cursor.at();
        let text_bytes = cursor.u32("the length of the additional text")? as usize;
        if !text_bytes.is_multiple_of(32) {
            let message =
                format!("the additional text has {text_bytes} bytes; allowed: multiples of 32");
            return Err(Fault::byte(at, message));
        }
        self.reserved
            .copy_from_slice(cursor.take(168, "reserved bytes")?);
        let (method, start) = (self.creation_method, self.start_position);
        if !(0..=1).contains(&method) {
            notes.push(format!("the method of creation is {method}; defined: 0, 1"));
        }
        if !(0..=7).contains(&start) {
            notes.push(format!("the start of rays is {start}; defined: 0 to 7"));
        }
        Ok((rays, spectra, extra, text_bytes))
    }

    /// Reads 4.7.2.
    fn read_flags(&mut self, cursor: &mut ByteCursor<'_>) -> Result<(), Fault> {
        for what in ["position", "direction"] {
            let at = cursor.at();
            if !cursor.flag(what)? {
                return Err(Fault::byte(at, format!("rays without {what}")));
            }
        }
        self.flags = Flags {
            radiant_flux: cursor.flag("the flag for radiant flux")?,
            wavelength: cursor.flag("the flag for wavelengths")?,
            luminous_flux: cursor.flag("the flag for luminous flux")?,
            stokes: cursor.flag("the flag for Stokes parameters")?,
            tristimulus: cursor.flag("the flag for tristimulus values")?,
            spectrum: cursor.flag("the flag for the presence of spectra")?,
        };
        Ok(())
    }

    /// Reads section 4.7.4 of the standard: tables, and zeros up to a multiple of 32 bytes.
    fn read_spectra(
        &mut self,
        cursor: &mut ByteCursor<'_>,
        spectra: u32,
        notes: &mut Vec<String>,
    ) -> Result<(), Fault> {
        let start = cursor.at();
        if spectra > MOST_SPECTRA {
            let message =
                format!("the file has {spectra} spectra; allowed: at most {MOST_SPECTRA}");
            return Err(Fault::byte(76, message));
        }
        for _ in 0..spectra {
            let at = cursor.at();
            let rows = cursor.u32("the length of a spectrum")? as usize;
            if rows == 0 {
                return Err(Fault::byte(at, "a spectrum has no row"));
            }
            if rows.saturating_mul(8) > cursor.left() {
                let left = cursor.left();
                let message = format!("a spectrum has {rows} rows, but only {left} bytes are left");
                return Err(Fault::byte(at, message));
            }
            let mut table = Vec::with_capacity(rows);
            for _ in 0..rows {
                table.push([cursor.f32("a wavelength")?, cursor.f32("its weight")?]);
            }
            self.spectra.push(table);
        }
        let length = cursor.at() - start;
        let filling = cursor.take(
            length.next_multiple_of(32) - length,
            "padding after spectra",
        )?;
        if filling.iter().any(|&b| b != 0) {
            notes.push("the padding after spectra is not zero; it is dropped".to_owned());
        }
        Ok(())
    }

    /// Refuses values that contradict each other.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let flags = self.flags;
        let refuse = |wrong: bool, what: &str| {
            if wrong {
                Err(Fault::file(what))
            } else {
                Ok(())
            }
        };
        let kind = self.spectrum_type;
        let radiant = flags.radiant_flux;
        let fluxes = [self.luminous_flux, self.radiant_flux];
        refuse(
            fluxes.iter().any(|f| *f < 0.0 || f.is_infinite()),
            "a total flux of the header is negative or infinite",
        )?;
        refuse(
            !radiant && !flags.luminous_flux,
            "rays have neither radiant nor luminous flux",
        )?;
        refuse(
            kind == SpectrumType::WavelengthPerRay && !flags.wavelength,
            "spectra are of the type \"wavelength of each ray\", but rays have no wavelength",
        )?;
        refuse(
            (kind == SpectrumType::SpectrumPerRay) != flags.spectrum,
            "rays must refer to a spectrum if, and only if, the type of spectra is \"spectrum of each ray\"",
        )?;
        refuse(
            flags.stokes && !radiant,
            "rays have Stokes parameters but no radiant flux",
        )?;
        refuse(
            flags.tristimulus && !flags.luminous_flux,
            "rays have tristimulus values X and Z without Y",
        )?;
        let single = self.wavelength_nm > 0.0 && self.wavelength_nm.is_finite();
        refuse(
            kind == SpectrumType::OneWavelength && !single,
            "the wavelength that all rays share is not positive",
        )?;
        let tables = [SpectrumType::OneSpectrum, SpectrumType::SpectrumPerRay].contains(&kind);
        refuse(
            tables && self.spectra.is_empty(),
            "rays refer to spectra, but there are none",
        )?;
        self.check_spectra()
    }

    fn check_spectra(&self) -> Result<(), Fault> {
        for (number, table) in (1..).zip(&self.spectra) {
            let sound = |[wavelength, weight]: &[f32; 2]| {
                let finite = wavelength.is_finite() && weight.is_finite();
                finite && *wavelength > 0.0 && *weight >= 0.0
            };
            if table.is_empty() {
                return Err(Fault::file(format!("spectrum {number} has no row")));
            }
            if let Some(row) = table.iter().position(|row| !sound(row)) {
                let [wavelength, weight] = table[row];
                return Err(Fault::file(format!(
                    "spectrum {number}, row {row}: {wavelength} nm with weight {weight}; allowed: positive wavelengths, weights of 0 or more"
                )));
            }
        }
        Ok(())
    }

    /// The bytes before the first ray, for files that are written incrementally.
    #[must_use]
    pub fn bytes(&self, rays: u64) -> Vec<u8> {
        // All lengths fit into 32 bits, because no file is longer.
        let short = |length: usize| u32::try_from(length).unwrap_or(u32::MAX).to_le_bytes();
        let mut bytes = b"TM25".to_vec();
        bytes.extend(self.version.to_le_bytes());
        bytes.extend(self.creation_method.to_le_bytes());
        bytes.extend(self.luminous_flux.to_le_bytes());
        bytes.extend(self.radiant_flux.to_le_bytes());
        bytes.extend(rays.to_le_bytes());
        bytes.extend(self.date);
        bytes.extend(self.start_position.to_le_bytes());
        bytes.extend((self.spectrum_type as u32).to_le_bytes());
        bytes.extend(self.wavelength_nm.to_le_bytes());
        bytes.extend(self.range_nm.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(short(self.spectra.len()));
        bytes.extend(short(self.extra_columns.len()));
        bytes.extend(short(4 * self.text_room));
        bytes.extend(self.reserved);
        let f = self.flags;
        let flags = [
            true,
            true,
            f.radiant_flux,
            f.wavelength,
            f.luminous_flux,
            f.stokes,
            f.tristimulus,
            f.spectrum,
        ];
        bytes.extend(flags.iter().flat_map(|&flag| u32::from(flag).to_le_bytes()));
        for content in &self.texts {
            text::write(content, TEXT, &mut bytes);
        }
        let start = bytes.len();
        for table in &self.spectra {
            bytes.extend(short(table.len()));
            bytes.extend(table.iter().flatten().flat_map(|v| v.to_le_bytes()));
        }
        bytes.resize(start + (bytes.len() - start).next_multiple_of(32), 0);
        for name in &self.extra_columns {
            text::write(name, NAME, &mut bytes);
        }
        text::write(&self.additional_text, self.text_room, &mut bytes);
        bytes
    }
}
