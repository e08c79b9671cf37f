//! Recording passes into the host's command encoder: one call a pass, each labelled and timed.

use crate::pipeline::{Binding, ComputePipeline, RenderTarget};
use crate::{Error, Gpu};
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

/// Records labelled passes into the host's encoder.
pub struct Recorder<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The host's encoder.
    pub encoder: &'a mut wgpu::CommandEncoder,
    timer: Option<&'a Timer>,
}

/// How much a compute pass does.
pub enum Work<'a> {
    /// At least this many threads; the shader leaves out those beyond.
    Threads([u32; 3]),
    /// This many workgroups.
    Groups([u32; 3]),
    /// As many workgroups as the buffer says at this byte.
    Indirect(&'a wgpu::Buffer, u64),
}

impl<'a> Recorder<'a> {
    /// Records without timing.
    pub fn new(gpu: &'a Gpu, encoder: &'a mut wgpu::CommandEncoder) -> Self {
        Recorder { gpu, encoder, timer: None }
    }

    /// Records with a GPU time for each pass; see [`Timer::finish`].
    pub fn timed(gpu: &'a Gpu, encoder: &'a mut wgpu::CommandEncoder, timer: &'a Timer) -> Self {
        Recorder { gpu, encoder, timer: Some(timer) }
    }

    /// A compute pass: what it is called, what runs, what it reads and writes (group 0), how much.
    pub fn compute(&mut self, label: &str, pipeline: &ComputePipeline, bindings: &[Binding], work: Work) {
        let group = pipeline.bind_group(self.gpu, 0, bindings);
        self.compute_pass(label, |_, pass| {
            pass.set_pipeline(&pipeline.pipeline);
            pass.set_bind_group(0, &group, &[]);
            dispatch(pass, pipeline, work);
        });
    }

    /// A compute pass of several dispatches that `record` makes.
    pub fn compute_pass(&mut self, label: &str, record: impl FnOnce(&Gpu, &mut wgpu::ComputePass)) {
        let query = self.timer.map(|t| t.profiler.begin_pass_query(label, self.encoder));
        let timestamp_writes = query.as_ref().and_then(|q| q.compute_pass_timestamp_writes());
        let mut pass =
            self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes });
        record(self.gpu, &mut pass);
        drop(pass);
        if let (Some(timer), Some(query)) = (self.timer, query) {
            timer.profiler.end_query(self.encoder, query);
        }
    }

    /// A render pass whose draws `record` makes.
    pub fn render_pass(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment>,
        record: impl FnOnce(&Gpu, &mut wgpu::RenderPass),
    ) {
        self.layered_pass(label, colors, depth, 1, record);
    }

    /// A render pass over `layers` layers of a depth array at once; what is in them stays.
    pub fn layered_depth_pass(
        &mut self,
        label: &str,
        view: &wgpu::TextureView,
        layers: u32,
        record: impl FnOnce(&Gpu, &mut wgpu::RenderPass),
    ) {
        let kept = wgpu::RenderPassDepthStencilAttachment {
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
            ..depth_target(view)
        };
        self.layered_pass(label, &[], Some(kept), layers, record);
    }

    fn layered_pass(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment>,
        layers: u32,
        record: impl FnOnce(&Gpu, &mut wgpu::RenderPass),
    ) {
        let query = self.timer.map(|t| t.profiler.begin_pass_query(label, self.encoder));
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: colors,
            depth_stencil_attachment: depth,
            timestamp_writes: query.as_ref().and_then(|q| q.render_pass_timestamp_writes()),
            multiview_mask: RenderTarget::layer_mask(layers),
            ..Default::default()
        });
        record(self.gpu, &mut pass);
        drop(pass);
        if let (Some(timer), Some(query)) = (self.timer, query) {
            timer.profiler.end_query(self.encoder, query);
        }
    }
}

/// Dispatches within a pass whose pipeline and groups are set.
pub fn dispatch(pass: &mut wgpu::ComputePass, pipeline: &ComputePipeline, work: Work) {
    match work {
        Work::Threads(t) => {
            let g = std::array::from_fn::<u32, 3, _>(|i| t[i].div_ceil(pipeline.workgroup[i]));
            pass.dispatch_workgroups(g[0], g[1], g[2]);
        }
        Work::Groups(g) => pass.dispatch_workgroups(g[0], g[1], g[2]),
        Work::Indirect(buffer, offset) => pass.dispatch_workgroups_indirect(buffer, offset),
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

/// A reversed-depth target that starts at infinity (0).
pub fn depth_target(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

/// GPU times of the passes of one frame.
pub struct Timer {
    profiler: GpuProfiler,
    supported: bool,
}

/// A pass and its GPU time in milliseconds; `None` where the adapter has no timestamps.
pub type PassTime = (String, Option<f64>);

impl Timer {
    /// A timer for a device.
    pub fn new(gpu: &Gpu) -> Result<Timer, Error> {
        let profiler = GpuProfiler::new(&gpu.device, GpuProfilerSettings::default())
            .map_err(|e| Error::Validation(e.to_string()))?;
        Ok(Timer { profiler, supported: gpu.capabilities.timestamps })
    }

    /// Submits the encoder, waits, and returns each pass with its time in the order of recording; passes that bear the
    /// same name are added up.
    pub fn finish(&mut self, gpu: &Gpu, mut encoder: wgpu::CommandEncoder) -> Result<Vec<PassTime>, Error> {
        self.profiler.resolve_queries(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        self.profiler.end_frame().map_err(|e| Error::Validation(e.to_string()))?;
        gpu.wait()?;
        let results = self.profiler.process_finished_frame(gpu.queue.get_timestamp_period()).unwrap_or_default();
        Ok(self.sum(&results))
    }

    /// Submits the encoder and does not wait; [`Timer::poll`] has the times of its passes some frames later.
    pub fn submit(&mut self, gpu: &Gpu, mut encoder: wgpu::CommandEncoder) -> Result<(), Error> {
        self.profiler.resolve_queries(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        self.profiler.end_frame().map_err(|e| Error::Validation(e.to_string()))
    }

    /// The times of the oldest submitted frame that has ended and was not asked for yet, as of [`Timer::finish`].
    pub fn poll(&mut self, gpu: &Gpu) -> Option<Vec<PassTime>> {
        let results = self.profiler.process_finished_frame(gpu.queue.get_timestamp_period())?;
        Some(self.sum(&results))
    }

    fn sum(&self, results: &[GpuTimerQueryResult]) -> Vec<PassTime> {
        let mut times: Vec<PassTime> = Vec::new();
        for r in results {
            let ms = r.time.as_ref().filter(|_| self.supported).map(|t| (t.end - t.start) * 1000.0);
            match times.iter_mut().find(|(name, _)| *name == r.label) {
                Some((_, total)) => *total = total.zip(ms).map(|(a, b)| a + b),
                None => times.push((r.label.clone(), ms)),
            }
        }
        times
    }
}
