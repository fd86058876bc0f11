//! Traces paths of light through a [`World`](etendue_world::World), back from a camera. The modules
//! contain ray intersections (`space`), scattering at surfaces (`scatter`), lights (`lights`), and
//! the radiance of a path (`paths`). `surface_hit` provides the points that a camera sees, for
//! renderers with adaptive sampling; `probe` measures the light field behind a pixel.

mod lights;
mod numbers;
mod paths;
mod picture;
mod probe;
mod scatter;
mod space;
mod surface_hit;

pub use paths::Paths;
pub use picture::Picture;
pub use probe::{BackwardProbe, Budget, PhotonProbe, Probe, Question, Stop};
pub use scatter::Reflects;
pub use space::{Hit, Ray, SceneGeometry};
pub use surface_hit::{Nearness, SurfaceHit, View};
