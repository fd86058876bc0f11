//! Pictures with few shading samples, placed where light has high frequencies (Durand et al. 2005, *A Frequency Analysis of Light Transport*, section
//! 6.2 and Figs. 15 to 17).
//!
//! Points visible to the camera are found at full resolution (`visible`). From these points and
//! from the distance of blockers at sparse points (`blockers`), the criteria give the bandwidth of
//! light across the picture (`criterion`), and so the sampling density (`density`). The default
//! calibrates them by the errors of first, even samples (`auto`). Samples are
//! blue noise of that density (`blue_noise`); only they are shaded. The picture between them is
//! reconstructed from similar points (`reconstruct`).

mod auto;
mod blockers;
mod blue_noise;
mod criterion;
mod cross;
mod cutoffs;
mod density;
mod edges;
mod guide;
mod method;
mod metric;
mod reconstruct;
mod shading;
mod smooth;
mod visible;

pub use blockers::BLOCKER_RAYS;
pub use method::{Layers, Rendered, SampleMethod, SamplePlan, Stage, render};
pub use metric::Metric;
