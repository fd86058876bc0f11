//! Arguments of commands that take scenes of other programs.

use super::{ForceArgs, ThreadArgs, assignment};
use clap::{Args, ValueEnum};
use etendue_import::{Color, Options};
use glam::DVec3;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct WorldArgs {
    /// Scene file: Mitsuba 3 (.xml), glTF 2.0 (.gltf, .glb), OBJ with MTL (.obj) or PLY (.ply)
    #[arg(value_name = "SCENE")]
    pub(crate) path: PathBuf,

    /// The folder that no file of the scene may lie out of, links followed [default: that of the scene file]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,

    /// The one number that each colour becomes
    #[arg(long, value_name = "CHANNEL", default_value = "luminance")]
    pub(crate) color: Channel,

    /// Give a parameter of the file, such as Mitsuba's $res, a value; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Most surfaces that light meets between a source and the camera, instead of the file's: 0 shows sources, 1 adds direct light
    #[arg(long, value_name = "N")]
    pub(crate) depth: Option<u32>,

    /// Add light of the same radiance from everywhere, W/(m² sr); always there where it is given
    #[arg(long, value_name = "RADIANCE", value_parser = radiance)]
    pub(crate) sky: Option<f64>,

    #[command(flatten)]
    pub(crate) view: ViewArgs,
}

/// A camera that the scene need not have: named `command`, and the first.
#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    /// Put a camera of 512 × 512 pixels here, in coordinates of the scene
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look_at", allow_hyphen_values = true)]
    pub(crate) look_from: Option<DVec3>,

    /// What is in the middle of its picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look_from", allow_hyphen_values = true)]
    pub(crate) look_at: Option<DVec3>,

    /// What is up in its picture
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "look_from", default_value = "0,1,0", allow_hyphen_values = true)]
    pub(crate) up: DVec3,

    /// Its angle from side to side, degrees
    #[arg(long, value_name = "DEG", value_parser = angle, requires = "look_from", default_value = "45")]
    pub(crate) fov: f64,
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    let parsed = text.split(',').map(|part| part.trim().parse().ok());
    let numbers: Vec<f64> = parsed.collect::<Option<_>>()?;
    numbers.iter().all(|v| v.abs() <= 1e9).then_some(numbers)
}

fn point(text: &str) -> Result<DVec3, String> {
    match numbers(text).as_deref() {
        Some([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
        _ => Err("allowed: three numbers within ±1e9, as in 0,1.5,-4".to_owned()),
    }
}

fn angle(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|v| 0.0 < *v && *v < 180.0);
    found.ok_or_else(|| "allowed: above 0 and below 180".to_owned())
}

fn radiance(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|v| (0.0..=1e30).contains(v));
    found.ok_or_else(|| "allowed: a number from 0 on".to_owned())
}

impl WorldArgs {
    pub(crate) fn options(&self) -> Options {
        Options {
            root: self.root.clone(),
            color: match self.color {
                Channel::Luminance => Color::Luminance,
                Channel::Red => Color::Red,
                Channel::Green => Color::Green,
                Channel::Blue => Color::Blue,
            },
            set: self.set.clone(),
        }
    }
}

/// What a colour becomes.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Channel {
    Luminance,
    Red,
    Green,
    Blue,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue import cbox.xml
  etendue import scenes/cbox/cbox.xml --root . --set res=64
  etendue import helmet.glb

Prints what the scene holds, and a note for all that is left out or approximated, with its line. A scene that cannot be
followed is refused with all causes: exit code 2.")]
pub(crate) struct ImportArgs {
    #[command(flatten)]
    pub(crate) scene: WorldArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  etendue render cbox.xml
  etendue render cbox.xml --size 64x64 --samples 1024 --depth 1 --out out/direct
  etendue render bunny.obj --look-from 0,1,4 --look-at 0,0.5,0 --fov 30 --sky 1

Leaves in its folder
  picture.exr    radiance and its standard error, as two parts of one channel Y
  picture.npz    the same as arrays radiance and error [row, column], float64
  picture.png    to look at: its brightest hundredth is white
Scenes of OBJ, of PLY and often of glTF have no camera, and may have no light: --look-from with --look-at, and --sky.
Pixels are boxes, whatever filter the file names: each is the mean of the radiance over its area.")]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) scene: WorldArgs,

    #[command(flatten)]
    pub(crate) camera: CameraArgs,

    /// Paths for each pixel, at least 2
    #[arg(long, value_name = "N", default_value = "64", value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) samples: u32,

    /// Seed of the paths
    #[arg(long, value_name = "N", default_value = "1")]
    pub(crate) seed: u64,

    /// Folder for the picture [default: out/NAME]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print nothing but errors
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// Which camera looks.
#[derive(Debug, Args)]
pub(crate) struct CameraArgs {
    /// The camera, where the scene has several [default: the first]
    #[arg(long = "camera", value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Pixels across and down, instead of the camera's
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[usize; 2]>,
}

/// Most pixels along a side.
const MOST: usize = 1 << 14;

fn size(text: &str) -> Result<[usize; 2], String> {
    let number = |text: &str| text.parse().ok().filter(|n| (1..=MOST).contains(n));
    let parsed = text
        .split_once('x')
        .and_then(|(w, h)| Some([number(w)?, number(h)?]));
    parsed.ok_or_else(|| format!("allowed: two whole numbers from 1 to {MOST}, as in 64x48"))
}
