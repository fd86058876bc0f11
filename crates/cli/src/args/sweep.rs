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

Leaves in its folder, out/NAME-sweep unless --out names another,
  sweep.csv                            a row for each plane at each point and each number: the frequencies that hold 95 % of the power,
                                       the shear slope, and each parameter, measured with its standard error and predicted
  bandwidth_rho, bandwidth_nu, slope   curves over the field that is named first, as PNG, SVG and CSV; a grid with more than 24
                                       panels has none
  points/                              a run for each point: the same command goes on where it was stopped, and one with other
                                       values of the same fields runs only what is new
Values are numbers. Exit codes are those of run, of the worst point: one true point in a hundred fails by chance.")]
pub(crate) struct SweepArgs {
    /// Scene file, in RON
    #[arg(value_name = "SCENE.ron")]
    pub(crate) path: PathBuf,

    /// Set a field to a value, to N values from A to B (A..B:N; A..B:Nlog by equal factors) or to those of
    /// a list (A,B,C); may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = setting)]
    pub(crate) set: Vec<Setting>,

    /// All points have the seed of the scene or of --seed: differences between points have less noise, and their errors are not
    /// independent. Otherwise each point has a seed of its own, made from that seed and its values
    #[arg(long)]
    pub(crate) common_seed: bool,

    /// Several fields take their values in step, instead of in all combinations; each must have as many
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
    /// The sweep that is asked for.
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

One row for each plane across the ray that leaves a smooth surface with a BRDF, and each value of the sweep; several sweeps go in step.
  k           curvature of the surface in the plane of incidence, 1/m, convex positive
  θ0, θ1      angles of incidence and of view, degrees, signed alike: in the mirror direction θ1 = −θ0
  d, d'       distance from the surface to the plane, and from the last blockers (without any, from the light) to the surface, m
  lobe        what holds 95 % of the energy of the lobe's spectrum, cycles per radian
  B, B'       what the reflection at d needs, cycles per unit slope: Eq. 20, light from far away, and Eq. 21, an edge or a narrow light at d'
  exact       with --measure: that of the predicted spectrum, window and light included; beside it the measured one and its standard error
Criteria say nothing of windows: those of the scene must hold the lobe, and its frequencies the spectrum.")]
pub(crate) struct BandwidthArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Trace the scene and measure the bandwidth; beside it stands that of the exact prediction
    #[arg(long)]
    pub(crate) measure: bool,

    /// Set a field to N values from A to B (A..B:N; A..B:Nlog by equal factors) or to those of a list (A,B,C);
    /// may be repeated
    #[arg(long, value_name = "PATH=VALUES", value_parser = sweep)]
    pub(crate) sweep: Vec<Sweep>,

    /// Write the table into this file too, with all digits
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
  traced      by covariance tracing (Belcour et al. 2013) along the chain of the plane, its window last, at all frequencies
  in band     the same Gaussian within the plane's frequencies, as all that follows
  exact       of the predicted spectrum, between parallel planes; other planes have it at azimuth 0 alone
  measured    of the photons, noise taken out by crossing groups of batches, with standard errors
Light fields with edges have no such moments: theirs are of the band, and a remark says so. Photons are traced once, and once or twice
more for each plane, onto a 4D grid.
Leaves in its folder, out/NAME-covariance unless --out names another, covariance.json, and for each plane covariance.png,
.svg and .csv: the spectrum at azimuth 0 with ellipses.")]
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
