//! Stanford PLY: ASCII and binary of both byte orders.
//!
//! The importer reads positions, faces and triangle strips; polygons become triangles (concave ones by ears). It skips
//! every other property and element; vertices with little alpha and surfaces in other elements are a warning. The counts in the header and the lengths of lists are checked against the size of
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

use super::far::Extent;
use super::polygon::Triangulator;
use super::warnings::Warnings;
use super::{Model, text};
use crate::{Material, Mesh, Place, SceneError};
use body::Body;
use glam::DVec3;
use header::{Element, Header, Property};

/// Reads a PLY file. `name` is for messages.
///
/// # Errors
/// If the file is malformed, cut off or has no triangles; the message names the line, the byte or the face.
pub fn parse(bytes: &[u8], name: &str) -> Result<Model, SceneError> {
    let bytes = &text::decoded(bytes)[..];
    let header = header::read(bytes, name)?;
    let warnings = Warnings::new(name);
    if header.textures > 0 {
        warnings.add_many(
            header.textures,
            "the header",
            "textures are not read; faces that they mask cast whole shadows",
        );
    }
    let mut body = Body::new(bytes, &header, name);
    let mut surface = Surface::default();
    for element in &header.elements {
        body.check_claim(element)?;
        match element.name.as_str() {
            "vertex" => surface.vertices(&mut body, element, &warnings)?,
            "tristrips" => corner_lists(&mut body, element, |strip| surface.add_strip(strip))?,
            "face" => corner_lists(&mut body, element, |face| surface.add_face(face))?,
            other => {
                if element.count > 0 && element.properties.iter().any(Property::holds_corners) {
                    warnings.add_many(element.count, format!("element {other:?}"), "only faces and tristrips are read");
                }
                corner_lists(&mut body, element, |_| {})?;
            }
        }
    }
    let (mesh, origin) = surface.into_mesh(name)?;
    if mesh.indices.is_empty() {
        return Err(SceneError::NoTriangles { file: name.to_string(), advice: advice(&header).to_string() });
    }
    Model::of_meshes(name, vec![mesh], vec![Material::default()], origin).checked(name)
}

fn advice(header: &Header) -> &'static str {
    if header.elements.iter().any(|e| e.name == "face" && e.count > 0) {
        "its faces need a property list named vertex_indices or vertex_index with three corners or more"
    } else {
        "it is a cloud of points; make a surface of it first"
    }
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

/// Index of a vertex's alpha among what is read of it.
const ALPHA: usize = 3;

/// Positions and polygons. Indices are checked at the end, since faces may precede vertices.
#[derive(Default)]
struct Surface {
    positions: Vec<DVec3>,
    /// Vertices that are no points, with their places. Those that no face uses do no harm.
    not_finite: Vec<(usize, Place, DVec3)>,
    /// Corners of all polygons, in sequence.
    corners: Vec<i64>,
    /// End of each polygon in `corners`.
    ends: Vec<usize>,
}

impl Surface {
    fn vertices(&mut self, body: &mut Body, element: &Element, warnings: &Warnings) -> Result<(), SceneError> {
        let names = ["x", "y", "z", "alpha"];
        let axis = |p: &Property| names.iter().position(|name| p.name == *name && p.length.is_none());
        let axes: Vec<_> = element.properties.iter().map(axis).collect();
        if !(0..3).all(|axis| axes.contains(&Some(axis))) {
            return Err(SceneError::Malformed {
                file: body.name.to_string(),
                place: Place::Part("the header, element vertex".to_string()),
                problem: "it needs the properties x, y and z".to_string(),
            });
        }
        self.positions = Vec::with_capacity(element.count);
        self.not_finite.clear();
        for vertex in 0..element.count {
            let mut read = [0.0, 0.0, 0.0, 1.0];
            for (property, axis) in element.properties.iter().zip(&axes) {
                let values = body.property(property)?;
                match *axis {
                    Some(ALPHA) => read[ALPHA] = values[0] / property.one(),
                    Some(axis) => read[axis] = values[0],
                    None => {}
                }
            }
            let [x, y, z, alpha] = read;
            let mut position = DVec3::new(x, y, z);
            if alpha < 0.5 {
                let message = "its alpha is below one half, and alpha of vertices is not read: its faces cast shadows";
                warnings.add(format!("vertex {vertex}"), message);
            }
            if !position.as_vec3().is_finite() {
                self.not_finite.push((vertex, body.place(), position));
                position = DVec3::ZERO;
            }
            self.positions.push(position);
        }
        Ok(())
    }

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

    /// The mesh and the point of the file's coordinates that is its origin.
    fn into_mesh(self, name: &str) -> Result<(Mesh, DVec3), SceneError> {
        self.check(name)?;
        let Surface { positions, corners, ends, .. } = self;
        let origin = Extent::of(corners.iter().map(|&c| positions[c as usize])).local_origin();
        let positions: Vec<_> = positions.iter().map(|&p| (p - origin).as_vec3()).collect();
        let mut indices = Vec::with_capacity(corners.len());
        let (mut split, mut start) = (Triangulator::new(), 0);
        for end in ends {
            let face = &corners[start..end];
            let point = |i: usize| positions[face[i] as usize];
            split.split(face.len(), point, |t| indices.extend(t.map(|i| face[i] as u32)));
            start = end;
        }
        Ok((Mesh { name: name.to_string(), positions, uvs: Vec::new(), indices, material: 0 }, origin))
    }

    /// Checks that faces use vertices that are there and that are points.
    fn check(&self, name: &str) -> Result<(), SceneError> {
        let Surface { positions, not_finite, corners, ends } = self;
        let in_range = |&c: &i64| usize::try_from(c).is_ok_and(|c| c < positions.len());
        if let Some(at) = corners.iter().position(|c| !in_range(c)) {
            let face = ends.partition_point(|&end| end <= at);
            let (file, place) = (name.to_string(), Place::Part(format!("face {face}")));
            let (index, count) = (corners[at], positions.len());
            return Err(SceneError::IndexOutOfRange { file, place, index, count, what: "vertices" });
        }
        let find = |&c: &i64| not_finite.binary_search_by_key(&(c as usize), |(v, ..)| *v).ok();
        let Some(at) = corners.iter().find_map(find) else { return Ok(()) };
        let (vertex, place, position) = not_finite[at].clone();
        let position = position.as_vec3().to_array();
        Err(SceneError::NotFinite { file: name.to_string(), place, vertex, position })
    }
}
