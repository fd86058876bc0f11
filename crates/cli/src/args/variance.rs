//! Arguments of `etendue variance`.

use super::shared::{FolderArgs, PhotonArgs, SceneArgs, WorkArgs, within};
use clap::Args;
use etendue_store::{ArgumentStyle, Failure};
use etendue_studies::variance::point_file;
use etendue_studies::variance::{
    DEFAULT_FREQUENCIES, DEFAULT_SETS, FREQUENCIES, PointCounts, SETS, Sampler,
};
use std::path::PathBuf;

/// All samplers that are not files.
pub(super) const SAMPLERS: &str = "independent,jitter,lhs,sobol,padded";

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue variance scenes/variance/soft_shadow.ron
  etendue variance scenes/variance/spot_disc.ron --plane receiver --samplers sobol,padded
  etendue variance scene.ron --plane receiver --samplers sobol,points.npy --counts 16..1024
  etendue variance scenes/variance/soft_shadow.ron --light-points     points of the light, not slopes

Predicts the error of the mean radiance over the window of a plane, for a renderer that estimates it \
with N rays, and shows the error really made beside it. The windows of the plane are replaced by Box \
windows of the same half-widths.
  predicted   from the 4D spectrum of the photons: the sum over frequencies of
              the power of the field times the power of the sampler. Sets of
              points are shifted at random, and wrap around the window
  found       from means over rays traced back at sets of points, each with a
              shift and random numbers of its own
  ratio       predicted variance divided by found variance
  gain        N Var/variance of the radiance: 1 for independent points, if light
              does not scatter on its way; smaller is better
  tail        share of the frequencies beyond those measured. They are assumed
              to go on as the last octave does, half as strong in each octave.
              The stated errors do not include the error of this assumption
Samplers:
  independent   independent points
  jitter        a point in each of n^4 cells, N = n^4
  lhs           Latin hypercube
  sobol         Sobol' net with Owen's scrambling, N = 2^k
  padded        two jittered sets in two dimensions, paired at random, N = n^2;
                for the pairs xu+yv and xy+uv
  FILE.npy      points of a file: f64 [N, 4] in [0, 1), axes x, u, y, v. Neither
                --counts nor --unshifted apply. The prediction is undecided
                (exit code 4) if the tail is more than 20 % of it
Writes to out/NAME-variance, or to the folder of --out: variance.json, and variance.png, .svg and .csv, \
which show the variance against N.")]
pub(crate) struct VarianceArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Name of the plane [default: the only plane of the scene]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Option<String>,

    /// Samplers, separated by commas
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = sampler, default_value = SAMPLERS)]
    pub(crate) samplers: Vec<SamplerArg>,

    /// Numbers of points: A..B stands for A, 4A, 16A, ... up to B, and A,B,C for a list
    #[arg(long, value_name = "A..B", default_value = "4..4096")]
    pub(crate) counts: PointCounts,

    /// Also predict and measure the errors of sets that are not shifted. The sampler must be
    /// jitter, lhs, sobol or padded, and the number of its cells along an axis must be a power of
    /// two
    #[arg(long)]
    pub(crate) unshifted: bool,

    /// Use the point on the light from which a ray comes instead of its slopes, as renderers that
    /// sample lights do. The window then covers the light, and for a disc the square around it. The
    /// light must have an area, and the plane must lie across the first leg
    #[arg(long)]
    pub(crate) light_points: bool,

    /// Number of sets of points from which each error is measured
    #[arg(long, value_name = "R", default_value_t = DEFAULT_SETS, value_parser = within::<u32>((*SETS.start()).into()..=(*SETS.end()).into()))]
    pub(crate) shifts: u32,

    /// Largest measured frequency M along each axis, in cycles per window
    #[arg(long, value_name = "M", default_value_t = DEFAULT_FREQUENCIES, value_parser = frequencies)]
    pub(crate) frequencies: usize,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

/// A sampler as it is named in the arguments.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SamplerArg {
    /// The samplers of a name: one sampler, or both padded samplers for `padded`.
    Named(Vec<Sampler>),
    /// A file of points.
    File(PathBuf),
}

/// The files of points among the samplers.
pub(crate) fn files(samplers: &[SamplerArg]) -> impl Iterator<Item = &PathBuf> {
    samplers.iter().filter_map(|sampler| match sampler {
        SamplerArg::Named(_) => None,
        SamplerArg::File(path) => Some(path),
    })
}

/// The samplers, with the points of files.
pub(crate) fn samplers(named: &[SamplerArg]) -> Result<Vec<Sampler>, Failure> {
    let of = |sampler: &SamplerArg| match sampler {
        SamplerArg::Named(all) => Ok(all.clone()),
        SamplerArg::File(path) => {
            let file = point_file::read(path, ArgumentStyle::Command)?;
            Ok(vec![Sampler::File(file)])
        }
    };
    let all: Vec<Vec<Sampler>> = named.iter().map(of).collect::<Result<_, Failure>>()?;
    Ok(all.concat())
}

pub(super) fn sampler(text: &str) -> Result<SamplerArg, String> {
    let text = text.trim();
    if let Some(samplers) = Sampler::named(text) {
        return Ok(SamplerArg::Named(samplers));
    }
    if text.to_ascii_lowercase().ends_with(".npy") {
        return Ok(SamplerArg::File(text.into()));
    }
    Err(format!(
        "no such sampler; allowed: {}, and files that end with .npy",
        Sampler::NAMES.join(", ")
    ))
}

fn frequencies(text: &str) -> Result<usize, String> {
    let [first, last] = [FREQUENCIES.start(), FREQUENCIES.end()];
    let number = text.trim().parse().ok();
    number
        .filter(|n| FREQUENCIES.contains(n))
        .ok_or_else(|| format!("must be a whole number from {first} to {last}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samplers_have_names_or_are_files() {
        assert_eq!(
            sampler("sobol"),
            Ok(SamplerArg::Named(vec![Sampler::Sobol]))
        );
        assert_eq!(sampler("a/b.npy"), Ok(SamplerArg::File("a/b.npy".into())));
        assert!(
            sampler("halton")
                .unwrap_err()
                .contains("allowed: independent")
        );
        assert!(frequencies("17").unwrap_err().contains("from 2 to 16"));
    }
}
