//! The ray-traced truth, from the cache where it is known already.

use crate::cli::TruthArgs;
use crate::error::CliError;
use crate::progress::{self, Progress};
use antumbra_metrics::{Figures, Image, MetricsError, RgbImage, figures, heat_map};
use antumbra_reference::cache::{Cached, trace_cached};
use antumbra_reference::{Reference, Settings, trace};
use antumbra_scene::Scene;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The largest side of a traced picture: the largest texture that GPUs have.
const MAX_SIDE: u32 = 16384;

/// The truth and how it was come by.
pub struct Truth {
    /// The picture.
    pub reference: Reference,
    /// Wall time that it took now, seconds.
    pub seconds: f64,
    /// True if it was read from the cache.
    pub was_stored: bool,
}

/// Traces a scene, or reads what was traced before.
pub fn of(scene: &Scene, size: [u32; 2], args: &TruthArgs) -> Result<Truth, CliError> {
    check_size(size)?;
    let settings = Settings {
        width: size[0],
        height: size[1],
        light_samples: args.light_samples,
        pixel_samples: args.pixel_samples,
        seed: args.seed,
    };
    let started = Instant::now();
    let progress = Progress::new("Tracing the truth");
    let show = |done| progress.set(done);
    let (reference, was_stored) = match cache_folder(args) {
        Some(folder) => {
            let cached = trace_cached(scene, &settings, &folder, &show, progress::cancelled())?;
            warn_if_not_kept(&cached, &folder);
            (cached.reference, cached.was_stored)
        }
        None => (trace(scene, &settings, &show, progress::cancelled())?, false),
    };
    Ok(Truth { reference, seconds: started.elapsed().as_secs_f64(), was_stored })
}

/// Refuses a picture that no GPU could be compared on.
pub fn check_size([width, height]: [u32; 2]) -> Result<(), CliError> {
    if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
        return Ok(());
    }
    Err(antumbra::Error::Size { what: "picture", width, height, max: MAX_SIDE }.into())
}

fn cache_folder(args: &TruthArgs) -> Option<PathBuf> {
    let named = args.cache.clone().filter(|dir| !dir.as_os_str().is_empty());
    if args.no_cache { None } else { named.or_else(|| Some(dirs::cache_dir()?.join("antumbra"))) }
}

fn warn_if_not_kept(cached: &Cached, folder: &Path) {
    if let Err(error) = &cached.stored {
        tracing::warn!("the reference cannot be kept in {}: {error}; --cache names another folder", folder.display());
    }
}

impl Truth {
    /// How far from it a technique's visibility is.
    pub fn figures(&self, spec: &str, visibility: &[f32]) -> Result<Figures, CliError> {
        self.against(spec, visibility, figures)
    }

    /// Where a technique's visibility strays from it.
    pub fn heat_map(&self, spec: &str, visibility: &[f32]) -> Result<RgbImage, CliError> {
        self.against(spec, visibility, heat_map)
    }

    fn against<T>(
        &self,
        spec: &str,
        visibility: &[f32],
        compare: impl Fn(Image, Image, &[bool]) -> Result<T, MetricsError>,
    ) -> Result<T, CliError> {
        let Reference { width, height, visibility: exact, valid, .. } = &self.reference;
        let image = |values| Image::new(*width, *height, values);
        let compared = image(visibility).and_then(|test| compare(test, image(exact)?, valid));
        compared.map_err(|source| CliError::Metrics { spec: spec.to_owned(), source })
    }

    /// One line about it for people.
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
