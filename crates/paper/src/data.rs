//! The data of a figure: arrays, a table of its curves and bars, and a description of both.

use crate::scene_run::Shot;
use etendue_compare::PlaneComparison;
use etendue_field::{ProjectionGrid, Slices, VirtualPlane};
use etendue_figures::{DrawnPicture, Figure};
use etendue_report::table::csv;
use etendue_store::Failure;
use etendue_store::npz::{Npz, Number};
use ndarray::{Array2, ArrayBase, Axis, Data, Dimension, arr1};
use std::collections::BTreeSet;

/// The file that describes each array of `figure.npz` and each column of `figure.csv`.
pub(crate) const DESCRIPTION: &str = "columns.csv";
/// The columns of [`DESCRIPTION`].
const HEADER: [&str; 5] = ["file", "name", "unit", "axes", "meaning"];

/// The unit, the axes and the meaning of what a figure stores: the arrays of a `plane`; each `row`
/// of pictures that are not arrays of a scene, which has the name of its quantity if it has no
/// name; each `column` of `figure.csv`, of which the one without a name is the quantity that the
/// vertical axis shows.
const WORDS: &str = include_str!("words.csv");

/// The unit, the axes and the meaning of an array, a row or a column; empty if it has none.
fn words_of(kind: &str, name: &str) -> [String; 3] {
    let mut reader = csv::Reader::from_reader(WORDS.as_bytes());
    let mut known = reader.records().filter_map(Result::ok);
    let found = known.find(|word| word[0] == *kind && word[1] == *name);
    found.map_or_else(Default::default, |word| {
        [2, 3, 4].map(|i| word[i].to_owned())
    })
}

/// The names and contents of the data files of a figure.
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
    let rows = rows.into_iter().map(Vec::from);
    files.push((DESCRIPTION, csv(&HEADER.map(str::to_owned), rows)?));
    Ok(files)
}

/// The descriptions of the columns of a table.
fn columns(csv: &str) -> Result<Vec<[String; 5]>, Failure> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let header = reader.headers().map_err(Failure::cannot_run)?;
    let described = header.iter().map(|heading| {
        let (name, unit) = heading.split_once(" [").unwrap_or((heading, ""));
        let [.., meaning] = words_of("column", heading);
        let [.., other] = words_of("column", "");
        let meaning = if meaning.is_empty() { other } else { meaning };
        ["figure.csv", name, unit.trim_end_matches(']'), "", &meaning].map(str::to_owned)
    });
    Ok(described.collect())
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

    /// Adds an array of a plane.
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
        let words = words_of("plane", array);
        self.add(
            &format!("{place}.{array}"),
            of,
            words.each_ref().map(String::as_str),
        )
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
        let [.., meaning] = words_of("row", &picture.row);
        let axes = format!("{x}, {y}");
        self.add(&name, &picture.values, [&picture.unit, &axes, &meaning])?;
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

/// A text as a word: its ASCII letters and digits, in lower case, joined by underscores.
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
        let mut reader = csv::Reader::from_reader(WORDS.as_bytes());
        let words: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let arrays: Vec<_> = words.iter().filter(|word| &word[0] == "plane").collect();
        assert_eq!(arrays.len(), 16);
        for word in arrays {
            let name = &word[1];
            assert!(figures.contains(&format!("`{name}`")), "{name}");
            assert!(word.iter().all(|text| !text.is_empty()), "{name}");
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
