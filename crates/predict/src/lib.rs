//! Predicts the spectra of a scene.
//!
//! [`Applicability`] states which theory applies to a plane of a scene, or why no theory applies.
//! It also holds the facts of the scene that this theory needs. The function [`predict`] returns
//! everything that the theory predicts for the plane, as an
//! [`etendue_compare::Prediction`]. [`Memory`] and [`seconds`] estimate what a prediction takes.
//!
//! This crate traces no photons and judges nothing.

mod applicability;
mod bandwidth;
mod budget;
mod chain;
mod converge;
mod covariance;
mod depth;
mod field;
mod first_order;
mod level;
mod memory;
mod off_parallel;
mod off_patches;
mod prediction;
mod stopped;
mod theories;
mod theory_input;
mod unlit;
mod work;

pub use applicability::Applicability;
pub use bandwidth::{criterion, exact_bandwidth};
pub use chain::{chain, stands_before};
pub use converge::{Convergence, ConvergenceStep, converge, converge_to};
pub use covariance::{AXES, CovarianceReport, SliceMoment, TracedPlane};
pub use field::predict_field;
pub use level::{test_each, test_of};
pub use memory::Memory;
pub use off_patches::OffPatches;
pub use prediction::{predict, predict_lights, predict_reference};
pub use stopped::stopped;
pub use theories::Theory;
pub use theory_input::path;
pub use work::{TooMuchWork, seconds, too_much_work};
