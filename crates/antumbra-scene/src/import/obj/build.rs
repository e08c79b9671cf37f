//! Faces to meshes.

use super::mtl::Library;
use super::statements::{Corner, Statements};
use crate::Mesh;
use crate::import::Model;
use crate::import::polygon::Triangulator;
use crate::import::texture_file::drop_idle_mask;
use glam::Vec2;
use indexmap::IndexSet;

/// One mesh for each material that faces use.
pub(super) fn model(statements: &Statements, library: &Library, name: &str) -> Model {
    let mut faces_of: Vec<Vec<&[Corner]>> = vec![Vec::new(); statements.materials.len()];
    for face in &statements.faces {
        faces_of[face.material].push(&statements.corners[face.corners.clone()]);
    }
    let (mut meshes, mut materials) = (Vec::new(), Vec::new());
    for (used, faces) in statements.materials.iter().zip(&faces_of).filter(|(_, faces)| !faces.is_empty()) {
        let mut material = library.get(used).cloned().unwrap_or_default();
        if !library.is_empty() && !used.is_empty() && !library.contains_key(used) {
            tracing::warn!("{name}: no material library defines {used:?}; it is drawn grey");
        }
        if material.texture.is_some() && faces.iter().all(|f| f.iter().all(|c| c.uv.is_none())) {
            tracing::warn!("{name}: material {used:?} has a texture, but its faces have no coordinates for it");
            material.texture = None;
        }
        drop_idle_mask(&mut material);
        let name = if used.is_empty() { name } else { used };
        let textured = material.texture.is_some();
        meshes.push(Mesh { name: name.to_string(), material: materials.len(), ..mesh(statements, faces, textured) });
        materials.push(material);
    }
    Model::of_meshes(name, meshes, materials)
}

/// Corners with the same position, and the same texture coordinate if there is a texture, share a vertex.
fn mesh(statements: &Statements, faces: &[&[Corner]], textured: bool) -> Mesh {
    let Statements { positions, uvs, .. } = statements;
    let position = |corner: &Corner| positions[corner.position as usize];
    let uv = |corner: &Corner| corner.uv.map_or(Vec2::ZERO, |uv| uvs[uv as usize]);
    let (mut vertices, mut indices, mut polygon) = (IndexSet::new(), Vec::new(), Vec::new());
    let mut split = Triangulator::new();
    for face in faces {
        polygon.clear();
        for &corner in *face {
            let vertex = Corner { uv: corner.uv.filter(|_| textured), ..corner };
            polygon.push(vertices.insert_full(vertex).0 as u32);
        }
        split.split(face.len(), |i| position(&face[i]), |t| indices.extend(t.map(|i| polygon[i])));
    }
    Mesh {
        positions: vertices.iter().map(position).collect(),
        uvs: if textured { vertices.iter().map(uv).collect() } else { Vec::new() },
        indices,
        ..Mesh::default()
    }
}
