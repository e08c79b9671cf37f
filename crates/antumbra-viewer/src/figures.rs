//! The error figures of a half, measured off the frame whenever picture or truth have changed.

use crate::job::Job;
use crate::readback::Readback;
use crate::truth::Truth;
use antumbra::Gpu;
use antumbra::gpu::texture::Texture;
use antumbra_metrics::{ErrorFigures, Image, error_figures};
use web_time::{Duration, Instant};

/// Least time from one measurement to the next.
const PAUSE: Duration = Duration::from_millis(400);

/// What is known, and what is under way.
#[derive(Default)]
pub struct Measured {
    /// The figures, or why there are none.
    pub figures: Option<Result<ErrorFigures, String>>,
    /// Visibility of each pixel as it was last read, with the picture's size.
    pub visibility: Option<([u32; 2], Vec<f32>)>,
    /// What the figures stand for: changes of the picture, and of the truth.
    of: Option<(u64, u64)>,
    changes: u64,
    known_truth: u64,
    reading: Option<(u64, Readback)>,
    comparing: Option<((u64, u64), Job<Compared>)>,
    last: Option<Instant>,
}

type Compared = (Vec<f32>, Result<ErrorFigures, String>);

impl Measured {
    /// The picture was drawn anew.
    pub fn outdated(&mut self) {
        self.changes += 1;
    }

    /// True if the figures stand for what is shown.
    pub fn is_current(&self) -> bool {
        self.of == Some((self.changes, self.known_truth))
    }

    /// Goes on with what is to be done.
    pub fn work(&mut self, gpu: &Gpu, visibility: &Texture, truth: &Truth, wake: impl Fn() + Send + 'static) {
        if let Some((of, result)) = self.comparing.as_ref().and_then(|(of, job)| Some((*of, job.poll()?))) {
            self.comparing = None;
            if let Ok((values, figures)) = result {
                let size = visibility.texture.size();
                (self.figures, self.of) = (Some(figures), Some(of));
                self.visibility = Some(([size.width, size.height], values));
            }
        }
        self.known_truth = truth.picture.lock().map_or(0, |p| p.version);
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
        let Ok(picture) = truth.picture.lock() else { return };
        let ([width, height], of) = (picture.size, (changes, picture.version));
        if values.len() != picture.visibility.len() {
            return;
        }
        let (true_values, valid) = (picture.visibility.clone(), picture.valid.clone());
        drop(picture);
        let job = Job::start("Comparing", wake, move |_| async move {
            let image = |data| Image::new(width, height, data);
            let figures = image(&values)
                .and_then(|test| error_figures(test, image(&true_values)?, &valid))
                .map_err(|e| e.to_string());
            (values, figures)
        });
        self.comparing = Some((of, job));
    }
}
