//! Arguments shared by several commands.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use etendue_field::tidy;
use etendue_pipeline::Run;
use etendue_pipeline::load::SceneSource;
use etendue_scene::{Color, RunFile};
use etendue_store::{Failure, Method};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Options that override the measurement settings of the scene.
#[derive(Clone, Debug, Args)]
pub(crate) struct PhotonArgs {
    /// Number of photons to emit [default: as in the scene]
    #[arg(long, value_name = "N", value_parser = whole_number, allow_hyphen_values = true)]
    pub(crate) photons: Option<u64>,

    /// Seed of the photons [default: as in the scene]
    #[arg(long, value_name = "N", value_parser = within::<u64>(0..=u64::MAX))]
    pub(crate) seed: Option<u64>,

    /// Measurement method
    #[arg(long, value_name = "METHOD", default_value = "photons", value_parser = methods())]
    pub(crate) method: Method,
}

/// Parses one of several named values, each with a line of help.
pub(super) fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    all: [(T, &'static str, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    let names = all.map(|(_, name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(move |text| {
        let mut all = all.iter();
        let found = all.find(|(_, name, _)| *name == text);
        found.map(|(value, ..)| *value).ok_or("no such value")
    })
}

/// Parses one of several named values.
pub(super) fn one_named<T: Copy + Send + Sync + 'static, const N: usize>(
    all: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.map(|(name, _)| name)).try_map(move |text| {
        let found = all.iter().find(|(name, _)| *name == text);
        found.map(|(_, value)| *value).ok_or("no such value")
    })
}

/// Parses a measurement method.
pub(super) fn methods() -> impl TypedValueParser<Value = Method> {
    let named = |method: Method, help| (method, method.name(), help);
    one_of([
        named(Method::Photons, "Photons traced forward from the light"),
        named(
            Method::Backward,
            "Rays that start at random in the window of each plane and are traced back to the light",
        ),
    ])
}

impl PhotonArgs {
    /// Overrides the measurement settings of a scene with these options.
    pub(crate) fn set(&self, run: &mut RunFile) {
        run.photons = self.photons.unwrap_or(run.photons);
        run.seed = self.seed.unwrap_or(run.seed);
    }

    /// Reads a scene that is measured with these options.
    pub(crate) fn run(&self, scene: &SceneArgs) -> Result<Run, Failure> {
        Run::read(&scene.source(), self.method, |run| self.set(run))
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct ForceArgs {
    /// Replace files that etendue did not write, or that were changed after etendue wrote them, and
    /// print the name of each replaced file
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct ThreadArgs {
    /// Number of threads [default: one for each core]. The results do not depend on this
    /// number
    #[arg(long = "threads", value_name = "N", value_parser = within::<u16>(1..=1024))]
    pub(crate) count: Option<u16>,
}

/// Options of commands that may take a long time.
#[derive(Clone, Debug, Args)]
pub(crate) struct WorkArgs {
    #[command(flatten)]
    pub(crate) force: ForceArgs,

    #[command(flatten)]
    pub(crate) threads: ThreadArgs,

    /// Print no progress, no warnings about the scene and no summary
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// The folder for the results of a scene.
#[derive(Clone, Debug, Args)]
pub(crate) struct FolderArgs {
    /// Folder for the results [default: a folder in out, named after the scene]
    #[arg(long = "out", value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
}

impl FolderArgs {
    /// The requested folder, or `out/NAME` if no folder was requested.
    pub(crate) fn or_named(&self, name: impl AsRef<Path>) -> PathBuf {
        let named = || Path::new("out").join(name);
        self.folder.clone().unwrap_or_else(named)
    }
}

/// The folder for the results of a stage of `run`.
#[derive(Debug, Args)]
pub(crate) struct StageFolderArgs {
    /// Folder for the results
    #[arg(long = "out", value_name = "DIR")]
    pub(crate) folder: PathBuf,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct SceneArgs {
    /// Scene file, in RON
    #[arg(value_name = "SCENE.ron")]
    pub(crate) path: PathBuf,

    /// Set a field of the scene, such as blockers.0.fill=0.5; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,

    /// Which number of each colour to measure: its luminance, or one channel [default: as in the
    /// scene, where it is `run.color`]
    #[arg(long, value_name = "CHANNEL", value_parser = one_named(Color::ALL))]
    pub(crate) color: Option<Color>,
}

impl SceneArgs {
    /// The scene file and its overrides, for the pipeline.
    pub(crate) fn source(&self) -> SceneSource {
        SceneSource {
            color: self.color,
            ..SceneSource::file(&self.path, &self.set)
        }
    }
}

pub(super) fn assignment(text: &str) -> Result<(String, String), String> {
    let (path, value) = text.split_once('=').ok_or("must be PATH=VALUE")?;
    Ok((path.trim().to_owned(), value.trim().to_owned()))
}

/// The largest share that may be written without a unit; a larger number is probably a
/// percentage.
const MAX_PLAIN_SHARE: f64 = 0.05;

/// Parses a share in (0, 1]. The text is a percentage with the sign %, or a plain number below
/// [`MAX_PLAIN_SHARE`].
pub(super) fn share(text: &str) -> Result<f64, String> {
    let fault = || "must be a share of the spectrum, such as 0.1% or 0.001".to_owned();
    let parsed = |number: &str| number.trim().parse().ok().filter(|x: &f64| *x > 0.0);
    if let Some(number) = text.trim().strip_suffix('%') {
        let share = parsed(number).map(|percent| 0.01 * percent);
        return share.filter(|share| *share <= 1.0).ok_or_else(fault);
    }
    match parsed(text) {
        Some(share) if share < MAX_PLAIN_SHARE => Ok(share),
        Some(percent) if percent <= 100.0 => Err(format!(
            "a number without % must be below {MAX_PLAIN_SHARE}: for {percent} per cent write {percent}% or {}",
            tidy(0.01 * percent)
        )),
        _ => Err(fault()),
    }
}

/// Parses a whole number in a range, which may be written as in [`whole_number`].
pub(super) fn within<T: TryFrom<u64> + Clone + Send + Sync + 'static>(
    range: RangeInclusive<u64>,
) -> impl TypedValueParser<Value = T> {
    move |text: &str| {
        let number = whole_number(text).ok().filter(|n| range.contains(n));
        let number = number.and_then(|n| T::try_from(n).ok());
        let [least, most] = [range.start(), range.end()];
        number.ok_or_else(|| format!("allowed: a whole number from {least} to {most}"))
    }
}

/// Parses a whole number, which may be written as 10_000_000, 1e7 or 2^23.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the value was checked to be a whole number that f64 holds exactly"
)]
pub(super) fn whole_number(text: &str) -> Result<u64, String> {
    let digits = text.replace('_', "");
    if let Ok(n) = digits.parse() {
        return Ok(n);
    }
    let power = digits.strip_prefix("2^").and_then(|m| m.parse().ok());
    if let Some(number) = power.and_then(|m: u32| 1_u64.checked_shl(m)) {
        return Ok(number);
    }
    let allowed = "must be a whole number from 0 to 9e15, such as 10_000_000, 1e7 or 2^23";
    let x: f64 = digits.parse().map_err(|_| allowed)?;
    if (0.0..=9.0e15).contains(&x) && x.fract() == 0.0 {
        Ok(x as u64)
    } else {
        Err(allowed.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::share;

    #[test]
    fn a_large_share_needs_its_unit() {
        assert_eq!(share("0.3%"), share("0.003"));
        assert_eq!(share("30 %"), Ok(0.3));
        assert_eq!(share("0.049"), Ok(0.049));
        for (text, advice) in [
            ("0.3", "write 0.3% or 0.003"),
            ("0.05", "write 0.05% or 0.0005"),
            ("2", "write 2% or 0.02"),
        ] {
            let message = share(text).err().unwrap_or_default();
            assert!(message.contains(advice), "{text}: {message}");
        }
        for text in ["0", "-1%", "101%", "101", "nan", "inf%", "x"] {
            assert!(share(text).is_err(), "{text}");
        }
    }
}
