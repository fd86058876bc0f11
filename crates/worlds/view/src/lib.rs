//! Shows what a camera sees in a scene of another program: pictures with many samples or few, and
//! the light field behind a pixel.

#![allow(
    clippy::missing_errors_doc,
    reason = "a Failure holds the complete message for the user"
)]

mod adaptive;
mod contents;
mod layers;
mod picture;
mod picture_request;
mod probe;
pub mod ranges;
mod world_source;

pub use contents::Contents;
pub use picture::{RenderedPicture, render};
pub use picture_request::PictureRequest;
pub use probe::{BandwidthMap, ProbeRequest, ProbedPixel, map_bandwidths, probe_pixel};
pub use world_source::{CameraChoice, Viewpoint, WorldSource};
