//! Draws light fields, spectra, and the path of the light between planes.
//!
//! The input consists of plain values (arrays, axes, positions in metres). The output is a
//! [`Figure`], which is an SVG with a CSV of its numbers, and which can also be written as a PNG.
//! The crate computes no physics and uses neither the disk nor system fonts, so the same values
//! give the same bytes.
//!
//! * [`comparison()`]: one quantity from two sources, such as measured | predicted | difference in
//!   σ.
//! * [`strip()`]: the scene cut along the central ray and, under each virtual plane, its light
//!   field and spectrum.
//! * [`plate()`]: pictures in rows and columns.
//! * [`section()`]: the cut of `strip()` alone.
//! * [`ellipses()`]: a spectrum, over which covariances are drawn as ellipses.
//! * [`curves()`]: curves and measured points, in adjacent panels.
//! * [`chart()`]: values with names beside each other.
//! * [`stacked()`]: several figures on one page.
//! * [`photograph()`]: the picture that a camera takes.
//!
//! Arrays are [x, y] with both axes ascending. Pictures show x to the right and y upwards.
//!
//! # Markup
//!
//! In fields described as *markup*, `*x*` is italic, `_{in}` a subscript and `^{2}` a superscript.
//! All other texts are shown verbatim.
//!
//! ```
//! use etendue_figures::{Axis, AxisQuantity, Comparison, Scale, comparison};
//! let power = ndarray::array![[0.0, 1.0], [0.5, 0.2]];
//! let figure = comparison(&Comparison {
//!     title: "Radial spectrum at the receiver",
//!     note: "p = 0.43, pass",
//!     x: Axis::centers("*ρ*", "cycles/m", [0.0, 16.0], 2),
//!     y: Axis::centers("*ν*", "cycles/slope", [0.0, 32.0], 2),
//!     quantity: AxisQuantity::new("|*S*|^{2}", "W² m⁻⁴ sr⁻² m⁴"),
//!     scale: Scale::Decibel { floor: -60.0 },
//!     sides: ["measured", "predicted"],
//!     measured: power.view(),
//!     predicted: power.view(),
//!     z: (&power - &power).view(),
//!     finer: None,
//! })?;
//! assert!(figure.png()?.starts_with(b"\x89PNG"));
//! # Ok::<(), etendue_figures::Error>(())
//! ```

mod axis;
mod bar;
mod chart;
mod color;
mod comparison;
mod curves;
mod cut;
mod ellipses;
mod figure;
mod grey;
mod grid;
mod image;
mod marks;
mod panel;
mod picture;
mod plate;
mod raster;
mod section;
mod section_figure;
mod sizes;
mod strip;
mod style;
mod svg;
mod text;
mod text_faults;
mod world;

pub use axis::{Axis, AxisQuantity};
pub use chart::{Chart, chart};
pub use color::{Palette, Scale, palettes};
pub use comparison::{Comparison, comparison};
pub use curves::{Curve, CurveKind, CurvePanel, Curves, curves};
pub use ellipses::{Ellipse, Ellipses, ellipses};
pub use figure::{DrawnPicture, Error, Figure, csv_text, stacked, svg_size};
pub use image::photograph;
pub use picture::{Guide, Picture, PlateRow};
pub use plate::{Bars, Plate, plate};
pub use section::{DrawnObject, DrawnWorld, PlaneMark, Section, Segment, SegmentKind};
pub use section_figure::section;
pub use strip::{Strip, strip};
pub use style::Style;
pub use text_faults::text_faults;
