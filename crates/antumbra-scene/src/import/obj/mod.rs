//! Wavefront OBJ, with the colours and textures of its material libraries.
//!
//! Faces are gathered into one mesh per material, since groups and objects make no difference to a shadow. Polygons
//! become triangles (concave ones by ears), indices may be negative, normals are not needed. A material library or a
//! texture that cannot be read is a warning; a face that cannot be drawn is an error that names its line. Positions are
//! read in double precision, and keywords also in capitals.
//!
//! The parser is our own. The crates, with their parse times as multiples of ours on models of 1 000 to 70 000 triangles:
//! - `tobj` 4.0 (1.1 to 2.3): errors name no line; it refuses colours with `w`, `vt` with one number, lines that go on
//!   after a backslash, comments that are not UTF-8, faces in a group before their vertices; `Kd 0.5` panics.
//! - `obj` 0.10 (1.3 to 2.6) does not check indices and keeps no line to report them by; it refuses the same `vt`, lines
//!   and comments.
//! - `obj-rs` 0.7 (1.3 to 4.3) panics on `lod`; `wavefront_obj` 11 (1.0 to 1.3) refuses negative indices; `wavefront` 0.2
//!   has no materials.
//! - `tobj`, `obj` and `wavefront_obj` refuse a whole material library for one odd statement. None reads the options of
//!   `map_*`.

mod build;
mod map;
mod mtl;
mod statements;

use super::{Model, ReadFile};
use crate::SceneError;

/// Reads an OBJ file. `name` is for messages; `read_file` gives the material libraries and textures that it refers to.
///
/// # Errors
/// If a statement is malformed, an index is out of range or there are no triangles; the message names the line.
pub fn parse(bytes: &[u8], name: &str, read_file: &mut ReadFile) -> Result<Model, SceneError> {
    let statements = statements::read(bytes, name)?;
    let library = mtl::load(&statements.libraries, name, read_file);
    build::model(&statements, &library, name).checked(name)
}
