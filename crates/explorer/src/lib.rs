//! The computations of `explorer.html`: a page with interactive light, blockers, travel and
//! receiver, which shows each light field and spectrum along the path.
//!
//! A [`Setup`] holds the settings, and a [`PathPlace`] is a place on the path. [`etendue_theory`]
//! predicts the light field and spectrum at each place. If all planes are parallel, light fields
//! and spectra are the results of `etendue predict` for the scene that [`scene`] writes. On a
//! curved glossy receiver, light fields and spectra are first-order predictions without the cosine.
//! Exact rays reflected by the sphere are traced on request.
//!
//! For WebAssembly the crate is a JavaScript library (`page`); `.ci/explorer` builds the page.

mod gloss;
#[cfg(target_family = "wasm")]
mod page;
mod parts;
mod plane;
mod planes;
mod rays;
mod ron;
mod setup;

pub use parts::{CELLS, grid, lobe};
pub use plane::PathPlace;
pub use ron::scene;
pub use setup::{SettingEntry, SettingKey, Setup, TABLE};
