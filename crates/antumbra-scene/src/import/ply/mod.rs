//! Stanford PLY: ASCII and binary of both byte orders.
//!
//! The importer reads positions, faces and triangle strips; polygons become triangles (concave ones by ears). It skips
//! every other property and element. The counts in the header and the lengths of lists are checked against the size of
//! the file before memory is reserved for them.
//!
//! The parser is our own. The crates, with their parse times as multiples of ours at 97 000 triangles:
//! - `ply-rs-bw` 4.0 (1.2 to 1.5) refuses `nan`, `.5`, `1.`, names such as `scalar_(PCV)` and items on two lines in
//!   ASCII, misreads elements with two properties of one name, and takes gigabytes for an element without properties.
//!   `ply-rs` 0.1 (6 to 11) is its unmaintained origin.
//! - `serde-ply` 0.2 (0.8 to 1.3) reads most files, but its errors name no line, byte or word, lists are not checked
//!   against the size of the file, unknown lines of the header pass, and comments that are not UTF-8 do not.

mod body;
mod header;

use super::Model;
use super::polygon::Triangulator;
use crate::{Material, Mesh, Place, SceneError};
use body::Body;
use glam::Vec3;
use header::{Element, Header, Property};

/// Reads a PLY file. `name` is for messages.
///
/// # Errors
/// If the file is malformed, cut off or has no triangles; the message names the line, the byte or the face.
pub fn parse(bytes: &[u8], name: &str) -> Result<Model, SceneError> {
    let header = header::read(bytes, name)?;
    let mut body = Body::new(bytes, &header, name);
    let mut surface = Surface::default();
    for element in &header.elements {
        body.check_claim(element)?;
        match element.name.as_str() {
            "vertex" => surface.positions = vertices(&mut body, element)?,
            "tristrips" => corner_lists(&mut body, element, |strip| surface.add_strip(strip))?,
            "face" => corner_lists(&mut body, element, |face| surface.add_face(face))?,
            _ => corner_lists(&mut body, element, |_| {})?,
        }
    }
    let mesh = surface.into_mesh(name)?;
    if mesh.indices.is_empty() {
        return Err(SceneError::NoTriangles { file: name.to_string(), advice: advice(&header).to_string() });
    }
    Model::of_meshes(name, vec![mesh], vec![Material::default()]).checked(name)
}

fn advice(header: &Header) -> &'static str {
    if header.elements.iter().any(|e| e.name == "face" && e.count > 0) {
        "its faces need a property list named vertex_indices or vertex_index with three corners or more"
    } else {
        "it is a cloud of points; make a surface of it first"
    }
}

fn vertices(body: &mut Body, element: &Element) -> Result<Vec<Vec3>, SceneError> {
    let axis = |p: &Property| ["x", "y", "z"].iter().position(|name| p.name == *name && p.length.is_none());
    let axes: Vec<_> = element.properties.iter().map(axis).collect();
    if !(0..3).all(|axis| axes.contains(&Some(axis))) {
        return Err(SceneError::Malformed {
            file: body.name.to_string(),
            place: Place::Part("the header, element vertex".to_string()),
            problem: "it needs the properties x, y and z".to_string(),
        });
    }
    let mut positions = Vec::with_capacity(element.count);
    for vertex in 0..element.count {
        let mut position = [0.0; 3];
        for (property, axis) in element.properties.iter().zip(&axes) {
            let values = body.property(property)?;
            if let &Some(axis) = axis {
                position[axis] = values[0] as f32;
            }
        }
        if position.iter().any(|c| !c.is_finite()) {
            let (file, place) = (body.name.to_string(), body.place());
            return Err(SceneError::NotFinite { file, place, vertex, position });
        }
        positions.push(position.into());
    }
    Ok(positions)
}

/// Reads all items of an element and calls `each` with every item's list of vertices.
fn corner_lists(body: &mut Body, element: &Element, mut each: impl FnMut(&[i64])) -> Result<(), SceneError> {
    // Items without properties take no bytes, so their count is unchecked.
    let count = if element.properties.is_empty() { 0 } else { element.count };
    let mut corners = Vec::new();
    for _ in 0..count {
        corners.clear();
        for property in &element.properties {
            let values = body.property(property)?;
            if !property.holds_corners() {
                continue;
            }
            if let Some(value) = values.iter().copied().find(|v| v.fract() != 0.0) {
                return Err(body.malformed(format!("{value} is not an index")));
            }
            corners.extend(values.iter().map(|&v| v as i64));
        }
        each(&corners);
    }
    Ok(())
}

/// Positions and polygons. Indices are checked at the end, since faces may precede vertices.
#[derive(Default)]
struct Surface {
    positions: Vec<Vec3>,
    /// Corners of all polygons, in sequence.
    corners: Vec<i64>,
    /// End of each polygon in `corners`.
    ends: Vec<usize>,
}

impl Surface {
    fn add_face(&mut self, face: &[i64]) {
        self.corners.extend(face);
        self.ends.push(self.corners.len());
    }

    /// Triangle strips, each ended by -1. Every second triangle has the opposite winding.
    fn add_strip(&mut self, strip: &[i64]) {
        for run in strip.split(|&corner| corner == -1) {
            for (i, t) in run.windows(3).enumerate() {
                self.add_face(&if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
            }
        }
    }

    fn into_mesh(self, name: &str) -> Result<Mesh, SceneError> {
        let Surface { positions, corners, ends } = self;
        let mut indices = Vec::with_capacity(corners.len());
        let (mut split, mut start) = (Triangulator::new(), 0);
        for (number, end) in ends.into_iter().enumerate() {
            let face = &corners[start..end];
            if let Some(&index) = face.iter().find(|&&c| c < 0 || c as usize >= positions.len()) {
                let (file, place) = (name.to_string(), Place::Part(format!("face {number}")));
                return Err(SceneError::IndexOutOfRange {
                    file,
                    place,
                    index,
                    count: positions.len(),
                    what: "vertices",
                });
            }
            let point = |i: usize| positions[face[i] as usize];
            split.split(face.len(), point, |t| indices.extend(t.map(|i| face[i] as u32)));
            start = end;
        }
        Ok(Mesh { name: name.to_string(), positions, uvs: Vec::new(), indices, material: 0 })
    }
}
