//! Renders pictures from few shading samples, which are placed where light has high frequencies
//! (Durand et al. 2005, *A Frequency Analysis of Light Transport*, section 6.2 and Figs. 15 to 17).
//!
//! A method is a choice of parts (`parts`), which follow each other in this order:
//!
//! Points visible to the camera are found at full resolution (`visible`). From the visible points
//! and the distance of blockers at sparse points (`blockers`), the criteria give the bandwidth of
//! light across the picture (`criterion`). The bandwidth determines the sampling density
//! (`density`). The default method begins with evenly distributed samples, and calibrates the
//! criteria by the errors of these samples (`auto`). Samples are blue noise of this density
//! (`blue_noise`), and only samples are shaded. Between samples the picture is reconstructed from
//! similar points (`reconstruct`).

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
mod objects;
mod parts;
mod reconstruct;
mod shading;
mod smooth;
mod visible;

pub use method::{Layers, Rendered, SamplePlan, Stage, render};
pub use parts::SampleMethod;
