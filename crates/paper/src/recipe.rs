//! The content of each figure of the paper.

use crate::caustic::caustic;
#[cfg(feature = "worlds")]
use crate::creatures;
use crate::kernels;
use crate::parameterisations::parameterisations;
use crate::plates::{blockers, lights, occluders, steps};
use crate::scene_run::resolved;
use crate::shading::{adaptive, environment};
use crate::spaces::{coordinates, directions};
use crate::subject::{FigureData, Subject, Text};
use crate::table1::operators;
use etendue_figures::Figure;
use etendue_store::Failure;
use std::path::Path;

/// A figure of the paper, with the scenes that are run for it and the function that draws it.
#[derive(Debug)]
pub(crate) struct Recipe {
    /// The number of the figure or table in the paper.
    pub(crate) name: &'static str,
    /// A description of the figure.
    pub(crate) about: &'static str,
    /// The scenes to run.
    pub(crate) scenes: &'static [Text],
    /// Further scenes, from which curves are computed or measured.
    pub(crate) also: &'static [Text],
    /// Whether the figure shows full radial spectra.
    pub(crate) full_radial: bool,
    pub(crate) draw: fn(&FigureData<'_>) -> Result<Figure, Failure>,
}

impl Recipe {
    /// The figure to be made by this recipe.
    pub(crate) fn subject(&'static self) -> Result<Subject, Failure> {
        let scenes = self.scenes.iter();
        let scenes = scenes.map(|(name, text)| resolved(name, text, &[], |photons| photons));
        Ok(Subject {
            name: self.name.to_owned(),
            about: self.about.to_owned(),
            arguments: self.name.to_owned(),
            scenes: scenes.collect::<Result<_, _>>()?,
            is_own: false,
            texts: self.scenes.iter().chain(self.also).copied().collect(),
            inputs: Vec::new(),
            warnings: Vec::new(),
            full_radial: self.full_radial,
            also: self.also,
            planes: Vec::new(),
            draw: self.draw,
        })
    }
}

/// A strip without full radial spectra, to which each recipe adds what it has.
const PLAIN: Recipe = Recipe {
    name: "",
    about: "",
    scenes: &[],
    also: &[],
    full_radial: false,
    draw: |taken| taken.strip(),
};

/// All recipes, in the order of the paper.
pub(crate) const RECIPES: &[Recipe] = &[
    Recipe {
        name: "1",
        about: "spectra along a path, from the light to the light that leaves a diffuse receiver",
        scenes: &[("fig1", etendue_scenes::FIG1)],
        full_radial: true,
        ..PLAIN
    },
    Recipe {
        name: "3",
        about: "the two parameterisations, in slopes and in angles, and travel",
        scenes: &[("fig3", etendue_scenes::FIG3)],
        also: &[("fig8", etendue_scenes::FIG8)],
        draw: coordinates,
        ..PLAIN
    },
    Recipe {
        name: "4",
        about: "a point light, and a spot with a bulb and a falloff",
        scenes: &[
            ("fig4_source", etendue_scenes::FIG4_SOURCE),
            ("fig4_point", etendue_scenes::FIG4_POINT),
            ("fig4_spot", etendue_scenes::FIG4_SPOT),
        ],
        draw: lights,
        ..PLAIN
    },
    Recipe {
        name: "5",
        about: "the cosine over slopes, g, and its transforms in 2D and 3D",
        draw: kernels::slopes,
        ..PLAIN
    },
    Recipe {
        name: "6",
        about: "all steps of diffuse shading: computed in flatland, and measured and predicted in 3D",
        scenes: &[("fig1", etendue_scenes::FIG1)],
        full_radial: true,
        draw: steps,
        ..PLAIN
    },
    Recipe {
        name: "7",
        about: "each of two occluders alone, and both together: the light that one blocks differs in phase from the light that the other blocks, and together they block all light",
        scenes: &[
            ("fig7_one", etendue_scenes::FIG7_ONE),
            ("fig7_other", etendue_scenes::FIG7_OTHER),
            ("fig7_two", etendue_scenes::FIG7_TWO),
        ],
        draw: occluders,
        ..PLAIN
    },
    Recipe {
        name: "8",
        about: "the receiver by slopes and by angles: their difference, and bandwidths",
        scenes: &[("fig8", etendue_scenes::FIG8)],
        draw: parameterisations,
        ..PLAIN
    },
    Recipe {
        name: "9",
        about: "light behind blockers of three sizes, and the share of high frequencies that leaves the receiver",
        scenes: &[
            ("fig9a", etendue_scenes::FIG9A),
            ("fig9b", etendue_scenes::FIG9B),
            ("fig9c", etendue_scenes::FIG9C),
        ],
        full_radial: true,
        draw: blockers,
        ..PLAIN
    },
    Recipe {
        name: "10",
        about: "the seven steps of shading a curved glossy receiver",
        scenes: &[("fig10", etendue_scenes::FIG10)],
        ..PLAIN
    },
    Recipe {
        name: "11",
        about: "a caustic: a beam on a hollow mirror, at incidences of 0° and 40°",
        scenes: &[
            ("fig11", etendue_scenes::FIG11),
            ("solar_oven", etendue_scenes::TABLE1_SOLAR_OVEN),
        ],
        draw: caustic,
        ..PLAIN
    },
    Recipe {
        name: "12",
        about: "transforms of the clamped cosine, alone and with Fresnel factors",
        draw: kernels::fresnel,
        ..PLAIN
    },
    Recipe {
        name: "13",
        about: "directions in 3D by longitude and latitude, and the error of treating these as flat",
        scenes: &[
            ("twist", etendue_scenes::TABLE1_TWIST),
            ("twisted_glossy", etendue_scenes::TABLE1_TWISTED_GLOSSY),
        ],
        draw: directions,
        ..PLAIN
    },
    Recipe {
        name: "14",
        about: "diffuse shading under an environment map: convolution and restriction together are a product",
        scenes: &[("fig14", etendue_scenes::FIG14)],
        also: &[("fig14_product", etendue_scenes::FIG14_PRODUCT)],
        draw: environment,
        ..PLAIN
    },
    Recipe {
        name: "15",
        about: "the bandwidth of a glossy reflection step by step, and the criteria of Eqs. 20 and 21 beside measurements",
        scenes: &[("fig15", etendue_scenes::FIG15)],
        also: &[
            ("bandwidth", etendue_scenes::BANDWIDTH),
            ("bandwidth_edge", etendue_scenes::BANDWIDTH_EDGE),
        ],
        draw: adaptive,
        ..PLAIN
    },
    #[cfg(feature = "worlds")]
    Recipe {
        name: "16",
        about: "the criteria of Fig. 17, and the shading samples they place",
        draw: creatures::criteria,
        ..PLAIN
    },
    #[cfg(feature = "worlds")]
    Recipe {
        name: "17",
        about: "a picture from few shading samples: placed uniformly, by the paper, by the corrected criteria, and a reference",
        draw: creatures::pictures,
        ..PLAIN
    },
    Recipe {
        name: "table1",
        about: "each operator of Table 1: light field and spectrum before and after it",
        scenes: &[
            ("travel", etendue_scenes::TABLE1_TRAVEL),
            ("fig1", etendue_scenes::FIG1),
            ("incidence", etendue_scenes::TABLE1_INCIDENCE),
            ("fig10", etendue_scenes::FIG10),
            ("glossy", etendue_scenes::TABLE1_GLOSSY),
            ("textured_glossy", etendue_scenes::TABLE1_TEXTURED_GLOSSY),
            ("fresnel_grazing", etendue_scenes::TABLE1_FRESNEL_GRAZING),
            ("tiles", etendue_scenes::TABLE1_TILES),
        ],
        draw: operators,
        ..PLAIN
    },
];

/// The recipe of a figure.
pub(crate) fn named(name: &str) -> Result<&'static Recipe, Failure> {
    let mut recipes = RECIPES.iter();
    recipes.find(|recipe| recipe.name == name).ok_or_else(|| {
        let names: Vec<&str> = RECIPES.iter().map(|recipe| recipe.name).collect();
        let file = format!("{name}.ron");
        let meant = if Path::new(&file).is_file() {
            format!(" (did you mean {file}?)")
        } else {
            String::new()
        };
        let message = format!(
            "no figure {name}{meant}; allowed: {}, all, or scene files, whose names end in .ron or .json",
            names.join(", ")
        );
        Failure::bad_input(message)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::Quality;
    use crate::scene_run::Shot;
    use etendue_figures::Style;
    use etendue_pipeline::Silent;

    #[test]
    #[ignore = "minutes: every figure is measured; .ci/pages runs it"]
    fn every_figure_fits_its_page_and_has_described_data_with_errors() {
        for recipe in RECIPES {
            let quality = Quality::Sketch;
            let subject = recipe.subject().unwrap();
            let shots = subject.scenes.iter().cloned();
            let shots = shots.map(|scene| Shot::take(scene, quality, recipe.full_radial, &Silent));
            let shots: Vec<Shot> = shots.collect::<Result<_, _>>().unwrap();
            let taken = FigureData {
                shots: &shots,
                also: recipe.also,
                planes: &[],
                quality,
                style: Style::default(),
                reporter: &Silent,
            };
            let figure = (subject.draw)(&taken).unwrap();
            fits_its_page(recipe.name, &figure);
            crate::data::tests::has_described_data(recipe.name, &figure, &shots);
        }
    }

    /// Checks that the page is at most seven inches wide and not longer than A4; an inch has 96
    /// units of the drawing. Texts, including sub- and superscripts, have at least 6 points.
    fn fits_its_page(name: &str, figure: &Figure) {
        let numbers = |attribute: &str| -> Vec<f64> {
            let mark = format!("{attribute}=\"");
            let rest = figure.svg.split(&mark).skip(1);
            let texts = rest.map(|rest| rest.split('"').next().unwrap());
            texts.map(|text| text.parse().unwrap()).collect()
        };
        let width = numbers(" width")[0];
        assert!(width <= 672.0, "figure {name}: {width} units wide");
        let height = numbers(" height")[0];
        let is_short = height <= 1.41 * 672.0;
        assert!(is_short, "figure {name}: {width} × {height}");
        let smallest = numbers("font-size").into_iter().fold(f64::MAX, f64::min);
        let points = 0.75 * smallest;
        assert!(points >= 6.0, "figure {name}: {points} points");
        let cut = figure.svg.lines().find(|line| line.contains('…'));
        assert_eq!(cut, None, "figure {name}");
    }
}
