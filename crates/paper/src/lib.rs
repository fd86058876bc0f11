//! Makes the figures of Durand et al. 2005, measured and predicted, and figures of a user's scenes.
//!
//! [`subjects`] resolves a [`FigureRequest`] to figures. [`make_all`] runs the scenes of the
//! figures, draws the figures, and writes each figure with its data and recipe. The content of
//! each figure of the paper is listed in `recipe.rs`.
//!
//! This crate has no theory and no tracer of its own, except for flatland; a figure chooses scenes
//! and draws their results.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

mod caustic;
#[cfg(feature = "worlds")]
mod creatures;
mod criteria;
mod data;
mod energy;
mod flatland;
mod kernels;
mod make;
mod parameterisations;
mod plates;
mod product;
mod quality;
mod recipe;
mod request;
mod rows;
mod scene_run;
mod shading;
mod spaces;
mod style;
mod subject;
mod table1;
mod user_figures;

pub use make::{make_all, subjects};
pub use quality::Quality;
pub use request::{FigureRequest, Wanted};
pub use subject::Subject;
