//! Recording passes into the host's command encoder: one call a pass, each labelled and timed.

use super::bindings::Binding;
use super::device::Gpu;
use super::host_struct::HostStruct;
use super::pipeline::{ComputePipeline, RenderPipeline, RenderTarget};
use super::resources::{BufferDescription, Resources, UniformArray, make_known};
use super::texture::{Texture, TextureDescription};
use super::timer::Timer;
use crate::error::Error;
use wgpu_profiler::GpuProfilerQuery;

/// Records the passes of one frame into the host's encoder, with resources that are kept from frame to frame.
pub struct Recorder<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    encoder: &'a mut wgpu::CommandEncoder,
    resources: &'a mut Resources,
    timer: Option<&'a Timer>,
    open: Option<OpenPass>,
}

/// A compute pass that takes further dispatches: wgpu begins a command buffer for every pass, so fewer are cheaper.
/// With a timer, each label has a pass of its own.
struct OpenPass {
    label: &'static str,
    pass: wgpu::ComputePass<'static>,
    query: Option<GpuProfilerQuery>,
}

/// The size of a dispatch.
#[derive(Clone, Copy)]
pub enum Work<'a> {
    /// At least this many threads; the shader leaves out those beyond.
    Threads([u32; 3]),
    /// One thread per pixel of an image of this size.
    Pixels([u32; 2]),
    /// This many workgroups.
    Groups([u32; 3]),
    /// As many workgroups as the buffer says at this byte.
    Indirect(&'a wgpu::Buffer, u64),
}

impl Work<'_> {
    /// At least this many workgroups, in two dimensions: one dimension holds 65 535. The workgroup (x, y) has the index
    /// `x + y * num_workgroups.x`.
    pub fn groups(count: u32) -> Self {
        let width = count.clamp(1, 1 << 15);
        Work::Groups([width, count.div_ceil(width), 1])
    }
}

impl<'a> Recorder<'a> {
    /// Begins a frame of `resources`; it ends when the recorder is dropped.
    pub fn new(gpu: &'a Gpu, encoder: &'a mut wgpu::CommandEncoder, resources: &'a mut Resources) -> Self {
        resources.begin_frame(encoder);
        Recorder { gpu, encoder, resources, timer: None, open: None }
    }

    /// Measures a GPU time for each pass; see [`Timer::finish`].
    pub fn timed(mut self, timer: Option<&'a Timer>) -> Self {
        self.timer = timer;
        self
    }

    /// A texture, the same as in the last frame if that one fits.
    pub fn texture(&mut self, label: &'static str, description: TextureDescription) -> Texture {
        let (texture, is_new) = self.resources.texture(self.gpu, label, description);
        if is_new && description.mips > 1 {
            make_known(self.encoder(), std::iter::once(&texture));
        }
        texture
    }

    /// A storage buffer, the same as in the last frame if that one fits.
    pub fn buffer(&mut self, label: &'static str, description: BufferDescription) -> wgpu::Buffer {
        let (buffer, missing) = self.resources.buffer(self.gpu, label, description);
        if missing > 0 {
            self.encoder().clear_buffer(&buffer, 0, Some(missing));
        }
        buffer
    }

    /// A uniform buffer of this value, which stays until the GPU has done what is recorded.
    pub fn uniform<T: HostStruct>(&mut self, label: &'static str, value: &T) -> wgpu::Buffer {
        self.resources.uniform(self.gpu, label, value)
    }

    /// Uniforms of one kind.
    pub fn uniforms<T: HostStruct>(
        &mut self,
        label: &'static str,
        values: impl IntoIterator<Item = T>,
    ) -> UniformArray {
        self.resources.uniforms(self.gpu, label, values.into_iter())
    }

    /// A storage buffer whose contents follow from `key`: they are made when it is first asked for with this key.
    pub fn buffer_of_key(
        &mut self,
        label: &'static str,
        key: &[u8],
        contents: impl FnOnce() -> Vec<u8>,
    ) -> wgpu::Buffer {
        self.resources.buffer_of_key(self.gpu, label, key, contents)
    }

    /// The first words of a buffer as they were some frames ago, if they have arrived since the last call; sends the
    /// present ones on their way. Never waits.
    pub fn read_back<const N: usize>(&mut self, label: &'static str, source: &wgpu::Buffer) -> Option<[u32; N]> {
        self.close_pass();
        let readback = self.resources.readback(self.gpu, label, 4 * N as u64);
        let words = readback.take();
        readback.send(self.encoder, source);
        words
    }

    /// True if resources that only debug views show are wanted.
    pub fn captures_debug(&self) -> bool {
        self.resources.captures_debug()
    }

    /// Offers points of the light as a debug view.
    pub fn debug_points(&mut self, label: &'static str, points: &[glam::Vec2]) {
        self.resources.debug_points(label, points);
    }

    /// The host's encoder, for copies and clears between passes.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.close_pass();
        self.encoder
    }

    /// Zeroes the first `bytes` of a buffer, or all of it.
    pub fn clear(&mut self, buffer: &wgpu::Buffer, bytes: Option<u64>) {
        self.encoder().clear_buffer(buffer, 0, bytes);
    }

    /// A dispatch: its label, its pipeline, the resources by their names in the shader, its size. Dispatches that
    /// follow each other share a pass; each sees the results of those before.
    pub fn compute(
        &mut self,
        label: &'static str,
        pipeline: &ComputePipeline,
        bindings: &[&[Binding]],
        work: Work,
    ) -> Result<(), Error> {
        let group = self.resources.bind_group(self.gpu, &pipeline.layout, bindings)?;
        self.resources.assign_pass(label);
        let pass = self.open_pass(label);
        pass.set_pipeline(&pipeline.pipeline);
        pass.set_bind_group(0, &group, &[]);
        let size = pipeline.workgroup;
        match work {
            Work::Threads([x, y, z]) => {
                pass.dispatch_workgroups(x.div_ceil(size[0]), y.div_ceil(size[1]), z.div_ceil(size[2]));
            }
            Work::Pixels([x, y]) => pass.dispatch_workgroups(x.div_ceil(size[0]), y.div_ceil(size[1]), 1),
            Work::Groups([x, y, z]) => pass.dispatch_workgroups(x, y, z),
            Work::Indirect(buffer, offset) => pass.dispatch_workgroups_indirect(buffer, offset),
        }
        Ok(())
    }

    fn open_pass(&mut self, label: &'static str) -> &mut wgpu::ComputePass<'static> {
        if self.open.as_ref().is_some_and(|open| self.timer.is_some() && open.label != label) {
            self.close_pass();
        }
        let (timer, encoder) = (self.timer, &mut *self.encoder);
        let open = self.open.get_or_insert_with(|| {
            let query = timer.map(|t| t.profiler.begin_pass_query(label, encoder));
            let timestamp_writes = query.as_ref().and_then(|q| q.compute_pass_timestamp_writes());
            let descriptor = wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes };
            OpenPass { label, pass: encoder.begin_compute_pass(&descriptor).forget_lifetime(), query }
        });
        if open.label != label {
            open.label = label;
            open.pass.insert_debug_marker(label);
        }
        &mut open.pass
    }

    fn close_pass(&mut self) {
        let Some(OpenPass { pass, query, .. }) = self.open.take() else { return };
        drop(pass);
        if let (Some(timer), Some(query)) = (self.timer, query) {
            timer.profiler.end_query(self.encoder, query);
        }
    }

    /// A render pass over `layers` layers at once, whose draws `draw` records.
    pub fn render(
        &mut self,
        label: &'static str,
        colors: &[Option<wgpu::RenderPassColorAttachment>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment>,
        layers: u32,
        draw: impl FnOnce(&mut Draw) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.close_pass();
        self.resources.assign_pass(label);
        let query = self.timer.map(|t| t.profiler.begin_pass_query(label, self.encoder));
        let pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: colors,
            depth_stencil_attachment: depth,
            timestamp_writes: query.as_ref().and_then(|q| q.render_pass_timestamp_writes()),
            multiview_mask: RenderTarget::layer_mask(layers),
            ..Default::default()
        });
        let mut draws = Draw { gpu: self.gpu, resources: self.resources, pass };
        let result = draw(&mut draws);
        drop(draws);
        if let (Some(timer), Some(query)) = (self.timer, query) {
            timer.profiler.end_query(self.encoder, query);
        }
        result
    }
}

impl Drop for Recorder<'_> {
    fn drop(&mut self) {
        self.close_pass();
        self.resources.end_frame();
    }
}

/// The draws of a render pass.
pub struct Draw<'a> {
    gpu: &'a Gpu,
    resources: &'a mut Resources,
    /// The pass, for draws with the pipeline that is bound.
    pub pass: wgpu::RenderPass<'a>,
}

impl Draw<'_> {
    /// Sets a pipeline and its resources, by their names in the shader.
    pub fn bind(&mut self, pipeline: &RenderPipeline, bindings: &[&[Binding]]) -> Result<(), Error> {
        let group = self.resources.bind_group(self.gpu, &pipeline.layout, bindings)?;
        self.pass.set_pipeline(&pipeline.pipeline);
        self.pass.set_bind_group(0, &group, &[]);
        Ok(())
    }
}

/// A colour target that starts at `clear`.
pub fn color_target<'a>(
    view: &'a wgpu::TextureView,
    clear: wgpu::Color,
) -> Option<wgpu::RenderPassColorAttachment<'a>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
    })
}

/// A depth target that starts at `clear`, or keeps its values: reversed depth starts at infinity (0).
pub fn depth_target(
    view: &wgpu::TextureView,
    clear: Option<f32>,
) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
    let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
    Some(wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    })
}
