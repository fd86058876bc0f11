//! Arguments of commands that read scenes of other programs.

use super::shared::{FolderArgs, WorkArgs, assignment, one_named, whole_number, within};
use super::variance::{SAMPLERS, SamplerArg, sampler, samplers};
use clap::{Args, Subcommand};
use etendue_adaptive::SampleMethod;
use etendue_import::{Color, Options};
use etendue_store::{ArgumentStyle, Failure};
use etendue_studies::variance::VarianceOptions;
use etendue_view::ranges::{self, MAX_ANGLE, MAX_COORDINATE, SIDE};
use etendue_view::{CameraChoice, PictureRequest, ProbeRequest, Viewpoint, WorldSource};
use glam::DVec3;
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub(crate) enum WorldCommand {
    /// Show what a scene file of another program contains.
    Import(ImportArgs),
    /// Render a scene of another program, and estimate the errors.
    Render(RenderArgs),
    /// Measure the light field behind one pixel of a rendered scene.
    Probe(ProbeArgs),
}

#[derive(Debug, Args)]
pub(crate) struct WorldArgs {
    /// Scene file: Mitsuba 3 (.xml), pbrt-v4 (.pbrt), glTF 2.0 (.gltf, .glb), OBJ with MTL (.obj) or PLY (.ply)
    #[arg(value_name = "SCENE")]
    pub(crate) path: PathBuf,

    /// Folder that must contain all files of the scene, after links are resolved [default: the folder of the scene file]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,

    /// Which value of each colour to use: its luminance, or one channel
    #[arg(long, value_name = "CHANNEL", default_value = "luminance", value_parser = one_named(Color::ALL))]
    pub(crate) color: Color,

    /// Set a parameter of the file, such as Mitsuba's $res; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Maximum number of surfaces between a light source and the camera, instead of the file's
    /// maximum: 0 shows sources only, 1 adds direct light
    #[arg(long, value_name = "N", value_parser = within::<u32>(0..=u32::MAX.into()))]
    pub(crate) bounces: Option<u32>,

    /// In addition to the lights of the scene, add uniform light of this radiance, in W/(m² sr),
    /// from all directions
    #[arg(long, value_name = "RADIANCE", value_parser = radiance)]
    pub(crate) sky: Option<f64>,

    #[command(flatten)]
    pub(crate) view: ViewArgs,
}

/// A camera from the command line, which does not depend on the scene. This camera is named
/// `command` and becomes the first camera.
#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    /// Add a camera of 512 × 512 pixels at this point, in coordinates of the scene
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look_at", allow_hyphen_values = true)]
    pub(crate) look_from: Option<DVec3>,

    /// Where the camera looks: a point that appears at the centre of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look_from", allow_hyphen_values = true)]
    pub(crate) look_at: Option<DVec3>,

    /// Up direction of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look_from", default_value = "0,1,0", allow_hyphen_values = true)]
    pub(crate) up: DVec3,

    /// Horizontal angle of view, in degrees
    #[arg(long, value_name = "DEG", value_parser = angle, requires = "look_from", default_value_t = Viewpoint::FOV)]
    pub(crate) fov: f64,
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    let parsed = text.split(',').map(|part| part.trim().parse().ok());
    let numbers: Vec<f64> = parsed.collect::<Option<_>>()?;
    numbers
        .iter()
        .all(|v| v.abs() <= MAX_COORDINATE)
        .then_some(numbers)
}

fn point(text: &str) -> Result<DVec3, String> {
    match numbers(text).as_deref() {
        Some([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
        _ => Err("allowed: three numbers within ±1e9, as in 0,1.5,-4".to_owned()),
    }
}

fn angle(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|v| 0.0 < *v && *v < MAX_ANGLE);
    found.ok_or_else(|| "allowed: above 0 and below 180".to_owned())
}

fn radiance(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|v| ranges::SKY.contains(v));
    found.ok_or_else(|| "allowed: a number from 0 to 1e9".to_owned())
}

impl WorldArgs {
    /// The requested scene.
    pub(crate) fn source(&self) -> WorldSource {
        let ViewArgs { up, fov, .. } = self.view;
        let ends = self.view.look_from.zip(self.view.look_at);
        WorldSource {
            options: Options {
                root: self.root.clone(),
                color: self.color,
                set: self.set.clone(),
                ..Options::default()
            },
            bounces: self.bounces,
            sky: self.sky,
            viewpoint: ends.map(|(from, at)| Viewpoint { from, at, up, fov }),
            ..WorldSource::new(self.path.clone(), ArgumentStyle::Command)
        }
    }
}

impl CameraArgs {
    /// The requested camera.
    pub(crate) fn choice(&self) -> CameraChoice {
        CameraChoice {
            name: self.name.clone(),
            size: self.size,
        }
    }
}

impl RenderArgs {
    /// The requested picture.
    pub(crate) fn request(&self) -> PictureRequest {
        PictureRequest {
            source: self.scene.source(),
            camera: self.camera.choice(),
            method: match self.method {
                Some(RenderMethod(method)) => method,
                None => PictureRequest::usual_method(self.shading_samples),
            },
            samples: self.samples,
            shading_samples: self.shading_samples,
            paths: self.paths,
            blocker_rays: self.blocker_rays,
            isotropic: self.isotropic,
            seed: self.seed,
            force: self.work.force.force,
        }
    }
}

/// The distribution of a picture's samples; `None` if all pixels have the same number of samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RenderMethod(Option<SampleMethod>);

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue import cbox.xml
  etendue import scenes/cbox/cbox.xml --root . --set res=64
  etendue import helmet.glb

Prints the contents of the scene, and a note about each thing that is left out or approximated. The note \
gives the line in the file. A scene that cannot be rendered is refused: all causes are printed, and the \
exit code is 2.")]
pub(crate) struct ImportArgs {
    #[command(flatten)]
    pub(crate) scene: WorldArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue render cbox.xml
  etendue render cbox.xml --size 64x64 --samples 1024 --bounces 1 --out out/direct
  etendue render bunny.obj --look-from 0,1,4 --look-at 0,0.5,0 --fov 30 --sky 1
  etendue render scenes/worlds/creatures.xml --shading-samples 20000
  etendue render scenes/worlds/creatures.xml --shading-samples 20000 --method uniform --out out/uniform

Writes to out/NAME, or to the folder of --out:
  picture.exr    radiance and its standard error, as two parts that each have
                 one channel Y
  picture.npz    the same numbers as float64 arrays radiance and error [row,
                 column]
  picture.png    for viewing; the brightest hundredth of the pixels is white
OBJ, PLY and many glTF files have no camera or light: add them with --look-from, --look-at and --sky.
With few shading samples (Durand et al. 2005, section 6.2), picture.exr and picture.npz also contain maps \
(bandwidth, unoccluded, curvature, blockers, shadow, density, samples, variance). picture.npz also contains the \
positions of the samples (points). bandwidth.png and samples.png show two of the maps, and timing.json \
contains the time of each stage in seconds. Methods:
  uniform     blue noise of even density
  predicted   density by the paper's criteria, Eqs. 20 and 21, corrected
  paper       the paper's algorithm as printed
  weighted    half by the criteria, half by the interpolation error of a first
              quarter of the samples
  variance    density by the standard deviation of a first quarter of the
              samples, without theory
Each pixel is the mean of the radiance over its area (a box filter), whatever filter the file names.")]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) scene: WorldArgs,

    #[command(flatten)]
    pub(crate) camera: CameraArgs,

    /// Distribution of samples: the method `reference` takes the same number of samples in every
    /// pixel; each other method takes a few shading samples at points that it chooses [default:
    /// reference, or auto with --shading-samples]
    #[arg(long, value_name = "METHOD", value_parser = one_named(PictureRequest::METHODS.map(|(name, method)| (name, RenderMethod(method)))))]
    pub(crate) method: Option<RenderMethod>,

    /// Paths per pixel of a reference picture, at least 2
    #[arg(long, value_name = "N", default_value_t = PictureRequest::SAMPLES, value_parser = within::<u32>(ranges::SAMPLES))]
    pub(crate) samples: u32,

    /// Shading samples in the whole picture, at most 4 per pixel; not used by
    /// `--method reference` [default: one for each 20 pixels]
    #[arg(long, value_name = "N", value_parser = within::<u32>(ranges::SHADING_SAMPLES))]
    pub(crate) shading_samples: Option<u32>,

    /// Paths per shading sample
    #[arg(long, value_name = "N", default_value_t = PictureRequest::PATHS, value_parser = within::<u32>(ranges::PATHS))]
    pub(crate) paths: u32,

    /// Rays per point that measure how far away the blockers are. As many rays measure how far
    /// away the lights are, except with `--method paper` [default: 100 with `--method paper`,
    /// otherwise 16]
    #[arg(long, value_name = "N", value_parser = within::<u32>(ranges::BLOCKER_RAYS))]
    pub(crate) blocker_rays: Option<u32>,

    /// Use isotropic sample densities, as `--method paper` does; by default, samples are denser along the
    /// direction in which light changes faster
    #[arg(long)]
    pub(crate) isotropic: bool,

    /// Seed of the paths
    #[arg(long, value_name = "N", default_value_t = PictureRequest::SEED, value_parser = within::<u64>(0..=u64::MAX))]
    pub(crate) seed: u64,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue probe cbox.xml --pixel 128,200
  etendue probe cbox.xml --pixel 128,200 --depth 2 --window 8 --rays 2^22
  etendue probe cbox.xml --pixel 128,200 --covariance
  etendue probe cbox.xml --pixel 128,200 --variance=sobol,padded
  etendue probe cbox.xml --map 64x40

Follows the ray through a pixel from the camera to the first surface, and from there in the mirror \
direction. Measures the light field at the camera, and the light fields that reach and leave each surface. \
Each light field is measured in two ways: by rays traced back, and by photons from the lights. The verdict \
compares the two results. Where photons are too few or do not find all light, the verdict compares the rays \
with other rays, which never sample a light.
Writes to out/NAME-X-Y, or to the folder of --out: probe.json, and the same arrays and pictures for each \
plane as run.
The exit codes are the same as for run.
With --map, writes map.exr, map.npz, map.csv and the pictures map.png and map.svg. The arrays are measured, \
error, azimuth, across, criterion, window, pixels (width of the window) and samples (per pixel along a \
direction).")]
pub(crate) struct ProbeArgs {
    #[command(flatten)]
    pub(crate) scene: WorldArgs,

    #[command(flatten)]
    pub(crate) camera: CameraArgs,

    /// Column and row of the pixel, from 0 at the top left
    #[arg(long, value_name = "X,Y", value_parser = pixel, allow_hyphen_values = true, required_unless_present = "map")]
    pub(crate) pixel: Option<[usize; 2]>,

    /// Compute the bandwidths at the camera for this many pixels instead of probing one pixel. The
    /// pixels are spaced evenly over the picture, and only backward rays are used
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, conflicts_with_all = ["pixel", "photons", "surfaces"])]
    pub(crate) map: Option<[usize; 2]>,

    /// Maximum number of surfaces along the ray
    #[arg(long = "depth", value_name = "N", default_value_t = ProbeRequest::SURFACES, value_parser = within::<u16>(ranges::SURFACES))]
    pub(crate) surfaces: u16,

    /// Width of the window, in pixels [default: the narrowest of 16, 32, 64 and so on that shows the
    /// bandwidth of the picture]
    #[arg(long, value_name = "PIXELS", value_parser = window)]
    pub(crate) window: Option<f64>,

    /// Backward rays per plane. Without --photons, a plane gets more if its verdict needs more
    /// [default: 2^20; for a map, 2^15]
    #[arg(long, value_name = "N", value_parser = enough)]
    pub(crate) rays: Option<u64>,

    /// Photons that check the backward rays. Planes that photons cannot decide get as many BSDF rays,
    /// which never sample a light [default: as many as the verdict needs, at most 2^28]
    #[arg(long, value_name = "N", value_parser = enough)]
    pub(crate) photons: Option<u64>,

    /// Seed of backward rays and photons
    #[arg(long, value_name = "N", default_value_t = ProbeRequest::SEED, value_parser = within::<u64>(0..=u64::MAX))]
    pub(crate) seed: u64,

    /// Also measure the covariance of each plane's spectrum, and compare the measured covariance at
    /// the camera with covariance tracing from the first surface
    #[arg(long, conflicts_with = "map")]
    pub(crate) covariance: bool,

    /// Also predict the Monte Carlo error of the mean radiance over the window of each plane, and
    /// measure that error with many sets of points; for these samplers, or for all named samplers
    /// (see etendue variance). Adds variance.png, .svg and .csv to each plane
    #[arg(long, value_name = "SAMPLERS", value_delimiter = ',', value_parser = sampler, num_args = 0..=1, require_equals = true, default_missing_value = SAMPLERS, conflicts_with = "map")]
    pub(crate) variance: Option<Vec<SamplerArg>>,

    /// Print probe.json instead of tables
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) out: FolderArgs,

    #[command(flatten)]
    pub(crate) work: WorkArgs,
}

impl ProbeArgs {
    /// The requested probe.
    pub(crate) fn request(&self) -> Result<ProbeRequest, Failure> {
        let default = match self.map {
            Some(_) => ProbeRequest::RAYS_OF_MAP,
            None => ProbeRequest::RAYS,
        };
        let variance = self.variance.as_deref().map(|named| {
            let samplers = samplers(named)?;
            Ok(VarianceOptions {
                samplers,
                ..VarianceOptions::new(ArgumentStyle::Command)
            })
        });
        Ok(ProbeRequest {
            source: self.scene.source(),
            camera: self.camera.choice(),
            surfaces: self.surfaces,
            window: self.window,
            rays: self.rays.unwrap_or(default),
            photons: self.photons,
            seed: self.seed,
            covariance: self.covariance,
            variance: variance.transpose()?,
            out: self.out.folder.clone(),
            force: self.work.force.force,
        })
    }
}

/// Parses a number of rays or photons. There are 64 batches, and each needs at least one ray or
/// photon.
fn enough(text: &str) -> Result<u64, String> {
    let number = whole_number(text)?;
    if ranges::RAYS.contains(&number) {
        return Ok(number);
    }
    Err(format!(
        "allowed: {} or more, at least one for each batch",
        ranges::RAYS.start()
    ))
}

fn pixel(text: &str) -> Result<[usize; 2], String> {
    let parsed = text
        .split_once(',')
        .and_then(|(x, y)| Some([x.parse().ok()?, y.parse().ok()?]));
    parsed.ok_or_else(|| "allowed: two whole numbers, as in 128,200".to_owned())
}

fn window(text: &str) -> Result<f64, String> {
    let sound = text.parse().ok().filter(|x| ranges::WINDOW.contains(x));
    sound.ok_or_else(|| "allowed: 0.01 to 10000".to_owned())
}

/// The selected camera.
#[derive(Debug, Args)]
pub(crate) struct CameraArgs {
    /// Camera to use, if the scene has several [default: the first]
    #[arg(long = "camera", value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Width and height of the picture in pixels, instead of the camera's
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub(crate) size: Option<[usize; 2]>,
}

fn size(text: &str) -> Result<[usize; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|n| SIDE.contains(n));
    let number = |text: &str| side(text).and_then(|n| usize::try_from(n).ok());
    let parsed = text
        .split_once('x')
        .and_then(|(w, h)| Some([number(w)?, number(h)?]));
    parsed.ok_or_else(|| {
        let most = SIDE.end();
        format!("allowed: two whole numbers from 1 to {most}, as in 64x48")
    })
}
