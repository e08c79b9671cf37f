//! Drawing: the clusters of each map's frustum are found for all maps in one dispatch, and a render pass draws as many
//! layers as the adapter allows.

use super::light_samples;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::{Recorder, Work, depth_target};
use crate::gpu::resources::{BufferDescription, UniformArray};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::casters::Casters;
use crate::input::frame::BoundFrame;
use crate::{bindings, gpu_struct};
use glam::Vec2;
use std::ops::Range;

gpu_struct! {
    /// The map in a layer.
    pub(crate) struct MapSlot {
        /// Index in the table of light samples.
        sample: u32,
        /// The stage that draws it; see `MapStage`.
        stage: u32,
    }
}

gpu_struct! {
    /// A round of drawing: the slots of one stage.
    pub(crate) struct MapStage {
        stage: u32,
        /// The slot of the table that layer 0 shows.
        first_slot: u32,
        /// The groups of layers that are drawn, and the number of layers in each.
        first_group: u32,
        group_count: u32,
        layers: u32,
        batch_count: u32,
        /// Clusters in all batches.
        cluster_count: u32,
    }
}

gpu_struct! {
    /// The group that a draw is for.
    pub(crate) struct GroupUniform {
        group: u32,
    }
}

/// Memory that an array of maps may take. WebGPU does not tell the amount of GPU memory.
const MOST_BYTES: u64 = 1 << 29;

/// Bytes of the arguments of an indirect draw.
const DRAW_BYTES: u64 = 16;

/// A stack of square `Depth32Float` maps of `near / z`, as in [`DepthMap`](crate::passes::maps::depth_map::DepthMap),
/// and the points of the light that they are drawn from.
pub struct LightMaps {
    /// One layer per map.
    pub texture: Texture,
    /// An array of `LightSample`.
    pub(crate) samples: wgpu::Buffer,
    layout: Layers,
    visible: wgpu::Buffer,
    draws: wgpu::Buffer,
    /// The number of each group.
    numbers: UniformArray,
}

/// The layers of an array of maps: groups that one render pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layers {
    pub per_group: u32,
    pub groups: u32,
    cluster_count: u32,
    batch_count: u32,
}

impl Layers {
    /// Layers for `capacity` maps of these casters.
    pub fn new(gpu: &Gpu, capacity: u32, casters: &Casters) -> Layers {
        let per_group = gpu.capabilities.layers_per_pass.min(capacity);
        Layers {
            per_group,
            groups: capacity.div_ceil(per_group),
            cluster_count: casters.cluster_count,
            batch_count: casters.batches.len().max(1) as u32,
        }
    }

    /// The stage of a drawing round over these layers, for [`LightMaps::record`].
    pub fn stage(&self, stage: u32, first_slot: u32, layers: Range<u32>) -> MapStage {
        let first_group = layers.start / self.per_group;
        let last = layers.end.div_ceil(self.per_group).min(self.groups);
        MapStage {
            stage,
            first_slot,
            first_group,
            group_count: last.saturating_sub(first_group),
            layers: self.per_group,
            batch_count: self.batch_count,
            cluster_count: self.cluster_count,
        }
    }
}

impl LightMaps {
    /// Maps of `size` texels per side, drawn from points of the light: positions in [-1/2, 1/2]².
    pub(crate) fn new(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        size: u32,
        layout: Layers,
        points: &[Vec2],
    ) -> Result<LightMaps, Error> {
        recorder.gpu.check_size("shadow map", size, size)?;
        let Layers { per_group, groups, cluster_count, batch_count } = layout;
        let clusters = u64::from(cluster_count) * u64::from(groups);
        let draws = u64::from(groups * batch_count) * DRAW_BYTES;
        let help = "one depth map for each point of the light, as near / z";
        let description = TextureDescription::new([size; 2], wgpu::TextureFormat::Depth32Float, help);
        recorder.debug_points("light samples", points);
        Ok(LightMaps {
            samples: light_samples(recorder, frame, points),
            visible: recorder.buffer("visible clusters", BufferDescription::new(clusters * 4)),
            draws: recorder.buffer("cluster draws", BufferDescription::new(draws)),
            numbers: recorder.uniforms("groups of layers", (0..groups).map(|group| GroupUniform { group })),
            texture: recorder.texture("light maps", description.layers(groups * per_group)),
            layout,
        })
    }

    /// The largest number of maps of `size` texels per side that one array holds on this device: as many as it has
    /// layers, within half a gigabyte.
    pub fn most(gpu: &Gpu, size: u32) -> u32 {
        let by_memory = (MOST_BYTES / (4 * u64::from(size) * u64::from(size))).min(u64::from(u32::MAX)) as u32;
        let layers = gpu.device.limits().max_texture_array_layers.min(by_memory);
        // Whole groups of layers, or a single map.
        let group = gpu.capabilities.layers_per_pass;
        if layers < group { layers.max(1) } else { layers / group * group }
    }

    /// Draws the slots that belong to a stage, which is bound as `stage_binding`.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        slots: &wgpu::Buffer,
        stage: &MapStage,
        stage_binding: &wgpu::BindingResource,
    ) -> Result<(), Error> {
        let set = bindings! {
            map_stage: stage_binding,
            light_samples: &self.samples,
            map_slots: slots,
        };
        let visible = bindings! { visible: &self.visible };
        self.cull(recorder, casters, stage, &[set, visible])?;
        let layers = self.layout.per_group;
        let target = RenderTarget { depth: Some(wgpu::CompareFunction::Greater), layers, ..RenderTarget::default() };
        let key = ShaderKey::new("passes::maps::light_maps::draw").feature("layered", layers > 1);
        let opaque = recorder.gpu.render_pipeline(&key, &target)?;
        let masked = recorder.gpu.render_pipeline(&key.feature("masked", true), &target)?;
        let clear_target = RenderTarget { depth: Some(wgpu::CompareFunction::Always), ..target };
        let key = ShaderKey::new("passes::maps::light_maps::clear").feature("layered", layers > 1);
        let clear = recorder.gpu.render_pipeline(&key, &clear_target)?;
        for group in stage.first_group..stage.first_group + stage.group_count {
            let view = self.texture.layers(group * layers, layers);
            let number = self.numbers.at(group);
            let group_set = bindings! { map_group: &number };
            // The layers of other stages keep their maps.
            recorder.render("light maps", &[], depth_target(&view, None), layers, |draw| {
                draw.bind(&clear, &[set, group_set])?;
                draw.pass.draw(0..3, 0..1);
                for (i, batch) in casters.batches.iter().enumerate() {
                    let pipeline = if batch.masked { &masked } else { &opaque };
                    draw.bind(pipeline, &[set, visible, group_set, &batch.bindings(casters)])?;
                    let index = u64::from(group * self.layout.batch_count + i as u32);
                    draw.pass.draw_indirect(&self.draws, index * DRAW_BYTES);
                }
                Ok(())
            })?;
        }
        Ok(())
    }

    /// Lists the clusters that any map of a group touches, for every group of the stage.
    fn cull(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        stage: &MapStage,
        [set, visible]: &[&[Binding]; 2],
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::maps::light_maps::culling");
        let cull = recorder.gpu.compute_pipeline(&key, "cull_for_light_maps")?;
        recorder.clear(&self.draws, None);
        let more = bindings! { boxes: &casters.cluster_bounds, draws: &self.draws };
        for batch in casters.batches.iter().filter(|b| b.cluster_count > 0) {
            let work = Work::Groups([batch.cluster_count.div_ceil(64).min(1 << 15), stage.group_count, 1]);
            recorder.compute("cluster culling", &cull, &[set, visible, more, &batch.bindings(casters)], work)?;
        }
        Ok(())
    }
}
