//! Summed-area tables [Crow 1984] of values stored of a depth map: the mean over any box by four corners.

use crate::bindings;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::gpu::texture::{Texture, TextureDescription};
use crate::passes::maps::light_depth::LightDepth;

#[cfg(test)]
mod twin;

crate::choices! {
    /// Number format of sums. Corners of a table are sums over up to the whole map, and a box is a small difference of
    /// such sums, so its precision depends on the format.
    pub enum Sums {
        /// 32-bit floating point, of up to four values a layer.
        Float = "float32",
        /// The same less about the mean of the map, so that sums stay small.
        Offset = "offset32",
        /// 64-bit integers, of up to two values a layer: exact to 2^-30.
        Fixed = "fixed64",
    }
}

/// Shape of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableShape {
    /// Texels per side.
    pub size: u32,
    /// Layers of four channels.
    pub layers: u32,
    /// Number format of sums.
    pub sums: Sums,
}

/// A table for each layer.
pub struct SummedArea {
    /// An array of layers: `Rgba32Float`, or `Rgba32Uint` for 64-bit integers.
    pub texture: Texture,
    /// About the mean of each layer, which is not in the sums; see `shaders/summed_area.wesl`.
    pub means: wgpu::Buffer,
}

impl SummedArea {
    /// Sums the values that the module at `part` stores of maps of one depth per texel; `warp` is the uniform of
    /// `shaders/depth_warp.wesl`.
    pub fn record(
        recorder: &mut Recorder,
        shape: TableShape,
        depth: &LightDepth,
        part: &'static str,
        warp: &wgpu::Buffer,
    ) -> Result<SummedArea, Error> {
        let key = |module| {
            let key = ShaderKey::new(module).part("warp", part).feature("fixed", shape.sums == Sums::Fixed);
            key.feature("background", depth.background.is_some())
        };
        let source = bindings! { warp: warp, source_map: &depth.casters.texture, background_map: depth.behind() };
        let means = recorder.buffer("means of layers", BufferDescription::new(u64::from(shape.layers) * 16));
        if shape.sums == Sums::Offset {
            let average = recorder.gpu.compute_pipeline(&key("passes::maps::summed_area::mean"), "average")?;
            let set = [&source[..], bindings! { mean_of_layer: &means }];
            recorder.compute(LABEL, &average, &set, Work::Groups([shape.layers, 1, 1]))?;
        }
        let format = match shape.sums {
            Sums::Fixed => wgpu::TextureFormat::Rgba32Uint,
            Sums::Float | Sums::Offset => wgpu::TextureFormat::Rgba32Float,
        };
        let set = [&source[..], bindings! { means: &means }];
        let key = key("passes::maps::summed_area::prefix");
        let texture = sums(recorder, LABEL, key, &set, [shape.size, shape.layers], format)?;
        Ok(SummedArea { texture, means })
    }
}

const LABEL: &str = "summed-area table";

/// Counts the set bits of a mask of `size` bits per side: rows of whole 32-bit words, in sequence. The counts are
/// `R32Uint`; see `shaders/mask_counts.wesl`.
pub fn mask_counts(
    recorder: &mut Recorder,
    label: &'static str,
    mask: &wgpu::Buffer,
    size: u32,
) -> Result<Texture, Error> {
    let key = ShaderKey::new("passes::maps::summed_area::prefix").feature("counts", true);
    sums(recorder, label, key, &[bindings! { mask: mask }], [size, 1], wgpu::TextureFormat::R32Uint)
}

/// Sums along the rows of a source, then down the columns.
fn sums(
    recorder: &mut Recorder,
    label: &'static str,
    key: ShaderKey,
    source: &[&[Binding]],
    [size, layers]: [u32; 2],
    format: wgpu::TextureFormat,
) -> Result<Texture, Error> {
    recorder.gpu.check_size("summed-area table", size, size)?;
    let along_rows = recorder.gpu.compute_pipeline(&key, "sum_lines")?;
    let down_columns = recorder.gpu.compute_pipeline(&key.feature("columns", true), "sum_lines")?;
    let texture = |help| TextureDescription::new([size; 2], format, help).layers(layers);
    let rows = recorder.texture("row sums", texture("sums over all texels to the left"));
    let table = recorder.texture(LABEL, texture("sums over all texels to the left and above, without their mean"));
    let groups = Work::Groups([size.div_ceil(8), 1, layers]);
    let target = bindings! { summed: &rows };
    recorder.compute(label, &along_rows, &[source, &[target]].concat(), groups)?;
    recorder.compute(label, &down_columns, &[bindings! { row_sums: &rows, summed: &table }], groups)?;
    Ok(table)
}
