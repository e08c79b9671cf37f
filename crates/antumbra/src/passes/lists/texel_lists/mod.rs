//! An irregular depth buffer [Aila, Laine 2004; Sintorn 2008]: for each texel of a map from the light's centre a list
//! of the receivers in it. Lists are counted, scanned and written.

use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::debug_view::DebugLayout;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::BufferDescription;
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::lists::list_length::ListLength;
use crate::passes::lists::scan::Scan;
use crate::{binding_array, gpu_struct};

gpu_struct! {
    /// The uniform of `shaders/texel_lists.wesl`.
    pub(crate) struct TexelMap {
        /// Texels per side.
        size: u32,
        /// Blocks of 8 x 8 texels per side.
        blocks: u32,
    }
}

/// Bytes of a `Block` in `shaders/texel_lists.wesl`.
const BLOCK_BYTES: u64 = 12;

/// For each texel the pixels whose receivers lie in it.
pub struct TexelLists {
    /// The uniform of `shaders/texel_lists.wesl`.
    pub uniform: wgpu::Buffer,
    /// The end of each texel's list (`u32`); it begins at the end of the list before.
    pub ends: wgpu::Buffer,
    /// `Block`: which texels of a block of 8 x 8 have a list, and the farthest receiver.
    pub blocks: wgpu::Buffer,
    /// The entries of all lists: indices of pixels, y times the image's width plus x.
    pub entries: wgpu::Buffer,
    /// Blocks of 8 x 8 texels per side.
    pub block_side: u32,
    texels: ListLength,
    scan: Scan,
}

impl TexelLists {
    /// For a map of `size` texels per side and `capacity` entries in all.
    pub fn new(recorder: &mut Recorder, size: u32, capacity: u32) -> TexelLists {
        let block_side = size.div_ceil(8);
        let blocks = u64::from(block_side).pow(2);
        let texels = 64 * blocks as u32;
        let help = "number of receivers in each texel of the map from the light's centre";
        let ends = BufferDescription::new(256 * blocks).debug(help, DebugLayout::ListLengths { side: size });
        TexelLists {
            uniform: recorder.uniform("texel map", &TexelMap { size, blocks: block_side }),
            ends: recorder.buffer("lists of receivers", ends),
            blocks: recorder.buffer("blocks of texels", BufferDescription::new(blocks * BLOCK_BYTES)),
            entries: recorder.buffer("entries of lists", BufferDescription::new(u64::from(capacity) * 4)),
            texels: ListLength::known(recorder, "number of texels", texels),
            scan: Scan::new(recorder, texels),
            block_side,
        }
    }

    /// Number of entries of all lists. It may exceed the capacity; entries beyond the capacity are not written.
    pub fn length(&self) -> &ListLength {
        &self.scan.total
    }

    /// The lists, for the technique's module `pair`.
    pub fn bindings(&self) -> [Binding<'_>; 2] {
        binding_array! { ends: &self.ends, entries: &self.entries }
    }

    /// Lists each pixel in the texels that the module `listed` gives. `key` is that of [`TexelLists::key`], with the
    /// features of the module; `more` are the bindings of the module.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &BoundFrame,
        key: &ShaderKey,
        more: &[Binding],
    ) -> Result<(), Error> {
        let pipeline = |entry| recorder.gpu.compute_pipeline(key, entry);
        let (clear, count, write) = (pipeline("clear")?, pipeline("count")?, pipeline("write")?);
        let blocks = binding_array! { texel_map: &self.uniform, blocks: &self.blocks };
        let set: [&[_]; 4] = [&frame.bindings(), &blocks, &self.bindings(), more];
        let label = "lists of receivers";
        recorder.compute(label, &clear, &set, Work::Groups([self.block_side, self.block_side, 1]))?;
        recorder.compute(label, &count, &set, Work::Pixels(frame.size))?;
        self.scan.record(recorder, label, &self.texels, &self.ends)?;
        recorder.compute(label, &write, &set, Work::Pixels(frame.size))
    }

    /// The shader that lists receivers, with the module that gives the texels of each.
    pub fn key(part: &'static str) -> ShaderKey {
        ShaderKey::new("passes::lists::texel_lists::lists").part("listed", part)
    }
}
