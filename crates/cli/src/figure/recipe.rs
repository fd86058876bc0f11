//! What each figure of the paper is made of.

use crate::failure::Failure;
use crate::figure::kernels;
use crate::figure::plates::{blockers, lights, occluders, parameterisations, steps};
use crate::figure::shot::Shot;
use crate::pictures;
use etendue_figures::Figure;

/// A figure: the scenes it is measured in, and how it is drawn.
#[derive(Debug)]
pub(crate) struct Recipe {
    /// Its number in the paper.
    pub(crate) name: &'static str,
    /// What it shows.
    pub(crate) about: &'static str,
    /// Names and texts of the scene files.
    pub(crate) scenes: &'static [(&'static str, &'static str)],
    /// Whether it shows curves or bars, which are kept as a table.
    pub(crate) has_table: bool,
    pub(crate) draw: fn(&[Shot]) -> Result<Figure, Failure>,
}

/// The scene files of the repository that figures use.
macro_rules! scene {
    ($path:literal) => {
        include_str!(concat!("../../../../scenes/", $path, ".ron"))
    };
}

/// In the order of the paper.
pub(crate) const RECIPES: &[Recipe] = &[
    Recipe {
        name: "1",
        about: "spectra along a path, from the light to what leaves a diffuse receiver",
        scenes: &[("fig1", scene!("fig1"))],
        has_table: false,
        draw: strip,
    },
    Recipe {
        name: "4",
        about: "a point light, and a spot with a bulb and a falloff",
        scenes: &[
            ("fig4_point", scene!("fig4_point")),
            ("fig4_spot", scene!("fig4_spot")),
        ],
        has_table: false,
        draw: lights,
    },
    Recipe {
        name: "5",
        about: "the cosine over slopes, g, and its transforms in 2D and 3D",
        scenes: &[],
        has_table: true,
        draw: |_| kernels::slopes(),
    },
    Recipe {
        name: "6",
        about: "all steps of diffuse shading: 2D slice, measured and predicted radial spectrum",
        scenes: &[("fig1", scene!("fig1"))],
        has_table: false,
        draw: steps,
    },
    Recipe {
        name: "7",
        about: "one occluder, the other, and both, whose spectra cancel by their phases",
        scenes: &[
            ("fig7_one", scene!("fig7_one")),
            ("fig7_other", scene!("fig7_other")),
            ("fig7_two", scene!("fig7_two")),
        ],
        has_table: false,
        draw: occluders,
    },
    Recipe {
        name: "8",
        about: "the receiver by slopes and by angles: what taking one for the other costs",
        scenes: &[("fig8", scene!("fig8"))],
        has_table: false,
        draw: parameterisations,
    },
    Recipe {
        name: "9",
        about: "light behind blockers of three sizes, and the share of high frequencies that leaves the receiver",
        scenes: &[
            ("fig9a", scene!("fig9a")),
            ("fig9b", scene!("fig9b")),
            ("fig9c", scene!("fig9c")),
        ],
        has_table: true,
        draw: blockers,
    },
    Recipe {
        name: "10",
        about: "the seven steps of shading a curved glossy receiver",
        scenes: &[("fig10", scene!("fig10"))],
        has_table: false,
        draw: strip,
    },
    Recipe {
        name: "11",
        about: "a caustic: a beam on a hollow mirror",
        scenes: &[("solar_oven", scene!("table1/solar_oven"))],
        has_table: false,
        draw: strip,
    },
    Recipe {
        name: "12",
        about: "transforms of the clamped cosine, alone and with Fresnel factors",
        scenes: &[],
        has_table: true,
        draw: |_| kernels::fresnel(),
    },
];

/// The recipe of a figure.
pub(crate) fn named(name: &str) -> Result<&'static Recipe, Failure> {
    let mut recipes = RECIPES.iter();
    recipes.find(|recipe| recipe.name == name).ok_or_else(|| {
        let names: Vec<&str> = RECIPES.iter().map(|recipe| recipe.name).collect();
        let message = format!("no figure {name}; allowed: {}, all", names.join(", "));
        Failure::bad_input(message)
    })
}

/// The planes of one scene along its path, measured and predicted.
fn strip(shots: &[Shot]) -> Result<Figure, Failure> {
    let Shot {
        scene,
        photons,
        theories,
        planes,
    } = &shots[0];
    pictures::strip_of(scene, *photons, theories, planes, true)
}
