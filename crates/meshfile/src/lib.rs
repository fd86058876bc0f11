//! Triangle meshes: reads OBJ and PLY files, generates surfaces, and writes PLY files. It knows
//! bytes, files and triangles, but no scene.
//!
//! The readers of OBJ and PLY files are written for this project instead of taken from a library.
//! The library tobj 4.0.5 reads an `l` line of three points as a triangle. The library tobj
//! doubles the vertices that two groups share, so a closed surface becomes open. The library tobj
//! refuses continued lines, Latin-1 comments, and colors on some vertices only, and its error
//! messages name no line. The library ply-rs-bw 4.0.1 refuses `.5`, `1.` and blank lines. The
//! library ply-rs-bw shifts binary data if a property is declared twice, and fills memory for an
//! element without properties. The tests use tobj and ply-rs-bw as independent readers of valid
//! files.

mod detailed;
mod fault;
mod files;
mod mesh;
mod obj;
mod paraboloid;
mod ply;
mod star;
mod text;

pub use detailed::{DetailedMesh, MeshAttribute};
pub use fault::Fault;
pub use mesh::Mesh;
pub use obj::parts::{ObjFile, ObjPart};
