//! Named spectra of pbrt-v4, as colours in linear sRGB.
//!
//! The colours were computed from pbrt's tables of n and k by wavelength, by the rule at
//! [`Color`](crate::Color), with D65 as the weight. The colours of metals differ from the colours
//! in Mitsuba for two reasons. Mitsuba weights its tables with the equal-energy white, and the
//! tables of pbrt and Mitsuba contain different numbers.

/// Returns red, green and blue of the spectrum of a glass or metal, or `None` for an unknown name.
pub(super) fn index(name: &str) -> Option<[f64; 3]> {
    let found = NAMED.iter().find(|(known, _)| *known == name)?;
    Some(found.1)
}

/// Checks whether a name denotes a standard illuminant.
pub(super) fn is_illuminant(name: &str) -> bool {
    let Some(which) = name.strip_prefix("stdillum-") else {
        return false;
    };
    let fluorescent = which.strip_prefix('F').and_then(|n| n.parse::<u8>().ok());
    matches!(which, "A" | "D50" | "D65") || fluorescent.is_some_and(|n| (1..=12).contains(&n))
}

#[rustfmt::skip]
const NAMED: &[(&str, [f64; 3])] = &[
    ("glass-BAF10", [1.664422, 1.671626, 1.684619]),
    ("glass-BK7", [1.513015, 1.517091, 1.524163]),
    ("glass-F10", [1.719582, 1.732508, 1.756502]),
    ("glass-F11", [1.774714, 1.790022, 1.819554]),
    ("glass-F5", [1.665355, 1.675851, 1.69556]),
    ("glass-FK51A", [1.483435, 1.486313, 1.491308]),
    ("glass-LASF9", [1.841193, 1.854552, 1.879446]),
    ("metal-Ag-eta", [0.1283473, 0.1233954, 0.1507139]),
    ("metal-Ag-k", [4.060675, 3.282513, 2.388917]),
    ("metal-Al-eta", [1.405952, 0.9256124, 0.5833764]),
    ("metal-Al-k", [7.732359, 6.595033, 5.353976]),
    ("metal-Au-eta", [0.07987052, 0.4046524, 1.558968]),
    ("metal-Au-k", [3.386746, 2.500706, 1.768912]),
    ("metal-Cu-eta", [0.1050559, 0.9768189, 1.203228]),
    ("metal-Cu-k", [3.270163, 2.589603, 2.366343]),
    ("metal-CuZn-eta", [0.4179793, 0.5195058, 1.121686]),
    ("metal-CuZn-k", [3.663866, 2.677607, 1.769291]),
    ("metal-MgO-eta", [1.731918, 1.738989, 1.751447]),
    ("metal-MgO-k", [0.0; 3]),
    ("metal-TiO2-eta", [2.857479, 2.953201, 3.181716]),
    ("metal-TiO2-k", [0.00009097303, 0.0, 0.0005662864]),
];
