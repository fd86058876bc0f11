//! Writes photons in the formats of `--save`.

use crate::measure::MeasuredScene;
use etendue_field::{Crossing, VirtualPlane};
use etendue_rayfile::mcpl::{self, PHOTON, Particle, WATTS, stat_sum_comment};
use etendue_rayfile::{NpyHeader, tm25};
use etendue_trace::PlaneInWorld;
use std::io;

/// The photons that cross a plane, as rays in world coordinates.
pub(super) struct Rays {
    world: PlaneInWorld,
    /// Number of photons emitted, including photons that met no object.
    emitted: u64,
    /// A description of the plane.
    about: String,
}

impl Rays {
    /// The rays of a plane; `None` if there is no such plane.
    pub(super) fn of(case: &MeasuredScene, plane: usize) -> Option<Self> {
        let VirtualPlane { name, distance, .. } = case.scene.planes.get(plane)?;
        let emitted = case.measurement.batches().map(|batch| batch.emitted).sum();
        Some(Self {
            world: PlaneInWorld::new(&case.scene, plane)?,
            emitted,
            about: format!(
                "scene {}, plane {name}, {distance} m from the light along the central ray; seed {}",
                case.scene.name, case.scene.run.seed
            ),
        })
    }

    /// The power of a photon, W.
    pub(super) fn watts(&self, crossing: &Crossing) -> f64 {
        self.world.flux(crossing) / self.emitted as f64
    }

    /// The position in metres, the direction, and the power in W of a photon.
    fn ray(&self, crossing: &Crossing) -> io::Result<([f64; 3], [f64; 3], f64)> {
        let [point, along] = self.world.ray(&crossing.ray).ok_or_else(|| {
            let what = "the crossing of a photon has no ray: this is a bug in etendue";
            io::Error::other(what)
        })?;
        Ok((point.to_array(), along.to_array(), self.watts(crossing)))
    }
}

/// The header of a photon file, and the format in which the file stores a photon.
pub(super) enum Content<'a> {
    /// An f64 array [rows, 5], in coordinates of the plane.
    Npy(u64),
    Mcpl(&'a Rays, Box<mcpl::McplHeader>, u64),
    Tm25(&'a Rays, Box<tm25::Tm25Header>, u64),
}

impl<'a> Content<'a> {
    /// The content of an MCPL file: photons of unknown energy, in f64.
    pub(super) fn mcpl(rays: &'a Rays, rows: u64) -> Self {
        let mut comments = vec![WATTS.as_bytes().to_vec(), rays.about.clone().into_bytes()];
        // MCPL stores the number of emitted photons as a sum; if files are merged, these sums are
        // added.
        comments.extend(stat_sum_comment("emitted_photons", rays.emitted as f64));
        let header = mcpl::McplHeader {
            universal_pdg: Some(PHOTON),
            source: format!("Etendue {}", env!("CARGO_PKG_VERSION")).into_bytes(),
            comments,
            ..mcpl::McplHeader::default()
        };
        Self::Mcpl(rays, Box::new(header), rows)
    }

    /// The content of a TM-25 file: rays without wavelengths, with the total flux `flux`
    /// in W.
    pub(super) fn tm25(rays: &'a Rays, rows: u64, flux: f64) -> Self {
        let mut header = tm25::Tm25Header {
            radiant_flux: single(flux),
            ..tm25::Tm25Header::default()
        };
        header.texts[3] = format!("Etendue {}", env!("CARGO_PKG_VERSION"));
        header.texts[7].clone_from(&rays.about);
        Self::Tm25(rays, Box::new(header), rows)
    }

    pub(super) fn begin(&self) -> Vec<u8> {
        match self {
            Self::Npy(rows) => NpyHeader::new("<f8", &[*rows, 5]).bytes(),
            Self::Mcpl(_, header, rows) => header.bytes(*rows),
            Self::Tm25(_, header, rows) => header.bytes(*rows),
        }
    }

    pub(super) fn rows(&mut self, crossings: &[Crossing]) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for crossing in crossings {
            match self {
                Self::Npy(_) => {
                    let Crossing { ray, weight } = crossing;
                    let row = [ray.x, ray.y, ray.u, ray.v, *weight];
                    bytes.extend(row.into_iter().flat_map(f64::to_le_bytes));
                }
                Self::Mcpl(rays, header, _) => {
                    // MCPL has centimetres.
                    let (position, direction, weight) = rays.ray(crossing)?;
                    let photon = Particle {
                        position_cm: position.map(|c| 100.0 * c),
                        direction,
                        energy_mev: 0.0,
                        time_ms: 0.0,
                        weight,
                        polarisation: [0.0; 3],
                        pdg: PHOTON,
                        user_flags: 0,
                    };
                    photon
                        .encode(header, &mut bytes)
                        .map_err(io::Error::other)?;
                }
                Self::Tm25(rays, ..) => {
                    // TM-25 has millimetres.
                    let (position, direction, power) = rays.ray(crossing)?;
                    let position = position.map(|c| 1000.0 * c);
                    let row = position.into_iter().chain(direction).chain([power]);
                    bytes.extend(row.flat_map(|v| single(v).to_le_bytes()));
                }
            }
        }
        Ok(bytes)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "TM-25 holds f32")]
fn single(value: f64) -> f32 {
    value as f32
}
