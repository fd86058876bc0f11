//! How much a scene file may hold and how much of it is shown, in one place.
//!
//! Work is bounded before it begins: what exceeds a limit is not looked at.

/// Bytes of a scene file: it is read into memory whole. The longest list of shapes takes about
/// half of it.
pub const FILE_BYTES: u64 = 16 << 20;

/// Bytes of a mesh or a picture: it is read into memory whole.
pub const INPUT_BYTES: u64 = 1 << 30;

/// Layers of blockers: each is looked for by its name among all of them.
pub const LAYERS: usize = 1_000;

/// Surfaces: each leg of the path looks at all of them.
pub const SURFACES: usize = 1_000;

/// Planes: each is a folder of results.
pub const PLANES: usize = 1_024;

/// Surfaces that the path visits, one after the other: each is another leg.
pub const VISITS: usize = 64;

/// Lobes of an environment: each is looked at for each direction of light.
pub const LOBES: usize = 10_000;

/// Shapes of a layer of blockers, and of all layers together: the prediction of more that are seen
/// takes many minutes.
pub const SHAPES: usize = 100_000;

/// Products of shapes of the light and several layers that a prediction may have to go through.
pub const PRODUCTS: f64 = 1e6;

/// Cells along a side, or rings, of a mesh that is made.
pub const CELLS: u32 = 2048;

/// Triangles of all meshes that are made, not read from files: a little more than the finest of them
/// has. Each takes 72 bytes, and about as much again while the hierarchy over them is built.
pub const MADE_TRIANGLES: u64 = 20_000_000;

/// The largest number of a scene, and the inverse of the smallest size: their products to the sixth power, which a
/// power spectrum has, stay far inside what f64 holds.
pub const MAX_NUMBER: f64 = 1e9;

/// Characters of a name, of the scene, of a plane, of blockers or of a surface: it names a folder or
/// stands in a picture.
pub const NAME: usize = 64;

/// Fields set on the command line: each is looked for in the whole scene.
pub const OVERRIDES: usize = 100;

/// Brackets around brackets in a value set on the command line: a scene has ten.
pub const NESTING: usize = 32;

/// Faults that a message tells; the others are counted.
pub const FAULTS: usize = 10;

/// Characters of a value, and of the path of a field, that a message shows.
pub const VALUE: usize = 200;

/// Characters of what is allowed, or of a fault of syntax, that a message shows.
pub const ALLOWED: usize = 1_000;
