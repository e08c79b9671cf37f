//! Drawing: what each map's frustum touches is found for all maps in one dispatch, and as many layers are drawn in a
//! render pass as the adapter allows.

use super::{LightSample, LightSamples};
use crate::input::casters::{BatchLayout, CLUSTER_TRIANGLES, Casters};
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::{Texture, UniformArray, buffer_of, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use std::ops::Range;

gpu_struct! {
    /// What a layer holds.
    pub(crate) struct MapSlot {
        /// Place in the table of light samples.
        sample: u32,
        /// The stage that draws it; see `MapStage`.
        stage: u32,
    }
}

gpu_struct! {
    /// One round of drawing: the slots of one stage.
    pub(crate) struct MapStage {
        stage: u32,
        /// The slot of the table that layer 0 shows.
        first_slot: u32,
        /// The groups of layers that are drawn, and how many layers a group has.
        first_group: u32,
        group_count: u32,
        layers: u32,
        batch_count: u32,
        /// Clusters in all batches.
        cluster_count: u32,
    }
}

/// Memory that an array of maps may take. WebGPU tells nobody how much there is.
const MOST_BYTES: u64 = 1 << 29;

/// Bytes of the arguments of an indirect draw.
const DRAW_BYTES: u64 = 16;

/// A stack of square `Depth32Float` maps of `near / z`, as in [`DepthMap`](crate::passes::maps::depth_map::DepthMap).
pub struct LightMaps {
    /// One layer a map.
    pub texture: Texture,
    size: u32,
    /// What one render pass draws: a view of as many layers as the adapter draws at once.
    groups: Vec<wgpu::TextureView>,
    layers_per_group: u32,
    cluster_count: u32,
    batch_count: u32,
    visible: wgpu::Buffer,
    draws: wgpu::Buffer,
    no_draws: wgpu::Buffer,
    /// The number of each group.
    numbers: UniformArray<GroupUniform>,
}

gpu_struct! {
    /// Which group a draw is for.
    pub(crate) struct GroupUniform {
        group: u32,
    }
}

impl LightMaps {
    /// Room for `capacity` maps of `size` texels a side.
    pub fn new(gpu: &Gpu, size: u32, capacity: u32, casters: &Casters) -> Result<LightMaps, Error> {
        gpu.check_size("shadow map", size, size)?;
        let layers_per_group = gpu.capabilities.layers_per_pass.min(capacity);
        let group_count = capacity.div_ceil(layers_per_group);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let layers = group_count * layers_per_group;
        let texture = Texture::array(gpu, "light maps", [size; 2], layers, 1, wgpu::TextureFormat::Depth32Float, usage);
        let batch_count = casters.batches.len().max(1) as u32;
        let one = [3 * CLUSTER_TRIANGLES, 0, 0, 0];
        let empty = one.repeat((group_count * batch_count) as usize);
        let no_draws = buffer_of(gpu, "no draws", bytemuck::cast_slice(&empty), wgpu::BufferUsages::COPY_SRC);
        Ok(LightMaps {
            groups: (0..group_count).map(|g| texture.layers(g * layers_per_group, layers_per_group)).collect(),
            texture,
            size,
            layers_per_group,
            cluster_count: casters.cluster_count,
            batch_count,
            visible: storage_buffer(
                gpu,
                "visible clusters",
                u64::from(casters.cluster_count) * u64::from(group_count) * 4,
            ),
            draws: storage_buffer(gpu, "cluster draws", no_draws.size()),
            no_draws,
            numbers: UniformArray::new(
                gpu,
                "groups of layers",
                &(0..group_count).map(|group| GroupUniform { group }).collect::<Vec<_>>(),
            ),
        })
    }

    /// Makes maps in `slot` unless there are as many of this size for these casters.
    pub fn ensure<'a>(
        slot: &'a mut Option<LightMaps>,
        gpu: &Gpu,
        size: u32,
        capacity: u32,
        casters: &Casters,
    ) -> Result<&'a LightMaps, Error> {
        if !slot.as_ref().is_some_and(|m| m.fits(gpu, size, capacity, casters)) {
            *slot = None; // Frees the old maps before the new ones are made.
            *slot = Some(LightMaps::new(gpu, size, capacity, casters)?);
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// True if they are `capacity` maps of this size for these casters.
    pub fn fits(&self, gpu: &Gpu, size: u32, capacity: u32, casters: &Casters) -> bool {
        let layers = gpu.capabilities.layers_per_pass.min(capacity);
        self.size == size
            && self.layers_per_group == layers
            && self.groups.len() as u32 == capacity.div_ceil(layers)
            && self.cluster_count == casters.cluster_count
            && self.batch_count == casters.batches.len().max(1) as u32
    }

    /// The largest number of maps of `size` texels a side that one array holds on this device: as many as it has layers,
    /// in no more than half a gigabyte.
    pub fn most(gpu: &Gpu, size: u32) -> u32 {
        let by_memory = (MOST_BYTES / (4 * u64::from(size) * u64::from(size))).min(u64::from(u32::MAX)) as u32;
        let layers = gpu.device.limits().max_texture_array_layers.min(by_memory);
        // Whole groups of layers, or a single map.
        let group = gpu.capabilities.layers_per_pass;
        if layers < group { layers.max(1) } else { layers / group * group }
    }

    /// The stage of a drawing round over these layers, for [`LightMaps::record`].
    pub(crate) fn stage(&self, stage: u32, first_slot: u32, layers: Range<u32>) -> MapStage {
        let first_group = layers.start / self.layers_per_group;
        let last = layers.end.div_ceil(self.layers_per_group).min(self.groups.len() as u32);
        MapStage {
            stage,
            first_slot,
            first_group,
            group_count: last.saturating_sub(first_group),
            layers: self.layers_per_group,
            batch_count: self.batch_count,
            cluster_count: self.cluster_count,
        }
    }

    /// Draws the slots that belong to the stage at `index`.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        samples: &LightSamples,
        slots: &wgpu::Buffer,
        stages: &UniformArray<MapStage>,
        index: u32,
    ) -> Result<(), Error> {
        let (stage, stage_binding) = (stages.value(index), stages.at(index));
        let set = bindings! {
            map_stage: &stage_binding,
            light_samples: &samples.buffer,
            map_slots: slots,
            visible: &self.visible,
        };
        self.cull(recorder, casters, &stage, set)?;
        let target = RenderTarget {
            colors: Vec::new(),
            depth: Some(wgpu::CompareFunction::Greater),
            layers: self.layers_per_group,
            ..RenderTarget::default()
        };
        let key = Self::key("passes::maps::light_maps::draw").feature("layered", self.layers_per_group > 1);
        let opaque = recorder.gpu.render_pipeline(&key, &target)?;
        let masked = recorder.gpu.render_pipeline(&key.clone().feature("masked", true), &target)?;
        let wipe_target = RenderTarget { depth: Some(wgpu::CompareFunction::Always), ..target };
        let wipe =
            recorder.gpu.render_pipeline(&ShaderKey { module: "passes::maps::light_maps::wipe", ..key }, &wipe_target)?;
        for group in stage.first_group..stage.first_group + stage.group_count {
            let view = &self.groups[group as usize];
            let number = self.numbers.at(group);
            let set = [&set[..], bindings! { map_group: &number }].concat();
            recorder.layered_depth_pass("light maps", view, self.layers_per_group, |gpu, pass| {
                pass.set_pipeline(&wipe.pipeline);
                pass.set_bind_group(0, &wipe.bind_group(gpu, 0, &set), &[]);
                pass.draw(0..3, 0..1);
                for (i, batch) in casters.batches.iter().enumerate() {
                    let pipeline = if batch.masked { &masked } else { &opaque };
                    pass.set_pipeline(&pipeline.pipeline);
                    pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                    pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                    pass.draw_indirect(&self.draws, u64::from(group * self.batch_count + i as u32) * DRAW_BYTES);
                }
            });
        }
        Ok(())
    }

    /// Lists the clusters that any map of a group touches, for every group of the stage.
    fn cull(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        stage: &MapStage,
        set: &[crate::gpu::pipeline::Binding],
    ) -> Result<(), Error> {
        let cull = recorder.gpu.compute_pipeline(&Self::key("passes::maps::light_maps::culling"), "cull_for_light_maps")?;
        recorder.encoder.copy_buffer_to_buffer(&self.no_draws, 0, &self.draws, 0, self.draws.size());
        let more = bindings! { boxes: &casters.cluster_bounds, draws: &self.draws };
        let set = [set, more].concat();
        recorder.compute_pass("cluster culling", |gpu, pass| {
            pass.set_pipeline(&cull.pipeline);
            pass.set_bind_group(0, &cull.bind_group(gpu, 0, &set), &[]);
            for batch in casters.batches.iter().filter(|b| b.cluster_count > 0) {
                pass.set_bind_group(1, &cull.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                pass.dispatch_workgroups(batch.cluster_count.div_ceil(64).min(1 << 15), stage.group_count, 1);
            }
        });
        Ok(())
    }

    fn key(module: &'static str) -> ShaderKey {
        ShaderKey::new(module)
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture::of_texture("light maps", "one depth map for each point of the light, as near / z", &self.texture)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 2] {
        let lists = self.visible.size() + 2 * self.draws.size();
        [Memory::new("cluster culling", lists), Memory::new("light maps", self.texture.bytes())]
    }
}
