//! Accumulation of the shadows of all patches.

use super::SsmSettings;
use super::maps::Maps;
use super::patches::Patches;
use super::settings::{Accumulate, Format};
use crate::bindings;
use crate::error::Error;
use crate::gpu::pipeline::RenderTarget;
use crate::gpu::recorder::{Recorder, Work, color_target};
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::input::frame::BoundFrame;

/// Accumulates the shadows of all patches from the coarsest level to the finest and takes the maximum of the layers.
/// `R32Float`, `map` x `map`: the fraction of the light that is hidden from the receiver at each texel.
pub(super) fn soft_shadow_map(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    settings: &SsmSettings,
    maps: &Maps,
    patches: &Patches,
) -> Result<Texture, Error> {
    let rectangles = match settings.accumulate {
        Accumulate::Gather => None,
        Accumulate::Blend => Some(draw_rectangles(recorder, frame, settings.format, maps, patches)?),
    };
    let levels = soften(recorder, frame, settings.format, maps, patches, rectangles)?;
    let merge = recorder.gpu.compute_pipeline(&ShaderKey::new("techniques::ssm::merge"), "merge")?;
    let help = "fraction of the light that is hidden from the receiver at each texel";
    let size = settings.map;
    let merged =
        recorder.texture("soft shadow map", TextureDescription::new([size; 2], wgpu::TextureFormat::R32Float, help));
    let finest = levels.array_mip(0);
    let set = bindings! { finest_soft: &finest, soft_shadow_map: &merged };
    recorder.compute("soft shadow map", &merge, &[set], Work::Threads([size, size, 1]))?;
    Ok(merged)
}

/// The soft shadow map of each level, with the shadows of all coarser ones: a layer for each occluder map.
fn soften(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    format: Format,
    maps: &Maps,
    patches: &Patches,
    rectangles: Option<Texture>,
) -> Result<Texture, Error> {
    let key = ShaderKey::new("techniques::ssm::soften")
        .feature("blended", rectangles.is_some())
        .feature("float16", format == Format::Float16);
    let coarsest = recorder.gpu.compute_pipeline(&key.clone().feature("coarsest", true), "soften")?;
    let finer = recorder.gpu.compute_pipeline(&key, "soften")?;
    let help = "fraction of the light that the patches of a level and of all coarser ones hide";
    let soft = recorder.texture("soft shadow levels", patches.texture(wgpu::TextureFormat::R32Float, help));
    let last = patches.shape.levels - 1;
    for level in (0..=last).rev() {
        let (own, coarser) = (soft.array_mip(level), soft.array_mip((level + 1).min(last)));
        // Unused without `blended`.
        let blended = rectangles.as_ref().unwrap_or(&soft).array_mip(level);
        let step = patches.level(level, 0);
        let set = bindings! {
            step: &step,
            level_soft: &own,
            coarser_soft: &coarser,
            blended: &blended,
        };
        let pipeline = if level == last { &coarsest } else { &finer };
        let side = patches.side(level);
        let work = Work::Threads([side, side, patches.shape.layers]);
        recorder.compute("soft shadow map", pipeline, &[&frame.bindings(), &patches.bindings(maps), set], work)?;
    }
    Ok(soft)
}

/// The penumbra rectangles of all patches, blended level by level.
fn draw_rectangles(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    format: Format,
    maps: &Maps,
    patches: &Patches,
) -> Result<Texture, Error> {
    let format = match format {
        Format::Float32 => wgpu::TextureFormat::R32Float,
        Format::Float16 => wgpu::TextureFormat::R16Float,
    };
    let target = RenderTarget { colors: vec![format], adds: true, ..RenderTarget::default() };
    let pipeline = recorder.gpu.render_pipeline(&ShaderKey::new("techniques::ssm::rectangles"), &target)?;
    let help = "fraction of the light that the patches of a level hide, by blending";
    let description = patches.texture(format, help).usage(wgpu::TextureUsages::RENDER_ATTACHMENT);
    let into = recorder.texture("penumbra rectangles", description);
    for (level, layer) in (0..patches.shape.levels).flat_map(|l| (0..patches.shape.layers).map(move |k| (l, k))) {
        let view = into.layer_mip(layer, level);
        let color = [color_target(&view, wgpu::Color::TRANSPARENT)];
        recorder.render("penumbra rectangles", &color, None, 1, |draw| {
            let step = patches.level(level, layer);
            let set = bindings! { step: &step };
            draw.bind(&pipeline, &[&frame.bindings(), &patches.bindings(maps), set])?;
            draw.pass.draw(0..6, 0..patches.side(level).pow(2));
            Ok(())
        })?;
    }
    Ok(into)
}
