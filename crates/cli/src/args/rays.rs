//! Arguments of `etendue rays`.

use super::shared::ForceArgs;
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
