//! Reads triangle meshes from PLY and OBJ files.
//!
//! Polygons are cut into fans around their first corner. Normals and texture coordinates come from the file where it
//! has them for all corners, and are otherwise left out: [`Mesh::smooth`](crate::scene::Mesh::smooth) makes normals.
//!
//! The readers are our own because the crates for these formats fail the tests of `tests/integration/mesh_files.rs`
//! (November 2026):
//!
//! - `tobj` 4.0.5 panics on `f 1//-6148914691236517207 2//1 3//1`, in release builds, too. Its errors have no line. It
//!   accepts `f 1/0/1`, faces of two corners, NaN and binary files; it refuses comments behind a statement, continued
//!   lines, and colours on only some vertices; it splits vertices at `g` and `o`, and so breaks smooth normals.
//! - `ply-rs-bw` 4.0.1 reads a header that names a property or an element twice into a wrong mesh, without an error. It
//!   needs 17 bytes of memory for each byte of a text's longest line. It refuses `1.`, `.5`, rows over several lines
//!   and files whose lines end in CR. Once the header is checked here, it would replace 60 lines and need as many.

mod obj;
mod ply;

use crate::error::{Error, Result};
use crate::files::{read_bounded, without_bom};
use crate::scene::Mesh;
use std::path::Path;

/// Most bytes in a file.
const MAX_BYTES: u64 = 512 << 20;

/// Reads the mesh at `path`, whose extension selects the format; what is left out goes to `warnings`.
///
/// # Errors
/// A damaged file, with line and column or byte; another extension than `ply` or `obj`.
pub fn read(path: &Path, warnings: &mut Vec<String>) -> Result<Mesh> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let reader = match extension.to_str() {
        Some("ply") => ply::read,
        Some("obj") => obj::read,
        _ => return Err(Error::unsupported(path, "not a mesh file that is known").with_hint("supported: .ply, .obj")),
    };
    reader(path, without_bom(&read_bounded(path, MAX_BYTES)?), warnings)
}
