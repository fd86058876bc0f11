//! Triangle meshes: reading OBJ and PLY files, generating and writing.
//!
//! The readers of OBJ and PLY files are written for this project instead of taken from a library.
//! The library tobj 4.0.5 reads an `l` line of three points as a triangle. The library tobj
//! doubles the vertices that two groups share, so a closed surface becomes open. The library tobj
//! refuses continued lines, Latin-1 comments, and colors on some vertices only, and its error
//! messages name no line. The library ply-rs-bw 4.0.1 refuses `.5`, `1.` and blank lines. The
//! library ply-rs-bw shifts binary data if a property is declared twice, and fills memory for an
//! element without properties. The tests use tobj and ply-rs-bw as independent readers of valid
//! files.

mod attribute;
mod detailed;
mod extension;
mod files;
mod obj;
mod paraboloid;
mod ply;
mod shared;
mod star;
mod text;

pub use attribute::MeshAttribute;
pub use detailed::DetailedMesh;
pub use obj::parts::{ObjFile, ObjPart};
pub use shared::Mesh;
