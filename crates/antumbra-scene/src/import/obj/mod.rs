//! Wavefront OBJ, with the colours and textures of its material libraries.
//!
//! Groups and objects make no difference to a shadow, so faces are gathered into one mesh a material. Polygons become
//! triangles (concave ones by ears), indices may be negative, normals are not needed. A material library or a texture
//! that cannot be read is a warning; a face that cannot be drawn is an error that names its line.

mod build;
mod mtl;
mod statements;

use super::{Model, ReadFile};
use crate::SceneError;

/// Reads an OBJ file. `name` is for messages; `read_file` gives the material libraries and textures that it refers to.
pub fn parse(bytes: &[u8], name: &str, read_file: &mut ReadFile) -> Result<Model, SceneError> {
    let statements = statements::read(bytes, name)?;
    let library = mtl::load(&statements.libraries, name, read_file);
    build::model(&statements, &library, name).checked(name)
}
