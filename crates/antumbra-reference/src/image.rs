//! A whole image on all cores.

use crate::tracer::Tracer;
use crate::view::{Pixel, View};
use antumbra_scene::Scene;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Sampling and size of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Pixels per row, > 0.
    pub width: u32,
    /// Rows, > 0.
    pub height: u32,
    /// Shadow rays of a pixel in all, > 0; rounded up to a multiple of `pixel_samples`. Powers of two are best
    /// distributed. A point light needs only one for each sub-pixel, and gets no more.
    pub light_samples: u32,
    /// Primary rays of a pixel, > 0; a square number gives a regular grid.
    pub pixel_samples: u32,
    /// Another seed gives other, independent light samples.
    pub seed: u64,
}

impl Settings {
    /// The usual quality, 1024 shadow rays and 16 primary rays per pixel, for an image of this size.
    pub fn of_size(width: u32, height: u32) -> Settings {
        Settings { width, height, light_samples: 1024, pixel_samples: 16, seed: 0 }
    }
}

/// The truth of one image. All lists are `width * height` long, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Fraction of the light's area that is seen, box-filtered over the pixel's sub-pixels; 1 where there is no
    /// surface.
    pub visibility: Vec<f32>,
    /// True where errors are to be measured: every sub-pixel sees a surface that faces the light and lies in front of
    /// it, the cosines between the direction to the light's centre and both normals over 0.1.
    pub valid: Vec<bool>,
    /// True where every sub-pixel sees such a surface and the smallest of these cosines lies between 0 and 0.1: errors
    /// there are a measure of their own.
    pub grazing: Vec<bool>,
    /// Estimated standard error of the visibility, for the given sub-pixels; on the safe side. Zero where nothing can
    /// stand between the pixel and the light.
    pub error: Vec<f32>,
    /// Shadow rays that were traced.
    pub rays: u64,
}

impl Reference {
    /// Root mean square of the standard errors over the valid pixels; 0 if there are none.
    pub fn rms_error(&self) -> f64 {
        let valid = || self.error.iter().zip(&self.valid).filter(|(_, v)| **v);
        let sum: f64 = valid().map(|(e, _)| f64::from(*e).powi(2)).sum();
        (sum / valid().count().max(1) as f64).sqrt()
    }

    fn of_pixels(settings: &Settings, pixels: &[Pixel]) -> Reference {
        Reference {
            width: settings.width,
            height: settings.height,
            visibility: pixels.iter().map(|p| p.visibility).collect(),
            valid: pixels.iter().map(|p| p.valid).collect(),
            grazing: pixels.iter().map(|p| p.grazing).collect(),
            error: pixels.iter().map(|p| p.error).collect(),
            rays: pixels.iter().map(|p| u64::from(p.rays)).sum(),
        }
    }
}

/// Errors of tracing.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum ReferenceError {
    /// The caller asked to stop.
    #[error("the ray-traced reference was cancelled")]
    Cancelled,
    /// A setting is zero.
    #[error("the reference's `{0}` is zero")]
    Zero(&'static str),
    /// The camera or the light has no direction or is not a number.
    #[error("the {0} has no usable direction: its target, up vector or size is degenerate")]
    Degenerate(&'static str),
}

/// Traces the whole image on the current rayon pool.
///
/// `progress` is called from any thread with the fraction that is done, in (0, 1]. Once `cancel` is set, the call ends
/// within about the time of a row.
pub fn trace(
    scene: &Scene,
    settings: &Settings,
    progress: &(dyn Fn(f32) + Sync),
    cancel: &AtomicBool,
) -> Result<Reference, ReferenceError> {
    check(scene, settings)?;
    let cancelled = || cancel.load(Ordering::Relaxed);
    if cancelled() {
        return Err(ReferenceError::Cancelled);
    }
    let tracer = Tracer::new(scene);
    let view = View::new(&tracer, &scene.camera, &scene.light, settings);
    let done = AtomicU32::new(0);
    let rows: Result<Vec<Vec<Pixel>>, ReferenceError> = (0..settings.height)
        .into_par_iter()
        .map(|y| {
            if cancelled() {
                return Err(ReferenceError::Cancelled);
            }
            let row = view.rows(y..y + 1);
            progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / settings.height as f32);
            Ok(row)
        })
        .collect();
    Ok(Reference::of_pixels(settings, &rows?.concat()))
}

/// Traces the hard shadow of the light's centre through given places of every pixel, in parts of a pixel from its upper
/// left corner: the result that a technique with samples at these positions must give.
///
/// # Panics
/// If there are no places.
pub fn trace_centre(scene: &Scene, size: [u32; 2], places: &[glam::Vec2]) -> Result<Reference, ReferenceError> {
    assert!(!places.is_empty(), "a pixel without places sees nothing");
    let settings = Settings {
        light_samples: places.len() as u32,
        pixel_samples: places.len() as u32,
        ..Settings::of_size(size[0], size[1])
    };
    check(scene, &settings)?;
    let tracer = Tracer::new(scene);
    let view = View::of_centre(&tracer, &scene.camera, &scene.light, size, places);
    let rows: Vec<Vec<Pixel>> = (0..size[1]).into_par_iter().map(|y| view.rows(y..y + 1)).collect();
    Ok(Reference::of_pixels(&settings, &rows.concat()))
}

fn check(scene: &Scene, settings: &Settings) -> Result<(), ReferenceError> {
    let s = settings;
    let named = [
        (s.width, "width"),
        (s.height, "height"),
        (s.light_samples, "light_samples"),
        (s.pixel_samples, "pixel_samples"),
    ];
    if let Some((_, name)) = named.into_iter().find(|(value, _)| *value == 0) {
        return Err(ReferenceError::Zero(name));
    }
    let camera = &scene.camera;
    if !(camera.eye.is_finite() && camera.target.is_finite() && camera.eye != camera.target) {
        return Err(ReferenceError::Degenerate("camera"));
    }
    let light = &scene.light;
    if !(light.center.is_finite()
        && light.target.is_finite()
        && light.center != light.target
        && light.size.is_finite()
        && light.size.min_element() >= 0.0)
    {
        return Err(ReferenceError::Degenerate("light"));
    }
    Ok(())
}
