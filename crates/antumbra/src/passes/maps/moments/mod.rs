//! Filterable shadow maps: values of each texel's depths, blurred, with a mip chain.

mod format;
pub(crate) mod fourier;
#[cfg(test)]
mod twin;
pub(crate) mod warp;

pub use format::TexelFormat;
pub use warp::{DepthWarp, Nearest};

use crate::error::Error;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::BoundFrame;
use crate::passes::maps::light_depth::LightDepth;
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

/// Size and format of a moment map, and its filtering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentShape {
    /// Texels per side.
    pub size: u32,
    /// Layers of four channels.
    pub layers: u32,
    /// Format of a texel.
    pub format: TexelFormat,
    /// Depths per texel, 1 or 4, whose moments are averaged.
    pub samples: u32,
    /// Width of the Gaussian in texels, odd; 1 is none.
    pub blur: u32,
    /// True if there is a mip chain.
    pub mips: bool,
}

/// Moments of the depths that the light's centre sees, or other values that the module `warp` stores of them.
pub struct MomentMap {
    /// An array of layers with all mip levels.
    pub texture: Texture,
    /// The uniform of `shaders/depth_warp.wesl`.
    pub warp: wgpu::Buffer,
}

impl MomentMap {
    /// Draws the depths, stores the values that the module at `part` makes of them, and filters these.
    pub fn record(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        shape: MomentShape,
        part: &'static str,
        warp: DepthWarp,
    ) -> Result<MomentMap, Error> {
        let depth = LightDepth::record(recorder, frame, shape.size, shape.samples)?;
        let levels = if shape.mips { 32 - shape.size.leading_zeros() } else { 1 };
        let map = MomentMap {
            texture: recorder
                .texture("moments", shape.description("values stored of a texel's depths, filtered").mips(levels)),
            warp: recorder.uniform("depth warp", &warp),
        };
        map.store(recorder, shape, &depth, part)?;
        map.blur(recorder, shape)?;
        map.reduce(recorder, shape, levels)?;
        Ok(map)
    }

    fn store(
        &self,
        recorder: &mut Recorder,
        shape: MomentShape,
        depth: &LightDepth,
        part: &'static str,
    ) -> Result<(), Error> {
        let key = shape
            .key("passes::maps::moments::store")
            .part("warp", part)
            .feature("multisampled", shape.samples > 1)
            .feature("background", depth.background.is_some());
        let store = recorder.gpu.compute_pipeline(&key, "store")?;
        let texels = self.texture.array_mip(0);
        let set = bindings! {
            warp: &self.warp,
            source_map: &depth.casters.texture,
            background_map: depth.behind(),
            texels: &texels,
        };
        recorder.compute("moments", &store, &[set], Work::Threads(shape.threads(0)))
    }

    fn blur(&self, recorder: &mut Recorder, shape: MomentShape) -> Result<(), Error> {
        if shape.blur < 2 {
            return Ok(());
        }
        let blur = recorder.gpu.compute_pipeline(&shape.key("passes::maps::moments::blur"), "blur_texels")?;
        let between = recorder.texture("half-blurred moments", shape.description("the same, blurred along x"));
        let first = self.texture.array_mip(0);
        // The kernel ends at two standard deviations, as that of `pcf`.
        let deviation = (shape.blur as f32 / 4.0).max(0.25);
        let passes = [(UVec2::X, &first, &between.view), (UVec2::Y, &between.view, &first)];
        for (axis, source, target) in passes {
            let kernel = recorder.uniform("blur", &BlurUniform { axis, radius: (shape.blur / 2) as i32, deviation });
            let set = bindings! { blur: &kernel, source: source, blurred: target };
            recorder.compute("moment blur", &blur, &[set], Work::Threads(shape.threads(0)))?;
        }
        Ok(())
    }

    fn reduce(&self, recorder: &mut Recorder, shape: MomentShape, levels: u32) -> Result<(), Error> {
        let reduce = recorder.gpu.compute_pipeline(&shape.key("passes::maps::moments::mip_chain"), "reduce_level")?;
        for level in 1..levels {
            let [finer, coarser] = [level - 1, level].map(|l| self.texture.array_mip(l));
            let set = bindings! { finer: &finer, coarser: &coarser };
            recorder.compute("moment mip chain", &reduce, &[set], Work::Threads(shape.threads(level)))?;
        }
        Ok(())
    }
}

impl MomentShape {
    fn description(&self, help: &'static str) -> TextureDescription {
        TextureDescription::new([self.size; 2], self.format.texture(), help).layers(self.layers)
    }

    fn key(&self, module: &'static str) -> ShaderKey {
        ShaderKey::new(module).feature("split", self.format.is_split()).storing(self.format.storage())
    }

    fn threads(&self, level: u32) -> [u32; 3] {
        let side = (self.size >> level).max(1);
        [side, side, self.layers]
    }
}
