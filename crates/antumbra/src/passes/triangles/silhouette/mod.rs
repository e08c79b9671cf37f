//! The texels of a map from the light's centre that a shadow's boundary may pass [Pan 2009, section 3.2].

use crate::input::casters::BatchLayout;
use crate::input::frame::{Frame, FrameUniform, light_from_world};
use crate::passes::triangles::culling::Culling;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::summed_area::SummedArea;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::{storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerContent, InnerPicture, Memory};
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::Mat4;

gpu_struct! {
    /// How silhouettes are looked for.
    pub(crate) struct SilhouetteUniform {
        light_from_world: Mat4,
        /// Texels a side.
        size: u32,
        /// Words of 32 texels a row.
        row: u32,
        /// 1 if edges behind what the depth map holds are left out.
        hide: u32,
    }
}

/// A bit for each texel, set where a silhouette edge passes or a surface with holes lies, and the number of set bits in
/// any rectangle.
pub struct SilhouetteMask {
    /// A bit a texel: word `y row + x / 32`, bit `x % 32`.
    pub texels: wgpu::Buffer,
    /// How many are set before each texel: [`SummedArea`] of counts.
    pub counts: SummedArea,
    /// Silhouette edges and texels of the last frame, if it was told to count.
    counters: wgpu::Buffer,
    uniform: wgpu::Buffer,
    size: u32,
}

/// How a mask is made.
#[derive(Clone, Copy, Debug)]
pub struct Marking {
    /// Leaves out what lies behind the depth map around it.
    pub hide: bool,
    /// Counts edges, for tests and reports.
    pub count: bool,
}

impl SilhouetteMask {
    /// An empty mask of `size` texels a side.
    pub fn new(gpu: &Gpu, size: u32) -> Result<SilhouetteMask, Error> {
        let row = size.div_ceil(32);
        let empty = SilhouetteUniform { light_from_world: Mat4::IDENTITY, size, row, hide: 0 };
        Ok(SilhouetteMask {
            texels: storage_buffer(gpu, "silhouette mask", u64::from(row * size) * 4),
            counts: SummedArea::of_mask(gpu, size)?,
            counters: storage_buffer(gpu, "silhouette edges", 16),
            uniform: uniform(gpu, "silhouettes", &empty),
            size,
        })
    }

    /// Makes a mask in `slot` unless one of this size is there.
    pub fn ensure<'a>(slot: &'a mut Option<SilhouetteMask>, gpu: &Gpu, size: u32) -> Result<&'a SilhouetteMask, Error> {
        if slot.as_ref().is_none_or(|m| m.size != size) {
            *slot = Some(SilhouetteMask::new(gpu, size)?);
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// Marks the texels that the silhouettes of what `map` holds pass, and counts them over all rectangles. `map` has
    /// been drawn from the light's centre and is of the mask's size.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        map: &DepthMap,
        marking: Marking,
    ) -> Result<(), Error> {
        let adjacency = frame.casters.adjacency(recorder.gpu)?;
        let value = SilhouetteUniform {
            light_from_world: light_from_world(&frame.light).as_mat4(),
            size: self.size,
            row: self.size.div_ceil(32),
            hide: u32::from(marking.hide),
        };
        recorder.gpu.queue.write_buffer(&self.uniform, 0, &value.uniform_bytes());
        recorder.encoder.clear_buffer(&self.texels, 0, None);
        recorder.encoder.clear_buffer(&self.counters, 0, None);
        let key = ShaderKey::new("passes::triangles::silhouette::mark")
            .feature("counted", marking.count);
        let edges = recorder.gpu.compute_pipeline(&key, "mark")?;
        let surfaces = recorder.gpu.compute_pipeline(&key.feature("masked", true), "mark")?;
        let culling = map.culling();
        recorder.compute_pass("silhouette mask", |gpu, pass| {
            for (i, batch) in frame.casters.batches.iter().enumerate().filter(|(_, b)| b.cluster_count > 0) {
                let pipeline = if batch.masked { &surfaces } else { &edges };
                let draw = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &culling.draws,
                    offset: Culling::draw_offset(i),
                    size: std::num::NonZero::new(32),
                });
                let set = frame.bindings(bindings! {
                    depth_map: &map.texture,
                    silhouette: &self.uniform,
                    ring: &adjacency.rings[i],
                    visible: &culling.visible,
                    draw: &draw,
                    marks: &self.texels,
                    silhouette_edges: &self.counters,
                });
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(&frame.casters)), &[]);
                let side = batch.cluster_count.min(1 << 15);
                pass.dispatch_workgroups(side, batch.cluster_count.div_ceil(side), 1);
            }
        });
        self.counts.record_counts(recorder, "silhouette mask", &self.texels)
    }

    /// Silhouette edges, if they were counted, and silhouette texels of the last frame. Waits for the GPU: for tests and
    /// reports.
    pub async fn stats(&self, gpu: &Gpu) -> Result<[u64; 2], Error> {
        let words = |bytes: Vec<u8>| -> Vec<u32> { bytemuck::pod_collect_to_vec(&bytes) };
        let edges = words(crate::gpu::resources::read_buffer(gpu, &self.counters).await?)[0];
        let texels = words(crate::gpu::resources::read_buffer(gpu, &self.texels).await?);
        Ok([u64::from(edges), texels.iter().map(|w| u64::from(w.count_ones())).sum()])
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture {
            name: "silhouette mask",
            help: "texels of the map from the light's centre that a silhouette passes, or a surface with holes",
            content: InnerContent::Mask { bits: self.texels.clone(), side: self.size },
        }
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("silhouette mask", self.texels.size() + self.counters.size() + self.counts.memory().bytes)
    }
}
