//! Cluster culling on the GPU: what a light frustum or a tile of it does not touch is not drawn.

use crate::casters::{BatchLayout, CLUSTER_TRIANGLES, Casters};
use crate::recorder::Recorder;
use crate::resource::{buffer_of, read_buffer, storage_buffer};
use crate::shader::ShaderKey;
use crate::{Error, Gpu, bindings, gpu_struct};
use glam::{Mat4, Vec4};

gpu_struct! {
    /// A frustum that casters are drawn into.
    pub(crate) struct MapView {
        clip_from_world: Mat4,
        /// Inward planes (normal, distance): a point is inside where all are >= 0.
        planes_ws: [Vec4; 6],
    }
}

impl MapView {
    /// The frustum of a projection with reversed or forward depth; the planes follow from the rows of the matrix.
    pub fn new(clip_from_world: Mat4) -> MapView {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_world.row(i));
        MapView { clip_from_world, planes_ws: [w + x, w - x, w + y, w - y, z, w - z] }
    }
}

/// Which clusters are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// What casts.
    Casters,
    /// What is an occluder where the scene is parted into occluders and receivers.
    Occluders,
    /// What is a receiver there.
    Receivers,
    /// What only takes shadows.
    Background,
}

/// Bytes of one set of draw arguments with its count of triangles, padded to the offset that bindings need.
const DRAW_STRIDE: u64 = 256;

/// The clusters that one frustum touches, as arguments for indirect draws: one draw a batch.
pub struct Culling {
    pub(crate) visible: wgpu::Buffer,
    pub(crate) draws: wgpu::Buffer,
    empty_draws: wgpu::Buffer,
}

impl Culling {
    /// Room for all clusters.
    pub fn new(gpu: &Gpu, casters: &Casters) -> Culling {
        let words = (DRAW_STRIDE / 4) as usize;
        let empty: Vec<u32> = (0..casters.batches.len().max(1) * words)
            .map(|i| if i % words == 0 { 3 * CLUSTER_TRIANGLES } else { 0 })
            .collect();
        let empty_draws = buffer_of(gpu, "no draws", bytemuck::cast_slice(&empty), wgpu::BufferUsages::COPY_SRC);
        Culling {
            visible: storage_buffer(gpu, "visible clusters", u64::from(casters.item_count) * 4),
            draws: storage_buffer(gpu, "cluster draws", empty_draws.size()),
            empty_draws,
        }
    }

    /// True if made for casters of this size.
    pub fn fits(&self, casters: &Casters) -> bool {
        self.visible.size() == (u64::from(casters.item_count) * 4).max(16)
            && self.draws.size() == casters.batches.len().max(1) as u64 * DRAW_STRIDE
    }

    /// GPU memory, in bytes.
    pub fn bytes(&self) -> u64 {
        self.visible.size() + 2 * self.draws.size()
    }

    /// First byte of a batch's draw arguments.
    pub(crate) fn draw_offset(batch: usize) -> u64 {
        batch as u64 * DRAW_STRIDE
    }

    /// Finds the clusters of these surfaces that touch the frustum.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        label: &str,
        casters: &Casters,
        surfaces: Surfaces,
        view: &wgpu::Buffer,
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::culling")
            .feature("occluders", surfaces == Surfaces::Occluders)
            .feature("receivers", surfaces == Surfaces::Receivers)
            .feature("background", surfaces == Surfaces::Background)
            .with::<MapView>()
            .with::<BatchLayout>();
        let pipeline = recorder.gpu.compute_pipeline(&key, "cull")?;
        recorder.encoder.copy_buffer_to_buffer(&self.empty_draws, 0, &self.draws, 0, self.draws.size());
        recorder.compute_pass(label, |gpu, pass| {
            pass.set_pipeline(&pipeline.pipeline);
            for (i, batch) in casters.batches.iter().enumerate().filter(|(_, b)| b.item_count > 0) {
                let draw = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &self.draws,
                    offset: Self::draw_offset(i),
                    size: std::num::NonZero::new(32),
                });
                let mut set =
                    bindings! { map_view: view, boxes: &casters.cluster_bounds, visible: &self.visible }.to_vec();
                set.push(("draw", draw));
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                let groups = batch.item_count.div_ceil(64);
                let side = groups.min(1 << 15);
                pass.dispatch_workgroups(side, groups.div_ceil(side), 1);
            }
        });
        Ok(())
    }

    /// Triangles that the last frame drew. Waits for the GPU: for tests and reports.
    pub async fn triangles_drawn(&self, gpu: &Gpu) -> Result<u64, Error> {
        let bytes = read_buffer(gpu, &self.draws).await?;
        let draws = bytes.chunks_exact(DRAW_STRIDE as usize);
        Ok(draws.map(|d| u64::from(u32::from_le_bytes([d[16], d[17], d[18], d[19]]))).sum())
    }
}
