//! The texels of a map from the light's centre that the boundary of a shadow may cross [Pan 2009, section 3.2].

use crate::error::Error;
use crate::gpu::debug_view::DebugLayout;
use crate::gpu::device::Gpu;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::Texture;
use crate::input::frame::{BoundFrame, light_from_world};
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::maps::summed_area::mask_counts;
use crate::passes::triangles::adjacency::edge_rings;
use crate::passes::triangles::culling::Culling;
use crate::{binding_array, bindings, gpu_struct};
use glam::Mat4;

gpu_struct! {
    /// The mask and the light.
    pub(crate) struct SilhouetteUniform {
        light_from_world: Mat4,
        /// Texels per side.
        size: u32,
        /// Words of 32 texels per row.
        row: u32,
        /// 1 if edges behind the depth map are left out.
        hide: u32,
    }
}

/// A bit per texel, set where a silhouette edge passes or a surface with holes lies, and the number of set bits in any
/// rectangle.
pub struct SilhouetteMask {
    /// Word `y row + x / 32`, bit `x % 32`.
    pub texels: wgpu::Buffer,
    /// The summed-area table of the bits; see `shaders/mask_counts.wesl`.
    pub counts: Texture,
    /// The number of silhouette edges, if they are counted.
    edges: Option<wgpu::Buffer>,
}

/// Options of a mask.
#[derive(Clone, Copy, Debug)]
pub struct Marking {
    /// Leaves out texels that lie behind the depth map all around.
    pub hide: bool,
    /// Counts edges, for tests and reports.
    pub count: bool,
}

impl SilhouetteMask {
    /// Marks the texels that the silhouettes of the clusters in `map` pass. `map` is drawn from the light's centre; the
    /// mask has its size.
    pub fn record(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        map: &DepthMap,
        marking: Marking,
    ) -> Result<SilhouetteMask, Error> {
        let rings = edge_rings(recorder.gpu, &frame.casters)?;
        let key = ShaderKey::new("passes::triangles::silhouette::mark").feature("counted", marking.count);
        let unmasked = recorder.gpu.compute_pipeline(&key, "mark")?;
        let masked = recorder.gpu.compute_pipeline(&key.feature("masked", true), "mark")?;
        let (size, row) = (map.size, map.size.div_ceil(32));
        let light_from_world = light_from_world(&frame.light).as_mat4();
        let uniform = SilhouetteUniform { light_from_world, size, row, hide: u32::from(marking.hide) };
        let uniform = recorder.uniform("silhouettes", &uniform);
        let help = "texels of the map from the light's centre that a silhouette or a surface with holes crosses";
        let texels = BufferDescription::new(4 * u64::from(row) * u64::from(size));
        let texels = texels.cleared().debug(help, DebugLayout::Mask { side: size });
        let texels = recorder.buffer("silhouette mask", texels);
        let edges = BufferDescription::new(4).cleared();
        let edges = marking.count.then(|| recorder.buffer("silhouette edges", edges));
        let own = bindings! {
            depth_map: &map.texture,
            silhouette: &uniform,
            visible: &map.culling.visible,
            marks: &texels,
        };
        let counted = edges.as_ref().map(|edges| binding_array! { silhouette_edges: edges });
        let counted = counted.as_ref().map(|set| &set[..]).unwrap_or_default();
        for (i, batch) in frame.casters.batches.iter().enumerate().filter(|(_, b)| b.cluster_count > 0) {
            let pipeline = if batch.masked { &masked } else { &unmasked };
            let draw = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &map.culling.draws,
                offset: Culling::draw_offset(i),
                size: std::num::NonZero::new(32),
            });
            let of_batch = bindings! { draw: &draw, ring: &rings[i] };
            let set: [&[_]; 5] = [&frame.bindings(), own, counted, of_batch, &batch.bindings(&frame.casters)];
            recorder.compute("silhouette mask", pipeline, &set, Work::groups(batch.cluster_count))?;
        }
        let counts = mask_counts(recorder, "silhouette mask", &texels, size)?;
        Ok(SilhouetteMask { texels, counts, edges })
    }

    /// The numbers of silhouette edges, if they were counted, and of silhouette texels. Waits for the GPU: for tests
    /// and reports.
    pub async fn stats(&self, gpu: &Gpu) -> Result<[u64; 2], Error> {
        let mut edges = 0;
        if let Some(buffer) = &self.edges {
            edges = u64::from(bytemuck::pod_read_unaligned::<u32>(&read_buffer(gpu, buffer).await?[..4]));
        }
        let texels = read_buffer(gpu, &self.texels).await?;
        Ok([edges, texels.iter().map(|byte| u64::from(byte.count_ones())).sum()])
    }
}
