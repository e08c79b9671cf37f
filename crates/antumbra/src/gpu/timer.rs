//! GPU times of passes.

use super::device::Gpu;
use crate::error::Error;
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

/// GPU times of the passes of one frame.
pub struct Timer {
    pub(super) profiler: GpuProfiler,
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
