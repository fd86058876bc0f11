//! The limits on the size of a scene file and on what messages show of it.
//!
//! Work is bounded before it begins: anything beyond a limit is not processed.

/// Largest number of bytes of a scene file, which is read into memory as a whole. The longest list
/// of shapes takes about half of this.
pub const FILE_BYTES: u64 = 16 << 20;

/// Largest number of bytes of a mesh or a picture, which is read into memory as a whole.
pub const INPUT_BYTES: u64 = 1 << 30;

/// Largest number of layers of blockers. Each name is searched among all layers.
pub const LAYERS: usize = 1_000;

/// Largest number of surfaces. Each leg of the path tests all surfaces.
pub const SURFACES: usize = 1_000;

/// Largest number of planes, each of which has its own results folder.
pub const PLANES: usize = 1_024;

/// Largest number of surfaces that the path visits in turn. Each visit adds a leg.
pub const VISITS: usize = 64;

/// Largest number of lobes of an environment. Each lobe is evaluated for each direction of light.
pub const LOBES: usize = 10_000;

/// Largest number of shapes of a layer of blockers, and of all layers together. Predictions for
/// more visible shapes take many minutes.
pub const SHAPES: usize = 100_000;

/// Largest product of the numbers of shapes of the light and of several layers, all of whose
/// combinations a prediction may have to evaluate.
pub const PRODUCTS: f64 = 1e6;

/// Largest number of cells along a side, or of rings, of a generated mesh.
pub const CELLS: u32 = 2048;

/// Largest number of triangles of all generated meshes together: slightly more than the finest
/// generated mesh has. Meshes read from files do not count. Each triangle takes 72 bytes, and
/// about as much again while the hierarchy over the triangles is built.
pub const MADE_TRIANGLES: u64 = 20_000_000;

/// The largest number of a scene, and the inverse of the smallest size. Products of six such
/// numbers, which occur in a power spectrum, stay far within the range of f64.
pub const MAX_NUMBER: f64 = 1e9;

/// Largest number of characters of the name of a scene, a plane, blockers or a surface, which may
/// name a folder or appear in a picture.
pub const NAME: usize = 64;

/// Largest number of fields set on the command line. Each field is searched for in the whole
/// scene.
pub const OVERRIDES: usize = 100;

/// Largest nesting depth of brackets in a value set on the command line; scenes have at most ten
/// levels.
pub const NESTING: usize = 32;

/// Largest number of faults that a message lists; further faults are only counted.
pub const FAULTS: usize = 10;

/// Largest number of characters of a value, and of the path of a field, that a message shows.
pub const VALUE: usize = 200;

/// Largest number of characters of what is allowed, or of a syntax error, that a message shows.
pub const ALLOWED: usize = 1_000;
