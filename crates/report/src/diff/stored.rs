//! Reads result folders for `diff`: every file is verified, and its content is not trusted.

use etendue_compare::{Class, Estimate, Residuals, Sample};
use etendue_field::{Complex, FrequencyAxis, SliceGrid};
use etendue_store::batches::ranged;
use etendue_store::npz::NpzFile;
use etendue_store::stored::ResultFolder;
use etendue_store::{Failure, MEASUREMENT, theory};
use ndarray::{Array1, Array2, Array3, Array4, Axis};
use serde::Deserialize;
use serde_json::Value;
use std::ops::Range;
use std::path::Path;

/// A result folder of `run` or `compare`, or a measurement, by any version of this program.
#[derive(Debug)]
pub(super) struct StoredResult {
    pub(super) index: ResultIndex,
    files: ResultFolder,
}

/// The part of a `summary.json` or `measurement.json` that `diff` needs.
#[derive(Debug, Deserialize)]
pub(super) struct ResultIndex {
    pub(super) scene: String,
    pub(super) scene_hash: String,
    pub(super) scene_file: Value,
    pub(super) version: String,
    pub(super) seed: u64,
    pub(super) method: String,
    pub(super) photons: u64,
    #[serde(deserialize_with = "ranged")]
    pub(super) batches: Range<u32>,
    /// The planes. A measurement does not list its planes, so they have no numbers.
    #[serde(default)]
    pub(super) planes: Vec<StoredPlane>,
}

/// The numbers of a plane in `summary.json` that `diff` needs. If a number does not exist, it is
/// null in the file.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct StoredPlane {
    pub(super) name: String,
    pub(super) class: String,
    in_window: u64,
    /// The effective number of independent real numbers in the noise; results of earlier versions
    /// do not have it.
    noise_dof: Option<f64>,
    pub(super) quadrature_error: Option<f64>,
    pub(super) parameters: Vec<StoredParameter>,
    pub(super) slope: StoredNumber,
}

/// A measured number with its standard error.
#[derive(Debug, Default, Deserialize)]
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

impl StoredPlane {
    /// Checks whether the prediction has no error of its own.
    fn is_closed_form(&self) -> bool {
        self.quadrature_error.is_none() && self.class == Class::Exact.to_string()
    }
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
    /// The number of photons in the window.
    pub(super) in_window: u64,
    /// The predicted slices, [azimuth, ρ ≥ 0, ν], if the result has a prediction.
    pub(super) predicted: Option<Array3<Complex>>,
    /// Whether the prediction has no error of its own.
    pub(super) is_closed_form: bool,
}

/// The batches of a plane, as stored in a result folder.
#[derive(Debug)]
pub(super) struct StoredBatches {
    /// The slices of each batch, [azimuth, ρ ≥ 0, ν].
    pub(super) slices: Vec<Array3<Complex>>,
    in_window: u64,
}

impl StoredResult {
    pub(super) fn read(folder: &Path) -> Result<Self, Failure> {
        let files = ResultFolder::read(folder)?;
        let path = folder.join(files.name);
        let fault = |what: String| Failure::bad_input(format!("{}: {what}", path.display()));
        let mut index: ResultIndex = serde_json::from_slice(&files.index)
            .map_err(|e| fault(format!("the file is not a summary of a run: {e}")))?;
        if index.batches.len() < 3 {
            return Err(fault(format!(
                "batches: {}; must be at least 3",
                index.batches.len()
            )));
        }
        if files.name == MEASUREMENT {
            let planes = index.scene_file["planes"].as_array();
            let planes = planes.into_iter().flatten();
            let names = planes.filter_map(|plane| plane["name"].as_str());
            let planes = names.map(|name| StoredPlane {
                name: name.to_owned(),
                ..StoredPlane::default()
            });
            index.planes = planes.collect();
        }
        Ok(Self { index, files })
    }

    pub(super) fn folder(&self) -> &Path {
        &self.files.folder
    }

    fn lists(&self, name: &str) -> bool {
        self.files.hash(name).is_some()
    }

    pub(super) fn plane(&self, name: &str) -> Option<&StoredPlane> {
        self.index.planes.iter().find(|plane| plane.name == name)
    }

    /// The hash of the file with a plane's arrays.
    pub(super) fn hash(&self, plane: &str) -> Option<&String> {
        self.files.hash(&self.slices_of(plane))
    }

    fn slices_of(&self, plane: &str) -> String {
        let slices = format!("{plane}/slices.npz");
        match self.lists(&slices) || !self.has_batches() {
            true => slices,
            false => batches_of(plane),
        }
    }

    /// Checks whether the folder has the batches of its planes.
    pub(super) fn has_batches(&self) -> bool {
        let mut planes = self.index.planes.iter();
        planes.all(|plane| self.lists(&batches_of(&plane.name)))
    }

    /// The batches of a plane, [batch, azimuth, ρ ≥ 0, ν].
    pub(super) fn batches(&self, plane: &str, grid: &SliceGrid) -> Result<StoredBatches, Failure> {
        let mut file = self.open(&batches_of(plane))?;
        let [azimuths, rho, nu] = grid.half_shape();
        let count = self.index.batches.len();
        check_length(&file, "slices", &[count, azimuths, rho, nu])?;
        let tally: Array2<u64> = file.array("tally", [count, 3])?;
        let slices: Array4<Complex> = file.array("slices", [count, azimuths, rho, nu])?;
        Ok(StoredBatches {
            slices: slices.outer_iter().map(|one| one.to_owned()).collect(),
            in_window: tally
                .column(1)
                .iter()
                .fold(0, |sum, n| sum.saturating_add(*n)),
        })
    }

    /// The file of predictions that a run saves beside its batches.
    pub(super) fn predictions(&self) -> Result<Option<NpzFile>, Failure> {
        let is_listed = self.lists(theory::FILE);
        is_listed.then(|| self.open(theory::FILE)).transpose()
    }

    fn open(&self, name: &str) -> Result<NpzFile, Failure> {
        NpzFile::new(self.folder().join(name), self.files.bytes(name)?)
    }

    /// The slices of a plane from the plane's arrays.
    pub(super) fn slices(&self, plane: &StoredPlane) -> Result<StoredSlices, Failure> {
        let mut file = self.open(&self.slices_of(&plane.name))?;
        let [azimuth, rho, nu] = ["azimuth", "rho", "nu"].map(|name| file.axis(name));
        let axes = [azimuth?, rho?, nu?];
        if self.slices_of(&plane.name) == batches_of(&plane.name) {
            return self.slices_of_batches(plane, file, axes);
        }
        let lengths = [0, 1, 2].map(|i| axes[i].len());
        check_length(&file, "measured", &lengths)?;
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
                batches: self.index.batches.len(),
            },
            in_window: plane.in_window,
            predicted: Some(half(&predicted, &grid)),
            is_closed_form: plane.is_closed_form(),
        })
    }

    /// The slices of a plane of which only batches are stored.
    fn slices_of_batches(
        &self,
        plane: &StoredPlane,
        mut file: NpzFile,
        [azimuth, half, nu]: [Array1<f64>; 3],
    ) -> Result<StoredSlices, Failure> {
        let below = half.iter().skip(1).rev().map(|rho| -rho);
        let rho: Array1<f64> = below.chain(half.iter().copied()).collect();
        let grid = SliceGrid {
            azimuths: azimuth.len(),
            rho: axis(&mut file, "rho", &rho)?,
            nu: axis(&mut file, "nu", &nu)?,
        };
        let StoredBatches { slices, in_window } = self.batches(&plane.name, &grid)?;
        let array = format!("{}/slices", plane.name);
        let predicted = self
            .predictions()?
            .map(|mut file| file.array(&array, grid.half_shape()));
        let residuals = Residuals::of(grid, slices);
        let mean = residuals.mean();
        Ok(StoredSlices {
            axes: [azimuth, rho, nu],
            grid,
            sample: Sample {
                sigma: residuals.variance().mapv(f64::sqrt),
                noise_dof: residuals.without(&mean).noise_dof(),
                batches: self.index.batches.len(),
                mean,
            },
            in_window,
            predicted: predicted.transpose()?,
            is_closed_form: plane.is_closed_form(),
        })
    }
}

/// The half with ρ ≥ 0 of an array [azimuth, ρ, ν].
fn half<A: Clone>(array: &Array3<A>, grid: &SliceGrid) -> Array3<A> {
    let (_, half) = array.view().split_at(Axis(1), grid.rho.half);
    half.to_owned()
}

fn batches_of(plane: &str) -> String {
    format!("{plane}/batches.npz")
}

/// Fails if a file is too short for an array with axes of these lengths.
fn check_length(file: &NpzFile, array: &str, lengths: &[usize]) -> Result<(), Failure> {
    let numbers = lengths.iter().try_fold(1_usize, |n, l| n.checked_mul(*l));
    if numbers.is_some_and(|n| n > 0 && file.may_hold(n)) {
        Ok(())
    } else {
        Err(file.fault(array, "the file is too short for its axes"))
    }
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
