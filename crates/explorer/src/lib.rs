//! The numbers of `docs/explorer.html`: a page on which light, blockers, travel and a receiver are
//! dragged, and each light field and spectrum along the path is seen to change.
//!
//! A [`Setup`] holds what can be set. A [`PathPlace`] is a place on the path: its light field and its
//! spectrum are those of [`etendue_theory`], between parallel planes the very numbers that
//! `etendue predict` gives for the scene that [`scene`] writes. On a curved glossy receiver they
//! are first-order, without the cosine, and rays are followed off the sphere when asked.
//!
//! For WebAssembly the crate is a library of JavaScript (`page`); `.ci/explorer` builds the page.

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
pub use setup::{Setting, SettingEntry, Setup, TABLE};
