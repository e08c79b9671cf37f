//! Metrics of a half, measured in the background whenever image or truth have changed.

use crate::job::Job;
use crate::readback::Readback;
use crate::truth::Truth;
use antumbra::Gpu;
use antumbra::gpu::texture::Texture;
use antumbra_metrics::{ErrorMetrics, Image, error_metrics};
use web_time::{Duration, Instant};

/// Shortest time between two measurements.
const PAUSE: Duration = Duration::from_millis(400);

/// The last metrics, and the pending measurement.
#[derive(Default)]
pub struct Measured {
    /// The metrics, or the error.
    pub metrics: Option<Result<ErrorMetrics, String>>,
    /// The last visibility, with the image's size.
    pub visibility: Option<([u32; 2], Vec<f32>)>,
    /// Inputs of the metrics: numbers of the image and of the truth.
    of: Option<(u64, u64)>,
    changes: u64,
    known_truth: u64,
    reading: Option<(u64, Readback)>,
    comparing: Option<((u64, u64), Job<Compared>)>,
    last: Option<Instant>,
}

type Compared = (Vec<f32>, Result<ErrorMetrics, String>);

impl Measured {
    /// Records that the image was drawn.
    pub fn outdated(&mut self) {
        self.changes += 1;
    }

    /// True if the metrics belong to the displayed image.
    pub fn is_current(&self) -> bool {
        self.of == Some((self.changes, self.known_truth))
    }

    /// Takes results and starts the next measurement.
    pub fn work(&mut self, gpu: &Gpu, visibility: &Texture, truth: &Truth, wake: impl Fn() + Send + 'static) {
        if let Some((of, result)) = self.comparing.as_ref().and_then(|(of, job)| Some((*of, job.poll()?))) {
            self.comparing = None;
            if let Ok((values, metrics)) = result {
                let size = visibility.texture.size();
                (self.metrics, self.of) = (Some(metrics), Some(of));
                self.visibility = Some(([size.width, size.height], values));
            }
        }
        self.known_truth = truth.image.lock().map_or(0, |p| p.version);
        let values = self.reading.as_ref().and_then(|(changes, reading)| Some((*changes, reading.poll_numbers()?)));
        if let Some((changes, values)) = values {
            self.reading = None;
            self.compare(changes, values, truth, wake);
        }
        let is_waiting = self.reading.is_some() || self.comparing.is_some();
        let is_due = self.last.is_none_or(|t| t.elapsed() > PAUSE);
        if !is_waiting && is_due && !self.is_current() && self.known_truth > 0 {
            self.last = Some(Instant::now());
            self.reading = Some((self.changes, Readback::start(gpu, visibility)));
        }
    }

    fn compare(&mut self, changes: u64, values: Vec<f32>, truth: &Truth, wake: impl Fn() + Send + 'static) {
        let Ok(image) = truth.image.lock() else { return };
        let ([width, height], of) = (image.size, (changes, image.version));
        if values.len() != image.visibility.len() {
            return;
        }
        let (true_values, valid) = (image.visibility.clone(), image.valid.clone());
        drop(image);
        let job = Job::start("Comparing", wake, move |_| async move {
            let image = |data| Image::new(width, height, data);
            let metrics = image(&values)
                .and_then(|test| error_metrics(test, image(&true_values)?, &valid))
                .map_err(|e| e.to_string());
            (values, metrics)
        });
        self.comparing = Some((of, job));
    }
}
