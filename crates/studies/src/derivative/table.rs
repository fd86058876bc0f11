//! The tables of a derivative, for files and for a terminal.

use super::{Derivative, PlaneDerivative};
use crate::sweep::table::{BANDWIDTHS, SLOPE};
use etendue_field::{percent, tidy, uncertain};
use etendue_report::table;
use etendue_scene::unit;
use etendue_store::Failure;

/// The numbers of a plane that have derivatives.
const NUMBERS: [&str; 3] = [BANDWIDTHS[0], BANDWIDTHS[1], SLOPE];

const HEADER: [&str; 10] = [
    "field",
    "plane",
    "step",
    "chosen",
    "size",
    "noise",
    "bias",
    "share_of_theory",
    "error_of_share",
    "p_value",
];

impl PlaneDerivative {
    /// The table with all digits: a row for each plane and each step.
    pub(super) fn csv(field: &str, all: &[Self]) -> Result<Vec<u8>, Failure> {
        let digits = |number: Option<f64>| number.map_or(String::new(), |x| format!("{x:?}"));
        let rows = all.iter().map(|of| {
            let mut row = vec![
                field.to_owned(),
                of.plane.clone(),
                digits(Some(of.step)),
                of.is_chosen.to_string(),
                digits(Some(of.size)),
                digits(of.noise),
                digits(of.bias),
                digits(of.share.map(|share| share.value)),
                digits(of.share.map(|share| share.error)),
                digits(of.p_value),
            ];
            let numbers = of.numbers.iter();
            row.extend(
                numbers.flat_map(|of| [of.map(|n| n.value), of.map(|n| n.error)].map(digits)),
            );
            row
        });
        let of_numbers = NUMBERS.map(|name| [name.to_owned(), format!("error_of_{name}")]);
        let header = [&HEADER.map(str::to_owned), of_numbers.as_flattened()].concat();
        table::csv(&header, rows)
    }
}

impl Derivative {
    /// The table for a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let unit = unit(&self.field);
        let [of_step, of_size] = match unit {
            "" => [String::new(), String::new()],
            unit => [format!(" [{unit}]"), format!(" [1/{unit}]")],
        };
        let header = [
            "plane".to_owned(),
            format!("step{of_step}"),
            format!("‖∂S‖/‖S‖{of_size}"),
            "noise".to_owned(),
            "bias".to_owned(),
            "times theory's".to_owned(),
            "p".to_owned(),
        ];
        let none = || "–".to_owned();
        let rows = self.planes.iter().map(|of| {
            let share = of.share.map(|share| uncertain(share.value, share.error));
            vec![
                of.plane.clone(),
                tidy(of.step),
                format!("{:.4}", of.size),
                of.noise.map_or_else(none, |noise| percent(noise, 3)),
                of.bias.map_or_else(none, |bias| percent(bias, 3)),
                share.unwrap_or_else(none),
                of.p_value.map_or_else(none, |p| format!("{p:.5}")),
            ]
        });
        let mut lines = vec![
            format!("∂S/∂({}) at {}:", self.field, tidy(self.value)),
            String::new(),
        ];
        lines.extend(table::aligned(
            std::iter::once(header.to_vec()).chain(rows).collect(),
        ));
        let open = self.planes.iter();
        let open = open.filter_map(|of| Some(format!("{}: {}", of.plane, of.open()?)));
        lines.extend(open);
        lines.join("\n")
    }
}
