//! The pool of resources of a technique: requests during recording are answered with the resource of the last frame if
//! it fits, with a new one otherwise. Resources are counted, and offered as debug views under their labels.

use super::bindings::{BindGroups, Binding, Layout};
use super::debug_view::{DebugContent, DebugLayout, DebugView};
use super::device::Gpu;
use super::host_struct::HostStruct;
use super::readback::Readback;
use super::texture::{Texture, TextureDescription};
use crate::error::Error;
use std::num::NonZero;
use std::sync::{Arc, Weak};
use wgpu::util::DeviceExt;

/// GPU memory of one pass.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Memory {
    /// Label of the pass.
    pub pass: &'static str,
    /// Bytes.
    pub bytes: u64,
}

/// Size and use of a buffer, and how a viewer shows it.
#[derive(Clone, Debug)]
pub struct BufferDescription {
    size: u64,
    cleared: u64,
    debug: Option<(&'static str, DebugLayout)>,
}

impl BufferDescription {
    /// A storage buffer of at least `size` bytes, zero when it is made. It can hold indirect arguments and uniforms,
    /// and be copied.
    pub fn new(size: u64) -> Self {
        BufferDescription { size: size.max(16), cleared: 0, debug: None }
    }

    /// Zero at the start of each frame.
    pub fn cleared(self) -> Self {
        BufferDescription { cleared: self.size, ..self }
    }

    /// The first `bytes` are zero at the start of each frame.
    pub fn cleared_head(self, bytes: u64) -> Self {
        BufferDescription { cleared: bytes, ..self }
    }

    /// Offered as a debug view; `help` gives the meaning and unit of its values.
    pub fn debug(self, help: &'static str, layout: DebugLayout) -> Self {
        BufferDescription { debug: Some((help, layout)), ..self }
    }
}

/// Uniforms of one kind, one behind the other in a buffer. Clones share it.
#[derive(Clone, Debug)]
pub struct UniformArray {
    buffer: wgpu::Buffer,
    size: u64,
}

/// Bytes from one uniform to the next: an offset that every device can bind at.
const UNIFORM_STRIDE: u64 = 256;

impl UniformArray {
    /// The binding of the value at `index`.
    pub fn at(&self, index: u32) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: u64::from(index) * UNIFORM_STRIDE,
            size: NonZero::new(self.size),
        })
    }
}

/// Frames for which a resource that is not asked for is kept.
const KEPT_FRAMES: u64 = 8;

#[derive(Debug)]
enum Content {
    Texture(Texture, TextureDescription),
    /// Storage, the bytes at its start that are cleared each frame, and whether that is done in the present frame.
    Buffer {
        buffer: wgpu::Buffer,
        cleared: u64,
        is_clear: bool,
        debug: Option<(&'static str, DebugLayout)>,
    },
    /// A buffer with the bytes, or the key to them, that it is filled with, and the recordings that read it.
    Filled {
        buffer: wgpu::Buffer,
        bytes: Vec<u8>,
        readers: Vec<Weak<()>>,
    },
    Readback(Readback),
    Points(Vec<glam::Vec2>),
}

#[derive(Debug)]
struct Entry {
    label: &'static str,
    /// Label of the pass that its memory counts for.
    pass: Option<&'static str>,
    content: Content,
    /// The last frame that asked for it.
    asked: u64,
}

impl Entry {
    fn bytes(&self) -> u64 {
        match &self.content {
            Content::Texture(texture, _) => texture.bytes(),
            Content::Buffer { buffer, .. } | Content::Filled { buffer, .. } => buffer.size(),
            Content::Readback(readback) => readback.bytes(),
            Content::Points(_) => 0,
        }
    }
}

/// The resources of one technique.
#[derive(Debug, Default)]
pub struct Resources {
    entries: Vec<Entry>,
    /// Position of the entry after the one that was last asked for: frames ask in the same order as a rule.
    cursor: usize,
    frame: u64,
    groups: BindGroups,
    /// Entries whose pass is the next one that is recorded, or the last one if no other follows.
    unassigned: Vec<usize>,
    last_pass: Option<&'static str>,
    scratch: Vec<u8>,
    captures: bool,
    made: u64,
    /// Lives until the GPU has done what the present frame records, or its encoder is dropped.
    recording: Arc<()>,
}

impl Resources {
    /// Resources that only debug views show are asked for from the next frame on, or no longer.
    pub fn set_debug_capture(&mut self, on: bool) {
        self.captures = on;
    }

    /// True if resources that only debug views show are wanted.
    pub fn captures_debug(&self) -> bool {
        self.captures
    }

    /// GPU memory by the label of the pass that first used it.
    pub fn memory(&self) -> Vec<Memory> {
        let mut memory: Vec<Memory> = Vec::new();
        for entry in self.entries.iter().filter(|e| e.bytes() > 0) {
            let pass = entry.pass.unwrap_or(entry.label);
            match memory.iter_mut().find(|m| m.pass == pass) {
                Some(known) => known.bytes += entry.bytes(),
                None => memory.push(Memory { pass, bytes: entry.bytes() }),
            }
        }
        memory
    }

    /// The textures and lists of the last frame.
    pub fn debug_views(&self) -> Vec<DebugView> {
        let view = |entry: &Entry| {
            let (help, content) = match &entry.content {
                Content::Texture(texture, d) => (d.help, DebugContent::Texture(texture.texture.clone())),
                Content::Buffer { buffer, debug: Some((help, layout)), .. } => {
                    (*help, DebugContent::Buffer(buffer.clone(), layout.clone()))
                }
                Content::Points(points) => {
                    ("points of the light that maps are drawn from", DebugContent::LightPoints(points.clone()))
                }
                _ => return None,
            };
            Some(DebugView { name: entry.label, help, content })
        };
        self.entries.iter().filter(|e| e.asked == self.frame).filter_map(view).collect()
    }

    /// Number of textures, buffers and bind groups that were made so far.
    pub fn made(&self) -> u64 {
        self.made + self.groups.made
    }

    pub(super) fn begin_frame(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.recording = Arc::default();
        let recording = self.recording.clone();
        encoder.on_submitted_work_done(move || drop(recording));
        for entry in &mut self.entries {
            if let Content::Buffer { buffer, cleared, is_clear, .. } = &mut entry.content {
                *is_clear = *cleared > 0 && entry.asked == self.frame;
                if *is_clear {
                    encoder.clear_buffer(buffer, 0, Some(*cleared));
                }
            }
        }
        let kept = self.entries.iter().filter(|e| e.asked == self.frame).filter_map(|e| match &e.content {
            Content::Texture(texture, description) if description.mips > 1 => Some(texture),
            _ => None,
        });
        make_known(encoder, kept);
        self.frame += 1;
        self.cursor = 0;
        self.unassigned.clear();
    }

    pub(super) fn end_frame(&mut self) {
        if let Some(pass) = self.last_pass {
            self.assign_pass(pass);
        }
        let oldest = self.frame.saturating_sub(KEPT_FRAMES);
        if self.entries.iter().any(|e| e.asked < oldest) {
            self.entries.retain(|e| e.asked >= oldest);
        }
        self.groups.retain_since(oldest);
        // The encoder's is the last one.
        self.recording = Arc::default();
    }

    /// The entry of this label that the present frame has not asked for yet, if it fits.
    fn find(&mut self, label: &'static str, fits: impl Fn(&Content) -> bool) -> Option<usize> {
        let is_next = |e: &Entry| e.label == label && e.asked < self.frame;
        let (before, after) = self.entries.split_at(self.cursor.min(self.entries.len()));
        let position = after.iter().position(is_next).map(|i| i + before.len());
        let index = position.or_else(|| before.iter().position(is_next))?;
        if !fits(&self.entries[index].content) {
            self.entries.remove(index); // Frees it before another is made.
            self.unassigned.retain(|&i| i != index);
            self.unassigned.iter_mut().filter(|i| **i > index).for_each(|i| *i -= 1);
            self.cursor = index;
            return None;
        }
        self.entries[index].asked = self.frame;
        self.cursor = index + 1;
        Some(index)
    }

    /// Adds an entry at the cursor, so that entries stay in the order of requests.
    fn add(&mut self, label: &'static str, content: Content) -> usize {
        let index = self.cursor.min(self.entries.len());
        self.entries.insert(index, Entry { label, pass: None, content, asked: self.frame });
        self.unassigned.iter_mut().filter(|i| **i >= index).for_each(|i| *i += 1);
        self.unassigned.push(index);
        self.cursor = index + 1;
        self.made += 1;
        index
    }

    /// Attributes resources made since the last pass to this one.
    pub(super) fn assign_pass(&mut self, pass: &'static str) {
        self.last_pass = Some(pass);
        for index in self.unassigned.drain(..) {
            self.entries[index].pass = Some(pass);
        }
    }

    pub(super) fn bind_group(
        &mut self,
        gpu: &Gpu,
        layout: &Layout,
        sets: &[&[Binding]],
    ) -> Result<wgpu::BindGroup, Error> {
        self.groups.get(&gpu.device, layout, sets, self.frame)
    }

    /// The texture, and whether it is new.
    pub(super) fn texture(
        &mut self,
        gpu: &Gpu,
        label: &'static str,
        description: TextureDescription,
    ) -> (Texture, bool) {
        let before = self.made;
        let fits = |c: &Content| matches!(c, Content::Texture(_, known) if *known == description);
        let index = self
            .find(label, fits)
            .unwrap_or_else(|| self.add(label, Content::Texture(Texture::new(gpu, label, description), description)));
        match &self.entries[index].content {
            Content::Texture(texture, _) => (texture.clone(), self.made > before),
            _ => unreachable!("found as a texture"),
        }
    }

    /// The buffer, and the bytes at its start that are still to be cleared in this frame.
    pub(super) fn buffer(&mut self, gpu: &Gpu, label: &'static str, wanted: BufferDescription) -> (wgpu::Buffer, u64) {
        let BufferDescription { size, cleared: clear, debug: shown } = wanted;
        let fits = |c: &Content| matches!(c, Content::Buffer { buffer, cleared, .. } if buffer.size() == size && *cleared == clear);
        let Some(index) = self.find(label, fits) else {
            let buffer = storage_buffer(gpu, label, size);
            self.add(label, Content::Buffer { buffer: buffer.clone(), cleared: clear, is_clear: true, debug: shown });
            return (buffer, 0);
        };
        let Content::Buffer { buffer, is_clear, debug, .. } = &mut self.entries[index].content else {
            unreachable!("found as a buffer")
        };
        *debug = shown;
        let missing = if *is_clear { 0 } else { clear };
        *is_clear = true;
        (buffer.clone(), missing)
    }

    /// A buffer of these bytes, which no frame changes before the GPU has read them: an encoder may record several
    /// lights before it is submitted, and frames may be in flight.
    fn filled(&mut self, gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let contents = std::mem::take(&mut self.scratch);
        let buffer = self.same_filled(label, &contents).or_else(|| self.refilled(gpu, label, &contents));
        let buffer = buffer.unwrap_or_else(|| {
            let buffer = buffer_of(gpu, label, &contents, usage | wgpu::BufferUsages::COPY_DST);
            self.add_filled(label, buffer, &contents)
        });
        self.scratch = contents;
        buffer
    }

    /// The buffer of a label that is filled with these bytes, or whose contents have this key.
    fn same_filled(&mut self, label: &'static str, wanted: &[u8]) -> Option<wgpu::Buffer> {
        let is_same =
            |e: &Entry| e.label == label && matches!(&e.content, Content::Filled { bytes, .. } if bytes == wanted);
        let (before, after) = self.entries.split_at(self.cursor.min(self.entries.len()));
        let position = after.iter().position(is_same).map(|i| i + before.len());
        let index = position.or_else(|| before.iter().position(is_same))?;
        Some(self.read_filled(index))
    }

    /// A buffer of a label that nothing reads any more, with other bytes of the same length.
    fn refilled(&mut self, gpu: &Gpu, label: &'static str, contents: &[u8]) -> Option<wgpu::Buffer> {
        let frame = self.frame;
        let is_free = |e: &Entry| match &e.content {
            Content::Filled { bytes, readers, .. } if e.label == label && e.asked < frame => {
                bytes.len() == contents.len() && readers.iter().all(|r| r.strong_count() == 0)
            }
            _ => false,
        };
        let index = self.entries.iter().position(is_free)?;
        if let Content::Filled { buffer, bytes, .. } = &mut self.entries[index].content {
            gpu.queue.write_buffer(buffer, 0, contents);
            bytes.copy_from_slice(contents);
        }
        Some(self.read_filled(index))
    }

    fn add_filled(&mut self, label: &'static str, buffer: wgpu::Buffer, bytes: &[u8]) -> wgpu::Buffer {
        let index = self.add(label, Content::Filled { buffer, bytes: bytes.to_vec(), readers: Vec::new() });
        self.read_filled(index)
    }

    /// Counts the present recording among the readers of a filled buffer.
    fn read_filled(&mut self, index: usize) -> wgpu::Buffer {
        let entry = &mut self.entries[index];
        let first_time = entry.asked < self.frame;
        entry.asked = self.frame;
        self.cursor = index + 1;
        let Content::Filled { buffer, readers, .. } = &mut entry.content else { unreachable!("a filled buffer") };
        if first_time || readers.is_empty() {
            readers.retain(|r| r.strong_count() > 0);
            readers.push(Arc::downgrade(&self.recording));
        }
        buffer.clone()
    }

    pub(super) fn uniform<T: HostStruct>(&mut self, gpu: &Gpu, label: &'static str, value: &T) -> wgpu::Buffer {
        self.scratch.clear();
        value.write_uniform(&mut self.scratch);
        self.filled(gpu, label, wgpu::BufferUsages::UNIFORM)
    }

    pub(super) fn uniforms<T: HostStruct>(
        &mut self,
        gpu: &Gpu,
        label: &'static str,
        values: impl Iterator<Item = T>,
    ) -> UniformArray {
        let (mut bytes, mut size) = (std::mem::take(&mut self.scratch), 0);
        bytes.clear();
        for value in values {
            let start = bytes.len();
            // A value is written at the start of a buffer of its own, as its alignment counts from there.
            let mut own = Vec::new();
            value.write_uniform(&mut own);
            bytes.extend_from_slice(&own);
            size = (bytes.len() - start) as u64;
            bytes.resize(bytes.len().next_multiple_of(UNIFORM_STRIDE as usize), 0);
        }
        self.scratch = bytes;
        UniformArray { buffer: self.filled(gpu, label, wgpu::BufferUsages::UNIFORM), size }
    }

    pub(super) fn buffer_of_key(
        &mut self,
        gpu: &Gpu,
        label: &'static str,
        key: &[u8],
        contents: impl FnOnce() -> Vec<u8>,
    ) -> wgpu::Buffer {
        self.same_filled(label, key).unwrap_or_else(|| {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
            let buffer = buffer_of(gpu, label, &contents(), usage);
            self.add_filled(label, buffer, key)
        })
    }

    pub(super) fn readback(&mut self, gpu: &Gpu, label: &'static str, size: u64) -> &Readback {
        let fits = |c: &Content| matches!(c, Content::Readback(r) if r.bytes() == size);
        let index = self
            .find(label, fits)
            .unwrap_or_else(|| self.add(label, Content::Readback(Readback::new(gpu, label, size))));
        match &self.entries[index].content {
            Content::Readback(readback) => readback,
            _ => unreachable!("found as a readback"),
        }
    }

    pub(super) fn debug_points(&mut self, label: &'static str, points: &[glam::Vec2]) {
        let fits = |c: &Content| matches!(c, Content::Points(known) if known == points);
        if self.find(label, fits).is_none() {
            self.add(label, Content::Points(points.to_vec()));
        }
    }
}

/// Puts all mip levels of textures into a state that the encoder knows. wgpu 30 takes the last state of a level within
/// a pass for its first where an earlier pass of the encoder used other levels only, and then misses a layout
/// transition.
pub(super) fn make_known<'a>(encoder: &mut wgpu::CommandEncoder, textures: impl Iterator<Item = &'a Texture>) {
    let to_resource = |texture: &'a Texture| wgpu::TextureTransition {
        texture: &texture.texture,
        selector: None,
        state: wgpu::TextureUses::RESOURCE,
    };
    encoder.transition_resources(std::iter::empty(), textures.map(to_resource));
}

/// A buffer that holds `bytes` from the start.
pub fn buffer_of(gpu: &Gpu, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents: bytes, usage })
}

/// A zeroed storage buffer of at least `size` bytes that can hold indirect arguments and uniforms, and be copied.
pub fn storage_buffer(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(16),
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::UNIFORM
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

/// A uniform buffer with the bytes of a host struct, for resources that outlive a frame.
pub fn uniform<T: HostStruct>(gpu: &Gpu, label: &str, value: &T) -> wgpu::Buffer {
    let mut bytes = Vec::new();
    value.write_uniform(&mut bytes);
    buffer_of(gpu, label, &bytes, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST)
}

/// The bytes of an array of host structs in a storage buffer.
pub fn storage_bytes<T>(values: &[T]) -> Vec<u8>
where
    T: encase::ShaderType + encase::ShaderSize + encase::internal::WriteInto,
{
    let mut buffer = encase::StorageBuffer::new(Vec::new());
    buffer.write(values).expect("a vector grows as needed");
    buffer.into_inner()
}
