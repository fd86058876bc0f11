//! The limits on the size of a scene file and on what messages show of it.
//!
//! Work is bounded before it begins: anything beyond a limit is not processed.

/// Bytes of a scene file, which is read into memory as a whole. The longest list of shapes takes
/// about half of this.
pub const FILE_BYTES: u64 = 16 << 20;

/// Bytes of a mesh or a picture, which is read into memory as a whole.
pub const INPUT_BYTES: u64 = 1 << 30;

/// Layers of blockers; each name is searched among all of them.
pub const LAYERS: usize = 1_000;

/// Surfaces; each leg of the path tests all of them.
pub const SURFACES: usize = 1_000;

/// Planes; each has a folder of results.
pub const PLANES: usize = 1_024;

/// Surfaces that the path visits in turn; each adds a leg.
pub const VISITS: usize = 64;

/// Lobes of an environment; each is evaluated for each direction of light.
pub const LOBES: usize = 10_000;

/// Shapes of a layer of blockers, and of all layers together; the prediction of more visible shapes
/// takes many minutes.
pub const SHAPES: usize = 100_000;

/// Products of shapes of the light and several layers that a prediction may have to evaluate.
pub const PRODUCTS: f64 = 1e6;

/// Cells along a side, or rings, of a generated mesh.
pub const CELLS: u32 = 2048;

/// Triangles of all generated meshes, not those read from files: slightly more than the finest
/// generated mesh has. Each triangle takes 72 bytes, and about as much again while the hierarchy
/// over the triangles is built.
pub const MADE_TRIANGLES: u64 = 20_000_000;

/// The largest number of a scene, and the inverse of the smallest size. Products of six of them,
/// which occur in a power spectrum, stay far within the range of f64.
pub const MAX_NUMBER: f64 = 1e9;

/// Characters of the name of a scene, a plane, blockers or a surface, which may name a folder or
/// appear in a picture.
pub const NAME: usize = 64;

/// Fields set on the command line; each is searched for in the whole scene.
pub const OVERRIDES: usize = 100;

/// Nesting depth of brackets in a value set on the command line; a scene has ten.
pub const NESTING: usize = 32;

/// Faults that a message lists; further ones are counted.
pub const FAULTS: usize = 10;

/// Characters of a value, and of the path of a field, that a message shows.
pub const VALUE: usize = 200;

/// Characters of what is allowed, or of a syntax error, that a message shows.
pub const ALLOWED: usize = 1_000;
