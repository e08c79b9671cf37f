//! Stanford PLY: ASCII and binary of both byte orders.
//!
//! Positions and faces are read; polygons become triangles (concave ones by ears), triangle strips too. Every other
//! property and element is skipped. What the header claims is checked against the bytes that are there before
//! anything is allocated for it.

mod body;
mod header;

use super::Model;
use super::polygon::Triangulator;
use crate::{Material, Mesh, Place, SceneError};
use body::Body;
use glam::Vec3;
use header::{Element, Header, Property};

/// Reads a PLY file. `name` is for messages.
pub fn parse(bytes: &[u8], name: &str) -> Result<Model, SceneError> {
    let header = header::read(bytes, name)?;
    let mut body = Body::new(bytes, &header, name);
    let mut surface = Surface::default();
    for element in &header.elements {
        body.check_claim(element)?;
        match element.name.as_str() {
            "vertex" => surface.positions = vertices(&mut body, element)?,
            "face" => surface.faces(&mut body, element)?,
            "tristrips" => surface.strips(&mut body, element)?,
            _ => body.skip(element)?,
        }
    }
    surface.check_indices(name)?;
    let mesh = surface.into_mesh(name);
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
    let place = |name| element.properties.iter().position(|p| p.is_scalar(name));
    let (Some(x), Some(y), Some(z)) = (place("x"), place("y"), place("z")) else {
        return Err(SceneError::Malformed {
            file: body.name.to_string(),
            place: Place::Part("the header, element vertex".to_string()),
            problem: "it needs the properties x, y and z".to_string(),
        });
    };
    let mut positions = Vec::with_capacity(element.count);
    for vertex in 0..element.count {
        let mut position = [0.0; 3];
        for (i, property) in element.properties.iter().enumerate() {
            match *property {
                Property::Scalar { kind, .. } if i == x || i == y || i == z => {
                    let axis = if i == x {
                        0
                    } else if i == y {
                        1
                    } else {
                        2
                    };
                    position[axis] = body.scalar(kind)? as f32;
                }
                _ => body.skip_property(property)?,
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

/// What is collected while reading: faces may come before vertices.
#[derive(Default)]
struct Surface {
    positions: Vec<Vec3>,
    /// Corners of all polygons, one after the other.
    corners: Vec<i64>,
    /// One past each polygon's last corner.
    ends: Vec<usize>,
}

impl Surface {
    fn faces(&mut self, body: &mut Body, element: &Element) -> Result<(), SceneError> {
        self.ends.reserve(element.count);
        for _ in 0..element.count {
            for property in &element.properties {
                match *property {
                    Property::List { length, item, ref name } if header::holds_corners(name) => {
                        body.list(length, item, |corner| self.corners.push(corner))?;
                    }
                    _ => body.skip_property(property)?,
                }
            }
            self.ends.push(self.corners.len());
        }
        Ok(())
    }

    /// Strips of triangles, each ended by -1; every second triangle is turned round.
    fn strips(&mut self, body: &mut Body, element: &Element) -> Result<(), SceneError> {
        let mut strip = Vec::new();
        for _ in 0..element.count {
            for property in &element.properties {
                match *property {
                    Property::List { length, item, ref name } if header::holds_corners(name) => {
                        body.list(length, item, |corner| strip.push(corner))?;
                    }
                    _ => body.skip_property(property)?,
                }
            }
            for run in strip.split(|&corner| corner == -1) {
                for (i, t) in run.windows(3).enumerate() {
                    self.corners.extend(if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
                    self.ends.push(self.corners.len());
                }
            }
            strip.clear();
        }
        Ok(())
    }

    fn check_indices(&self, name: &str) -> Result<(), SceneError> {
        let count = self.positions.len();
        let Some(at) = self.corners.iter().position(|&c| c < 0 || c as usize >= count) else { return Ok(()) };
        let face = self.ends.partition_point(|&end| end <= at);
        Err(SceneError::IndexOutOfRange {
            file: name.to_string(),
            place: Place::Part(format!("face {face}")),
            index: self.corners[at],
            count,
            what: "vertices",
        })
    }

    fn into_mesh(self, name: &str) -> Mesh {
        let Surface { positions, corners, ends } = self;
        let mut indices = Vec::with_capacity(corners.len());
        let (mut split, mut start) = (Triangulator::new(), 0);
        for end in ends {
            let face = &corners[start..end];
            let point = |i: usize| positions[face[i] as usize];
            split.split(face.len(), point, |t| indices.extend(t.map(|i| face[i] as u32)));
            start = end;
        }
        Mesh { name: name.to_string(), positions, uvs: Vec::new(), indices, material: 0 }
    }
}
