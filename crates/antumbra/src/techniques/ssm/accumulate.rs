//! The shadows of all patches, added up.

use super::patches::{Patches, SsmLevel};
use super::settings::{Accumulate, Format};
use super::{SsmSettings, maps::Maps};
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::{Recorder, Work, color_target, dispatch};
use crate::gpu::texture::Texture;
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::bindings;

/// The soft shadow map of every level, and the finest one merged over the layers.
pub(super) struct SoftMap {
    /// `R32Float`, `map` x `map`: the part of the light that is hidden from the receiver at each texel.
    pub merged: Texture,
    /// `R32Float`, a layer an occluder map, a mip a level: what the level and all coarser ones hide.
    levels: Texture,
    /// Each level of these.
    level_views: Vec<wgpu::TextureView>,
    /// Where rectangles are blended, level by level.
    blended: Option<Texture>,
    format: Format,
}

impl SoftMap {
    /// Room for the levels of `patches`.
    pub fn new(gpu: &Gpu, settings: &SsmSettings, patches: &Patches) -> SoftMap {
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let side = [patches.side(0); 2];
        let (layers, levels) = (patches.shape.layers, patches.shape.levels);
        let blended = (settings.accumulate == Accumulate::Blend).then(|| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
            Texture::array(gpu, "penumbra rectangles", side, layers, levels, blended_format(settings.format), usage)
        });
        let format = wgpu::TextureFormat::R32Float;
        let readable = usage | wgpu::TextureUsages::COPY_SRC;
        let soft = Texture::array(gpu, "soft shadow levels", side, layers, levels, format, usage);
        SoftMap {
            merged: Texture::new(gpu, "soft shadow map", [settings.map; 2], 1, format, readable),
            level_views: (0..levels).map(|level| soft.array_mip(level)).collect(),
            levels: soft,
            blended,
            format: settings.format,
        }
    }

    /// Adds up the shadows of all patches, from the coarsest level to the finest, and merges the layers.
    pub fn record(&self, recorder: &mut Recorder, frame: &Frame, maps: &Maps, patches: &Patches) -> Result<(), Error> {
        if let Some(blended) = &self.blended {
            self.draw_rectangles(recorder, frame, maps, patches, blended)?;
        }
        self.soften(recorder, frame, maps, patches)?;
        let merge = recorder.gpu.compute_pipeline(&Patches::key("techniques::ssm::merge"), "merge")?;
        let set = bindings! { finest_soft: &self.level_views[0], soft_shadow_map: &self.merged };
        let size = patches.shape.size;
        recorder.compute("soft shadow map", &merge, set, Work::Threads([size, size, 1]));
        Ok(())
    }

    fn soften(&self, recorder: &mut Recorder, frame: &Frame, maps: &Maps, patches: &Patches) -> Result<(), Error> {
        let key = Patches::key("techniques::ssm::soften")
            .feature("blended", self.blended.is_some())
            .feature("float16", self.format == Format::Float16);
        let coarsest = recorder.gpu.compute_pipeline(&key.clone().feature("coarsest", true), "soften")?;
        let finer = recorder.gpu.compute_pipeline(&key, "soften")?;
        let common = patches.bindings(frame, &maps.receivers);
        recorder.compute_pass("soft shadow map", |gpu, pass| {
            for level in (0..patches.shape.levels).rev() {
                let is_coarsest = level + 1 == patches.shape.levels;
                let pipeline = if is_coarsest { &coarsest } else { &finer };
                let step = patches.levels.at(2 * level);
                let own = &self.level_views[level as usize];
                let coarser = self.level_views.get(level as usize + 1);
                let blended = self.blended.as_ref().map(|b| b.array_mip(level));
                let mut set = [&common[..], bindings! { step: &step, level_soft: own }].concat();
                if let Some(view) = coarser {
                    set.extend_from_slice(bindings! { coarser_soft: view });
                }
                if let Some(view) = &blended {
                    set.extend_from_slice(bindings! { blended: view });
                }
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                let side = patches.side(level);
                dispatch(pass, pipeline, Work::Threads([side, side, patches.shape.layers]));
            }
        });
        Ok(())
    }

    fn draw_rectangles(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        maps: &Maps,
        patches: &Patches,
        into: &Texture,
    ) -> Result<(), Error> {
        let colors = vec![blended_format(self.format)];
        let target = RenderTarget { colors, adds: true, ..RenderTarget::default() };
        let pipeline = recorder.gpu.render_pipeline(&Patches::key("techniques::ssm::rectangles"), &target)?;
        let common = patches.bindings(frame, &maps.receivers);
        for i in 0..2 * patches.shape.levels {
            let SsmLevel { level, layer } = patches.levels.value(i);
            if layer >= patches.shape.layers {
                continue;
            }
            let view = into.texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_mip_level: level,
                mip_level_count: Some(1),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let step = patches.levels.at(i);
            let set = [&common[..], bindings! { step: &step }].concat();
            let color = [color_target(&view, wgpu::Color::TRANSPARENT)];
            recorder.render_pass("penumbra rectangles", &color, None, |gpu, pass| {
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, &set), &[]);
                pass.draw(0..6, 0..patches.side(level).pow(2));
            });
        }
        Ok(())
    }

    /// For looking at: what is looked up at the end, and what each level added.
    pub fn inner_pictures(&self) -> [InnerPicture; 2] {
        let hidden = "part of the light that is hidden from the receiver at each texel";
        let levels = "part of the light that a level of patches and all coarser ones hide";
        [
            InnerPicture::of_texture("soft shadow map", hidden, &self.merged),
            InnerPicture::of_texture("soft shadow levels", levels, &self.levels),
        ]
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Vec<Memory> {
        let own = Memory::new("soft shadow map", self.merged.bytes() + self.levels.bytes());
        let blended = self.blended.iter().map(|b| Memory::new("penumbra rectangles", b.bytes()));
        blended.chain([own]).collect()
    }
}

fn blended_format(format: Format) -> wgpu::TextureFormat {
    match format {
        Format::Float32 => wgpu::TextureFormat::R32Float,
        Format::Float16 => wgpu::TextureFormat::R16Float,
    }
}
