//! The ray-traced reference, from the cache where it was traced before.

use crate::{Error, Monitor};
use antumbra_metrics::{ErrorMetrics, Image, Metrics, MetricsError, RgbImage, error_metrics, heat_map, metrics};
use antumbra_reference::cache::{Cached, trace_cached};
use antumbra_reference::{Reference, Settings, trace};
use antumbra_scene::Scene;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Largest side of a reference in pixels: the largest texture of today's GPUs.
const MAX_SIDE: u32 = 16384;

/// Sampling and storage of a reference.
#[derive(Clone, Debug)]
pub struct TruthSettings {
    /// Shadow rays per pixel, shared among its pixel samples.
    pub light_samples: u32,
    /// Primary rays per pixel.
    pub pixel_samples: u32,
    /// Seed of the samples.
    pub seed: u64,
    /// Folder of the cache; none disables it.
    pub cache: Option<PathBuf>,
}

impl TruthSettings {
    /// For a point light: one shadow ray per primary ray is exact.
    pub fn of_point_light(&self) -> TruthSettings {
        TruthSettings { light_samples: self.pixel_samples, ..self.clone() }
    }
}

/// A reference and its origin.
pub struct Truth {
    /// The image.
    pub reference: Reference,
    /// Wall time of this run's tracing or reading, seconds.
    pub seconds: f64,
    /// True if it was read from the cache.
    pub was_stored: bool,
}

/// Fails unless both sides of an image are within 1 and the largest texture of today's GPUs.
pub fn check_size([width, height]: [u32; 2]) -> Result<(), Error> {
    if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
        return Ok(());
    }
    Err(antumbra::Error::Size { what: "image", width, height, max: MAX_SIDE }.into())
}

impl Truth {
    /// Traces a scene, or reads the reference from the cache.
    pub fn of(scene: &Scene, size: [u32; 2], settings: &TruthSettings, monitor: &dyn Monitor) -> Result<Truth, Error> {
        check_size(size)?;
        let TruthSettings { light_samples, pixel_samples, seed, cache } = settings;
        let [width, height] = size;
        let settings =
            Settings { width, height, light_samples: *light_samples, pixel_samples: *pixel_samples, seed: *seed };
        let started = Instant::now();
        let progress = monitor.task("Tracing the truth");
        let (reference, was_stored) = match cache {
            Some(folder) => {
                let cached = trace_cached(scene, &settings, folder, &*progress, monitor.stop())?;
                warn_if_not_kept(&cached, folder);
                (cached.reference, cached.was_stored)
            }
            None => (trace(scene, &settings, &*progress, monitor.stop())?, false),
        };
        Ok(Truth { reference, seconds: started.elapsed().as_secs_f64(), was_stored })
    }

    /// Error metrics of a technique's visibility.
    pub fn metrics(&self, spec: &str, visibility: &[f32]) -> Result<Metrics, Error> {
        self.against(spec, visibility, metrics)
    }

    /// The same over the pixels where the light is grazing, which [`Truth::metrics`] leaves out; `None` without such
    /// pixels.
    pub fn grazing_metrics(&self, spec: &str, visibility: &[f32]) -> Result<Option<ErrorMetrics>, Error> {
        let grazing = &self.reference.grazing;
        let some = grazing.contains(&true);
        some.then(|| self.against(spec, visibility, |test, truth, _| error_metrics(test, truth, grazing))).transpose()
    }

    /// Signed error of a technique's visibility as colours.
    pub fn heat_map(&self, spec: &str, visibility: &[f32]) -> Result<RgbImage, Error> {
        self.against(spec, visibility, heat_map)
    }

    fn against<T>(
        &self,
        spec: &str,
        visibility: &[f32],
        compare: impl Fn(Image, Image, &[bool]) -> Result<T, MetricsError>,
    ) -> Result<T, Error> {
        let Reference { width, height, visibility: exact, valid, .. } = &self.reference;
        let image = |values| Image::new(*width, *height, values);
        let compared = image(visibility).and_then(|test| compare(test, image(exact)?, valid));
        compared.map_err(|source| Error::Metrics { spec: spec.to_owned(), source })
    }

    /// One line for the terminal.
    pub fn summary(&self) -> String {
        let r = &self.reference;
        let valid = r.valid.iter().filter(|v| **v).count();
        let origin = match self.was_stored {
            true => "read from the cache".to_owned(),
            false => format!("{:.1} million shadow rays in {:.1} s", r.rays as f64 * 1e-6, self.seconds),
        };
        format!("estimated error {:.5} (root mean square over {valid} valid pixels); {origin}", r.rms_error())
    }
}

fn warn_if_not_kept(cached: &Cached, folder: &Path) {
    if let Err(error) = &cached.stored {
        tracing::warn!("the reference cannot be kept in {}: {error}; --cache names another folder", folder.display());
    }
}
