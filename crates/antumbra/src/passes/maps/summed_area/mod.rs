//! Summed-area tables [Crow 1984] of what a technique stores of a depth map: the mean over any box by four corners.

use crate::passes::maps::light_depth::LightDepth;
use crate::passes::maps::moments::DepthWarp;
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{Texture, storage_buffer};
use crate::gpu::shader::ShaderKey;
use crate::technique::{InnerPicture, Memory};
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::bindings;

crate::choices! {
    /// What sums are kept in. Corners of a table are sums over up to the whole map, and a box is a small difference of
    /// such, so what rounding leaves of it depends on this.
    pub enum Sums {
        /// 32-bit floating point, of up to four values a layer.
        Float = "float32",
        /// The same less about the mean of the map, so that sums stay small.
        Offset = "offset32",
        /// 64-bit integers, of up to two values a layer: exact to 2^-30.
        Fixed = "fixed64",
    }
}

/// What a table is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableShape {
    /// Texels a side.
    pub size: u32,
    /// Layers of four channels.
    pub layers: u32,
    /// What sums are kept in.
    pub sums: Sums,
}

/// A table for each layer.
pub struct SummedArea {
    /// An array of layers: `Rgba32Float`, or `Rgba32Uint` for 64-bit integers.
    pub texture: Texture,
    /// TechniqueAbout the mean of each layer, which is not in the sums; see `shaders/summed_area.wesl`.
    pub means: wgpu::Buffer,
    shape: TableShape,
    /// Sums of the rows.
    rows: Texture,
}

impl SummedArea {
    /// An empty table.
    pub fn new(gpu: &Gpu, shape: TableShape) -> Result<SummedArea, Error> {
        let format = match shape.sums {
            Sums::Fixed => wgpu::TextureFormat::Rgba32Uint,
            Sums::Float | Sums::Offset => wgpu::TextureFormat::Rgba32Float,
        };
        SummedArea::stored(gpu, shape, format)
    }

    /// An empty table of a mask of `size` bits a side; see `shaders/mask_counts.wesl`.
    pub fn of_mask(gpu: &Gpu, size: u32) -> Result<SummedArea, Error> {
        let shape = TableShape { size, layers: 1, sums: Sums::Fixed };
        SummedArea::stored(gpu, shape, wgpu::TextureFormat::R32Uint)
    }

    fn stored(gpu: &Gpu, shape: TableShape, format: wgpu::TextureFormat) -> Result<SummedArea, Error> {
        gpu.check_size("summed-area table", shape.size, shape.size)?;
        let usage =
            wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let texture = |label| Texture::array(gpu, label, [shape.size; 2], shape.layers, 1, format, usage);
        Ok(SummedArea {
            texture: texture("summed-area table"),
            means: storage_buffer(gpu, "means of layers", u64::from(shape.layers) * 16),
            rows: texture("row sums"),
            shape,
        })
    }

    /// Makes a table in `slot` unless one of this shape is there.
    pub fn ensure<'a>(slot: &'a mut Option<SummedArea>, gpu: &Gpu, shape: TableShape) -> Result<&'a SummedArea, Error> {
        if slot.as_ref().is_none_or(|t| t.shape != shape) {
            *slot = None; // Frees the old table before the new one is made.
            *slot = Some(SummedArea::new(gpu, shape)?);
        }
        Ok(slot.as_ref().expect("just made"))
    }

    /// Sums what the module at `part` stores of maps of one depth a texel; `warp` is the uniform of
    /// `shaders/depth_warp.wesl`.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        depth: &LightDepth,
        part: &'static str,
        warp: &wgpu::Buffer,
    ) -> Result<(), Error> {
        let key = |module| {
            let key =
                ShaderKey::new(module).part("warp", part);
            key.feature("fixed", self.shape.sums == Sums::Fixed).feature("background", depth.background.is_some())
        };
        let source = bindings! {
            warp: warp,
            source_map: &depth.casters.texture,
            background_map: &depth.behind().texture,
        };
        let layers = self.shape.layers;
        if self.shape.sums == Sums::Offset {
            let average = recorder.gpu.compute_pipeline(&key("passes::maps::summed_area::mean"), "average")?;
            let set = [&source[..], bindings! { mean_of_layer: &self.means }].concat();
            recorder.compute("summed-area table", &average, &set, Work::Groups([layers, 1, 1]));
        }
        let means = bindings! { means: &self.means };
        let set = [&source[..], means].concat();
        self.record_sums(recorder, "summed-area table", key("passes::maps::summed_area::prefix"), &set)
    }

    /// Counts the set bits of a mask ([`SummedArea::of_mask`]): a word a 32 texels of a row, rows one after the other.
    pub fn record_counts(&self, recorder: &mut Recorder, label: &str, mask: &wgpu::Buffer) -> Result<(), Error> {
        let key = ShaderKey::new("passes::maps::summed_area::prefix").feature("counts", true);
        self.record_sums(recorder, label, key, bindings! { mask: mask })
    }

    /// Sums along the rows of what `source` binds, then down the columns.
    fn record_sums(
        &self,
        recorder: &mut Recorder,
        label: &str,
        key: ShaderKey,
        source: &[Binding],
    ) -> Result<(), Error> {
        let along_rows = recorder.gpu.compute_pipeline(&key, "sum_lines")?;
        let down_columns = recorder.gpu.compute_pipeline(&key.feature("columns", true), "sum_lines")?;
        let groups = || Work::Groups([self.shape.size.div_ceil(8), 1, self.shape.layers]);
        let rows = [source, bindings! { summed: &self.rows }].concat();
        recorder.compute(label, &along_rows, &rows, groups());
        let columns = bindings! { row_sums: &self.rows, summed: &self.texture };
        recorder.compute(label, &down_columns, columns, groups());
        Ok(())
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture::of_texture(
            "summed-area table",
            "sums of what is stored over all texels to the left and above, without their mean",
            &self.texture,
        )
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("summed-area table", self.texture.bytes() + self.rows.bytes() + self.means.size())
    }
}
