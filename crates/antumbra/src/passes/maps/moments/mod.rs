//! A shadow map that can be filtered: what a technique stores of each texel's depths, blurred, with a mip chain.

mod format;
pub(crate) mod fourier;
#[cfg(test)]
mod twin;
pub(crate) mod warp;

pub use format::TexelFormat;
pub use warp::{DepthWarp, Nearest};

use crate::input::casters::Casters;
use crate::passes::maps::light_depth::LightDepth;
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::{Texture, UniformArray, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::UVec2;

gpu_struct! {
    /// One direction of a Gaussian.
    pub(crate) struct BlurUniform {
        /// (1, 0) or (0, 1).
        axis: UVec2,
        /// Texels to each side of the middle.
        radius: i32,
        /// Of the Gaussian, texels.
        deviation: f32,
    }
}

/// What a moment map is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentShape {
    /// Texels a side.
    pub size: u32,
    /// Layers of four channels.
    pub layers: u32,
    /// What a texel is.
    pub format: TexelFormat,
    /// Depths a texel, 1 or 4, whose moments are averaged.
    pub samples: u32,
    /// Width of the Gaussian in texels, odd; 1 is none.
    pub blur: u32,
    /// Whether there is a mip chain.
    pub mips: bool,
}

/// Moments of the depths that the light's centre sees, or whatever else the module `warp` stores of them.
pub struct MomentMap {
    /// An array of `layers` layers with all mip levels.
    pub texture: Texture,
    /// The uniform of `shaders/depth_warp.wesl`.
    pub warp: wgpu::Buffer,
    shape: MomentShape,
    depth: LightDepth,
    /// Half-way through the blur.
    between: Option<Texture>,
    blur: UniformArray<BlurUniform>,
    levels: Vec<wgpu::TextureView>,
}

impl MomentMap {
    /// An empty map.
    pub fn new(gpu: &Gpu, shape: MomentShape, casters: &Casters) -> Result<MomentMap, Error> {
        let MomentShape { size, layers, format, samples, blur, mips } = shape;
        let depth = LightDepth::new(gpu, size, samples, casters)?;
        let count = if mips { 32 - size.leading_zeros() } else { 1 };
        let usage =
            wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let texture = |label, mips| Texture::array(gpu, label, [size; 2], layers, mips, format.texture(), usage);
        let moments = texture("moments", count);
        // The kernel ends at two standard deviations, as that of `pcf`.
        let deviation = (blur as f32 / 4.0).max(0.25);
        let along = |axis| BlurUniform { axis, radius: (blur / 2) as i32, deviation };
        Ok(MomentMap {
            levels: (0..count).map(|level| moments.array_mip(level)).collect(),
            texture: moments,
            warp: uniform(gpu, "depth warp", &DepthWarp::default()),
            between: (blur > 1).then(|| texture("half-blurred moments", 1)),
            blur: UniformArray::new(gpu, "blur", &[along(UVec2::X), along(UVec2::Y)]),
            shape,
            depth,
        })
    }

    /// Makes a map in `slot` unless one of this shape for these casters is there.
    pub fn ensure<'a>(
        slot: &'a mut Option<MomentMap>,
        gpu: &Gpu,
        shape: MomentShape,
        casters: &Casters,
    ) -> Result<&'a MomentMap, Error> {
        if !slot.as_ref().is_some_and(|m| m.shape == shape && m.depth.fits(casters)) {
            *slot = None; // Frees the old map before the new one is made.
            *slot = Some(MomentMap::new(gpu, shape, casters)?);
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// Draws what the light's centre sees, stores what the module at `part` makes of it, and filters that.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        part: &'static str,
        warp: DepthWarp,
    ) -> Result<(), Error> {
        self.depth.record(recorder, frame)?;
        recorder.gpu.queue.write_buffer(&self.warp, 0, &warp.uniform_bytes());
        self.store(recorder, part)?;
        self.blur(recorder)?;
        self.reduce(recorder)
    }

    fn store(&self, recorder: &mut Recorder, part: &'static str) -> Result<(), Error> {
        let key = self
            .key("passes::maps::moments::store")
            .part("warp", part)
            .feature("multisampled", self.shape.samples > 1)
            .feature("background", self.depth.background.is_some());
        let store = recorder.gpu.compute_pipeline(&key, "store")?;
        let set = bindings! {
            warp: &self.warp,
            source_map: &self.depth.casters.texture,
            background_map: &self.depth.behind().texture,
            texels: &self.levels[0],
        };
        recorder.compute("moments", &store, set, Work::Threads(self.threads(0)));
        Ok(())
    }

    fn blur(&self, recorder: &mut Recorder) -> Result<(), Error> {
        let Some(between) = &self.between else { return Ok(()) };
        let blur =
            recorder.gpu.compute_pipeline(&self.key("passes::maps::moments::blur"), "blur_texels")?;
        for (axis, (source, target)) in
            [(&self.levels[0], &between.view), (&between.view, &self.levels[0])].iter().enumerate()
        {
            let kernel = self.blur.at(axis as u32);
            let set = bindings! { blur: &kernel, source: *source, blurred: *target };
            recorder.compute("moment blur", &blur, set, Work::Threads(self.threads(0)));
        }
        Ok(())
    }

    fn reduce(&self, recorder: &mut Recorder) -> Result<(), Error> {
        if self.levels.len() < 2 {
            return Ok(());
        }
        let reduce = recorder.gpu.compute_pipeline(&self.key("passes::maps::moments::mip_chain"), "reduce_level")?;
        recorder.compute_pass("moment mip chain", |gpu, pass| {
            pass.set_pipeline(&reduce.pipeline);
            for (level, pair) in self.levels.windows(2).enumerate() {
                let set = bindings! { finer: &pair[0], coarser: &pair[1] };
                pass.set_bind_group(0, &reduce.bind_group(gpu, 0, set), &[]);
                dispatch(pass, &reduce, Work::Threads(self.threads(level as u32 + 1)));
            }
        });
        Ok(())
    }

    fn key(&self, module: &'static str) -> ShaderKey {
        let format = self.shape.format;
        ShaderKey::new(module).feature("split", format.is_split()).storing(format.storage())
    }

    fn threads(&self, level: u32) -> [u32; 3] {
        let side = (self.shape.size >> level).max(1);
        [side, side, self.shape.layers]
    }

    /// For looking at: the depths, and what is stored of them.
    pub fn inner_pictures(&self) -> [InnerPicture; 2] {
        let help = "what is stored of the depths of a texel, filtered";
        [self.depth.casters.inner_picture(), InnerPicture::of_texture("moments", help, &self.texture)]
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let own = Memory::new("moments", self.texture.bytes());
        let between = self.between.iter().map(|t| Memory::new("moment blur", t.bytes()));
        self.depth.memory().into_iter().chain([own]).chain(between).collect()
    }
}
