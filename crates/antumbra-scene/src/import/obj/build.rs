//! Faces to meshes.

use super::mtl::Library;
use super::statements::{NONE, Statements};
use crate::import::Model;
use crate::import::picture::drop_idle_mask;
use crate::import::polygon::Triangulator;
use crate::{Material, Mesh};
use glam::Vec2;

/// One mesh for each material that faces use.
pub(super) fn model(statements: &Statements, library: &Library, name: &str) -> Model {
    let mut faces_of: Vec<Vec<std::ops::Range<usize>>> = vec![Vec::new(); statements.materials.len()];
    let mut start = 0;
    for face in &statements.faces {
        faces_of[face.material].push(start..face.end);
        start = face.end;
    }
    let mut builder =
        Builder { statements, vertex_of: vec![NONE; statements.positions.len()], split: Triangulator::new() };
    let (mut meshes, mut materials) = (Vec::new(), Vec::new());
    for (material_name, faces) in statements.materials.iter().zip(&faces_of).filter(|(_, faces)| !faces.is_empty()) {
        let mut material = match library.get(material_name) {
            Some(material) => material.clone(),
            None => {
                if !material_name.is_empty() && !library.is_empty() {
                    tracing::warn!("{name}: no material library defines {material_name:?}; it is drawn grey");
                }
                Material::default()
            }
        };
        let textured = material.texture.is_some() && builder.has_uvs(faces);
        if material.texture.is_some() && !textured {
            tracing::warn!(
                "{name}: material {material_name:?} has a texture, but its faces have no coordinates for it"
            );
            material.texture = None;
        }
        drop_idle_mask(&mut material);
        let mesh_name = if material_name.is_empty() { name } else { material_name };
        meshes.push(builder.mesh(mesh_name, faces, materials.len(), textured));
        materials.push(material);
    }
    Model::of_meshes(name, meshes, materials)
}

struct Builder<'a> {
    statements: &'a Statements,
    /// For each position the newest vertex of the present mesh that stands there; all `NONE` between meshes.
    vertex_of: Vec<u32>,
    split: Triangulator,
}

/// A vertex of the mesh under construction.
struct Vertex {
    position: u32,
    uv: u32,
    /// The next vertex at the same position with another texture coordinate.
    next: u32,
}

impl Builder<'_> {
    fn has_uvs(&self, faces: &[std::ops::Range<usize>]) -> bool {
        faces.iter().any(|f| self.statements.corners[f.clone()].iter().any(|c| c[1] != NONE))
    }

    fn mesh(&mut self, name: &str, faces: &[std::ops::Range<usize>], material: usize, textured: bool) -> Mesh {
        let Statements { positions, uvs, corners, .. } = self.statements;
        let (mut vertices, mut indices, mut polygon) = (Vec::new(), Vec::new(), Vec::new());
        for face in faces {
            let face = &corners[face.clone()];
            polygon.clear();
            for &[position, uv] in face {
                polygon.push(vertex(&mut self.vertex_of, &mut vertices, position, if textured { uv } else { NONE }));
            }
            let point = |i: usize| positions[face[i][0] as usize];
            self.split.split(face.len(), point, |t| indices.extend(t.map(|i| polygon[i])));
        }
        vertices.iter().for_each(|v| self.vertex_of[v.position as usize] = NONE);
        let uv = |v: &Vertex| uvs.get(v.uv as usize).copied().unwrap_or(Vec2::ZERO);
        Mesh {
            name: name.to_string(),
            positions: vertices.iter().map(|v| positions[v.position as usize]).collect(),
            uvs: if textured { vertices.iter().map(uv).collect() } else { Vec::new() },
            indices,
            material,
        }
    }
}

/// The vertex with this position and texture coordinate, made if there is none.
fn vertex(vertex_of: &mut [u32], vertices: &mut Vec<Vertex>, position: u32, uv: u32) -> u32 {
    let newest = vertex_of[position as usize];
    let mut at = newest;
    while at != NONE {
        let vertex = &vertices[at as usize];
        if vertex.uv == uv {
            return at;
        }
        at = vertex.next;
    }
    let number = vertices.len() as u32;
    vertices.push(Vertex { position, uv, next: newest });
    vertex_of[position as usize] = number;
    number
}
