//! Converts a file to another format, and adds notes on everything that is lost.

use crate::mcpl::{self, McplFile, Particle, WATTS};
use crate::tm25::{self, Flags, SpectrumType, Tm25File};
use crate::{
    Fault, Format, PHOTON_ENERGY_LENGTH, PowerUnit, RayFile, RaySet, Wavelengths, gz, npy,
};

/// A converted file.
#[derive(Clone, Debug, PartialEq)]
pub struct Converted {
    /// Bytes of the file.
    pub bytes: Vec<u8>,
    /// Notes for the user, one sentence for each kind of data that was dropped or changed.
    pub notes: Vec<String>,
}

/// Writes a file in a format. A file that is converted to its own format is preserved completely.
///
/// # Errors
/// When the format cannot represent some rays, for example negative weights in TM-25 and NPY.
/// Therefore every file that this function writes can be read.
pub fn convert(file: &RayFile, to: Format) -> Result<Converted, Fault> {
    let packed = |bytes: Vec<u8>| match to {
        Format::McplGz => gz::pack(&bytes),
        _ => bytes,
    };
    let mut notes = Vec::new();
    let bytes = match (file, to) {
        (RayFile::Tm25(file), Format::Tm25) => file.write(),
        (RayFile::Mcpl(file), Format::Mcpl | Format::McplGz) => packed(file.write()),
        (_, Format::Tm25) => {
            notes = dropped(file);
            to_tm25(&file.rays(), &mut notes)?.write()
        }
        (_, Format::Mcpl | Format::McplGz) => {
            notes = dropped(file);
            packed(to_mcpl(&file.rays(), &mut notes)?.write())
        }
        (_, Format::Npy) => {
            notes = dropped(file);
            let set = file.rays();
            note_unit(&set, "an array", &mut notes);
            if matches!(set.wavelengths, Wavelengths::Spectrum(_)) {
                notes.push("the spectrum of all rays is dropped".to_owned());
            }
            npy::write(&set)?
        }
    };
    Ok(Converted { bytes, notes })
}

/// The parts of a file that a set of rays does not hold.
fn dropped(file: &RayFile) -> Vec<String> {
    let mut notes = Vec::new();
    let mut note = |there: bool, what: &str| {
        if there {
            notes.push(format!("{what} dropped"));
        }
    };
    match file {
        RayFile::Tm25(file) => {
            let header = file.header();
            let Flags {
                radiant_flux,
                luminous_flux,
                stokes,
                tristimulus,
                spectrum,
                ..
            } = header.flags;
            note(radiant_flux && luminous_flux, "luminous flux of rays:");
            note(stokes, "Stokes parameters of rays:");
            note(tristimulus, "tristimulus values of rays:");
            note(spectrum, "spectra of rays:");
            note(!header.extra_columns.is_empty(), "additional columns:");
            let texts = header.texts.iter().chain([&header.additional_text]);
            note(
                texts.into_iter().any(|t| !t.is_empty()),
                "text fields of the header:",
            );
            note(header.date != [0; 28], "date:");
        }
        RayFile::Mcpl(file) => {
            let header = file.header();
            let others = file.particles().filter(|p| p.pdg != mcpl::PHOTON).count();
            note(
                others > 0,
                &format!("kind and energy of {others} particles that are not photons:"),
            );
            note(
                file.particles().any(|p| p.time_ms.abs() > 0.0),
                "times of particles:",
            );
            note(header.polarisation, "polarisation of particles:");
            note(header.user_flags, "user flags of particles:");
            note(
                header.comments.iter().any(|c| c != WATTS.as_bytes()),
                "comments:",
            );
            note(!header.blobs.is_empty(), "blobs:");
        }
        RayFile::Npy(_) => {}
    }
    notes
}

fn note_unit(set: &RaySet, what: &str, notes: &mut Vec<String>) {
    if set.unit != PowerUnit::Weight {
        notes.push(format!(
            "{what} does not state that power is in {}",
            set.unit.symbol()
        ));
    }
}

/// The rays as a TM-25 file, in f32.
fn to_tm25(set: &RaySet, notes: &mut Vec<String>) -> Result<Tm25File, Fault> {
    let mut header = tm25::Tm25Header::default();
    let total = single(set.total_power());
    match set.unit {
        PowerUnit::Lumen => {
            header.flags.radiant_flux = false;
            header.flags.luminous_flux = true;
            header.luminous_flux = total;
        }
        PowerUnit::Watt => header.radiant_flux = total,
        PowerUnit::Weight => {
            header.radiant_flux = total;
            notes.push("weights, whose unit is not stated, are written as W".to_owned());
        }
    }
    match &set.wavelengths {
        Wavelengths::One(wavelength) => {
            header.spectrum_type = SpectrumType::OneWavelength;
            header.wavelength_nm = single(wavelength * 1e9);
        }
        Wavelengths::Each(each) if each.iter().any(|w| w.is_nan()) => {
            notes.push(
                "some rays have no wavelength; the wavelengths of all other rays are dropped"
                    .to_owned(),
            );
        }
        Wavelengths::Each(each) => {
            header.spectrum_type = SpectrumType::WavelengthPerRay;
            header.flags.wavelength = true;
            let least = each.iter().copied().fold(f64::INFINITY, f64::min);
            let most = each.iter().copied().fold(0.0, f64::max);
            header.range_nm = [least, most].map(|w| single(w * 1e9));
        }
        Wavelengths::Spectrum(table) => {
            header.spectrum_type = SpectrumType::OneSpectrum;
            let row = |[wavelength, weight]: &[f64; 2]| [single(wavelength * 1e9), single(*weight)];
            header.spectra = vec![table.iter().map(row).collect()];
        }
        Wavelengths::Unknown => {}
    }
    let mut numbers = Vec::with_capacity(set.len() * header.columns());
    for ray in 0..set.len() {
        let position = set.positions[ray].map(|c| single(c * 1000.0));
        numbers.extend(position);
        numbers.extend(set.directions[ray].map(single));
        let power = single(set.powers[ray]);
        // The columns are in the order radiant flux, wavelength, luminous flux.
        let wavelength = set.wavelength(ray).filter(|_| header.flags.wavelength);
        numbers.extend((set.unit != PowerUnit::Lumen).then_some(power));
        numbers.extend(wavelength.map(|w| single(w * 1e9)));
        numbers.extend((set.unit == PowerUnit::Lumen).then_some(power));
    }
    notes.push("numbers of rays are rounded to single precision".to_owned());
    Tm25File::new(header, numbers)
}

#[expect(clippy::cast_possible_truncation, reason = "TM-25 holds f32")]
fn single(value: f64) -> f32 {
    value as f32
}

/// The rays as photons of an MCPL file, in f64.
fn to_mcpl(set: &RaySet, notes: &mut Vec<String>) -> Result<McplFile, Fault> {
    let mut header = mcpl::McplHeader {
        universal_pdg: Some(mcpl::PHOTON),
        source: b"Etendue".to_vec(),
        ..mcpl::McplHeader::default()
    };
    let first = set.powers.first().copied().filter(|&p| p > 0.0);
    header.universal_weight =
        first.filter(|first| set.powers.iter().all(|p| p.to_bits() == first.to_bits()));
    if set.unit == PowerUnit::Watt {
        header.comments.push(WATTS.as_bytes().to_vec());
    } else {
        note_unit(set, "MCPL", notes);
    }
    match &set.wavelengths {
        Wavelengths::Unknown => {
            notes.push("rays have no wavelength, so their photons have the energy 0".to_owned());
        }
        Wavelengths::Spectrum(_) => {
            notes.push(
                "the spectrum of all rays is dropped, so photons have the energy 0".to_owned(),
            );
        }
        Wavelengths::Each(each) if each.iter().any(|w| w.is_nan()) => {
            notes.push(
                "some rays have no wavelength, so their photons have the energy 0".to_owned(),
            );
        }
        Wavelengths::One(_) | Wavelengths::Each(_) => {}
    }
    let photon = |ray: usize| Particle {
        position_cm: set.positions[ray].map(|c| c * 100.0),
        direction: set.directions[ray],
        energy_mev: set
            .wavelength(ray)
            .map_or(0.0, |wavelength| PHOTON_ENERGY_LENGTH / wavelength),
        time_ms: 0.0,
        weight: set.powers[ray],
        polarisation: [0.0; 3],
        pdg: mcpl::PHOTON,
        user_flags: 0,
    };
    McplFile::new(header, (0..set.len()).map(photon))
}
