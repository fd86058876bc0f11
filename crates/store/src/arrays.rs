//! Writes the array files of one plane: `slices.npz`, `radial.npz` and `radial.exr`.

use crate::exr::{Part, exr};
use crate::npz::{Npz, azimuths};
use crate::{Failure, Results};
use etendue_compare::PlaneComparison;
use etendue_field::Complex;
use ndarray::{Array1, Array2, Array3};
use serde_json::{Value, json};

/// The file names of a plane.
pub const NAMES: [&str; 3] = ["slices.npz", "radial.npz", "radial.exr"];

/// Writes the files; `made_from` describes their source.
pub fn write(
    results: &mut Results,
    made_from: Value,
    plane: &PlaneComparison,
) -> Result<(), Failure> {
    let name = &plane.report.name;
    results.write(&format!("{name}/slices.npz"), &slices(plane)?)?;
    results.write(&format!("{name}/radial.npz"), &radial(plane)?)?;
    let exr = radial_exr(made_from, plane)?;
    results.write(&format!("{name}/radial.exr"), &exr)
}

/// The slices of a plane, as in `slices.npz`.
#[derive(Debug)]
pub struct SliceArrays {
    /// Azimuths, radians.
    pub azimuth: Array1<f64>,
    /// The measured spectrum, [azimuth, ρ, ν].
    pub measured: Array3<Complex>,
    /// The predicted spectrum.
    pub predicted: Array3<Complex>,
    /// Standard deviation of |measured − predicted| if the prediction is true.
    pub sigma: Array3<f64>,
    /// Standard deviation of |measured| alone; `None` if it equals `sigma`. The two differ if the
    /// prediction also has noise.
    pub measured_sigma: Option<Array3<f64>>,
    /// Frequencies ρ, cycles per metre.
    pub rho: Array1<f64>,
    /// Frequencies ν, cycles per unit of u.
    pub nu: Array1<f64>,
}

impl SliceArrays {
    /// The slices of a plane.
    #[must_use]
    pub fn of(plane: &PlaneComparison) -> Self {
        let grid = plane.measured.grid;
        let measured_sigma = plane.measured_sigma.as_ref();
        Self {
            azimuth: azimuths(&grid),
            measured: plane.measured.full(),
            predicted: plane.predicted.full(),
            sigma: grid.unfold_even(plane.sigma.view()),
            measured_sigma: measured_sigma.map(|sigma| grid.unfold_even(sigma.view())),
            rho: Array1::from(grid.rho.values()),
            nu: Array1::from(grid.nu.values()),
        }
    }
}

fn slices(plane: &PlaneComparison) -> Result<Vec<u8>, Failure> {
    let arrays = SliceArrays::of(plane);
    let npz = Npz::default()
        .add("azimuth", &arrays.azimuth)?
        .add("measured", &arrays.measured)?
        .add("predicted", &arrays.predicted)?
        .add("sigma", &arrays.sigma)?
        .add("rho", &arrays.rho)?
        .add("nu", &arrays.nu)?;
    match &arrays.measured_sigma {
        Some(sigma) => npz.add("measured_sigma", sigma)?.bytes(),
        None => npz.bytes(),
    }
}

fn radial(plane: &PlaneComparison) -> Result<Vec<u8>, Failure> {
    let grid = plane.measured.grid;
    Npz::default()
        .add("power", &plane.radial.power)?
        .add("predicted_power", &plane.predicted_radial)?
        .add("sigma", &plane.radial.sigma)?
        .add("sigma_predicted", &plane.radial_sigma)?
        .add("shot_noise", &plane.radial.shot_noise)?
        .add("rho", &Array1::from(grid.rho.values()))?
        .add("nu", &Array1::from(grid.nu.values()))?
        .bytes()
}

/// The measured minus the predicted radial power, divided by its standard deviation if the
/// prediction is true.
pub fn radial_z(plane: &PlaneComparison) -> Array2<f64> {
    z(
        &plane.radial.power,
        &plane.predicted_radial,
        &plane.radial_sigma,
    )
}

/// Returns (measured − predicted) / sigma, or NaN where there is no error estimate because no
/// photon arrived.
pub fn z(measured: &Array2<f64>, predicted: &Array2<f64>, sigma: &Array2<f64>) -> Array2<f64> {
    let mut z = measured - predicted;
    z.zip_mut_with(sigma, |z, s| *z = if *s > 0.0 { *z / s } else { f64::NAN });
    z
}

/// An OpenEXR file of four parts, with ρ to the right and ν upwards.
fn radial_exr(mut made_from: Value, plane: &PlaneComparison) -> Result<Vec<u8>, Failure> {
    let power = &plane.radial.power;
    let difference = power - &plane.predicted_radial;
    let parts = [
        ("measured", power),
        ("predicted", &plane.predicted_radial),
        ("difference", &difference),
        ("z", &radial_z(plane)),
    ];
    let (width, height) = power.dim();
    let parts = parts.map(|(name, values)| {
        let rows = (0..height).rev();
        let pixels = rows.flat_map(|j| (0..width).map(move |i| (i, j)));
        #[expect(
            clippy::cast_possible_truncation,
            reason = "EXR viewers expect 32-bit numbers"
        )]
        let samples = pixels.map(|at| values[at] as f32).collect();
        Part { name, samples }
    });
    let grid = plane.measured.grid;
    made_from["plane"] = json!(plane.report.name);
    made_from["rho_max"] = json!(grid.rho.max());
    made_from["nu_max"] = json!(grid.nu.max());
    exr([width, height], Vec::from(parts), &made_from)
}
