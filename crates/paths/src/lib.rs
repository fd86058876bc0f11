//! Paths of light through a [`World`](etendue_world::World), followed back from a camera: what surfaces a ray meets (`space`), what they do to light
//! (`scatter`), where light is (`lamps`), and the radiance that a path finds. `seen` has the
//! places that a camera sees, for renderers that choose where to spend paths; `probe` asks for the light field behind a pixel.

mod lamps;
mod numbers;
mod paths;
mod picture;
mod probe;
mod scatter;
mod seen;
mod space;

pub use paths::Paths;
pub use picture::Picture;
pub use probe::{BackwardProbe, Budget, PhotonProbe, Probe, Question, Stop};
pub use scatter::Reflects;
pub use seen::{Nearness, Seen, View};
pub use space::{Hit, Ray, Space};
