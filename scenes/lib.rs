//! The scenes of the figures of Durand et al. 2005, as text.
//!
//! The command contains these files, so that it draws the figures wherever it is installed.

/// Defines a constant with the text of each scene file.
macro_rules! scenes {
    ($($name:ident = $path:literal,)*) => {
        $(
            #[doc = concat!("The text of `", $path, ".ron`.")]
            pub const $name: &str = include_str!(concat!($path, ".ron"));
        )*
    };
}

scenes! {
    BANDWIDTH = "bandwidth",
    BANDWIDTH_EDGE = "bandwidth_edge",
    FIG1 = "fig1",
    FIG10 = "fig10",
    FIG11 = "fig11",
    FIG14 = "fig14",
    FIG14_PRODUCT = "fig14_product",
    FIG15 = "fig15",
    FIG3 = "fig3",
    FIG4_POINT = "fig4_point",
    FIG4_SOURCE = "fig4_source",
    FIG4_SPOT = "fig4_spot",
    FIG7_ONE = "fig7_one",
    FIG7_OTHER = "fig7_other",
    FIG7_TWO = "fig7_two",
    FIG8 = "fig8",
    FIG9A = "fig9a",
    FIG9B = "fig9b",
    FIG9C = "fig9c",
    TABLE1_FRESNEL_GRAZING = "table1/fresnel_grazing",
    TABLE1_GLOSSY = "table1/glossy",
    TABLE1_INCIDENCE = "table1/incidence",
    TABLE1_SOLAR_OVEN = "table1/solar_oven",
    TABLE1_TEXTURED_GLOSSY = "table1/textured_glossy",
    TABLE1_TILES = "table1/tiles",
    TABLE1_TRAVEL = "table1/travel",
    TABLE1_TWIST = "table1/twist",
    TABLE1_TWISTED_GLOSSY = "table1/twisted_glossy",
}

/// The world of Figs. 16 and 17 and the files that it needs, each with its name.
pub const CREATURES: [(&str, &[u8]); 4] = [
    ("creatures.xml", include_bytes!("worlds/creatures.xml")),
    ("hall.exr", include_bytes!("worlds/hall.exr")),
    ("hunter.ply", include_bytes!("worlds/hunter.ply")),
    ("grazer.ply", include_bytes!("worlds/grazer.ply")),
];
