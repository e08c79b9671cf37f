//! Frustum culling of clusters on the GPU: clusters outside of a light frustum or of a tile of it are not drawn.

use crate::bindings;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::casters::Casters;

/// Which clusters are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// All casters.
    Casters,
    /// Occluders of the occluder/receiver classification.
    Occluders,
    /// Receivers of that classification.
    Receivers,
    /// Meshes that only receive.
    Background,
}

/// Bytes of one set of draw arguments with its count of triangles, padded to the offset that bindings need.
const DRAW_STRIDE: u64 = 256;

/// The clusters that one frustum touches, as arguments for indirect draws: one draw per batch.
pub struct Culling {
    /// Numbers of the clusters, batch by batch.
    pub(crate) visible: wgpu::Buffer,
    pub(crate) draws: wgpu::Buffer,
}

impl Culling {
    /// First byte of a batch's draw arguments.
    pub(crate) fn draw_offset(batch: usize) -> u64 {
        batch as u64 * DRAW_STRIDE
    }

    /// Finds the clusters of these surfaces that touch the frustum; `view` is a `MapView`.
    pub fn record(
        recorder: &mut Recorder,
        casters: &Casters,
        surfaces: Surfaces,
        view: &wgpu::Buffer,
    ) -> Result<Culling, Error> {
        let key = ShaderKey::new("passes::triangles::culling")
            .feature("occluders", surfaces == Surfaces::Occluders)
            .feature("receivers", surfaces == Surfaces::Receivers)
            .feature("background", surfaces == Surfaces::Background);
        let pipeline = recorder.gpu.compute_pipeline(&key, "cull")?;
        let batches = casters.batches.len().max(1) as u64;
        let culling = Culling {
            visible: recorder.buffer("visible clusters", BufferDescription::new(u64::from(casters.cluster_count) * 4)),
            draws: recorder.buffer("cluster draws", BufferDescription::new(batches * DRAW_STRIDE).cleared()),
        };
        for (i, batch) in casters.batches.iter().enumerate().filter(|(_, b)| b.cluster_count > 0) {
            let draw = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &culling.draws,
                offset: Self::draw_offset(i),
                size: std::num::NonZero::new(32),
            });
            let set = bindings! {
                map_view: view,
                boxes: &casters.cluster_bounds,
                visible: &culling.visible,
                draw: &draw,
            };
            let groups = batch.cluster_count.div_ceil(64);
            let side = groups.min(1 << 15);
            let work = Work::Groups([side, groups.div_ceil(side), 1]);
            recorder.compute("cluster culling", &pipeline, &[set, &batch.bindings(casters)], work)?;
        }
        Ok(culling)
    }

    /// Triangles that the last frame drew. Waits for the GPU: for tests and reports.
    pub async fn triangles_drawn(&self, gpu: &Gpu) -> Result<u64, Error> {
        let bytes = read_buffer(gpu, &self.draws).await?;
        let draws = bytes.chunks_exact(DRAW_STRIDE as usize);
        Ok(draws.map(|d| u64::from(u32::from_le_bytes([d[16], d[17], d[18], d[19]]))).sum())
    }
}
