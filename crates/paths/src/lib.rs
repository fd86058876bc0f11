//! Paths of light through a [`World`](etendue_world::World), followed back from a camera: what surfaces a ray meets (`space`), what they do to light
//! (`scatter`), where light is (`lights`), and the radiance that a path finds. `surface_hit` has the
//! places that a camera sees, for renderers that choose where to spend paths; `probe` asks for the light field behind a pixel.

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
