//! The triangles of a mesh that share an edge, found once per mesh on the GPU: borrowed vertices never come to the CPU.
//!
//! Vertices at the same position are one vertex, whatever their indices, so a mesh that is cut along texture seams, or
//! whose faces have vertices of their own, is closed again. Any number of triangles may share an edge.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{BufferDescription, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::input::casters::Casters;
use crate::{bindings, gpu_struct};
use std::ops::Range;

gpu_struct! {
    /// The triangles of one mesh.
    pub(crate) struct MeshRange {
        first_triangle: u32,
        triangle_count: u32,
        /// Slots of the hash table minus one; slots are a power of two.
        slot_mask: u32,
    }
}

/// The ring of half-edges at every edge, one buffer per batch; see `shaders/edges.wesl`. The first call finds them.
pub(crate) fn edge_rings<'a>(gpu: &Gpu, casters: &'a Casters) -> Result<&'a [wgpu::Buffer], Error> {
    if casters.edge_rings.get().is_none() {
        let mut rings = Vec::new();
        gpu.submit(|recorder| {
            rings = find(recorder, casters)?;
            Ok(())
        })?;
        // Another thread may have set the same.
        let _ = casters.edge_rings.set(rings);
    }
    Ok(casters.edge_rings.get().expect("set above"))
}

fn corners(mesh: &Range<u32>) -> u32 {
    3 * (mesh.end - mesh.start)
}

/// Slots of a mesh's hash table: at least two per half-edge, so that chains are short.
fn slots_of(corners: u32) -> u32 {
    (2 * corners).next_power_of_two().max(4)
}

fn find(recorder: &mut Recorder, casters: &Casters) -> Result<Vec<wgpu::Buffer>, Error> {
    let key = ShaderKey::new("passes::triangles::adjacency::link");
    let weld = recorder.gpu.compute_pipeline(&key, "weld_corners")?;
    let link = recorder.gpu.compute_pipeline(&key, "link_edges")?;
    let most = casters.batches.iter().flat_map(|b| &b.meshes).map(corners).max().unwrap_or(0);
    let of = |words: u32| BufferDescription::new(4 * u64::from(words));
    let slots = recorder.buffer("hash table", of(slots_of(most)));
    let welded = recorder.buffer("welded corners", of(most));
    let mut rings = Vec::new();
    for batch in &casters.batches {
        let triangles = batch.meshes.iter().map(|m| m.end).max().unwrap_or(0);
        let ring = storage_buffer(recorder.gpu, "edges", 12 * u64::from(triangles));
        for mesh in batch.meshes.iter().filter(|m| !m.is_empty()) {
            let corners = corners(mesh);
            let slot_count = slots_of(corners);
            let range =
                MeshRange { first_triangle: mesh.start, triangle_count: corners / 3, slot_mask: slot_count - 1 };
            let range = recorder.uniform("mesh", &range);
            let set: [&[_]; 2] =
                [bindings! { mesh: &range, slots: &slots, welded: &welded, ring: &ring }, &batch.bindings(casters)];
            for pipeline in [&weld, &link] {
                recorder.clear(&slots, Some(4 * u64::from(slot_count)));
                recorder.compute("adjacency", pipeline, &set, Work::groups(corners.div_ceil(64)))?;
            }
        }
        rings.push(ring);
    }
    Ok(rings)
}
