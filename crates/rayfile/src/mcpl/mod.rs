//! MCPL, the Monte Carlo Particle List, versions 2 and 3.
//!
//! Source: T. Kittelmann et al., "Monte Carlo Particle Lists: MCPL", Comput. Phys. Commun. 218
//! (2017) 17–42, and <https://mctools.github.io/mcpl>. Units: cm, MeV, ms. A photon (PDG code 22)
//! of energy E has the wavelength h c / E, see [`PHOTON_ENERGY_LENGTH`]. The format defines no
//! unit of the weight. Files of Étendue state in a comment, [`WATTS`], that the weight is in W.
//!
//! Files of either byte order are read, and records are kept as they are. Each record is checked
//! once.

mod direction;
mod header;
mod particle;
mod stat;

pub use header::{McplHeader, WATTS};
pub use particle::Particle;
pub use stat::{StatSum, stat_sum_comment};

use crate::cursor::ByteCursor;
use crate::set::PHOTON_ENERGY_LENGTH;
use crate::{Fault, PowerUnit, RaySet, Wavelengths};

/// The PDG code of a photon.
pub const PHOTON: i32 = 22;

/// A file with its records unchanged.
#[derive(Clone, Debug, PartialEq)]
pub struct McplFile {
    header: McplHeader,
    count: usize,
    records: Vec<u8>,
    /// The bytes after the last record. They are too few for another record: a public test file,
    /// for example, ends with a line feed.
    rest: Vec<u8>,
}

impl McplFile {
    /// Reads an unpacked file.
    ///
    /// # Errors
    /// The first violation of the format. Files that were not closed are also refused: their
    /// header states no particles although records follow. Files with enough bytes after the last
    /// record for another record are also refused.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let (header, count, start) = McplHeader::read(bytes)?;
        let size = header.record_size();
        let records = bytes.get(start..).unwrap_or_default();
        let needed = usize::try_from(count)
            .ok()
            .and_then(|count| count.checked_mul(size));
        let rest = needed.and_then(|needed| records.len().checked_sub(needed));
        let Some(rest) = rest.filter(|&rest| rest < size) else {
            return Err(wrong_length(start, count, size, records.len()));
        };
        let (records, rest) = records.split_at(records.len() - rest);
        let file = Self {
            header,
            count: records.len() / size,
            records: records.to_vec(),
            rest: rest.to_vec(),
        };
        for index in 0..file.count {
            file.decode(index)
                .and_then(|p| p.check())
                .map_err(|what| Fault::ray(index, what))?;
        }
        Ok(file)
    }

    /// A file of version 3 with the given particles, all of which must fit the header's
    /// options.
    ///
    /// # Errors
    /// When a particle is invalid, or differs from the universal weight or PDG code of the header.
    pub fn new(
        header: McplHeader,
        particles: impl IntoIterator<Item = Particle>,
    ) -> Result<Self, Fault> {
        header.check()?;
        let mut file = Self {
            header: McplHeader {
                version: 3,
                ..header
            },
            count: 0,
            records: Vec::new(),
            rest: Vec::new(),
        };
        for particle in particles {
            let written = particle.encode(&file.header, &mut file.records);
            written.map_err(|what| Fault::ray(file.count, what))?;
            file.count += 1;
        }
        Ok(file)
    }

    /// The header, which applies to all particles.
    #[must_use]
    pub fn header(&self) -> &McplHeader {
        &self.header
    }

    /// The number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Checks whether the file has no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// All particles, in their order.
    pub fn particles(&self) -> impl Iterator<Item = Particle> {
        // Each record was decoded when the file was read, so no particle is omitted.
        (0..self.count).filter_map(|index| self.decode(index).ok())
    }

    /// The bytes of the file. If the file was read, these bytes are the original bytes.
    #[must_use]
    pub fn write(&self) -> Vec<u8> {
        let mut bytes = self.header.bytes(self.count as u64);
        bytes.extend(&self.records);
        bytes.extend(&self.rest);
        bytes
    }

    /// The rays of the file in metres. The power of a ray is the weight of the particle,
    /// in W if the comment [`WATTS`] states this. Particles other than photons, and photons of
    /// energy 0, have no wavelength.
    #[must_use]
    pub fn rays(&self) -> RaySet {
        let watts = self.header.comments.iter().any(|c| c == WATTS.as_bytes());
        let wavelength = |p: &Particle| {
            let known = p.pdg == PHOTON && p.energy_mev > 0.0;
            if known {
                PHOTON_ENERGY_LENGTH / p.energy_mev
            } else {
                f64::NAN
            }
        };
        let mut set = RaySet {
            positions: Vec::with_capacity(self.count),
            directions: Vec::with_capacity(self.count),
            powers: Vec::with_capacity(self.count),
            unit: if watts {
                PowerUnit::Watt
            } else {
                PowerUnit::Weight
            },
            wavelengths: Wavelengths::Unknown,
        };
        let mut wavelengths = Vec::with_capacity(self.count);
        for particle in self.particles() {
            set.positions.push(particle.position_cm.map(|c| c / 100.0));
            set.directions.push(particle.direction);
            set.powers.push(particle.weight);
            wavelengths.push(wavelength(&particle));
        }
        set.wavelengths = shared(wavelengths);
        set
    }

    /// The particle with an index within the file.
    fn decode(&self, index: usize) -> Result<Particle, String> {
        let size = self.header.record_size();
        let record = self.records.get(index * size..(index + 1) * size);
        let mut cursor = ByteCursor::new(record.unwrap_or_default(), 0, self.header.little_endian);
        Particle::decode(&self.header, &mut cursor)
    }
}

/// A single wavelength if all rays have the same wavelength.
fn shared(each: Vec<f64>) -> Wavelengths {
    let first = each.first().copied().unwrap_or(f64::NAN);
    if each.iter().all(|w| w.is_nan()) {
        Wavelengths::Unknown
    } else if each.iter().all(|w| w.to_bits() == first.to_bits()) {
        Wavelengths::One(first)
    } else {
        Wavelengths::Each(each)
    }
}

fn wrong_length(start: usize, count: u64, size: usize, found: usize) -> Fault {
    let message = if count == 0 {
        format!(
            "the header states 0 particles, but {found} bytes follow the header: the file was not closed (`mcpltool --repair` counts its particles)"
        )
    } else {
        format!("{count} particles of {size} bytes should follow, but {found} bytes do")
    };
    Fault::byte(start, message)
}
