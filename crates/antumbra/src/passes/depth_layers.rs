//! The nearest few casters of each texel, seen from the light's centre, in one pass over the casters.
//!
//! Each fragment puts its depth in its place among the texel's nearest by a chain of atomic maxima: the multi-depth test
//! of [Liu et al. 2010]. Peeling, a pass over the casters for each layer, gives the same bits. On llvmpipe, 2 cores, the
//! one pass takes this part of peeling's time, clearing and copying included (medians of 5 frames):
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
//! layers and of triangles, and over all takes two thirds of the time. GPUs have not been measured. Reading the buffer
//! instead of a texture made from it would save a twentieth. The price is memory: 2k + 1 maps for k layers where peeling
//! has k.

use crate::casters::Casters;
use crate::passes::depth_map::DepthMap;
use crate::recorder::{Recorder, Work};
use crate::shader::{HostStruct, ShaderKey};
use crate::resource::{Texture, storage_buffer, uniform};
use crate::technique::Memory;
use crate::{Error, Frame, Gpu, bindings, gpu_struct};

gpu_struct! {
    /// Where a texel's depths are in the buffer, layer after layer.
    pub(crate) struct LayerShape {
        /// Texels from one row to the next.
        row: u32,
        /// Texels from one layer to the next.
        layer: u32,
        /// Layers.
        count: u32,
        gap: f32,
    }
}

/// Square maps of `near / z` as in [`DepthMap`], one behind the other: layer `i` holds the i-th nearest surface of each
/// texel, front or back, and 0 where there are no more. Depths descend strictly: surfaces of the same depth to the last
/// bit are one. Coinciding surfaces that are not of the same triangles may differ in the last bits, by up to some 4e-7 of
/// the depth, and are then two.
pub struct DepthLayers {
    /// `R32Float`, `size` x `size` x `layers`; its view is an array even of a single layer.
    pub texture: Texture,
    /// The first layer as a depth map, drawn by the way.
    pub nearest: DepthMap,
    depths: wgpu::Buffer,
    shape: LayerShape,
    shape_buffer: wgpu::Buffer,
}

impl DepthLayers {
    /// Empty maps of `size` texels a side; `layers` is 1 or more.
    pub fn new(gpu: &Gpu, size: u32, layers: u32, casters: &Casters) -> Result<DepthLayers, Error> {
        gpu.check_size("shadow map", size, size)?;
        let row = size.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4);
        let kept = layers;
        let layers = std::env::var("COLLECT").map_or(layers, |v| v.parse().unwrap());
        let shape = LayerShape { row, layer: row * size, count: layers, gap: 0.0 };
        let bytes = 4 * u64::from(row) * u64::from(size) * u64::from(layers);
        let limits = gpu.device.limits();
        let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
        if bytes > most {
            let max = (most / (4 * u64::from(layers))).isqrt() as u32;
            return Err(Error::Size { what: "depth layers", width: size, height: size, max });
        }
        let usage =
            wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        Ok(DepthLayers {
            texture: Texture::array(gpu, "depth layers", [size; 2], kept, 1, wgpu::TextureFormat::R32Float, usage),
            nearest: DepthMap::new(gpu, size, casters)?,
            depths: storage_buffer(gpu, "nearest depths", bytes),
            shape,
            shape_buffer: uniform(gpu, "layer shape", &shape),
        })
    }

    /// Makes maps in `slot` unless `layers` of this size for these casters are there, and draws what the light's centre
    /// sees and what lies behind it.
    pub fn of_light<'a>(
        slot: &'a mut Option<DepthLayers>,
        recorder: &mut Recorder,
        frame: &Frame,
        size: u32,
        layers: u32,
    ) -> Result<&'a DepthLayers, Error> {
        let casters = &frame.casters;
        if !slot.as_ref().is_some_and(|m| m.nearest.fits(size, casters) && m.texture.texture.depth_or_array_layers() == layers) {
            *slot = None; // Frees the old maps before the new ones are made.
            *slot = Some(DepthLayers::new(recorder.gpu, size, layers, casters)?);
        }
        let maps = slot.as_ref().expect("just made");
        maps.record(recorder, frame)?;
        Ok(maps)
    }

    fn record(&self, recorder: &mut Recorder, frame: &Frame) -> Result<(), Error> {
        recorder.encoder.clear_buffer(&self.depths, 0, None);
        let set = bindings! { nearest_depths: &self.depths, layer_shape: &self.shape_buffer };
        self.nearest.draw(recorder, "depth layers", &frame.casters, frame.map_clip_from_world(), Some(set))?;
        let size = self.texture.texture.size();
        let kappa: f32 = std::env::var("KAPPA").map_or(0., |v| v.parse().unwrap());
        if kappa > 0. {
            let texel = frame.frustum.tan_half * 2.0 / size.width as f32;
            let per = texel / (0.5 * frame.light.size.max(glam::Vec2::splat(1e-6)));
            let gap = kappa * per.min_element() * frame.frustum.near;
            let v = LayerShape { gap, ..self.shape };
            recorder.gpu.queue.write_buffer(&self.shape_buffer, 0, &v.uniform_bytes());
            let key = ShaderKey::new("passes::depth_layers").with::<LayerShape>();
            let thin = recorder.gpu.compute_pipeline(&key, "thin")?;
            let set = bindings! { nearest_depths: &self.depths, layer_shape: &self.shape_buffer };
            let n = (self.shape.layer).div_ceil(64);
            recorder.compute("thin", &thin, set, Work::Groups([n.min(65535), n.div_ceil(65535), 1]));
        }
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * self.shape.row),
            rows_per_image: Some(size.height),
        };
        let source = wgpu::TexelCopyBufferInfo { buffer: &self.depths, layout };
        recorder.encoder.copy_buffer_to_texture(source, self.texture.texture.as_image_copy(), size);
        Ok(())
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 2] {
        let [culling, map] = self.nearest.memory();
        [culling, Memory::new("depth layers", self.depths.size() + self.texture.bytes() + map.bytes)]
    }
}
