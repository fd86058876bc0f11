//! Arguments of `etendue rays`.

use super::shared::ForceArgs;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue rays led.tm25ray                          show rays, power, units, wavelengths and texts
  etendue rays led.tm25ray --out led.mcpl.gz        the same rays as photons of MCPL
  etendue rays out/fig9b/receiver/photons.mcpl --out rays.npy

The first bytes of FILE determine its format; the ending of the output file determines the other:
  .tm25ray          IES TM-25: mm, nm, W or lm, single precision
  .mcpl, .mcpl.gz   MCPL: cm, MeV, ms, weights; a photon of energy E has the wavelength hc/E
  .npy              f64 [rays, 8]: x, y, z (m), kx, ky, kz, power, wavelength (m; NaN where it is not known)
A note lists what the other format cannot hold. Copies in the same format keep everything. docs/rays.md has the units.")]
pub(crate) struct RaysArgs {
    /// Ray file: IES TM-25, MCPL (also gzipped) or NPY
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,

    /// Also write the rays into this file, in the format of its extension
    #[arg(long, value_name = "OTHER")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) force: ForceArgs,
}
