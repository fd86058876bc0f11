//! Defines two kinds of limits: on the size of a scene file, and on the text of the file that
//! messages show.
//!
//! Limits are checked before work begins, so anything beyond a limit is not processed.

/// Maximum number of bytes of a scene file, which is read into memory as a whole. The longest
/// allowed list of shapes takes about half of this number of bytes.
pub const FILE_BYTES: u64 = 16 << 20;

/// Maximum number of bytes of a mesh or a picture, which is read into memory as a whole.
pub const INPUT_BYTES: u64 = 1 << 30;

/// Maximum number of further lights. Each light is traced and predicted on its own.
pub const OTHER_LIGHTS: usize = 63;

/// Maximum number of layers of blockers. This number is limited because each name is searched for
/// among all layers.
pub const LAYERS: usize = 1_000;

/// Maximum number of surfaces. This number is limited because each leg of the path tests all
/// surfaces.
pub const SURFACES: usize = 1_000;

/// Maximum number of virtual planes, each of which has its own results folder.
pub const PLANES: usize = 1_024;

/// Maximum number of surfaces that the path visits, one after the other. This number is limited
/// because each visit adds a leg to the path.
pub const VISITS: usize = 64;

/// Maximum number of lobes of an environment. This number is limited because each lobe is
/// evaluated for each direction of light.
pub const LOBES: usize = 10_000;

/// Maximum number of shapes of one layer of blockers, and of all layers together. If more shapes
/// are visible, predictions take many minutes.
pub const SHAPES: usize = 100_000;

/// Maximum number of corners of the hole of an aperture. Each photon is tested against each edge of
/// the hole.
pub const HOLE_CORNERS: usize = 32;

/// Maximum of a product: the number of shapes of the light times the numbers of shapes of several
/// layers. A prediction may have to evaluate all combinations of these shapes.
pub const PRODUCTS: f64 = 1e6;

/// Maximum number of cells along a side, or of rings, of a generated mesh.
pub const CELLS: u32 = 2048;

/// Maximum number of triangles of all generated meshes together. This limit is slightly above the
/// number of triangles of the finest generated mesh. Meshes that are read from files do not count
/// towards this number. Each triangle takes 72 bytes, and about 72 more bytes while the hierarchy
/// over the triangles is built.
pub const MADE_TRIANGLES: u64 = 20_000_000;

/// The largest allowed number in a scene file. Its reciprocal is the smallest allowed size.
/// Products of six numbers of this size, which occur in a power spectrum, stay far within the range
/// of f64.
pub const MAX_NUMBER: f64 = 1e9;

/// Maximum number of characters of the name of a scene, a plane, blockers or a surface; the name
/// may become a folder name or appear in a picture.
pub const NAME: usize = 64;

/// Maximum number of fields that arguments of the command set. This number is limited because
/// each field is searched for in the entire scene.
pub const OVERRIDES: usize = 100;

/// Maximum nesting depth of brackets in a value that the command line sets; scenes have at most
/// ten levels.
pub const NESTING: usize = 32;

/// Maximum number of faults that a message lists; further faults are only counted.
pub const FAULTS: usize = 10;

/// Maximum number of characters that a message shows of a value, and of the path of a field.
pub const VALUE: usize = 200;

/// Maximum number of characters that a message shows of a description of allowed values, or of a
/// syntax error.
pub const ALLOWED: usize = 1_000;
