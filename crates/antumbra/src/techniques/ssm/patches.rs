//! The micro-patches, on one level or on several.

use super::SsmSettings;
use super::maps::Maps;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{BufferDescription, UniformArray};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::BoundFrame;
use crate::passes::maps::depth_pyramid::DepthPyramid;
use crate::{binding_array, bindings, gpu_struct};

gpu_struct! {
    /// Constants of all levels.
    pub(crate) struct SsmUniform {
        /// Inverse distance of the farthest receiver.
        farthest_receiver_q: f32,
        /// Smallest width of a penumbra, in texels of its level.
        window: f32,
        levels: u32,
        /// Occluder maps.
        layers: u32,
        /// Texels per side of the maps.
        size: u32,
        /// The same, rounded up to whole tiles on every level.
        padded: u32,
    }
}

gpu_struct! {
    /// A level of a layer.
    pub(crate) struct SsmLevel {
        level: u32,
        layer: u32,
    }
}

/// Patches per side of a tile; the coarsest level has at least one tile.
const TILE: u32 = 8;
/// Bytes of `Totals` in `levels.wesl`: 32 largest depths, three counts, rounded up.
const TOTALS: u64 = 4 * 36;

/// Every level of the patches of one or two occluder maps.
pub(super) struct Patches {
    pub shape: SsmUniform,
    /// `Rg32Float`: covered fraction and inverse distance.
    patches: Texture,
    /// `Rgba32Float`: the largest, smallest and mean inverse distance of each tile, and its covered fraction.
    tiles: Texture,
    /// Counts of the frame; see [`Ssm`](super::Ssm).
    pub totals: wgpu::Buffer,
    uniform: wgpu::Buffer,
    levels: UniformArray,
}

impl SsmUniform {
    fn new(frame: &BoundFrame, settings: &SsmSettings) -> SsmUniform {
        let levels = if settings.hierarchy { (settings.map / TILE).max(1).ilog2() + 1 } else { 1 };
        SsmUniform {
            farthest_receiver_q: 1.0 / frame.frustum.receivers[1],
            window: settings.window as f32,
            levels,
            layers: settings.passes,
            size: settings.map,
            padded: settings.map.next_multiple_of(TILE << (levels - 1)),
        }
    }

    /// A texture of all levels and layers with a texel for each square of `patches` x `patches` patches.
    fn texture(&self, patches: u32, format: wgpu::TextureFormat, help: &'static str) -> TextureDescription {
        TextureDescription::new([self.padded / patches; 2], format, help).layers(self.layers).mips(self.levels)
    }
}

impl Patches {
    /// Turns texels of the occluder maps into patches, and moves those with wide penumbrae to coarser levels.
    pub fn record(
        recorder: &mut Recorder,
        frame: &BoundFrame,
        settings: &SsmSettings,
        maps: &Maps,
    ) -> Result<Patches, Error> {
        let bounds = match settings.hierarchy {
            true => Some(DepthPyramid::record(recorder, &maps.receivers, frame.frustum.near)?),
            false => None,
        };
        let shape = SsmUniform::new(frame, settings);
        let help =
            "covered fraction of each micro-patch and its inverse distance, 1/metres; a mip level for each level";
        let (tiles, rest) = (
            "largest, smallest and mean inverse distance of each tile, 1/metres, and its covered fraction",
            "sums of the patches that move up a level",
        );
        let levels = (0..2 * shape.levels).map(|i| SsmLevel { level: i / 2, layer: i % 2 });
        let patches = Patches {
            patches: recorder.texture("micro-patches", shape.texture(1, wgpu::TextureFormat::Rg32Float, help)),
            tiles: recorder.texture("tiles of patches", shape.texture(TILE, wgpu::TextureFormat::Rgba32Float, tiles)),
            totals: recorder.buffer("patch totals", BufferDescription::new(TOTALS).cleared()),
            uniform: recorder.uniform("soft shadow map", &shape),
            levels: recorder.uniforms("patch levels", levels),
            shape,
        };
        let rising = recorder.texture("rising patches", shape.texture(1, wgpu::TextureFormat::Rgba32Float, rest));
        let mut sources = frame.bindings().to_vec();
        sources.extend(binding_array! {
            depth_map: &maps.receivers.texture,
            nearest_occluders: &maps.nearest.texture,
        });
        if let Some(bounds) = &bounds {
            sources.extend(binding_array! { pyramid_bounds: &bounds.bounds });
        }
        if let Some(farthest) = &maps.farthest {
            sources.extend(binding_array! { farthest_occluders: farthest });
        }
        let key = ShaderKey::new("techniques::ssm::patches")
            .feature("flat", bounds.is_none())
            .feature("farthest", maps.farthest.is_some());
        let first = recorder.gpu.compute_pipeline(&key.clone().feature("first", true), "raise")?;
        let next = recorder.gpu.compute_pipeline(&key, "raise")?;
        for level in 0..shape.levels {
            let [level_patches, level_tiles, level_rising] =
                [&patches.patches, &patches.tiles, &rising].map(|texture| texture.array_mip(level));
            let below = rising.array_mip(level.saturating_sub(1));
            let step = patches.level(level, 0);
            let set = bindings! {
                step: &step,
                ssm: &patches.uniform,
                totals: &patches.totals,
                level_patches: &level_patches,
                level_tiles: &level_tiles,
                level_rising: &level_rising,
                rising: &below,
            };
            let (pipeline, sources) = if level == 0 { (&first, &sources[..]) } else { (&next, &[][..]) };
            let side = patches.side(level);
            let work = Work::Threads([side, side, shape.layers]);
            recorder.compute("micro-patches", pipeline, &[set, sources], work)?;
        }
        Ok(patches)
    }

    /// Texels per side of a level.
    pub fn side(&self, level: u32) -> u32 {
        self.shape.padded >> level
    }

    /// A texture with a texel for each patch of all levels and layers.
    pub fn texture(&self, format: wgpu::TextureFormat, help: &'static str) -> TextureDescription {
        self.shape.texture(1, format, help)
    }

    /// The uniform of a level of a layer.
    pub fn level(&self, level: u32, layer: u32) -> wgpu::BindingResource<'_> {
        self.levels.at(2 * level + layer)
    }

    /// The resources of `levels.wesl`.
    pub fn bindings<'a>(&'a self, maps: &'a Maps) -> [Binding<'a>; 5] {
        binding_array! {
            depth_map: &maps.receivers.texture,
            patches: &self.patches,
            patch_tiles: &self.tiles,
            ssm: &self.uniform,
            totals: &self.totals,
        }
    }
}
