//! The nearest few casters of each texel, seen from the light's centre, in one pass over the casters.
//!
//! Each fragment puts its depth in its place among the texel's nearest by a chain of atomic maxima: the multi-depth test
//! of [Liu et al. 2010]. Peeling, a pass over the casters for each layer, gives the same bits. On llvmpipe, 2 cores, the
//! one pass takes this part of peeling's time for as many surfaces as layers, clearing and copying included (medians of 5
//! frames):
//!
//! | scene (triangles) | 1024 texels, 2 layers | 4 layers | 2048 texels, 2 layers | 4 layers |
//! |---|---|---|---|---|
//! | fence (5 thousand) | 0.84 | 0.56 | 1.16 | 0.74 |
//! | layers (8 thousand) | 0.94 | 0.69 | 1.95 | 1.08 |
//! | plant (10 thousand) | 0.67 | 0.44 | 0.91 | 0.55 |
//! | Stanford bunny (69 thousand) | 0.77 | 0.37 | 0.86 | 0.47 |
//! | bumpy (476 thousand) | 0.51 | 0.28 | 0.61 | 0.31 |
//!
//! Peeling wins where few triangles cover many texels and two layers are asked for; the one pass gains with the number of
//! layers and of triangles, and over all takes two thirds of the time. GPUs have not been measured. The price is memory:
//! for k layers that are surfaces 3k + 1 maps where peeling has k, and four more where surfaces are merged.

use crate::input::casters::Casters;
use crate::passes::triangles::culling::Surfaces;
use crate::passes::maps::depth_map::{DepthMap, Drawing};
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{Texture, storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// Where a texel's depths are in the buffer, one behind the other, row after row.
    pub(crate) struct LayerShape {
        /// Texels a side.
        size: u32,
        /// Texels from one row to the next.
        row: u32,
        /// Surfaces that are collected.
        count: u32,
        /// Surfaces that are less than this behind a layer's first are of that layer, in the unit of the depths.
        gap: f32,
    }
}

/// Square maps, one behind the other, of what lies between two distances: each texel has the `near / z` of the nearer, as
/// in [`DepthMap`], and the difference to that of the farther. A layer is a surface, or several that the light can hardly
/// tell apart, such as both sides of a slat or the leaves of a twig. The last one is a column down to surfaces for which
/// no layer is left. Where there are no more, it is 0.
///
/// Surfaces of the same depth to the last bit are one. Coinciding surfaces that are not of the same triangles may differ in
/// the last bits, by up to some 4e-7 of the depth.
pub struct DepthLayers {
    /// `Rg32Float`, `size` x `size` x `layers`; its view is an array even of a single layer.
    pub texture: Texture,
    /// The nearest surface as a depth map, drawn by the way.
    pub nearest: DepthMap,
    /// Whether more surfaces than layers are collected.
    merged: bool,
    /// 0 between frames.
    depths: wgpu::Buffer,
    shape: LayerShape,
    shape_buffer: wgpu::Buffer,
}

/// Surfaces that are collected for each texel besides a layer each, where several may be one: as a rule both sides of two
/// more things.
const COLLECTED_BESIDES: u32 = 4;

impl DepthLayers {
    /// Empty maps of `size` texels a side; `layers` is 1 or more. If surfaces are `merged`, more than that are collected,
    /// as far as they fit into a buffer.
    pub fn new(gpu: &Gpu, size: u32, layers: u32, merged: bool, casters: &Casters) -> Result<DepthLayers, Error> {
        gpu.check_size("shadow map", size, size)?;
        let limits = gpu.device.limits();
        let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size) / 4;
        let row = size.next_multiple_of(64);
        let texels = u64::from(row) * u64::from(size);
        let fit = (most / texels) as u32;
        if fit < layers {
            let max = (most / u64::from(layers)).isqrt() as u32;
            return Err(Error::Size { what: "depth layers", width: size, height: size, max });
        }
        let count = if merged { (layers + COLLECTED_BESIDES).min(fit) } else { layers };
        let shape = LayerShape { size, row, count, gap: 0.0 };
        let usage =
            wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(DepthLayers {
            texture: Texture::array(gpu, "depth layers", [size; 2], layers, 1, wgpu::TextureFormat::Rg32Float, usage),
            depths: storage_buffer(gpu, "nearest depths", 4 * texels * u64::from(count)),
            nearest: DepthMap::new(gpu, size, casters)?,
            merged,
            shape,
            shape_buffer: uniform(gpu, "layer shape", &shape),
        })
    }

    /// Makes maps in `slot` unless `layers` of this size for these casters are there, and draws what the light's centre
    /// sees and what lies behind it. What moves by less than `apart` texels against the first surface of a layer when the
    /// eye goes from the light's centre to its rim is of that layer. 0 gives each surface its own, and leaves out those
    /// behind the last.
    pub fn of_light<'a>(
        slot: &'a mut Option<DepthLayers>,
        recorder: &mut Recorder,
        frame: &Frame,
        size: u32,
        layers: u32,
        apart: f32,
    ) -> Result<&'a DepthLayers, Error> {
        let (casters, merged) = (&frame.casters, apart > 0.0);
        let fits = |m: &DepthLayers| {
            let kept = m.texture.texture.depth_or_array_layers();
            m.nearest.fits(size, casters) && kept == layers && m.merged == merged
        };
        if !slot.as_ref().is_some_and(fits) {
            *slot = None; // Frees the old maps before the new ones are made.
            *slot = Some(DepthLayers::new(recorder.gpu, size, layers, merged, casters)?);
        }
        let maps = slot.as_ref().expect("just made");
        maps.record(recorder, frame, apart)?;
        Ok(maps)
    }

    fn record(&self, recorder: &mut Recorder, frame: &Frame, apart: f32) -> Result<(), Error> {
        let gap = frame.frustum.near * self.gap(frame, apart);
        let shape = LayerShape { gap, ..self.shape };
        recorder.gpu.queue.write_buffer(&self.shape_buffer, 0, &shape.uniform_bytes());
        let collected = bindings! { nearest_depths: &self.depths, layer_shape: &self.shape_buffer };
        let drawing = Drawing { layers: Some(collected), ..Drawing::of("depth layers", Surfaces::Casters) };
        self.nearest.draw(recorder, &frame.casters, frame.map_clip_from_world(), &drawing)?;
        let key = ShaderKey::new("passes::maps::depth_layers");
        let merge = recorder.gpu.compute_pipeline(&key, "merge_layers")?;
        let set = bindings! {
            nearest_depths: &self.depths,
            layer_shape: &self.shape_buffer,
            layers: &self.texture,
        };
        recorder.compute("merging layers", &merge, set, Work::Threads([shape.size, shape.size, 1]));
        Ok(())
    }

    /// The difference of inverse distances at which the light moves surfaces by `apart` texels against each other.
    pub fn gap(&self, frame: &Frame, apart: f32) -> f32 {
        let texel = 2.0 * frame.frustum.tan_half / self.shape.size as f32;
        let half_light = (0.5 * frame.light.size).max(glam::Vec2::splat(1.0e-6));
        apart * (texel / half_light).min_element()
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture::of_texture(
            "depth layers",
            "near and far end of each layer of surfaces, as inverse distance",
            &self.texture,
        )
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 2] {
        let [culling, map] = self.nearest.memory();
        [culling, Memory::new("depth layers", self.depths.size() + self.texture.bytes() + map.bytes)]
    }
}
