//! Arguments of `etendue rays` and `etendue spectrum`.

use super::shared::{FolderArgs, ForceArgs, WorkArgs, assignment};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue rays led.tm25ray                     show rays, power, units, wavelengths and texts
  etendue rays led.tm25ray --out led.mcpl.gz   write the same rays as MCPL photons
  etendue rays out/fig9b/receiver/photons.mcpl --out rays.npy

The first bytes of FILE tell its format. The extension of the output file selects the output format:
  .tm25ray          IES TM-25: mm, nm, W or lm, single precision
  .mcpl, .mcpl.gz   MCPL: cm, MeV, ms, weights; a photon of energy E has the
                    wavelength hc/E
  .npy              f64 [rays, 8]: x, y, z (m), kx, ky, kz, power, wavelength
                    (m; NaN if unknown)
A note lists the data that the output format cannot hold. A copy in the same format keeps all data. \
docs/rays.md lists the units.")]
pub(crate) struct RaysArgs {
    /// Ray file in IES TM-25, MCPL (also gzipped) or NPY
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Also write the rays to this file, in the format given by its extension
    #[arg(long, value_name = "OTHER")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue spectrum led.tm25ray                                 all rays, in a window around them
  etendue spectrum led.mcpl --set planes.0.at='Distance(0.5)'  half a metre on
  etendue spectrum rays.npy --flux 1 --set 'window.u=Hann(0.2)' --set frequencies.nu.max=40

The command measures a scene whose light is the file, with one plane, rays, at the origin of the file and perpendicular to its Z axis; \
--set changes its fields. Each ray counts once, and errors come from the spread between 64 groups of rays. \
The folder is that of `etendue measure`, so `etendue compare --measured DIR --theory FILE.npz` compares it with a theory.")]
pub(crate) struct SpectrumArgs {
    /// Ray file in IES TM-25, MCPL (also gzipped) or NPY
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Power of all rays in W, if the file does not state it
    #[arg(long, value_name = "W", allow_hyphen_values = true)]
    pub(crate) flux: Option<f64>,

    /// Set a field of the scene, such as window.x=Hann(0.01); may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}
