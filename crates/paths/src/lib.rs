//! Paths of light through a [`World`](etendue_world::World), followed back from a camera: what surfaces a ray meets (`space`), what they do to light
//! (`scatter`), where light is (`lamps`), and the radiance that a path finds.

mod lamps;
mod numbers;
mod paths;
mod picture;
mod scatter;
mod space;

pub use paths::Paths;
pub use picture::Picture;
