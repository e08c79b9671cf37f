//! Faces to meshes.

use super::mtl::{Library, Paint};
use super::statements::{Corner, Statements};
use crate::Mesh;
use crate::import::Model;
use crate::import::far::Extent;
use crate::import::polygon::Triangulator;
use crate::import::texture_file::drop_idle_mask;
use crate::import::warnings::Warnings;
use glam::{Affine2, DVec3, Vec2, Vec3};
use indexmap::IndexSet;

/// One mesh for each material that faces use.
pub(super) fn model(statements: &Statements, library: &Library, name: &str) -> Model {
    let mut faces_of: Vec<Vec<&[Corner]>> = vec![Vec::new(); statements.materials.len()];
    for face in &statements.faces {
        faces_of[face.material].push(&statements.corners[face.corners.clone()]);
    }
    let origin =
        Extent::of(statements.corners.iter().map(|c| statements.positions[c.position as usize])).local_origin();
    let (mut meshes, mut materials, warnings) = (Vec::new(), Vec::new(), Warnings::new(name));
    for (used, faces) in statements.materials.iter().zip(&faces_of).filter(|(_, faces)| !faces.is_empty()) {
        let Paint { mut material, uv } = library.get(used).cloned().unwrap_or_default();
        let place = || format!("material {used:?}");
        if !library.is_empty() && !used.is_empty() && !library.contains_key(used) {
            warnings.add(place(), "no material library defines it; it is drawn grey");
        }
        if material.texture.is_some() && faces.iter().all(|f| f.iter().all(|c| c.uv.is_none())) {
            warnings.add(place(), "it has a texture, but its faces have no coordinates for it");
            material.texture = None;
        }
        drop_idle_mask(&mut material);
        if material.alpha_cutoff.is_some_and(|c| material.base_color.w < c) {
            warnings.add(place(), "its opacity is below one half; its faces cast no shadow and are not drawn");
        }
        let name = if used.is_empty() { name } else { used };
        let uv = material.texture.is_some().then_some(uv);
        meshes.push(Mesh { name: name.to_string(), material: materials.len(), ..mesh(statements, faces, uv, origin) });
        materials.push(material);
    }
    Model::of_meshes(name, meshes, materials, origin)
}

/// Corners with the same position, and the same texture coordinate if there is a texture, share a vertex. `uv` is the
/// transform of the texture coordinates.
fn mesh(statements: &Statements, faces: &[&[Corner]], uv: Option<Affine2>, origin: DVec3) -> Mesh {
    let Statements { positions, uvs, .. } = statements;
    let position = |corner: &Corner| -> Vec3 { (positions[corner.position as usize] - origin).as_vec3() };
    let (mut vertices, mut indices, mut polygon) = (IndexSet::new(), Vec::new(), Vec::new());
    let mut split = Triangulator::new();
    for face in faces {
        polygon.clear();
        for &corner in *face {
            let vertex = Corner { uv: corner.uv.filter(|_| uv.is_some()), ..corner };
            polygon.push(vertices.insert_full(vertex).0 as u32);
        }
        split.split(face.len(), |i| position(&face[i]), |t| indices.extend(t.map(|i| polygon[i])));
    }
    let uv_of = |corner: &Corner| corner.uv.map_or(Vec2::ZERO, |uv| uvs[uv as usize]);
    Mesh {
        positions: vertices.iter().map(position).collect(),
        uvs: uv.map_or(Vec::new(), |uv| vertices.iter().map(|c| uv.transform_point2(uv_of(c))).collect()),
        indices,
        ..Mesh::default()
    }
}
