//! Traces rays backwards from virtual planes to the light, as an independent check of the
//! photons.

mod connected;
mod end;
mod leg;
mod plane_sampler;
mod reflected;
mod source;
mod tracer;

pub use connected::finds;
pub use tracer::{Backward, LightNotFound};
