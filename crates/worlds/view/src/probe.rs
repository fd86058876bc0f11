//! Measures the light field behind a pixel, and how fast light changes over a picture.

mod covariance;
mod effort;
mod estimates;
mod found;
mod map;
mod picture;
mod pixel;
mod scene;
mod variance;
mod words;

pub use map::{BandwidthMap, map_bandwidths};
pub use pixel::{ProbedPixel, probe_pixel};
pub use scene::ProbeRequest;
