//! Draws the difference of two results at one plane.

use super::difference::Diff;
use super::pairs::Pairs;
use super::planes::{Compared, PlaneDiff, view};
use super::radial::RadialDiff;
use crate::pictures::{DECIBEL, image, power_axes, spectrum_quantity};
use crate::table::spaced;
use etendue_field::percent;
use etendue_figures::{Comparison, comparison};
use etendue_store::Failure;
use std::path::Path;

impl Diff {
    /// The picture of the plane that differs most, for a file at `path`: the power of both results,
    /// and their difference.
    ///
    /// # Errors
    /// When the path ends neither in .png nor in .svg, or when no plane is compared.
    pub fn drawn(&self, path: &Path) -> Result<Vec<u8>, Failure> {
        let compared = self.planes.iter().filter_map(PlaneDiff::named);
        let size = |(_, plane): &(&String, &Compared)| plane.test.chi2_per_dof.unwrap_or(0.0);
        let (name, plane) = compared
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .ok_or_else(|| Failure::bad_input("no plane is compared, so none can be drawn"))?;
        let radial = self.radial(name)?;
        let [x, y] = power_axes(radial.orientation, &radial.grid);
        let [of_a, of_b] = &radial.powers;
        let test = &plane.test;
        let figure = comparison(&Comparison {
            title: &format!("{}: power spectra of two results", spaced(name)),
            note: &format!(
                "A: {}, B: {}; they differ by {}, and noise alone is {}",
                self.results[0].folder().display(),
                self.results[1].folder().display(),
                percent(test.difference, 3),
                percent(test.noise, 3)
            ),
            x,
            y,
            quantity: spectrum_quantity(),
            scale: DECIBEL,
            sides: ["B", "A"],
            measured: of_b.view(),
            predicted: of_a.view(),
            z: radial.z.view(),
            finer: None,
        });
        image(&figure.map_err(Failure::cannot_run)?, path)
    }

    /// Reads a plane once more: other planes need no radial power.
    fn radial(&self, name: &str) -> Result<RadialDiff, Failure> {
        let results = self.results.each_ref();
        let missing = || Failure::bad_input(format!("plane {name} is not in both results"));
        let slices = results.map(|result| result.slices(result.plane(name).ok_or_else(missing)?));
        let [a, b] = slices;
        let slices = [&a?, &b?];
        let is_paired = self.unpaired.is_none();
        let pairs = is_paired.then(|| Pairs::read(results, name, slices));
        let pairs = pairs.transpose()?;
        let orientation = &view(&results[0].index.scene_file, name)["orientation"];
        let orientation = serde_json::from_value(orientation.clone()).unwrap_or_default();
        let differences = pairs.as_ref().map(|pairs| &pairs.differences);
        Ok(RadialDiff::new(slices, differences, orientation))
    }
}
