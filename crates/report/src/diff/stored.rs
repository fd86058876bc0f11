//! Reads result folders for `diff`: every file is verified, and its content is not trusted.

use etendue_compare::{Estimate, Sample};
use etendue_field::{Complex, FrequencyAxis, SliceGrid};
use etendue_scene::{Color, read_below};
use etendue_store::npz::NpzFile;
use etendue_store::stored::listed_bytes;
use etendue_store::{Failure, MAX_INDEX_BYTES, SUMMARY, sealed};
use ndarray::{Array1, Array3, Axis};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The error of a folder without a result. The folder of `run --rgb` has a result in each
/// of its folders.
#[must_use]
pub fn no_result(folder: &Path) -> Failure {
    let shown = folder.display();
    let colors = [Color::Red, Color::Green, Color::Blue].map(Color::name);
    let is_rgb = colors
        .iter()
        .all(|c| folder.join(c).join(SUMMARY).is_file());
    Failure::bad_input(if is_rgb {
        format!(
            "{shown} holds results of three channels; allowed: one of {shown}/red, {shown}/green and {shown}/blue"
        )
    } else if folder.is_dir() {
        format!(
            "{shown} holds no result, because it has no {SUMMARY}; allowed: a folder that run or compare has written"
        )
    } else {
        format!("{shown}: no such folder")
    })
}

/// A result folder of `run` or `compare`, by any version of this program.
#[derive(Debug)]
pub(super) struct StoredResult {
    pub(super) folder: PathBuf,
    pub(super) index: ResultIndex,
}

/// The part of a `summary.json` that `diff` needs.
#[derive(Debug, Deserialize)]
pub(super) struct ResultIndex {
    pub(super) scene: String,
    pub(super) scene_hash: String,
    pub(super) scene_file: Value,
    pub(super) version: String,
    pub(super) seed: u64,
    pub(super) method: String,
    pub(super) photons: u64,
    pub(super) batches: usize,
    pub(super) planes: Vec<StoredPlane>,
    files: BTreeMap<String, String>,
}

/// The numbers of a plane in `summary.json` that `diff` needs. If a number does not exist, it is
/// null in the file.
#[derive(Debug, Deserialize)]
pub(super) struct StoredPlane {
    pub(super) name: String,
    pub(super) class: String,
    pub(super) in_window: u64,
    /// The effective number of independent real numbers in the noise; results of earlier versions
    /// do not have it.
    #[serde(default)]
    noise_dof: Option<f64>,
    pub(super) quadrature_error: Option<f64>,
    pub(super) parameters: Vec<StoredParameter>,
    pub(super) slope: StoredNumber,
}

/// A measured number with its standard error.
#[derive(Debug, Deserialize)]
pub(super) struct StoredNumber {
    measured: Option<f64>,
    error: Option<f64>,
}

/// A parameter of a first-order chain.
#[derive(Debug, Deserialize)]
pub(super) struct StoredParameter {
    pub(super) name: String,
    pub(super) unit: String,
    scene: Option<f64>,
    #[serde(flatten)]
    pub(super) number: StoredNumber,
    detectable: Option<f64>,
}

impl StoredNumber {
    pub(super) fn estimate(&self, batches: usize) -> Option<Estimate> {
        Some(Estimate {
            value: self.measured?,
            error: self.error?,
            batches,
        })
    }
}

impl StoredParameter {
    /// Checks whether the photons determine the parameter, so that a change as large as the
    /// parameter itself would be detected.
    pub(super) fn is_determined(&self) -> bool {
        let (Some(scene), Some(detectable)) = (self.scene, self.detectable) else {
            return false;
        };
        scene.abs() < 1e-12 || detectable <= scene.abs()
    }
}

/// The slices of a plane, as stored in a result folder.
#[derive(Debug)]
pub(super) struct StoredSlices {
    pub(super) axes: [Array1<f64>; 3],
    pub(super) grid: SliceGrid,
    pub(super) sample: Sample,
    /// The predicted slices, [azimuth, ρ ≥ 0, ν].
    pub(super) predicted: Array3<Complex>,
}

impl StoredResult {
    pub(super) fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(SUMMARY);
        let shown = path.display();
        let fault = |what: String| Failure::bad_input(format!("{shown}: {what}"));
        if !path.is_file() {
            return Err(no_result(folder));
        }
        let bytes = read_below(folder, SUMMARY, MAX_INDEX_BYTES)
            .map_err(|e| Failure::bad_input(format!("cannot read {shown}: {e}")))?;
        sealed::check_format(&bytes).map_err(fault)?;
        let index: ResultIndex = serde_json::from_slice(&bytes)
            .map_err(|e| fault(format!("the file is not a summary of a run: {e}")))?;
        sealed::check_seal(&bytes).map_err(fault)?;
        if index.batches < 3 {
            return Err(fault(format!(
                "batches: {}; must be at least 3",
                index.batches
            )));
        }
        Ok(Self {
            folder: folder.to_owned(),
            index,
        })
    }

    pub(super) fn plane(&self, name: &str) -> Option<&StoredPlane> {
        self.index.planes.iter().find(|plane| plane.name == name)
    }

    /// The hash of the file with a plane's arrays.
    pub(super) fn hash(&self, plane: &str) -> Option<&String> {
        self.index.files.get(&slices_of(plane))
    }

    /// The slices of a plane from the plane's arrays.
    pub(super) fn slices(&self, plane: &StoredPlane) -> Result<StoredSlices, Failure> {
        let name = slices_of(&plane.name);
        let bytes = listed_bytes(&self.folder, SUMMARY, &self.index.files, &name)?;
        let mut file = NpzFile::new(self.folder.join(&name), bytes)?;
        let [azimuth, rho, nu] = ["azimuth", "rho", "nu"].map(|name| file.axis(name));
        let axes = [azimuth?, rho?, nu?];
        let lengths = [0, 1, 2].map(|i| axes[i].len());
        let numbers = lengths.iter().try_fold(1_usize, |n, l| n.checked_mul(*l));
        if !numbers.is_some_and(|n| n > 0 && file.may_hold(n)) {
            return Err(file.fault("measured", "the file is too short for its axes"));
        }
        let grid = SliceGrid {
            azimuths: lengths[0],
            rho: axis(&mut file, "rho", &axes[1])?,
            nu: axis(&mut file, "nu", &axes[2])?,
        };
        let sigma = if file.has("measured_sigma") {
            "measured_sigma"
        } else {
            "sigma"
        };
        let sigma: Array3<f64> = file.array(sigma, lengths)?;
        if sigma.iter().any(|sigma| *sigma < 0.0) {
            return Err(file.fault("sigma", "the array holds a number below 0"));
        }
        let measured: Array3<Complex> = file.array("measured", lengths)?;
        let predicted: Array3<Complex> = file.array("predicted", lengths)?;
        Ok(StoredSlices {
            axes,
            grid,
            sample: Sample {
                mean: half(&measured, &grid),
                sigma: half(&sigma, &grid),
                noise_dof: plane.noise_dof.filter(|dof| *dof > 0.0),
                batches: self.index.batches,
            },
            predicted: half(&predicted, &grid),
        })
    }
}

/// The half with ρ ≥ 0 of an array [azimuth, ρ, ν].
fn half<A: Clone>(array: &Array3<A>, grid: &SliceGrid) -> Array3<A> {
    let (_, half) = array.view().split_at(Axis(1), grid.rho.half);
    half.to_owned()
}

fn slices_of(plane: &str) -> String {
    format!("{plane}/slices.npz")
}

/// Reads an axis with an odd number of frequencies and zero in the middle.
fn axis(file: &mut NpzFile, name: &str, values: &Array1<f64>) -> Result<FrequencyAxis, Failure> {
    let half = values.len() / 2;
    if values.len().is_multiple_of(2) || values[half].abs() > 0.0 {
        return Err(file.fault(name, "must be an odd number of frequencies around 0"));
    }
    let spacing = values.get(half + 1).copied().unwrap_or(1.0);
    Ok(FrequencyAxis { half, spacing })
}
