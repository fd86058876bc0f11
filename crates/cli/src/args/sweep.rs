//! Arguments of commands on several values of a scene, and of covariances.

use super::shared::{FolderArgs, PhotonArgs, SceneArgs, WorkArgs};
use clap::Args;
use etendue_pipeline::load::SceneSource;
use etendue_sweep::SweepRequest;
use etendue_sweep::values::{Setting, Sweep, setting, sweep};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:8
  etendue sweep scenes/fig9b.ron --set blockers.0.pitch=0.05..0.4:4log --set blockers.0.fill=0.3,0.6 --photons 2^20
  etendue sweep scenes/fig9b.ron --together --set surfaces.0.center.2=1.5,2,3 --set surfaces.0.albedo=0.2,0.5,0.8

Writes to out/NAME-sweep, or to the folder of --out:
  sweep.csv                            a row for each point, plane and number: the frequencies that hold 95 % of the power,
                                       the shear slope and each parameter, measured with standard error, and predicted
  bandwidth_rho, bandwidth_nu, slope   curves over the first field, as PNG, SVG and CSV (no curves for more than 24 panels)
  points/                              a run for each point. The same command continues an interrupted sweep, and a command
                                       with other values of the same fields runs only the new points
Values are numbers. Exit codes are those of run, for the worst point; one correct point in a hundred fails by chance.")]
pub(crate) struct SweepArgs {
    /// Scene file, in RON
    #[arg(value_name = "SCENE.ron")]
    pub(crate) path: PathBuf,

    /// Set a field to a value, to N values from A to B (A..B:N; A..B:Nlog for logarithmic spacing)
    /// or to those of a list (A,B,C); may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = setting)]
    pub(crate) set: Vec<Setting>,

    /// Use the seed of the scene or of --seed at all points: differences between points have less
    /// noise, but their errors are not independent. Otherwise each point has its own seed, derived
    /// from that seed and its values
    #[arg(long)]
    pub(crate) common_seed: bool,

    /// Vary several fields in step, instead of in all combinations; each must have the same number
    /// of values
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
  etendue bandwidth scenes/bandwidth.ron --sweep surfaces.0.facing.0=0..1:5      tan of the angle of incidence
  etendue bandwidth scenes/bandwidth_edge.ron --measure --csv edge.csv

One row for each plane across the ray that leaves a smooth surface with a BRDF, and for each value of the sweep; several sweeps advance together.
  k           curvature of the surface in the plane of incidence, 1/m, convex positive
  θ0, θ1      angles of incidence and of view, degrees, with one sign convention: θ1 = −θ0 in the mirror direction
  d, d'       distance from the surface to the plane, and from the last blockers (without any, from the light) to the surface, m
  lobe        frequency below which the lobe's spectrum has 95 % of its energy, cycles per radian
  B, B'       bandwidth of the reflection at d, cycles per unit slope: by Eq. 20 for light from far away, by Eq. 21 for an edge or narrow light at d'
  exact       with --measure: bandwidth of the predicted spectrum, window and light included, then the measured one with its standard error
The criteria ignore windows: the windows of the scene must contain the lobe, and its frequencies the spectrum.")]
pub(crate) struct BandwidthArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Also trace the scene and measure the bandwidth; that of the exact prediction is shown beside
    /// it
    #[arg(long)]
    pub(crate) measure: bool,

    /// Set a field to N values from A to B (A..B:N; A..B:Nlog for logarithmic spacing) or to those
    /// of a list (A,B,C); may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = sweep)]
    pub(crate) sweep: Vec<Sweep>,

    /// Also write the table into this file, with all digits
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

The covariance of the power spectrum |L|² over (ρx, ρy, νu, νv): ∫ P Ω Ωᵀ/∫ P, cycles² over the units of the coordinates.
  traced      covariance tracing (Belcour et al. 2013) along the chain of the plane, with its window, over all frequencies
  in band     the same Gaussian restricted to the plane's frequencies, like the rows below
  exact       the predicted spectrum: complete between parallel planes, at azimuth 0 alone for other planes
  measured    the photons, with standard errors; products of different groups of batches remove the noise
The moments of light fields with edges diverge; theirs are restricted to the band, and a remark says so. Photons are traced once,
and once or twice more for each plane to fill a 4D grid.
Writes to out/NAME-covariance, or to the folder of --out: covariance.json, and for each plane covariance.png, .svg and .csv,
the spectrum at azimuth 0 with ellipses.")]
pub(crate) struct CovarianceArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// The planes, by name; may be repeated [default: all]
    #[arg(long, value_name = "NAME")]
    pub(crate) plane: Vec<String>,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) photons: PhotonArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}
