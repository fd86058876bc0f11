//! The data of a figure: arrays, a table of its curves and bars, and a description of both.

use crate::scene_run::Shot;
use etendue_compare::PlaneComparison;
use etendue_field::{ProjectionGrid, Slices, VirtualPlane};
use etendue_figures::{DrawnPicture, Figure};
use etendue_store::Failure;
use etendue_store::npz::{Npz, Number};
use ndarray::{Array2, ArrayBase, Axis, Data, Dimension, arr1};
use std::collections::BTreeSet;

/// The file that describes each array of `figure.npz` and each column of `figure.csv`.
pub(crate) const DESCRIPTION: &str = "columns.csv";
/// The columns of [`DESCRIPTION`].
const HEADER: [&str; 5] = ["file", "name", "unit", "axes", "meaning"];

/// The arrays of a plane: name, unit, axes and meaning.
const ARRAYS: [[&str; 4]; 16] = [
    [
        "light_field",
        FIELD,
        "x, u",
        "measured light field, integrated over y and v with the window; cells fill ± half_widths",
    ],
    [
        "light_field_sigma",
        FIELD,
        "x, u",
        "standard error of light_field",
    ],
    [
        "half_widths",
        "m; slope or rad",
        "2",
        "half-widths of the light field in x and u",
    ],
    [
        "measured",
        POWER,
        "ρ, ν",
        "measured |S|², averaged over azimuths; shot noise is subtracted, so it may be below 0",
    ],
    [
        "measured_sigma",
        POWER,
        "ρ, ν",
        "standard error of measured",
    ],
    [
        "predicted",
        POWER,
        "ρ, ν",
        "predicted |S|², averaged over azimuths",
    ],
    [
        "measured_slice",
        SPECTRUM,
        "ρ, ν",
        "measured S at azimuth 0, complex",
    ],
    [
        "measured_slice_sigma",
        SPECTRUM,
        "ρ, ν",
        "standard deviation of measured_slice, root of its mean squared modulus",
    ],
    [
        "predicted_slice",
        SPECTRUM,
        "ρ, ν",
        "predicted S at azimuth 0, complex",
    ],
    ["rho", "cycles/m", "ρ", "spatial frequencies"],
    ["nu", PER_ANGLE, "ν", "angular frequencies"],
    [
        "full_radial",
        POWER,
        RINGS,
        "measured mean of |ℓ̂|² over rings; shot noise is subtracted",
    ],
    [
        "full_radial_sigma",
        POWER,
        RINGS,
        "standard error of full_radial",
    ],
    [
        "full_radial_predicted",
        POWER,
        RINGS,
        "predicted mean of |ℓ̂|² over rings",
    ],
    [
        "rho_edges",
        "cycles/m",
        "|Ωxy|",
        "edges of the rings in |Ωxy|",
    ],
    [
        "nu_edges",
        PER_ANGLE,
        "|Ωuv|",
        "edges of the rings in |Ωuv|",
    ],
];
const FIELD: &str = "W m⁻² sr⁻¹ m";
const SPECTRUM: &str = "W m⁻² sr⁻¹ m²";
const POWER: &str = "W² m⁻⁴ sr⁻² m⁴";
const PER_ANGLE: &str = "cycles/slope; on a surface, cycles/rad";
const RINGS: &str = "|Ωxy|, |Ωuv|";

/// The meaning of the pictures of a row that are not arrays of a scene. A row without a name has
/// the name of its quantity.
const ROWS: [(&str, &str); 12] = [
    (
        "2D",
        "power spectrum of the scene in 2D (flatland), computed",
    ),
    (
        "across",
        "measured light field over the second position and the second direction, integrated over the first ones: the inverse transform of the slice at 90°",
    ),
    (
        "difference",
        "radiance less that of the reference, relative to white",
    ),
    (
        "measured",
        "measured power, with the axes and from the planes that the figure states",
    ),
    (
        "off the chain",
        "|measured − first-order chain|, a root mean square over azimuths, in percent of the largest measured modulus",
    ),
    ("phase", "phase of measured_slice; NaN where it is dark"),
    ("power", "|measured_slice|²"),
    (
        "predicted",
        "predicted power, with the axes and from the planes that the figure states",
    ),
    (
        "relative luminance",
        "radiance relative to white, at most 1",
    ),
    ("samples per pixel", "shading samples per pixel, at most 1"),
    ("square", "square of the criterion that the column names"),
    ("theory", "the function that the column names, computed"),
];

/// The meaning of the columns of `figure.csv`; the remaining column is the quantity that the
/// vertical axis shows.
const COLUMNS: [(&str, &str); 8] = [
    ("panel", "title of the panel"),
    ("axis", "quantity along x, with its unit"),
    ("curve", "name of the curve in the key"),
    ("x", "place along x"),
    (
        "standard error",
        "standard error of the value, from batches of photons; 0 for computed values",
    ),
    ("column", "heading of the column above the bar"),
    ("predicted", "predicted height of the bar, in its unit"),
    ("", "value on the vertical axis"),
];

/// Returns the names and contents of the data files of a figure.
pub(crate) fn files(
    figure: &Figure,
    shots: &[Shot],
) -> Result<Vec<(&'static str, Vec<u8>)>, Failure> {
    let mut arrays = Arrays::default();
    for shot in shots {
        for (plane, found) in shot.scene.planes.iter().zip(&shot.planes) {
            let name = format!("{}.{}", shot.scene.name, plane.name);
            arrays.add_plane(&name, plane, found)?;
        }
    }
    for picture in &figure.pictures {
        arrays.add_picture(picture)?;
    }
    let mut files = Vec::new();
    let mut rows = arrays.rows;
    if !rows.is_empty() {
        files.push(("figure.npz", arrays.npz.bytes()?));
    }
    if !figure.csv.is_empty() {
        files.push(("figure.csv", figure.csv.clone().into_bytes()));
        rows.extend(columns(&figure.csv)?);
    }
    files.push((DESCRIPTION, table(rows)?));
    Ok(files)
}

/// Returns the descriptions of the columns of a table.
fn columns(csv: &str) -> Result<Vec<[String; 5]>, Failure> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let header = reader.headers().map_err(Failure::cannot_run)?;
    let described = header.iter().map(|heading| {
        let (name, unit) = heading.split_once(" [").unwrap_or((heading, ""));
        let known = COLUMNS.iter().find(|(name, _)| *name == heading);
        let (_, meaning) = known.unwrap_or(&COLUMNS[COLUMNS.len() - 1]);
        ["figure.csv", name, unit.trim_end_matches(']'), "", meaning].map(str::to_owned)
    });
    Ok(described.collect())
}

fn table(rows: Vec<[String; 5]>) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(HEADER).map_err(Failure::cannot_run)?;
    for row in rows {
        writer.write_record(row).map_err(Failure::cannot_run)?;
    }
    writer.into_inner().map_err(Failure::cannot_run)
}

/// Unit, axes and meaning of an array.
type Words<'a> = [&'a str; 3];

/// Arrays of a figure with their descriptions.
#[derive(Debug, Default)]
struct Arrays {
    npz: Npz,
    rows: Vec<[String; 5]>,
    names: BTreeSet<String>,
    /// The arrays of scenes that a figure may show, which are stored once.
    shown: Vec<Array2<f64>>,
}

impl Arrays {
    fn add<A, S, D>(
        &mut self,
        name: &str,
        array: &ArrayBase<S, D>,
        words: Words<'_>,
    ) -> Result<(), Failure>
    where
        A: Number,
        S: Data<Elem = A>,
        D: Dimension,
    {
        if !self.names.insert(name.to_owned()) {
            let message = format!("two arrays of the figure are named {name}");
            return Err(Failure::cannot_run(message));
        }
        self.npz = std::mem::take(&mut self.npz).add(name, array)?;
        let [unit, axes, meaning] = words;
        self.rows
            .push(["figure.npz", name, unit, axes, meaning].map(str::to_owned));
        Ok(())
    }

    /// Adds an array of [`ARRAYS`].
    fn add_known<A, S, D>(
        &mut self,
        place: &str,
        array: &str,
        of: &ArrayBase<S, D>,
    ) -> Result<(), Failure>
    where
        A: Number,
        S: Data<Elem = A>,
        D: Dimension,
    {
        let known = ARRAYS.iter().find(|[name, ..]| *name == array);
        let [_, unit, axes, meaning] = known.unwrap_or(&[""; 4]);
        self.add(&format!("{place}.{array}"), of, [unit, axes, meaning])
    }

    /// Adds the light field, the radial spectra and the slices at azimuth 0 of a plane, each
    /// measurement with its standard error, and all axes.
    fn add_plane(
        &mut self,
        at: &str,
        plane: &VirtualPlane,
        found: &PlaneComparison,
    ) -> Result<(), Failure> {
        let field = &found.projection.mean;
        let ProjectionGrid { half_x, half_u, .. } = field.grid;
        let [measured, predicted] = [&found.measured, &found.predicted].map(Slices::full);
        let sigma = found.measured_sigma.as_ref().unwrap_or(&found.sigma);
        let sigma = found.measured.grid.unfold_even(sigma.view());
        let zero = Axis(0);
        self.add_known(at, "light_field", &field.values)?;
        self.add_known(at, "light_field_sigma", &found.projection.standard_error)?;
        self.add_known(at, "half_widths", &arr1(&[half_x, half_u]))?;
        self.add_known(at, "measured", &found.radial.power)?;
        self.add_known(at, "measured_sigma", &found.radial.sigma)?;
        self.add_known(at, "predicted", &found.predicted_radial)?;
        self.add_known(at, "measured_slice", &measured.index_axis(zero, 0))?;
        self.add_known(at, "measured_slice_sigma", &sigma.index_axis(zero, 0))?;
        self.add_known(at, "predicted_slice", &predicted.index_axis(zero, 0))?;
        self.add_known(at, "rho", &arr1(&plane.grid.rho.values()))?;
        self.add_known(at, "nu", &arr1(&plane.grid.nu.values()))?;
        self.shown.extend(
            [&field.values, &found.radial.power, &found.predicted_radial].map(Array2::clone),
        );
        if let Some(full) = &found.full_radial {
            self.add_known(at, "full_radial", &full.measured.power)?;
            self.add_known(at, "full_radial_sigma", &full.measured.sigma)?;
            self.add_known(at, "full_radial_predicted", &full.predicted)?;
            self.add_known(at, "rho_edges", &arr1(&full.measured.rho_edges))?;
            self.add_known(at, "nu_edges", &arr1(&full.measured.nu_edges))?;
            self.shown
                .extend([full.measured.power.clone(), full.predicted.clone()]);
        }
        Ok(())
    }

    /// Adds a picture, unless it shows an array of a scene.
    fn add_picture(&mut self, picture: &DrawnPicture) -> Result<(), Failure> {
        let bits = |a: &f64, b: &f64| a.to_bits() == b.to_bits();
        let same = |shown: &Array2<f64>| {
            let both = shown.iter().zip(&picture.values);
            shown.dim() == picture.values.dim() && both.into_iter().all(|(a, b)| bits(a, b))
        };
        if self.shown.iter().any(same) {
            return Ok(());
        }
        let name = format!("figure.{}.{}", word(&picture.row), word(&picture.column));
        let [(x, columns), (y, rows)] = &picture.axes;
        let known = ROWS.iter().find(|(row, _)| *row == picture.row);
        let meaning = known.map_or("", |(_, meaning)| meaning);
        let axes = format!("{x}, {y}");
        self.add(&name, &picture.values, [&picture.unit, &axes, meaning])?;
        for (end, (heading, centers)) in [("x", (x, columns)), ("y", (y, rows))] {
            let (quantity, unit) = heading.split_once(" [").unwrap_or((heading, ""));
            let words = [unit.trim_end_matches(']'), quantity, "centres of cells"];
            self.add(&format!("{name}.{end}"), &arr1(centers), words)?;
        }
        match &picture.sigma {
            Some(sigma) => self.add(
                &format!("{name}.sigma"),
                sigma,
                [&picture.unit, &axes, "standard error of the picture"],
            ),
            None => Ok(()),
        }
    }
}

/// Returns a text as a word: its ASCII letters and digits, in lower case, joined by underscores.
fn word(text: &str) -> String {
    let parts = text.split(|c: char| !c.is_ascii_alphanumeric());
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    parts.join("_").to_lowercase()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use etendue_store::npz::NpzFile;
    use std::collections::BTreeMap;

    /// Checks that a figure has data, that names are unique, that each array and column has a
    /// meaning, and that what photons measured has standard errors.
    pub(crate) fn has_described_data(figure: &str, drawn: &Figure, shots: &[Shot]) {
        let files: BTreeMap<&str, Vec<u8>> = files(drawn, shots).unwrap().into_iter().collect();
        assert!(files.len() > 1, "figure {figure} has no data");
        let mut rows = csv::Reader::from_reader(&files[DESCRIPTION][..]);
        let mut known = BTreeSet::new();
        for row in rows.records() {
            let row = row.unwrap();
            let [file, name, meaning] = [0, 1, 4].map(|i| row[i].to_owned());
            assert!(
                !name.is_empty() && !meaning.is_empty(),
                "figure {figure}: {row:?}"
            );
            assert!(
                known.insert([file, name]),
                "figure {figure}: {row:?} is named twice"
            );
        }
        if let Some(npz) = files.get("figure.npz") {
            has_errors(
                NpzFile::new("figure.npz".into(), npz.clone()).unwrap(),
                shots,
            );
        }
        let Some(table) = files.get("figure.csv") else {
            return;
        };
        let mut table = csv::Reader::from_reader(&table[..]);
        let header = table.headers().unwrap().clone();
        let column = |name: &str| header.iter().position(|heading| heading == name);
        let error = column("standard error").unwrap();
        for row in table.records() {
            let row = row.unwrap(); // Rows of another length would be an error.
            let is_measured = column("curve").is_none_or(|curve| &row[curve] == "photons");
            // S(0)/S(0) has no error.
            let is_norm = column("x").is_some_and(|x| row[x].parse() == Ok(0.0));
            if is_measured && !is_norm {
                assert!(
                    row[error].parse::<f64>().unwrap() > 0.0,
                    "figure {figure}: {row:?}"
                );
            }
        }
    }

    fn has_errors(mut npz: NpzFile, shots: &[Shot]) {
        for shot in shots {
            for (plane, found) in shot.scene.planes.iter().zip(&shot.planes) {
                let mut errors = |name: &str, shape: (usize, usize)| {
                    let name = format!("{}.{}.{name}", shot.scene.name, plane.name);
                    let sigma: Array2<f64> = npz.array(&name, shape).unwrap();
                    let is_dark = found.measured.is_dark();
                    assert!(is_dark || sigma.iter().any(|s| *s > 0.0), "{name}");
                };
                let power = found.radial.power.dim();
                errors("light_field_sigma", found.projection.mean.values.dim());
                errors("measured_sigma", power);
                errors("measured_slice_sigma", power);
                if let Some(full) = &found.full_radial {
                    errors("full_radial_sigma", full.measured.power.dim());
                }
            }
        }
    }

    /// `results/files.md` describes the arrays of planes.
    #[test]
    fn the_page_of_files_names_each_array_of_a_plane() {
        let page = include_str!("../../../results/files.md");
        let (_, figures) = page.split_once("## Figures").unwrap();
        for [name, unit, axes, meaning] in ARRAYS {
            assert!(figures.contains(&format!("`{name}`")), "{name}");
            assert!(![unit, axes, meaning].contains(&""), "{name}");
        }
    }

    fn picture(row: &str, column: &str, value: f64) -> DrawnPicture {
        DrawnPicture {
            row: row.to_owned(),
            column: column.to_owned(),
            unit: String::new(),
            axes: ["u [slope]", "v"].map(|axis| (axis.to_owned(), vec![0.0])),
            values: Array2::from_elem((1, 1), value),
            sigma: None,
        }
    }

    /// Figs. 5, 16 and 17 have no scenes: what they draw is all their data.
    #[test]
    fn a_picture_without_a_scene_is_stored_with_its_axes_and_described() {
        let mut figure = Figure {
            svg: String::new(),
            csv: "panel,x,B [1/m],standard error\n".to_owned(),
            pictures: vec![picture("theory", "(c) G(u, v)", 2.5)],
        };
        has_described_data("of a picture", &figure, &[]);
        let written = files(&figure, &[]).unwrap();
        let mut npz = NpzFile::new("figure.npz".into(), written[0].1.clone()).unwrap();
        let stored: Array2<f64> = npz.array("figure.theory.c_g_u_v", (1, 1)).unwrap();
        assert_eq!(stored, Array2::from_elem((1, 1), 2.5));
        let described = String::from_utf8(written[2].1.clone()).unwrap();
        assert!(described.contains("figure.npz,figure.theory.c_g_u_v.x,slope,u,centres of cells"));
        assert!(described.contains("figure.csv,B,1/m,,value on the vertical axis"));
        // Two arrays of one name would hide each other.
        figure.pictures.push(picture("theory", "(c) G u v", 1.0));
        assert!(files(&figure, &[]).is_err());
    }

    #[test]
    #[should_panic(expected = "surprise")]
    fn a_row_that_nobody_described_is_found() {
        let figure = Figure {
            svg: String::new(),
            csv: String::new(),
            pictures: vec![picture("surprise", "(a)", 1.0)],
        };
        has_described_data("of a picture", &figure, &[]);
    }
}
