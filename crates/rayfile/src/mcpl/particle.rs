//! The record of a particle in a file.

use super::direction;
use super::header::{McplHeader, ordered};
use crate::cursor::ByteCursor;

/// A particle, in the units of the format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Position, cm.
    pub position_cm: [f64; 3],
    /// Direction, a unit vector.
    pub direction: [f64; 3],
    /// Kinetic energy, MeV.
    pub energy_mev: f64,
    /// Time, ms.
    pub time_ms: f64,
    /// Weight, in an unspecified unit.
    pub weight: f64,
    /// A vector without a fixed meaning, which programs may use. It is zero if a file has no such
    /// vector.
    pub polarisation: [f64; 3],
    /// Kind of particle, as a code of the Particle Data Group.
    pub pdg: i32,
    /// Bits without a fixed meaning, which programs may use.
    pub user_flags: u32,
}

impl Particle {
    /// Reads a record.
    pub(super) fn decode(header: &McplHeader, cursor: &mut ByteCursor<'_>) -> Result<Self, String> {
        let numbers = ParticleNumbers { header };
        let mut next = || numbers.read(cursor);
        let polarisation = if header.polarisation {
            [next()?, next()?, next()?]
        } else {
            [0.0; 3]
        };
        let position_cm = [next()?, next()?, next()?];
        let packed = [next()?, next()?];
        let energy = next()?;
        let time_ms = next()?;
        let weight = match header.universal_weight {
            Some(weight) => weight,
            None => next()?,
        };
        let negative = energy.is_sign_negative();
        let direction = match header.version {
            2 => direction::unpack_octahedral(packed, negative)?,
            _ => direction::unpack(packed, negative)?,
        };
        let short = |fault: crate::Fault| fault.message;
        let pdg = match header.universal_pdg {
            Some(pdg) => pdg,
            None => cursor.i32("a PDG code").map_err(short)?,
        };
        let user_flags = match header.user_flags {
            true => cursor.u32("user flags").map_err(short)?,
            false => 0,
        };
        Ok(Self {
            position_cm,
            direction,
            energy_mev: energy.abs(),
            time_ms,
            weight,
            polarisation,
            pdg,
            user_flags,
        })
    }

    /// Refuses NaN and infinite numbers, negative energies, and directions that are not unit
    /// vectors.
    pub(super) fn check(&self) -> Result<(), String> {
        let numbers = [
            ("position, cm", self.position_cm.as_slice()),
            ("energy, MeV", &[self.energy_mev]),
            ("time, ms", &[self.time_ms]),
            ("weight", &[self.weight]),
            ("polarisation", &self.polarisation),
        ];
        for (name, values) in numbers {
            if let Some(value) = values.iter().find(|v| !v.is_finite()) {
                return Err(format!("{name} is {value}; allowed: finite numbers"));
            }
        }
        if self.energy_mev < 0.0 {
            let energy = self.energy_mev;
            return Err(format!("energy is {energy} MeV; allowed: 0 or more"));
        }
        direction::check(self.direction)
    }

    /// Appends the record of a file with this header, packed as in version 3.
    ///
    /// # Errors
    /// When the file cannot hold the particle. A file holds only finite numbers that its precision
    /// can store, energies that are not negative, and directions that are unit vectors. If the file
    /// has a universal weight or PDG code, the particle must have this value.
    pub fn encode(&self, header: &McplHeader, records: &mut Vec<u8>) -> Result<(), String> {
        self.check()?;
        if header
            .universal_weight
            .is_some_and(|w| w.to_bits() != self.weight.to_bits())
        {
            return Err("the weight of the particle is not the universal weight".to_owned());
        }
        if header.universal_pdg.is_some_and(|pdg| pdg != self.pdg) {
            return Err("the PDG code of the particle is not the universal PDG code".to_owned());
        }
        let numbers = ParticleNumbers { header };
        let (packed, negative) = direction::pack(self.direction);
        let energy = if negative {
            -self.energy_mev
        } else {
            self.energy_mev
        };
        let polarisation = header.polarisation.then_some(self.polarisation);
        let weight = header.universal_weight.is_none().then_some(self.weight);
        let all = polarisation.into_iter().flatten();
        let all = all.chain(self.position_cm).chain(packed);
        for value in all.chain([energy, self.time_ms]).chain(weight) {
            numbers.write(value, records)?;
        }
        if header.universal_pdg.is_none() {
            records.extend(ordered(self.pdg.to_le_bytes(), header.little_endian));
        }
        if header.user_flags {
            records.extend(ordered(self.user_flags.to_le_bytes(), header.little_endian));
        }
        Ok(())
    }
}

/// Reads numbers in the precision and byte order of a file.
struct ParticleNumbers<'a> {
    header: &'a McplHeader,
}

impl ParticleNumbers<'_> {
    fn read(&self, cursor: &mut ByteCursor<'_>) -> Result<f64, String> {
        let read = if self.header.single_precision {
            cursor.f32("a number").map(f64::from)
        } else {
            cursor.f64("a number")
        };
        read.map_err(|fault| fault.message)
    }

    fn write(&self, value: f64, records: &mut Vec<u8>) -> Result<(), String> {
        let little = self.header.little_endian;
        if !self.header.single_precision {
            records.extend(ordered(value.to_le_bytes(), little));
            return Ok(());
        }
        #[expect(clippy::cast_possible_truncation, reason = "the file stores f32")]
        let single = value as f32;
        if single.is_infinite() && value.is_finite() {
            return Err(format!("{value} does not fit single precision"));
        }
        records.extend(ordered(single.to_le_bytes(), little));
        Ok(())
    }
}
