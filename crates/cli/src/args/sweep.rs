//! Arguments of the commands that run a scene for several values of its fields, and arguments of
//! `etendue covariance`.

use super::shared::{FolderArgs, PhotonArgs, SceneArgs, WorkArgs};
use clap::Args;
use etendue_pipeline::load::SceneSource;
use etendue_studies::derivative::DerivedField;
use etendue_studies::sweep::SweepRequest;
use etendue_studies::sweep::values::{Setting, Sweep, setting, sweep};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:8
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:4log --set blockers.0.fill=0.3,0.6 --photons 2^20
  etendue sweep scenes/fig9b.ron --derivative surfaces.0.center.2 --photons 2^20
  etendue sweep scenes/fig9b.ron --together --set surfaces.0.center.2=1.5,2,3 --set surfaces.0.albedo=0.2,0.5,0.8

Writes to out/NAME-sweep, or to the folder of --out:
  sweep.csv                            a row for each number at each plane and
                                       each point. The numbers are the
                                       frequencies below which 95 % of the power
                                       lies, the shear slope and each parameter.
                                       A row has the measured number, its
                                       standard error and the predicted number
  bandwidth_rho, bandwidth_nu, slope   curves as functions of the first field:
                                       PNG, SVG and CSV (none if they would have
                                       more than 24 panels)
  differences.csv                      with --common-seed
  derivative.csv, PLANE/derivative.npz with --derivative, which writes to
                                       out/NAME-derivative. A row for each plane
                                       and step, and the slices of the chosen
                                       step
  points/                              the run of each point. The same command
                                       continues an interrupted sweep. A command
                                       with other values of the same fields runs
                                       only the new points
Values must be numbers. The worst point determines the exit code, as in run. One correct point in a \
hundred fails by chance.")]
pub(crate) struct SweepArgs {
    /// Scene file, in RON
    #[arg(value_name = "SCENE.ron")]
    pub(crate) path: PathBuf,

    /// Set a field to a single value, to N values from A to B (A..B:N, or A..B:Nlog for logarithmic
    /// spacing) or to the values of a list (A,B,C); may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = setting)]
    pub(crate) set: Vec<Setting>,

    /// Use the same seed at all points: the scene's seed, or the value of --seed. Points keep their
    /// batches, and differences.csv has the differences of neighbouring points, measured in pairs,
    /// with less noise (docs/verdict.md). The errors and the verdicts of the points are then not
    /// independent.
    /// Without this option, each point has its own seed, computed from the scene's seed (or --seed)
    /// and the point's values
    #[arg(long)]
    pub(crate) common_seed: bool,

    /// Measure the derivative of the slices by a field, instead of a sweep: from pairs of runs with
    /// three steps up to STEP [default: 4 % of the value]. The largest step whose bias is below the
    /// noise is taken, and theory is compared over the same step
    #[arg(long, value_name = "FIELD[=STEP]", value_parser = DerivedField::parse, conflicts_with = "together")]
    pub(crate) derivative: Option<DerivedField>,

    /// Vary several fields together, value by value, instead of in all combinations; all fields
    /// must have the same number of values
    #[arg(long)]
    pub(crate) together: bool,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

impl SweepArgs {
    /// The requested sweep.
    pub(crate) fn request(&self) -> SweepRequest {
        SweepRequest {
            scene: SceneSource::file(&self.path, &[]),
            set: self.set.clone(),
            common_seed: self.common_seed,
            together: self.together,
            photons: self.photons.photons,
            seed: self.photons.seed,
            method: self.photons.method,
            force: self.work.force.force,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue bandwidth scenes/bandwidth.ron
  etendue bandwidth scenes/bandwidth.ron --measure --sweep surfaces.0.form.Sphere=-0.3..0.5:9
  etendue bandwidth scenes/bandwidth.ron --sweep surfaces.0.facing.0=0..1:5
      values are tangents of the angle of incidence
  etendue bandwidth scenes/bandwidth_edge.ron --measure --csv edge.csv

Prints a row for each value of the sweep and for each suitable plane. A plane is suitable if it is \
orthogonal to the central ray and sees light that leaves a smooth surface with a BRDF. Several sweeps \
advance together.
  k           curvature of the surface in the plane of incidence, in 1/m,
              positive if convex
  θ0, θ1      angles of incidence and of view, in degrees, with the same sign
              convention: θ1 = −θ0 in the mirror direction
  d, d'       distances in m: from the surface to the plane, and from the last
              blockers (or the light, if there are none) to the surface
  lobe        frequency below which the lobe's spectrum has 95 % of its energy,
              in cycles per radian
  B, B'       bandwidth of the reflection at distance d, in cycles per unit
              slope: by Eq. 20 for distant light, and by Eq. 21 for an edge or a
              narrow light at distance d'
  exact       with --measure: bandwidth of the predicted spectrum, which
              includes window and light. The next column is the measured
              bandwidth with its standard error
The criteria ignore windows. Therefore the windows of the scene must contain the lobe, and the frequencies \
of the scene must contain the spectrum.")]
pub(crate) struct BandwidthArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Also trace the scene and measure the bandwidth; the bandwidth of the exact prediction is
    /// shown beside the measured bandwidth
    #[arg(long)]
    pub(crate) measure: bool,

    /// Set a field to N values from A to B (A..B:N, or A..B:Nlog for logarithmic spacing) or to the
    /// values of a list (A,B,C); may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = sweep)]
    pub(crate) sweep: Vec<Sweep>,

    /// Also write the table to this file, with all digits
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue covariance scenes/table1/glossy.ron
  etendue covariance scenes/fig9b.ron --plane receiver --photons 2^22 --out out/covariance

Prints the covariance ∫ P Ω Ωᵀ/∫ P of the power spectrum P = |L|² over Ω = (ρx, ρy, νu, νv). The units are \
cycles² divided by the units of two coordinates. The columns are:
  traced      computed by covariance tracing (Belcour et al. 2013) along the
              chain of the plane, with its window, over all frequencies
  in band     computed from the Gaussian of traced, within the plane's
              frequencies; exact and measured also cover only these
  exact       computed from the predicted spectrum: from the complete spectrum
              between parallel planes, and from azimuth 0 for other planes
  measured    measured by the photons, with standard errors. Products of
              different groups of batches remove the noise
The moments of light fields with edges diverge: they are given only within the band, and a remark says so. \
Photons are traced once, and once or twice more for each plane to fill a 4D grid.
Writes to out/NAME-covariance, or to the folder of --out: covariance.json, and for each plane \
covariance.png, .svg and .csv, which show the spectrum at azimuth 0 with ellipses.")]
pub(crate) struct CovarianceArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Name of a plane; may be repeated [default: all planes]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Vec<String>,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}
