//! Lists of receivers for each texel of a map from the light's centre: an irregular depth buffer [Aila, Laine 2004;
//! Sintorn 2008], counted, scanned, and written.

use crate::input::frame::{Frame, FrameUniform};
use crate::passes::lists::scan::{ListLength, Scan};
use crate::gpu::bindings::Binding;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{storage_buffer, uniform};
use crate::gpu::shader::ShaderKey;
use crate::technique::{InnerContent, InnerPicture, Memory};
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};

gpu_struct! {
    /// The texels that lists are kept for; see `shaders/texel_lists.wesl`.
    pub(crate) struct TexelMap {
        /// Texels a side.
        size: u32,
        /// Blocks of 8 x 8 texels a side.
        blocks: u32,
    }
}

/// Bytes of a block in `shaders/texel_lists.wesl`.
const BLOCK_BYTES: u64 = 12;

/// For each texel the pixels that fall into it.
pub struct TexelLists {
    /// The uniform of `shaders/texel_lists.wesl`.
    pub uniform: wgpu::Buffer,
    /// Where each texel's list ends (`u32`); it begins where that of the texel before ends.
    pub ends: wgpu::Buffer,
    /// For each block of 8 x 8 texels which of them have a list, and the farthest of what is listed.
    pub blocks: wgpu::Buffer,
    /// All lists, one after the other: numbers of pixels, y times the picture's width plus x.
    pub entries: wgpu::Buffer,
    /// How long all lists together are, which may be more than there is room for: what is beyond is not written.
    pub length: ListLength,
    texels: ListLength,
    scan: Scan,
    size: u32,
    capacity: u32,
}

impl TexelLists {
    /// For a map of `size` texels a side and `capacity` entries in all.
    pub fn new(gpu: &Gpu, size: u32, capacity: u32) -> TexelLists {
        let blocks = size.div_ceil(8);
        let texels = blocks * blocks * 64;
        TexelLists {
            uniform: uniform(gpu, "texel map", &TexelMap { size, blocks }),
            ends: storage_buffer(gpu, "ends of lists", u64::from(texels) * 4),
            blocks: storage_buffer(gpu, "blocks of texels", u64::from(blocks * blocks) * BLOCK_BYTES),
            entries: storage_buffer(gpu, "lists of pixels", u64::from(capacity) * 4),
            length: ListLength::unknown(gpu, "length of lists"),
            texels: ListLength::known(gpu, "number of texels", texels),
            scan: Scan::new(gpu, texels),
            size,
            capacity,
        }
    }

    /// Makes lists in `slot` unless some of this shape are there.
    pub fn ensure<'a>(slot: &'a mut Option<TexelLists>, gpu: &Gpu, size: u32, capacity: u32) -> &'a TexelLists {
        if slot.as_ref().is_none_or(|l| (l.size, l.capacity) != (size, capacity)) {
            *slot = None; // Frees the old lists before the new ones are made.
            *slot = Some(TexelLists::new(gpu, size, capacity));
        }
        slot.as_ref().expect("just made")
    }

    /// Blocks of 8 x 8 texels a side.
    pub fn block_side(&self) -> u32 {
        self.size.div_ceil(8)
    }

    /// What shaders import from `shaders/texel_lists.wesl`, and the lists.
    pub fn bindings(&self) -> Vec<Binding<'_>> {
        bindings! {
            texel_map: &self.uniform,
            ends: &self.ends,
            blocks: &self.blocks,
            entries: &self.entries,
        }
        .to_vec()
    }

    /// Lists what the module at `part` says of each pixel; `more` is what that module binds.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        part: ShaderKey,
        more: &[Binding],
    ) -> Result<(), Error> {
        let key = part;
        let pipeline = |entry| recorder.gpu.compute_pipeline(&key, entry);
        let (clear, count, write) = (pipeline("clear")?, pipeline("count")?, pipeline("write")?);
        let set = frame.bindings(&[&self.bindings()[..], more].concat());
        let label = "lists of receivers";
        recorder.encoder.clear_buffer(&self.ends, 0, None);
        let blocks = self.block_side() * self.block_side();
        recorder.compute(label, &clear, &set, Work::Threads([blocks, 1, 1]));
        let [width, height] = frame.size;
        recorder.compute(label, &count, &set, Work::Threads([width, height, 1]));
        self.scan.record(recorder, label, &self.texels, &self.ends, &self.length)?;
        recorder.compute(label, &write, &set, Work::Threads([width, height, 1]));
        Ok(())
    }

    /// The shader that lists, with the module that says what a receiver covers.
    pub fn key(part: &'static str) -> ShaderKey {
        ShaderKey::new("passes::lists::texel_lists::lists").part("listed", part)
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture {
            name: "lists of receivers",
            help: "how many receivers are listed in each texel of the map from the light's centre",
            content: InnerContent::ListLengths { ends: self.ends.clone(), side: self.size },
        }
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        let buffers = [&self.ends, &self.blocks, &self.entries];
        Memory::new("lists of receivers", buffers.iter().map(|b| b.size()).sum::<u64>() + self.scan.bytes())
    }
}
