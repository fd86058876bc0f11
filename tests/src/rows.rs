//! Every row of the paper's Table 1, and what the sections of a whole validation have found of it.

use crate::report::Section;

/// A row of the table, and where its checks stand.
struct Row {
    name: &'static str,
    /// In ray space, and in Fourier space.
    operator: [&'static str; 2],
    checks: &'static [Checks],
}

/// The rows of a section that have this in one of these columns.
struct Checks {
    /// What the section's title begins with.
    section: &'static str,
    column: &'static str,
    values: &'static [&'static str],
}

const fn checks(
    section: &'static str,
    column: &'static str,
    values: &'static [&'static str],
) -> Checks {
    Checks {
        section,
        column,
        values,
    }
}

const MAPS: &str = "Operators in 2D";
const CIRCLE: &str = "A glossy circle";
const FACTORS: &str = "Operators of shading in 2D";
const MIRRORS: &str = "Operators in 4D";
const SHADED: &str = "Shading in 4D";
const MAIN: &str = "Every plane";

const ROWS: [Row; 12] = [
    Row {
        name: "travel",
        operator: ["shear", "shear"],
        checks: &[
            checks(MAPS, "up to", &["travel", "beyond"]),
            checks(MIRRORS, "operator", &["travel"]),
            checks(SHADED, "operator", &["travel"]),
            checks(MAIN, "plane", &["before_blockers"]),
        ],
    },
    Row {
        name: "visibility",
        operator: ["multiplication", "convolution"],
        checks: &[
            checks(
                FACTORS,
                "operator",
                &["visibility of a rectangle", "visibility of a half-plane"],
            ),
            checks(MAIN, "plane", &["after_blockers", "receiver"]),
            checks(SHADED, "plane", &["1_incidence"]),
        ],
    },
    Row {
        name: "light incidence",
        operator: ["scale, spatial", "scale, spatial"],
        checks: &[
            checks(MAPS, "up to", &["incidence"]),
            checks(CIRCLE, "up to", &["incidence"]),
            checks(MIRRORS, "operator", &["incidence"]),
            checks(SHADED, "operator", &["incidence"]),
        ],
    },
    Row {
        name: "outgoing angle",
        operator: ["scale, spatial", "scale, spatial"],
        checks: &[
            checks(MAPS, "up to", &["outgoing"]),
            checks(CIRCLE, "up to", &["outgoing"]),
            checks(MIRRORS, "operator", &["outgoing"]),
            checks(SHADED, "operator", &["outgoing"]),
        ],
    },
    Row {
        name: "curvature",
        operator: ["shear", "shear"],
        checks: &[
            checks(MAPS, "up to", &["curvature", "back"]),
            checks(CIRCLE, "up to", &["curvature", "back"]),
            checks(MIRRORS, "operator", &["curvature", "back"]),
            checks(SHADED, "operator", &["curvature", "back"]),
        ],
    },
    Row {
        name: "cosine term",
        operator: ["multiplication", "convolution"],
        checks: &[
            checks(
                FACTORS,
                "operator",
                &[
                    "clamped cosine",
                    "cosine along latitudes",
                    "full-circle series",
                ],
            ),
            checks(CIRCLE, "up to", &["cosine"]),
            checks(SHADED, "operator", &["cosine"]),
        ],
    },
    Row {
        name: "mirror (section 4.2)",
        operator: ["reflection of angles", "reflection of angles"],
        checks: &[
            checks(MAPS, "up to", &["event"]),
            checks(CIRCLE, "up to", &["mirror"]),
            checks(FACTORS, "operator", &["ideal mirror, δ/cos θ"]),
            checks(MIRRORS, "operator", &["mirror"]),
            checks(SHADED, "operator", &["mirror"]),
        ],
    },
    Row {
        name: "BRDF",
        operator: ["convolution", "multiplication"],
        checks: &[
            checks(
                FACTORS,
                "operator",
                &[
                    "lobe, Phong n = 20",
                    "lobe, Phong n = 3",
                    "lobe, Gaussian σ = 0.08",
                    "lobe, Beckmann α = 0.1",
                    "lobe, GGX α = 0.1",
                    "cosine and Gaussian lobe",
                    "cosine and Phong lobe",
                ],
            ),
            checks(CIRCLE, "up to", &["brdf"]),
            checks(SHADED, "operator", &["Phong", "GGX", "Beckmann"]),
        ],
    },
    Row {
        name: "texture mapping",
        operator: ["multiplication", "convolution"],
        checks: &[
            checks(FACTORS, "operator", &["texture"]),
            checks(SHADED, "operator", &["Phong, texture"]),
        ],
    },
    Row {
        name: "separable BRDF",
        operator: [
            "multiplication, then convolution",
            "convolution, then multiplication",
        ],
        checks: &[
            checks(
                FACTORS,
                "operator",
                &[
                    "Fresnel · cosine, n = 1.5",
                    "Fresnel · cosine, aluminium",
                    "Fresnel · cosine, Schlick F₀ = 0.04",
                    "separable, f(θ_i') = Schlick",
                    "separable, asymmetric f(θ_i')",
                    "separable, h(θ_o') = cos²",
                    "sum of three separable terms",
                ],
            ),
            checks(SHADED, "scene", &["fresnel_grazing"]),
        ],
    },
    Row {
        name: "space-varying BRDF",
        operator: ["semi-convolution, angles", "semi-convolution, space"],
        checks: &[
            checks(
                FACTORS,
                "operator",
                &["space-varying BRDF, semi-convolution"],
            ),
            checks(SHADED, "operator", &["Phong, blended"]),
        ],
    },
    Row {
        name: "environment map (section 6.1)",
        operator: ["shear by k, multiplication", "product at Ωx/k"],
        checks: &[
            checks(
                FACTORS,
                "operator",
                &[
                    "environment map, convex",
                    "irradiance of an environment, convex",
                    "environment map, concave",
                    "irradiance of an environment, concave",
                ],
            ),
            checks(SHADED, "scene", &["environment"]),
        ],
    },
];

/// Every row, of the sections of all parts.
pub(crate) fn rows(sections: &[Section]) -> Section {
    let mut passed = true;
    let rows = ROWS.iter().map(|row| {
        let found = Found::of(row, sections);
        passed &= found.passes();
        let [primal, fourier] = row.operator;
        vec![
            row.name.to_owned(),
            primal.to_owned(),
            fourier.to_owned(),
            format!("{} of {}", found.sound, found.without),
            format!("{} of {}", found.agreeing, found.p.len()),
            found.p.iter().copied().fold(1.0, f64::min).to_string(),
            verdict(found.passes()).to_owned(),
        ]
    });
    let rows = rows.collect();
    Section {
        title: "Every row".to_owned(),
        text: "What the sections below have found of each row: checks of its operator without photons, by quadrature and by traced rays; and \
               planes measured with photons right after it, with the smallest of their p against the exact prediction. Required: a row has \
               both, and all of them pass where they stand."
            .to_owned(),
        header: vec![
            "row",
            "ray space",
            "Fourier",
            "without photons",
            "planes with photons",
            "smallest p",
            "verdict",
        ],
        rows,
        passed,
    }
}

fn verdict(passes: bool) -> &'static str {
    if passes { "pass" } else { "FAIL" }
}

/// What was found of a row.
#[derive(Debug, Default)]
struct Found {
    /// Checks without photons, and how many of them passed.
    without: usize,
    sound: usize,
    /// Planes with photons that passed, and the p of all.
    agreeing: usize,
    p: Vec<f64>,
}

impl Found {
    fn of(row: &Row, sections: &[Section]) -> Self {
        let mut found = Self::default();
        for checks in row.checks {
            let of = sections.iter();
            for section in of.filter(|s| s.title.starts_with(checks.section)) {
                found.add(checks, section);
            }
        }
        found
    }

    fn add(&mut self, checks: &Checks, section: &Section) {
        let column = |name: &str| section.header.iter().position(|header| *header == name);
        let Some(of) = column(checks.column) else {
            return;
        };
        let p = column("p exact").or_else(|| column("p"));
        for cells in &section.rows {
            let is_planted = cells.iter().any(|cell| cell.contains("planted"));
            if is_planted || !checks.values.contains(&cells[of].as_str()) {
                continue;
            }
            // A row without a verdict has that of its section.
            let passes = column("verdict").map_or(section.passed, |at| cells[at] == "pass");
            if let Some(p) = p {
                self.agreeing += usize::from(passes);
                self.p.push(cells[p].parse().unwrap_or(0.0));
            } else {
                self.sound += usize::from(passes);
                self.without += 1;
            }
        }
    }

    fn passes(&self) -> bool {
        let all = self.sound == self.without && self.agreeing == self.p.len();
        all && self.sound > 0 && self.agreeing > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(title: &str, header: &[&'static str], rows: &[&[&str]]) -> Section {
        let cells = |row: &&[&str]| row.iter().map(ToString::to_string).collect();
        Section {
            title: title.to_owned(),
            text: String::new(),
            header: header.to_vec(),
            rows: rows.iter().map(cells).collect(),
            passed: true,
        }
    }

    #[test]
    fn a_row_needs_checks_of_both_kinds_and_all_of_them() {
        let without = || {
            let rows: &[&[&str]] = &[&["texture", "pass"], &["another", "FAIL"]];
            section("Operators of shading in 2D", &["operator", "verdict"], rows)
        };
        let with = |verdict: &str| {
            let rows: &[&[&str]] = &[&["Phong, texture", "0.3", verdict]];
            section("Shading in 4D", &["operator", "p exact", "verdict"], rows)
        };
        let texture = |sections: &[Section]| {
            let rows = rows(sections).rows;
            let row = rows.into_iter().find(|row| row[0] == "texture mapping");
            row.expect("the row")[3..].join(", ")
        };
        let both = [without(), with("pass")];
        assert_eq!(texture(&both), "1 of 1, 1 of 1, 0.3, pass");
        assert_eq!(texture(&both[1..]), "0 of 0, 1 of 1, 0.3, FAIL");
        assert_eq!(
            texture(&[without(), with("undecided")]),
            "1 of 1, 0 of 1, 0.3, FAIL"
        );
    }
}
