//! The shadow map: depth of the nearest caster seen from a point of the light.

use crate::casters::{BatchLayout, Casters};
use crate::passes::culling::{Culling, MapView, Surfaces};
use crate::passes::depth_layers::LayerShape;
use crate::pipeline::{Binding, RenderTarget};
use crate::recorder::{Recorder, depth_target};
use crate::resource::{Texture, uniform};
use crate::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerPicture, Memory};
use crate::{Error, Frame, Gpu, bindings, gpu_struct};
use glam::Mat4;

/// A square map of `near / z`, z being the linear distance along the light's normal and `near` that of the frustum
/// [Williams 1978]. The reversed depth with its far plane at infinity is the inverse distance itself: 0 is infinitely
/// far, planes are affine in the map's coordinates, and no second texture is needed for linear depth.
pub struct DepthMap {
    /// `Depth32Float`, `size` x `size`.
    pub texture: Texture,
    size: u32,
    samples: u32,
    view: wgpu::Buffer,
    texel: wgpu::Buffer,
    culling: Culling,
}

/// What is drawn into a map.
pub(crate) struct Drawing<'a> {
    /// Label of the pass.
    pub label: &'a str,
    /// What is drawn.
    pub surfaces: Surfaces,
    /// `Greater` keeps the nearest surface of each texel, `Less` the farthest; depth is reversed.
    pub kept: wgpu::CompareFunction,
    /// Where the farthest surface of each texel is kept.
    pub farthest: Option<Farthest<'a>>,
    /// Buffers that every surface of a texel is handed to; see [`DepthLayers`](crate::passes::depth_layers::DepthLayers).
    pub layers: Option<&'a [Binding<'a>]>,
    /// Whether a surface is drawn to every texel that it touches, not only to those whose middle it covers; then nothing
    /// else can be kept.
    pub touched: bool,
}

gpu_struct! {
    /// See `conservative_map.wesl`.
    pub(crate) struct ConservativeUniform {
        /// Half a texel in the units of clip space, and a little more for rounding.
        half_texel: f32,
    }
}

impl ConservativeUniform {
    fn of_map(size: u32) -> ConservativeUniform {
        ConservativeUniform { half_texel: 1.001 / size as f32 }
    }
}

/// The farthest surface of each texel that lies before another map of the same size.
#[derive(Clone, Copy)]
pub(crate) struct Farthest<'a> {
    /// What it has to lie before.
    pub before: &'a DepthMap,
    /// Four bytes a texel, row by row: the bits of its depth turned over, 0 where there is nothing.
    pub depths: &'a wgpu::Buffer,
}

impl<'a> Drawing<'a> {
    /// The nearest of these surfaces.
    pub fn of(label: &'a str, surfaces: Surfaces) -> Drawing<'a> {
        Drawing { label, surfaces, kept: wgpu::CompareFunction::Greater, farthest: None, layers: None, touched: false }
    }
}

impl DepthMap {
    /// An empty map of `size` texels a side.
    pub fn new(gpu: &Gpu, size: u32, casters: &Casters) -> Result<DepthMap, Error> {
        DepthMap::multisampled(gpu, size, 1, casters)
    }

    /// An empty map of `size` texels a side with 1 or 4 depths in each.
    pub fn multisampled(gpu: &Gpu, size: u32, samples: u32, casters: &Casters) -> Result<DepthMap, Error> {
        gpu.check_size("shadow map", size, size)?;
        let read = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let usage = if samples == 1 { read | wgpu::TextureUsages::COPY_SRC } else { read };
        Ok(DepthMap {
            texture: Texture::depth(gpu, "depth map", [size; 2], samples, usage),
            size,
            samples,
            view: uniform(gpu, "map view", &MapView::new(Mat4::IDENTITY)),
            texel: uniform(gpu, "map texel", &ConservativeUniform::of_map(size)),
            culling: Culling::new(gpu, casters),
        })
    }

    /// Makes a map in `slot` unless one of this size for these casters is there.
    pub fn ensure<'a>(
        slot: &'a mut Option<DepthMap>,
        gpu: &Gpu,
        size: u32,
        casters: &Casters,
    ) -> Result<&'a DepthMap, Error> {
        if !slot.as_ref().is_some_and(|m| m.fits(size, casters)) {
            *slot = Some(DepthMap::new(gpu, size, casters)?);
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// True if it is of this size for these casters, with one depth a texel.
    pub fn fits(&self, size: u32, casters: &Casters) -> bool {
        self.size == size && self.samples == 1 && self.culling.fits(casters)
    }

    /// Makes a map of `size` texels a side in `slot` if need be and draws what the light's centre sees.
    pub fn of_light<'a>(
        slot: &'a mut Option<DepthMap>,
        recorder: &mut Recorder,
        frame: &Frame,
        size: u32,
    ) -> Result<&'a DepthMap, Error> {
        let map = DepthMap::ensure(slot, recorder.gpu, size, &frame.casters)?;
        map.record(recorder, &frame.casters, frame.map_clip_from_world())?;
        Ok(map)
    }

    /// Draws the casters that `clip_from_world` holds.
    pub fn record(&self, recorder: &mut Recorder, casters: &Casters, clip_from_world: Mat4) -> Result<(), Error> {
        let drawing = Drawing::of("depth map", Surfaces::Casters);
        self.draw(recorder, casters, clip_from_world, &drawing)
    }

    /// Draws the casters that the light's centre sees, each to every texel that it touches: what no texel of a window
    /// shows is not in that window. Holes of masked materials that are smaller than a texel may be closed.
    pub(crate) fn record_touched(&self, recorder: &mut Recorder, frame: &Frame, label: &str) -> Result<(), Error> {
        let drawing = Drawing { touched: true, ..Drawing::of(label, Surfaces::Casters) };
        self.draw(recorder, &frame.casters, frame.map_clip_from_world(), &drawing)
    }

    /// Draws what is asked for.
    pub(crate) fn draw(
        &self,
        recorder: &mut Recorder,
        casters: &Casters,
        clip_from_world: Mat4,
        drawing: &Drawing,
    ) -> Result<(), Error> {
        let view = MapView::new(clip_from_world);
        recorder.gpu.queue.write_buffer(&self.view, 0, &view.uniform_bytes());
        self.culling.record(recorder, "cluster culling", casters, drawing.surfaces, &self.view)?;
        let depth = Some(drawing.kept);
        let native = drawing.touched && recorder.gpu.capabilities.conservative_rasterization;
        let target = RenderTarget { depth, samples: self.samples, conservative: native, ..RenderTarget::default() };
        let key = match drawing.touched {
            true => Self::key("passes::conservative_map").feature("native", native),
            false => Self::key("passes::depth_map")
                .feature("layers", drawing.layers.is_some())
                .feature("farthest", drawing.farthest.is_some()),
        };
        let opaque = recorder.gpu.render_pipeline(&key, &target)?;
        let masked = recorder.gpu.render_pipeline(&key.feature("masked", true), &target)?;
        let set = bindings! { map_view: &self.view, visible: &self.culling.visible, conservative: &self.texel };
        let mut set = [set, drawing.layers.unwrap_or_default()].concat();
        if let Some(Farthest { before, depths }) = drawing.farthest {
            recorder.encoder.clear_buffer(depths, 0, None);
            set.extend_from_slice(bindings! { background: &before.texture, farthest_depths: depths });
        }
        // Reversed depth: what is infinitely far is 0, and the nearest of all 1.
        let nothing = if drawing.kept == wgpu::CompareFunction::Less { 1.0 } else { 0.0 };
        let cleared = wgpu::RenderPassDepthStencilAttachment {
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(nothing), store: wgpu::StoreOp::Store }),
            ..depth_target(&self.texture.view)
        };
        recorder.render_pass(drawing.label, &[], Some(cleared), |gpu, pass| {
            for (i, batch) in casters.batches.iter().enumerate() {
                let pipeline = if batch.masked { &masked } else { &opaque };
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
                pass.draw_indirect(&self.culling.draws, Culling::draw_offset(i));
            }
        });
        Ok(())
    }

    fn key(module: &'static str) -> ShaderKey {
        let key = ShaderKey::new(module).with::<MapView>().with::<BatchLayout>();
        key.with::<LayerShape>().with::<ConservativeUniform>()
    }

    /// What was culled.
    pub fn culling(&self) -> &Culling {
        &self.culling
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture::of_texture(
            "depth map",
            "nearest caster as near / z: 0 is infinitely far, 1 at the near plane",
            &self.texture,
        )
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 2] {
        self.memory_of("depth map")
    }

    /// The same of a map that is drawn by a pass of this label.
    pub(crate) fn memory_of(&self, label: &'static str) -> [Memory; 2] {
        [Memory::new("cluster culling", self.culling.bytes()), Memory::new(label, self.texture.bytes())]
    }
}
