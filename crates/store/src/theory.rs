//! Reads predictions of any program from NPZ files, and writes them.
//!
//! docs/own-theory.md lists the arrays. Radiance is real, so a slice is its own conjugate at −ρ
//! and −ν.

use crate::Failure;
use crate::npz::{Npz, NpzFile, Number, half_axes};
use crate::predictions::stacked;
use etendue_compare::{Class, PredictedParameter, Prediction};
use etendue_field::{
    Complex, Projection, ProjectionGrid, SliceGrid, Slices, VirtualPlane, modulus, percent,
};
use etendue_spectrum::PROJECTION_BINS;
use ndarray::{Array1, Array3, ArrayD, ArrayViewD, Axis, Ix3, IxDyn};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::Path;

/// The name of the file of predictions in a result folder.
pub const FILE: &str = "predictions.npz";

/// The arrays of a plane.
const ARRAYS: [&str; 10] = [
    "slices",
    "replicates",
    "sigma",
    "azimuth",
    "rho",
    "nu",
    "parameters",
    "units",
    "values",
    "derivatives",
];
/// The largest number of replicates, and of parameters.
const MAX_COUNT: u64 = 1000;
/// Slices must be smaller, so that their powers are finite.
const MAX_SLICE: f64 = 1e100;
/// The largest relative difference between two arrays that are said to be equal.
const SAME: f64 = 1e-9;

/// Reads the prediction of each plane from a file.
pub fn read(path: &Path, planes: &[VirtualPlane]) -> Result<Vec<Prediction>, Failure> {
    parse(path, regular_bytes(path)?, planes)
}

/// The bytes of a regular file.
fn regular_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let unread =
        |why: &dyn Display| Failure::bad_input(format!("cannot read {}: {why}", path.display()));
    // A device could be read for ever.
    if std::fs::metadata(path).is_ok_and(|of| !of.is_file()) {
        return Err(unread(&"it is no regular file"));
    }
    std::fs::read(path).map_err(|e| unread(&e))
}

/// The prediction of each plane in the bytes of a file, which messages name as `path`.
pub fn parse(
    path: &Path,
    bytes: Vec<u8>,
    planes: &[VirtualPlane],
) -> Result<Vec<Prediction>, Failure> {
    let mut file = opened(path, bytes, planes)?;
    let each = planes.iter();
    each.map(|plane| TheoryArrays::new(&mut file, plane).prediction(path))
        .collect()
}

/// A plane that another program has measured, in the form of a prediction.
#[derive(Clone, Debug)]
pub struct MeasuredArrays {
    /// Number of the plane.
    pub plane: usize,
    /// The slices and their replicates.
    pub prediction: Prediction,
    /// The errors of the slices, [azimuth, ρ ≥ 0, ν].
    pub sigma: Option<Array3<f64>>,
}

/// Reads those of `planes` that a file of another program holds.
pub fn measured(path: &Path, planes: &[VirtualPlane]) -> Result<Vec<MeasuredArrays>, Failure> {
    let mut file = opened(path, regular_bytes(path)?, planes)?;
    let names = file.names();
    let is_in = |plane: &VirtualPlane| {
        let parts = names.iter().filter_map(|name| name.rsplit_once('/'));
        parts.into_iter().any(|(of, _)| of == plane.name)
    };
    let found = planes.iter().enumerate().filter(|(_, plane)| is_in(plane));
    let found = found.map(|(i, plane)| {
        let mut arrays = TheoryArrays::new(&mut file, plane);
        Ok(MeasuredArrays {
            plane: i,
            prediction: arrays.prediction(path)?,
            sigma: arrays.sigma()?,
        })
    });
    let found: Vec<_> = found.collect::<Result<_, Failure>>()?;
    match found.is_empty() {
        true => Err(Failure::bad_input(format!("{}: no arrays", path.display()))),
        false => Ok(found),
    }
}

/// The file with these bytes, which holds only arrays of planes.
fn opened(path: &Path, bytes: Vec<u8>, planes: &[VirtualPlane]) -> Result<NpzFile, Failure> {
    let file = NpzFile::new(path.to_owned(), bytes)?;
    let is_known = |name: &String| {
        let parts = name.rsplit_once('/');
        parts.is_some_and(|(plane, array)| {
            ARRAYS.contains(&array) && planes.iter().any(|of| of.name == plane)
        })
    };
    if let Some(other) = file.names().into_iter().find(|name| !is_known(name)) {
        let planes: Vec<&str> = planes.iter().map(|plane| plane.name.as_str()).collect();
        let allowed = format!(
            "is not known; allowed: PLANE/ARRAY, where PLANE is one of {}, and ARRAY one of {}",
            planes.join(", "),
            ARRAYS.join(", ")
        );
        return Err(file.fault(&other, allowed));
    }
    Ok(file)
}

/// The file of the predictions of planes.
pub fn bytes(planes: &[VirtualPlane], predictions: &[Prediction]) -> Result<Vec<u8>, Failure> {
    let mut file = Npz::default();
    for (plane, prediction) in planes.iter().zip(predictions) {
        file = with_plane(file, &plane.name, prediction)?;
    }
    file.bytes()
}

/// Adds the prediction of a plane to a file.
fn with_plane(mut file: Npz, plane: &str, prediction: &Prediction) -> Result<Npz, Failure> {
    let Prediction {
        slices,
        replicates,
        parameters,
        ..
    } = prediction;
    let name = |array: &str| format!("{plane}/{array}");
    let grid = &slices.grid;
    file = file.add(&name("slices"), &slices.half)?;
    for (axis, values) in half_axes(grid) {
        file = file.add(&name(axis), &values)?;
    }
    if !replicates.is_empty() {
        file = file.add(&name("replicates"), &stacked(grid, replicates))?;
    } else if let Some(error) = prediction.error() {
        // The error of a rule is known as a whole, and not for each frequency.
        let sigma = error * slices.norm() / (slices.half.len() as f64).sqrt();
        let sigma = Array3::from_elem(grid.half_shape(), sigma);
        file = file.add(&name("sigma"), &sigma)?;
    }
    let texts = |of: fn(&PredictedParameter) -> &String| -> Vec<String> {
        parameters.iter().map(of).cloned().collect()
    };
    let values: Array1<f64> = parameters.iter().map(|one| one.value).collect();
    let derivatives = parameters.iter().map(|one| &one.derivative);
    file.add_texts(&name("parameters"), &texts(|one| &one.name))?
        .add_texts(&name("units"), &texts(|one| &one.unit))?
        .add(&name("values"), &values)?
        .add(&name("derivatives"), &stacked(grid, derivatives))
}

/// The arrays of one plane in a file.
struct TheoryArrays<'a> {
    file: &'a mut NpzFile,
    plane: &'a VirtualPlane,
}

impl<'a> TheoryArrays<'a> {
    fn new(file: &'a mut NpzFile, plane: &'a VirtualPlane) -> Self {
        Self { file, plane }
    }

    fn prediction(&mut self, path: &Path) -> Result<Prediction, Failure> {
        self.check_axes()?;
        let plane = self.plane;
        let replicates = self.stack("replicates", 3)?;
        let slices = self.slices(&replicates)?;
        let quadrature_error = self.error(&slices, &replicates)?;
        let grid = ProjectionGrid::new(&plane.window, PROJECTION_BINS);
        let values = slices.light_field(0, grid.bins, [grid.half_x, grid.half_u]);
        Ok(Prediction {
            class: Class::Exact,
            steps: vec![format!("theory  {}", path.display())],
            quadrature_error,
            mesh_error: None,
            rule_error: None,
            first_order: None,
            replicates,
            unblocked: slices.at_zero().abs(),
            projection: Projection { grid, values },
            parameters: self.parameters()?,
            depth: None,
            cuts: Vec::new(),
            slices,
        })
    }

    /// The slices, which are the mean of the replicates if there are any.
    fn slices(&mut self, replicates: &[Slices]) -> Result<Slices, Failure> {
        let mut mean = Slices::zeros(self.plane.grid);
        for one in replicates {
            mean.half += &one.half;
        }
        mean.half /= Complex::from(replicates.len().max(1) as f64);
        let name = self.name("slices");
        if !replicates.is_empty() && !self.file.has(&name) {
            return Ok(mean);
        }
        if !self.file.has(&name) {
            return Err(self.file.fault(&name, "is missing, and so are replicates"));
        }
        let all = self.array("slices", None)?;
        let slices = self.folded("slices", all.view())?;
        if !replicates.is_empty() && mean.relative_difference(&slices) > SAME {
            return Err(self.file.fault(&name, "must be the mean of the replicates"));
        }
        Ok(slices)
    }

    /// The relative error of the slices, if the file states errors.
    fn error(&mut self, slices: &Slices, replicates: &[Slices]) -> Result<Option<f64>, Failure> {
        let (name, size) = (self.name("sigma"), slices.norm());
        if size <= 0.0 {
            return Ok(None);
        }
        if !replicates.is_empty() {
            if self.file.has(&name) {
                let what = "must be left out, because replicates state the errors";
                return Err(self.file.fault(&name, what));
            }
            let squares = replicates.iter().map(|one| {
                let apart = one.relative_difference(slices);
                apart * apart
            });
            let count = replicates.len() as f64;
            let error = squares.sum::<f64>() / (count * (count - 1.0));
            return Ok(Some(error.sqrt()));
        }
        let sum = |sigma: Array3<f64>| sigma.iter().map(|sigma| sigma * sigma).sum::<f64>();
        Ok(self.sigma()?.map(|sigma| sum(sigma).sqrt() / size))
    }

    /// The errors of the slices, [azimuth, ρ ≥ 0, ν], if the file states them.
    fn sigma(&mut self) -> Result<Option<Array3<f64>>, Failure> {
        let name = self.name("sigma");
        if !self.file.has(&name) {
            return Ok(None);
        }
        let sigma: ArrayD<f64> = self.array("sigma", None)?;
        if sigma.iter().any(|sigma| *sigma < 0.0) {
            return Err(self.file.fault(&name, "must not be negative"));
        }
        Ok(Some(self.half(sigma.view())))
    }

    fn parameters(&mut self) -> Result<Vec<PredictedParameter>, Failure> {
        let name = self.name("parameters");
        let derivatives = self.stack("derivatives", 0)?;
        if !self.file.has(&name) {
            return if derivatives.is_empty() {
                Ok(Vec::new())
            } else {
                Err(self
                    .file
                    .fault(&name, "is missing, but there are derivatives"))
            };
        }
        let names = self.file.texts(&name)?;
        let count = names.len();
        let same = |found: usize, array: &str| {
            let what = format!("{count} names, but {found} {array}");
            if found == count { Ok(()) } else { Err(what) }
        };
        let fault = |what| self.file.fault(&name, what);
        same(derivatives.len(), "derivatives").map_err(fault)?;
        let values: Array1<f64> = self.file.array(&self.name("values"), [count])?;
        let units = self.name("units");
        let units = match self.file.has(&units) {
            true => self.file.texts(&units)?,
            false => vec![String::new(); count],
        };
        same(units.len(), "units").map_err(|what| self.file.fault(&name, what))?;
        let each = names.into_iter().zip(units).zip(values).zip(derivatives);
        let each = each.map(|(((name, unit), value), derivative)| PredictedParameter {
            name,
            unit,
            value,
            derivative,
        });
        Ok(each.collect())
    }

    fn name(&self, array: &str) -> String {
        format!("{}/{array}", self.plane.name)
    }

    /// Checks the axes that the file has.
    fn check_axes(&mut self) -> Result<(), Failure> {
        let grid = &self.plane.grid;
        let whole = Array1::from(grid.rho.values());
        for (array, values) in half_axes(grid) {
            let name = self.name(array);
            if !self.file.has(&name) {
                continue;
            }
            let found = self.file.axis(&name)?;
            let last = values[values.len() - 1];
            let equals = |values: &Array1<f64>| {
                let mut pairs = found.iter().zip(values);
                found.len() == values.len() && pairs.all(|(a, b)| (a - b).abs() <= SAME * last)
            };
            let is_right = equals(&values) || array == "rho" && equals(&whole);
            if !is_right {
                let (plane, count) = (&self.plane.name, values.len());
                let what =
                    format!("must be the axis of plane {plane}: {count} values up to {last}");
                return Err(self.file.fault(&name, what));
            }
        }
        Ok(())
    }

    /// An array with the axes [azimuth, ρ, ν], with all ρ or with ρ ≥ 0, and with an axis of
    /// `counts` items before them if it is given.
    fn array<A: Number>(
        &mut self,
        array: &str,
        counts: Option<RangeInclusive<u64>>,
    ) -> Result<ArrayD<A>, Failure> {
        let name = self.name(array);
        let shape = self.file.shape(&name)?;
        let (first, rest) = shape.split_at(usize::from(counts.is_some()).min(shape.len()));
        let is_counted = counts
            .as_ref()
            .is_none_or(|counts| first.first().is_some_and(|count| counts.contains(count)));
        let SliceGrid { azimuths, rho, nu } = self.plane.grid;
        let lengths = [rho.count(), rho.half + 1].map(|rho| [azimuths, rho, nu.count()]);
        let fits = |lengths: &[usize; 3]| rest.iter().copied().eq(lengths.map(|n| n as u64));
        let Some(lengths) = lengths
            .iter()
            .find(|lengths| fits(lengths))
            .filter(|_| is_counted)
        else {
            let before = counts.map_or(String::new(), |counts| {
                format!("{} to {}, then ", counts.start(), counts.end())
            });
            let what = format!(
                "its shape is {shape:?}; must be {before}{:?} or {:?}: azimuth, ρ (all or ρ ≥ 0), ν",
                lengths[0], lengths[1]
            );
            return Err(self.file.fault(&name, what));
        };
        let count = first
            .iter()
            .map(|count| usize::try_from(*count).unwrap_or(usize::MAX));
        let shape: Vec<usize> = count.chain(lengths.iter().copied()).collect();
        self.file.array(&name, IxDyn(&shape))
    }

    /// The half with ρ ≥ 0 of the last three axes of an array.
    fn half<A: Copy>(&self, of: ArrayViewD<'_, A>) -> Array3<A> {
        let all = of.into_dimensionality::<Ix3>().expect("three axes");
        let grid = &self.plane.grid;
        let is_whole = all.dim().1 == grid.rho.count() && grid.rho.half > 0;
        let first = if is_whole { grid.rho.half } else { 0 };
        all.slice_axis(Axis(1), (first..).into()).to_owned()
    }

    /// Slices from an array with the axes [azimuth, ρ, ν].
    fn folded(&self, array: &str, all: ArrayViewD<'_, Complex>) -> Result<Slices, Failure> {
        if all.iter().any(|value| modulus(*value) >= MAX_SLICE) {
            let what = format!("has numbers above {MAX_SLICE:.0e}");
            return Err(self.file.fault(&self.name(array), what));
        }
        let slices = Slices {
            grid: self.plane.grid,
            half: self.half(all.view()),
        };
        let full = slices.full();
        if all.len() == full.len() {
            let pairs = all.iter().zip(&full);
            let apart: f64 = pairs.map(|(a, b)| (a - b).norm_sqr()).sum();
            let size: f64 = full.iter().map(|value| value.norm_sqr()).sum();
            if apart > SAME * SAME * size {
                let what = format!(
                    "must be the conjugate of itself at −ρ and −ν, because radiance is real; it is {} off",
                    percent((apart / size).sqrt(), 3)
                );
                return Err(self.file.fault(&self.name(array), what));
            }
        }
        Ok(slices)
    }

    /// Several slices, of which there are at least `least`. Returns none if the file does not have
    /// the array.
    fn stack(&mut self, array: &str, least: u64) -> Result<Vec<Slices>, Failure> {
        if !self.file.has(&self.name(array)) {
            return Ok(Vec::new());
        }
        let all = self.array(array, Some(least..=MAX_COUNT))?;
        all.outer_iter()
            .map(|one| self.folded(array, one))
            .collect()
    }
}
