//! A technique with its resources: the state that a renderer keeps for a light.

use crate::error::Error;
use crate::gpu::debug_view::DebugView;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::{Memory, Resources};
use crate::gpu::timer::Timer;
use crate::input::frame::Frame;
use crate::technique::{StatsFuture, Technique};
use crate::techniques::spec::Spec;

/// The shadows of one light by one technique. Textures and buffers are made by the first frame and kept.
pub struct Shadows<T: Technique + ?Sized = dyn Technique> {
    resources: Resources,
    technique: Box<T>,
}

impl<T: Technique> Shadows<T> {
    /// Shadows by this technique.
    pub fn new(technique: T) -> Shadows<T> {
        Shadows { resources: Resources::default(), technique: Box::new(technique) }
    }

    /// The technique.
    pub fn technique(&self) -> &T {
        &self.technique
    }
}

impl Shadows {
    /// Shadows by the technique of a SPEC, for command lines.
    pub fn from_spec(gpu: &Gpu, spec: &Spec) -> Result<Shadows, Error> {
        Ok(Shadows { resources: Resources::default(), technique: spec.make(gpu)? })
    }
}

impl<T: Technique + ?Sized> Shadows<T> {
    /// Records all passes that fill the frame's visibility. Nothing waits, and a frame like the last one makes no
    /// resource and no bind group.
    pub fn record(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, frame: &Frame) -> Result<(), Error> {
        self.record_timed(gpu, encoder, frame, None)
    }

    /// The same with a GPU time for each pass; see [`Timer::finish`].
    pub fn record_timed(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame,
        timer: Option<&Timer>,
    ) -> Result<(), Error> {
        let mut recorder = Recorder::new(gpu, encoder, &mut self.resources).timed(timer);
        let frame = frame.bind(&mut recorder)?;
        self.technique.record(&frame, &mut recorder)
    }

    /// GPU memory by the label of the pass that uses it.
    pub fn memory(&self) -> Vec<Memory> {
        self.resources.memory()
    }

    /// The textures and lists of the last frame, for viewers.
    pub fn debug_views(&self) -> Vec<DebugView> {
        self.resources.debug_views()
    }

    /// Keeps resources that only debug views show, which cost time and memory, from the next frame on or no longer.
    pub fn set_debug_capture(&mut self, on: bool) {
        self.resources.set_debug_capture(on);
    }

    /// Number of textures, buffers and bind groups that were made so far.
    pub fn resources_made(&self) -> u64 {
        self.resources.made()
    }

    /// Counts of the last frame, such as the number of maps. Waits for the GPU: for tests and reports.
    pub fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        self.technique.stats(gpu)
    }
}
