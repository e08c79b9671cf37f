//! Alpha of vertices: where it takes a masked surface below the cutoff, the surface is cut.

use super::File;
use super::material::Materials;
use crate::Mesh;
use std::collections::HashMap;

/// Cuts a mesh by the alpha of its vertices, which is multiplied with the material's.
pub(super) fn cut(file: &File, mesh: &mut Mesh, alphas: &[f32], cutoff: f32, materials: &mut Materials, place: &str) {
    let material = &materials.list[mesh.material];
    let (factor, first) = (material.base_color.w, alphas.first().copied().unwrap_or(1.0));
    let Some(texture) = &material.texture else {
        // The alpha is linear over a triangle, and so is the edge of the hole.
        if factor > 0.0 {
            cut_below(mesh, alphas, cutoff / factor);
        }
        return;
    };
    if alphas.iter().all(|&a| a == first) {
        mesh.material = materials.faded(mesh.material, first, cutoff);
        return;
    }
    let strongest = factor * f32::from(texture.rgba.iter().skip(3).step_by(4).copied().max().unwrap_or(255)) / 255.0;
    let shows = |t: &&[u32]| t.iter().any(|&i| alphas[i as usize] * strongest >= cutoff);
    mesh.indices = mesh.indices.chunks_exact(3).filter(shows).flatten().copied().collect();
    if mesh.indices.iter().any(|&i| alphas[i as usize] != 1.0) {
        let message = "alpha of vertices varies over a masked texture; only triangles that it hides whole are cut out";
        file.warnings.add(place, message);
    }
}

/// Keeps the part of every triangle where the interpolated alpha is not below the threshold.
fn cut_below(mesh: &mut Mesh, alphas: &[f32], threshold: f32) {
    let shows = |i: u32| alphas[i as usize] >= threshold;
    let whole = std::mem::take(&mut mesh.indices);
    // Neighbours share the points on their edge.
    let mut crossings = HashMap::new();
    for triangle in whole.chunks_exact(3) {
        let mut polygon = Vec::with_capacity(4);
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (triangle[a], triangle[b])) {
            if shows(a) {
                polygon.push(a);
            }
            if shows(a) != shows(b) {
                let edge = (a.min(b), a.max(b));
                polygon.push(*crossings.entry(edge).or_insert_with(|| add_crossing(mesh, alphas, edge, threshold)));
            }
        }
        for i in 2..polygon.len() {
            mesh.indices.extend([polygon[0], polygon[i - 1], polygon[i]]);
        }
    }
}

fn add_crossing(mesh: &mut Mesh, alphas: &[f32], (a, b): (u32, u32), threshold: f32) -> u32 {
    let (a, b) = (a as usize, b as usize);
    let t = ((threshold - alphas[a]) / (alphas[b] - alphas[a])).clamp(0.0, 1.0);
    mesh.positions.push(mesh.positions[a].lerp(mesh.positions[b], t));
    if !mesh.uvs.is_empty() {
        mesh.uvs.push(mesh.uvs[a].lerp(mesh.uvs[b], t));
    }
    mesh.positions.len() as u32 - 1
}
