//! Which triangles of a mesh share an edge, found once a mesh on the GPU: borrowed vertices never come to the CPU.
//!
//! Vertices at the same place are one, whatever their number in the index buffer, so a mesh that was cut along texture
//! seams or whose faces bear vertices of their own is closed again. Any number of triangles may share an edge.

use crate::input::casters::{BatchLayout, Casters};
use crate::gpu::resources::{storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// The triangles of one mesh.
    pub(crate) struct MeshRange {
        first_triangle: u32,
        triangle_count: u32,
        /// Slots of the hash table less one, a power of two less one.
        slot_mask: u32,
    }
}

/// For each batch the ring of the half-edges at every edge; see `shaders/edges.wesl`.
#[derive(Clone)]
pub struct Adjacency {
    pub(crate) rings: Vec<wgpu::Buffer>,
}

/// Slots a half-edge, at least: chains stay short.
const SLOTS: u64 = 2;

impl Adjacency {
    /// Finds the edges of all meshes.
    pub(crate) fn of(gpu: &Gpu, casters: &Casters) -> Result<Adjacency, Error> {
        let key = ShaderKey::new("passes::triangles::adjacency::link");
        let weld = gpu.compute_pipeline(&key, "weld_corners")?;
        let link = gpu.compute_pipeline(&key, "link_edges")?;
        let corners = |mesh: &std::ops::Range<u32>| u64::from(mesh.end - mesh.start) * 3;
        let most = casters.batches.iter().flat_map(|b| &b.meshes).map(corners).max().unwrap_or(0);
        let slots = storage_buffer(gpu, "hash table", (most * SLOTS).next_power_of_two() * 4);
        let welded = storage_buffer(gpu, "welded corners", most * 4);
        let range = uniform(gpu, "mesh", &MeshRange { first_triangle: 0, triangle_count: 0, slot_mask: 0 });
        let mut rings = Vec::new();
        for batch in &casters.batches {
            let all = batch.meshes.iter().map(|m| m.end).max().unwrap_or(0);
            let ring = storage_buffer(gpu, "edges", u64::from(all) * 12);
            for mesh in batch.meshes.iter().filter(|m| !m.is_empty()) {
                let threads = corners(mesh);
                let value = MeshRange {
                    first_triangle: mesh.start,
                    triangle_count: mesh.end - mesh.start,
                    slot_mask: (threads * SLOTS).next_power_of_two() as u32 - 1,
                };
                gpu.queue.write_buffer(&range, 0, &value.uniform_bytes());
                let mut encoder = gpu.device.create_command_encoder(&Default::default());
                for pipeline in [&weld, &link] {
                    encoder.clear_buffer(&slots, 0, Some(u64::from(value.slot_mask + 1).max(4) * 4));
                    let set = bindings! { mesh: &range, slots: &slots, welded: &welded, ring: &ring };
                    let mut pass = encoder.begin_compute_pass(&Default::default());
                    pass.set_pipeline(&pipeline.pipeline);
                    pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, set), &[]);
                    pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                    let groups = (threads as u32).div_ceil(64);
                    let side = groups.min(1 << 15);
                    pass.dispatch_workgroups(side, groups.div_ceil(side), 1);
                }
                gpu.queue.submit([encoder.finish()]);
            }
            rings.push(ring);
        }
        Ok(Adjacency { rings })
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.rings.iter().map(wgpu::Buffer::size).sum()
    }
}
